"""Addresses of strips, laws, masses, bolts and rings: the number that each means, its unit, and names that are none."""

from dataclasses import replace

import pytest

import casingfem as cf

OWN = cf.Material(E=190e9, nu=0.29, rho=7900.0)
BOLTS = cf.Bolts(count=3, k=(1e8, 2e8, 4e8), k_rot=7.0, loose={2: 0.5})
SPRINGS = cf.ElasticEdge(k_r=3e8, k_z=4e8, around=cf.FourierField.of({0: 0.1, 4: (0.2, -0.1)}))
RING = cf.Ring(
    section=cf.edge.Section.rectangle(width=0.03, depth=0.02), material=replace(OWN, rho=8000.0), support=SPRINGS
)
STRIPS = (
    cf.Strip(start=0.0, end=0.1, thickness=4e-3),
    cf.Strip(start=0.1, end=0.15, thickness=6e-3, material=OWN),
)
MASSES = {
    "base": [cf.edge.EdgeMass(angle=0.1, mass=1.0)],
    "top": [cf.edge.EdgeMass(angle=a, mass=10.0 * a) for a in (0.2, 0.3)],
}


def named_numbers(shell):
    """Unit of each number by its address."""
    found = cf.updating.parameters(shell)
    return dict(zip(found.name, found.unit, strict=True))


def casing(frustum, base=BOLTS, top=RING):
    return frustum(supports={"base": base, "top": top}, strips=STRIPS, masses=MASSES)


def blade(steel):
    """A chart and a taper with laws of two and three stations, and plain numbers between."""
    chart = cf.Blade(length=0.3, chord=(0.1, 0.09, 0.07), camber=0.5, twist=(0.0, 0.4))
    taper = cf.Taper(along=(0.9, 0.5))
    return cf.Shell(chart=chart, thickness=3e-3, taper=taper, material=steel, supports={"root": cf.Clamped()})


NUMBERS = {
    "strip.1.thickness": 4e-3,
    "strip.2.thickness": 6e-3,
    "strip.2.material.E": 190e9,
    "strip.2.material.nu": 0.29,
    "strip.2.material.rho": 7900.0,
    "mass.base.1.mass": 1.0,
    "mass.base.1.angle": 0.1,
    "mass.top.1.mass": 2.0,
    "mass.top.2.mass": 3.0,
    "mass.top.2.angle": 0.3,
    "bolts.1.k": 4e8,
    "bolts.2.k": 2e8,
    "support.base.k": 4e8,
    "support.base.k_rot": 7.0,
    "support.base.bolts.3.k": 4e8,
    "support.top.section.depth": 0.02,
    "support.top.material.rho": 8000.0,
    "support.top.k_z": 4e8,
    "support.top.support.k_r": 3e8,
}


@pytest.mark.parametrize("name", NUMBERS)
def test_a_number_is_read_and_replaced_alone(frustum, name):
    shell = casing(frustum)
    assert cf.updating.get_value(shell, name) == NUMBERS[name]
    changed = cf.updating.with_value(shell, name, 1.25 * NUMBERS[name])
    for other, value in NUMBERS.items():
        expected = 1.25 * value if other == name else value
        if "support.base.k" in (name, other) and "k" in (name.split(".")[-1], other.split(".")[-1]):
            continue  # the k of all bolts and of one of them go together
        assert cf.updating.get_value(changed, other) == pytest.approx(expected, rel=1e-15), other


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("strip.0.thickness", "found strip '0', expected a number from 1"),
        ("strip.3.thickness", "found strip '3'"),
        ("strip.x.thickness", "found strip 'x'"),
        ("strip.1.width", "a strip, expected one of thickness, material.E, material.nu, material.rho"),
        ("strip.2.material", "number of a strip, expected one of thickness"),
        ("strip.2.material.G", "number of a strip, expected one of thickness"),
        ("strip.2.material.E.1", "number of a strip, expected one of thickness"),
        ("strip.2.matter.E", "number of a strip, expected one of thickness"),
        ("strip.1.material.nu", "strip 1 without a material of its own; vary material.nu"),
        ("mass.base.0.mass", "this shell: 1 on 'base', 2 on 'top'"),
        ("mass.base.2.mass", "expected mass.<edge>.<number>.mass or .angle"),
        ("mass.rim.1.mass", "expected mass.<edge>.<number>.mass or .angle"),
        ("mass.top.1.mass.kg", "expected mass.<edge>.<number>.mass or .angle"),
        ("mass.top.1", "expected mass.<edge>.<number>.mass or .angle"),
        ("mass.top.1.weight", "expected mass.<edge>.<number>.mass or .angle"),
        ("bolts.4.k", "'bolts.4.k': "),
        ("support.base.bolts.4.k", "'support.base.bolts.4.k': "),
        ("support.base.support.k", "'support.base.support.k': "),
        ("support.top.support", "'support.top.support': the numbers of this ring are section.width"),
        ("taper.along.1", "such parameter, expected a name that starts with material, chart, shell, radius, thickness"),
        ("material.E.1.2", "such parameter, expected a name that starts with material, chart, shell"),
        ("material.E.1", "expected nothing after it, as it is one number"),
    ],
)
def test_names_that_are_none_are_refused_in_words(frustum, name, words):
    with pytest.raises(cf.errors.InputError) as caught:
        cf.updating.get_value(casing(frustum), name)
    assert words in str(caught.value)


def test_bolts_need_no_edge_where_one_edge_has_them(frustum):
    both = casing(frustum, top=replace(RING, support=BOLTS))
    with pytest.raises(
        cf.errors.InputError, match=r"2 edges with bolts, expected one; name the edge as support\.<edge>\.bolts\.1\.k"
    ):
        cf.updating.get_value(both, "bolts.1.k")
    under = casing(frustum, base=cf.Clamped(), top=replace(RING, support=BOLTS))
    assert cf.updating.get_value(under, "bolts.2.k") == 2e8
    assert (
        cf.updating.get_value(cf.updating.with_value(under, "bolts.2.k", 1e8), "support.top.support.bolts.2.k") == 1e8
    )
    assert cf.updating.get_value(under, "support.top.k_rot") == 7.0


def test_a_shell_without_masses_says_so(frustum):
    with pytest.raises(cf.errors.InputError, match="this shell: none"):
        cf.updating.get_value(frustum(), "mass.base.1.mass")


@pytest.mark.parametrize(
    ("name", "value"),
    [("chart.chord.1", 0.1), ("chart.chord.3", 0.07), ("chart.twist.2", 0.4), ("chart.camber", 0.5),
     ("taper.along.2", 0.5)],
)  # fmt: skip
def test_a_law_has_a_number_at_each_station(steel, name, value):
    shell = blade(steel)
    assert cf.updating.get_value(shell, name) == value
    changed = cf.updating.with_value(shell, name, 0.45)
    names = [other for other in named_numbers(shell) if other != name]
    assert cf.updating.get_value(changed, name) == 0.45
    assert [cf.updating.get_value(changed, other) for other in names] == [
        cf.updating.get_value(shell, other) for other in names
    ]


@pytest.mark.parametrize("name", ["chart.chord", "chart.chord.0", "chart.chord.4", "chart.chord.x"])
def test_a_law_without_a_station_is_refused(steel, name):
    with pytest.raises(cf.errors.InputError, match="expected the number of a station after it"):
        cf.updating.get_value(blade(steel), name)


def test_every_number_of_a_casing_has_its_unit(frustum):
    shell = replace(casing(frustum), radius_defect=cf.FourierField.of({0: 0.1, 3: (0.1, 0.2)}))
    found = named_numbers(shell)
    ring = {"width": "m", "depth": "m", "area": "m^2", "I_r": "m^4", "I_z": "m^4", "J": "m^4"}
    constants = {"E": "Pa", "nu": "-", "rho": "kg/m^3"}
    springs = {"k_r": "N/m^2", "k_theta": "N/m^2", "k_z": "N/m^2", "k_rot": "N/rad", "k_face": "N/m^3"}
    assert found == {
        **{f"material.{name}": unit for name, unit in constants.items()},
        "shell.thickness": "m", "chart.r_base": "m", "chart.r_top": "m", "chart.height": "m",
        "radius.p0.cos": "-", "radius.p3.cos": "-", "radius.p3.sin": "-",
        "strip.1.thickness": "m", "strip.2.thickness": "m",
        **{f"strip.2.material.{name}": unit for name, unit in constants.items()},
        "support.base.k": "N/m", "support.base.k_rot": "N m/rad",
        **{f"support.base.bolts.{k}.k": "N/m" for k in (1, 2, 3)},
        **{f"support.top.section.{name}": unit for name, unit in ring.items()},
        **{f"support.top.material.{name}": unit for name, unit in constants.items()},
        **{f"support.top.{name}": unit for name, unit in springs.items()},
        "mass.base.1.mass": "kg", "mass.base.1.angle": "rad",
        **{f"mass.top.{k}.{name}": unit for k in (1, 2) for name, unit in (("mass", "kg"), ("angle", "rad"))},
    }  # fmt: skip
    assert all(cf.updating.get_value(shell, name) is not None for name in found)


def test_harmonics_of_springs_are_those_they_share_or_have_alone(frustum):
    shared = named_numbers(frustum(supports={"base": SPRINGS}))
    names = [f"support.base.around.{wave}" for wave in ("p0.cos", "p4.cos", "p4.sin")]
    assert [name for name in shared if ".p" in name] == names
    apart = cf.updating.with_value(frustum(supports={"base": SPRINGS}), "support.base.k_r.p2.sin", 0.3)
    own = {name for name in named_numbers(apart) if ".p2." in name}
    assert own == {"support.base.k_r.p2.cos", "support.base.k_r.p2.sin"}
    assert not any(".around." in name for name in named_numbers(apart))


def test_parameters_tell_value_and_unit_of_each_number(steel):
    told = cf.updating.parameters(blade(steel)).columns()
    rows = dict(zip(told["name"], zip(told["value"], told["unit"], strict=True), strict=True))
    assert rows["chart.twist.2"] == (0.4, "rad")
    assert rows["taper.along.1"] == (0.9, "-")
    assert rows["shell.thickness"] == (3e-3, "m")
    plate = cf.Shell(
        chart=cf.Plate(length=1.0, width=0.5), thickness=0.01, material=steel,
        masses={"tip": [cf.edge.EdgeMass(angle=0.25, mass=2.0)]},
    )  # fmt: skip
    assert named_numbers(plate)["mass.tip.1.angle"] == "rad or m"
