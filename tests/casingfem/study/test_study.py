"""Studies: what a file says becomes objects; what is wrong with it is said all at once, by key."""

import json
import tomllib
from collections.abc import Iterator
from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import casingfem as cf
from tests.casingfem.study.study_texts import THIN, written

STUDIES = Path(__file__).parents[3] / "data" / "studies"

# the study of design.md, on a mesh that suits a test
FRUSTUM = (
    THIN
    + """[[imperfection]]
of = "radius"
harmonics = [{p = 8, cos = 0.004}, {p = 20, cos = 0.003}, {p = 4, cos = 0.0019, sin = 0.0006}]
[support.base]
kind = "clamped"
[modes]
count = 6
[mesh]
order = 4
rows = [0.0, 0.5, 1.0]
around = 11
"""
)

UPDATE = """
[update]
table = "table.csv"
[[update.parameter]]
name = "material.E"
lower = 150e9
upper = 250e9
"""


def problems_of(folder: Path, text: str) -> tuple[str, ...]:
    with pytest.raises(cf.errors.InputError) as caught:
        cf.load_study(written(folder, text))
    assert str(caught.value) == "\n".join(caught.value.problems)
    return caught.value.problems


def test_the_study_of_the_manual_becomes_its_shell(tmp_path):
    shell = cf.load_study(written(tmp_path, FRUSTUM)).shell
    assert (shell.chart.r_base, shell.chart.r_top, shell.chart.height) == (0.50, 0.45, 0.25)
    assert (shell.thickness, shell.material.E) == (3e-3, 210e9)
    assert isinstance(shell.supports["base"], cf.Clamped)
    assert shell.radius_defect.coefficients(4) == (0.0019, 0.0006)
    assert (shell.mesh.order, shell.mesh.rows, shell.mesh.around) == (4, (0.0, 0.5, 1.0), 11)


def test_an_order_alone_keeps_the_elements_of_the_default_mesh(tmp_path):
    plain, finer = (
        cf.load_study(written(tmp_path, FRUSTUM.partition("[mesh]")[0] + mesh)).shell.mesh
        for mesh in ("", "[mesh]\norder = 10\n")
    )
    assert (plain.order, plain.around) == (8, 29)
    assert (finer.order, finer.rows, finer.around) == (10, plain.rows, plain.around)


SINGLE = [file for file in sorted(STUDIES.glob("*.toml")) if "[chain]" not in file.read_text(encoding="utf-8")]


@pytest.mark.parametrize("file", SINGLE, ids=lambda file: file.stem)
def test_every_study_of_the_repository_loads(file):
    assert cf.load_study(file).shell.thickness > 0.0


@pytest.mark.parametrize(
    ("chart", "edge", "kind"),
    [
        ('kind = "cylinder"\nradius = 0.3\nheight = 0.4', "top", cf.Cylinder),
        ('kind = "panel"\nradius = 0.3\nlength = 0.4\nangle = 0.5', "root", cf.Panel),
        ('kind = "plate"\nlength = 0.4\nwidth = 0.2', "left", cf.Plate),
        ('kind = "twisted-plate"\nlength = 0.4\nwidth = 0.2\ntwist_deg = 30', "tip", cf.geometry.TwistedPlate),
    ],
)
def test_every_chart(tmp_path, chart, edge, kind):
    head = "[material]\nE = 1e9\nnu = 0\nrho = 1000\n[shell]\nthickness = 0.002\n"
    shell = cf.load_study(
        written(tmp_path, f'{head}[chart]\n{chart}\n[support.{edge}]\nkind = "shear-diaphragm"')
    ).shell
    assert isinstance(shell.chart, kind)
    assert isinstance(shell.supports[edge], cf.ShearDiaphragm)


def test_an_elastic_edge_with_its_pattern(tmp_path):
    spring = 'kind = "elastic"\nk_face = 1e13\nk_r = 2e8\naround = [{p = 4, cos = 0.3, sin = -0.1}]'
    support = cf.load_study(written(tmp_path, FRUSTUM.replace('kind = "clamped"', spring))).shell.supports["base"]
    assert (support.k_face, support.k_r, support.around.coefficients(4)) == (1e13, 2e8, (0.3, -0.1))


def test_an_elastic_edge_whose_springs_vary_each_in_its_way(tmp_path):
    spring = (
        'kind = "elastic"\nk_z = 1e9\nk_r = 2e8\naround.k_r = [{p = 4, cos = 0.3}]\naround.k_z = [{p = 2, sin = 0.1}]'
    )
    support = cf.load_study(written(tmp_path, FRUSTUM.replace('kind = "clamped"', spring))).shell.supports["base"]
    assert {name: field.harmonics for name, field in support.patterns.items()} == {"k_r": (4,), "k_z": (2,)}
    assert support.pattern("k_z").coefficients(2) == (0.0, 0.1)


@pytest.mark.parametrize(
    ("around", "words"),
    [
        ("around = [{p = 0, cos = 0.3}]", r"around: found harmonics \[0\], expected each p >= 1 once"),
        ("around = [{p = 4, cos = 0.3}, {p = 4}]", r"around: found harmonics \[4, 4\], expected each p >= 1 once"),
        ("around.k_r = [{p = 0, cos = 0.3}]", r"around.k_r: found harmonics \[0\], expected each p >= 1 once"),
    ],
)
def test_patterns_of_springs_have_waves_each_once(tmp_path, around, words):
    spring = f'kind = "elastic"\nk_face = 1e13\nk_r = 2e8\n{around}'
    with pytest.raises(cf.errors.InputError, match=words):
        cf.load_study(written(tmp_path, FRUSTUM.replace('kind = "clamped"', spring)))


def test_an_empty_pattern_is_none(tmp_path):
    spring = 'kind = "elastic"\nk_face = 1e13\naround = []'
    support = cf.load_study(written(tmp_path, FRUSTUM.replace('kind = "clamped"', spring))).shell.supports["base"]
    assert (support.around, support.k_face) == (None, 1e13)


def test_random_imperfections_of_one_seed_are_not_one_field(tmp_path):
    more = '[[imperfection]]\nof = "radius"\nrandom = "example"\nseed = 7\nscale = 0.5\n'
    more += '[[imperfection]]\nof = "thickness"\nrandom = [{p = 2, median = 0.01}, {p = 5, median = 0.002}]\nseed = 7\n'
    shell = cf.load_study(written(tmp_path, FRUSTUM + more)).shell
    random = shell.radius_defect.fields[1]
    assert isinstance(random, cf.field.RandomField)
    # .24 t at n = 2, over the mean radius, halved
    assert random.spectrum.median[0] == pytest.approx(0.5 * 0.24 * 3e-3 / 0.475, rel=1e-12)
    wall = shell.thickness_defect
    assert wall.spectrum.high / wall.spectrum.median == pytest.approx(1.8226, rel=1e-4)
    phase = [np.arctan2(*field.fit.coefficients(2)) for field in (random, wall)]
    assert phase[0] != pytest.approx(phase[1], abs=1e-3)


def test_imperfections_of_one_quantity_add_up(tmp_path):
    more = '[[imperfection]]\nof = "radius"\nharmonics = [{p = 8, cos = 0.001}]\n'
    more += '[[imperfection]]\nof = "thickness"\nharmonics = [{p = 2, sin = 0.01}]\n'
    more += '[[imperfection]]\nof = "modulus"\nharmonics = [{p = 4, sin = 0.02}]\n'
    more += '[[imperfection]]\nof = "density"\nharmonics = [{p = 4, cos = 0.03}]\n'
    shell = cf.load_study(written(tmp_path, FRUSTUM + more)).shell
    assert shell.modulus_defect.coefficients(4) == (0.0, 0.02)
    assert shell.density_defect.coefficients(4) == (0.03, 0.0)
    assert shell.radius_defect.coefficients(8)[0] == pytest.approx(0.005)
    assert shell.thickness_defect.coefficients(2) == (0.0, 0.01)


def survey(folder: Path, radius: float = 0.5, taper: float = -0.2) -> None:
    theta, z = np.meshgrid(np.arange(0.0, 360.0, 5.0), [0.0, 0.12, 0.25])
    r = (radius + taper * z) * (1.0 + 0.004 * np.cos(8 * np.radians(theta)))
    rows = "\n".join(f"{a},{b},{c!r}" for a, b, c in zip(theta.flat, z.flat, r.ravel().tolist(), strict=True))
    (folder / "survey.csv").write_text(f"# SYNTHETIC\ntheta_deg,z_m,radius_m\n{rows}\n")


SURVEYED = FRUSTUM.replace(FRUSTUM[FRUSTUM.index("harmonics") :].splitlines()[0], 'survey = "survey.csv"\nn_max = 12')


def test_a_survey_is_found_beside_the_study(tmp_path):
    survey(tmp_path)
    assert cf.load_study(written(tmp_path, SURVEYED)).shell.radius_defect.fit.amplitude(8) == pytest.approx(0.004)


def test_a_survey_keeps_its_heights_on_a_meridian_that_begins_anywhere(tmp_path):
    """The frustum as a meridian half a metre up: the same defect, along s now."""
    survey(tmp_path)
    rows = (tmp_path / "survey.csv").read_text().splitlines()
    moved = [f"{a},{float(z) + 0.5},{r}" for a, z, r in (row.split(",") for row in rows[2:])]
    (tmp_path / "survey.csv").write_text("\n".join([*rows[:2], *moved]) + "\n")
    start = SURVEYED.index("[chart]")
    end = SURVEYED.index("\n[", start)
    chart = '[chart]\nkind = "meridian"\nstart = [0.5, 0.5]\npiece = [{ to = [0.45, 0.75] }]\n'
    study = cf.load_study(written(tmp_path, SURVEYED[:start] + chart + SURVEYED[end:]))
    assert study.shell.radius_defect.fit.amplitude(8) == pytest.approx(0.004, rel=1e-5)


def test_a_second_survey_of_the_radius_is_refused(tmp_path):
    survey(tmp_path)
    again = '[[imperfection]]\nof = "radius"\nsurvey = "survey.csv"\nn_max = 12\n'
    (problem,) = problems_of(tmp_path, SURVEYED + again)
    assert "imperfection: found 2 surveys of the radius, expected one" in problem


def test_a_survey_of_another_casing_is_refused(tmp_path):
    survey(tmp_path, radius=0.8)
    (problem,) = problems_of(tmp_path, SURVEYED)
    assert "imperfection[1].survey" in problem
    assert "expected about 0.475 m" in problem


def test_all_problems_of_a_file_come_together(tmp_path):
    text = FRUSTUM.replace("nu = 0.3", "nu = 0.5").replace("thickness = 3.0e-3", "thickness = -3.0e-3")
    text = text.replace("[support.base]", "[support.bottom]") + UPDATE
    found = problems_of(tmp_path, text)
    assert [problem.split(": ")[1] for problem in found] == [
        "material.nu", "shell.thickness", "support.bottom", "update.table",
    ]  # fmt: skip
    assert all(problem.startswith(str(tmp_path / "study.toml")) for problem in found)


def test_one_mistake_is_one_problem(tmp_path):
    """What depends on a part that is wrong is not blamed for it."""
    (tmp_path / "table.csv").write_text("mode,n,freq_hz,sigma_hz\n1,8,370,1\n")
    spring = 'kind = "elastic"\nk_face = -1e13'
    text = FRUSTUM.replace('kind = "clamped"', spring) + UPDATE.replace("material.E", "support.base.k_face")
    (problem,) = problems_of(tmp_path, text)
    assert "support.base.k_face: found -10000000000000.0" in problem


def test_an_unknown_key_suggests_the_known_one(tmp_path):
    (problem, missing) = sorted(problems_of(tmp_path, FRUSTUM.replace("r_top", "rtop")), key=len, reverse=True)
    assert "chart.rtop: found an unknown key" in problem
    assert "did you mean r_top?" in problem
    assert "chart.r_top: found nothing, expected mean radius at z = height [m]" in missing


def test_start_values_move_the_start_but_not_the_study(tmp_path):
    cf.FrequencyTable.from_arrays(freq_hz=[370.0], sigma_hz=1.0, n=[8]).to_csv(tmp_path / "table.csv")
    study = cf.load_study(written(tmp_path, FRUSTUM + UPDATE + "start = 200e9\n"))
    assert (study.shell.material.E, study.start.material.E) == (210e9, 200e9)
    assert study.parameters == (cf.Parameter(name="material.E", lower=150e9, upper=250e9),)


def test_the_source_changes_with_every_file_it_depends_on(tmp_path):
    survey(tmp_path)
    first = cf.load_study(written(tmp_path, SURVEYED)).source["sha256"]
    survey(tmp_path, taper=-0.21)
    assert cf.load_study(tmp_path / "study.toml").source["sha256"] != first


ODD = [
    -1, 0, 10**30, 1e308, 5e-324, float("nan"), float("inf"), "", "x", "../..", "é" * 99, "\0", True, [], [1],
    [{}], [[1]], {}, {"a": 1},
]  # fmt: skip


def places(data: Any, above: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    for key, value in data.items() if isinstance(data, dict) else enumerate(data):
        yield (*above, key)
        if isinstance(value, dict | list):
            yield from places(value, (*above, key))


def problems_in(file: Path) -> tuple[str, ...]:
    try:
        cf.load_study(file)
    except cf.errors.InputError as error:
        return error.problems
    return ()


@pytest.mark.campaign
def inline(value):
    """A value as TOML writes it, tables within a line."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {inline(one)}" for key, one in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(inline, value)) + "]"
    return json.dumps(value) if isinstance(value, bool | str) else str(value)


def test_whatever_is_at_a_key_the_study_loads_or_states_what_is_wrong(tmp_path):
    (tmp_path / "table.csv").write_text("mode,n,freq_hz,sigma_hz\n1,8,370,1\n")
    spring = 'kind = "elastic"\nk_face = 1e13\naround = [{p = 4, cos = 0.3}]'
    whole = FRUSTUM.replace('kind = "clamped"', spring) + UPDATE + "sigma = 1e9\n"
    whole += "[[strip]]\nfrom = 0.0\nto = 0.125\nthickness = 4e-3\n"
    whole += '[reduce]\ninterface = "top"\nmodes = 9\nout = "a.npz"\n'
    data = tomllib.loads(whole)
    refused = 0
    for k, place in enumerate(places(data)):
        for odd in ODD[k % 12 :: 12]:  # `reports.verification.robustness.schema` puts all of them everywhere
            changed = deepcopy(data)
            owner: Any = changed
            for key in place[:-1]:
                owner = owner[key]
            owner[place[-1]] = odd
            (tmp_path / "study.toml").write_text(
                "\n".join(f"{key} = {inline(value)}" for key, value in changed.items())
            )
            found = problems_in(tmp_path / "study.toml")
            refused += bool(found)
            key = str(place[0])
            assert all(line.startswith(str(tmp_path / "study.toml")) for line in found)
            assert not found or any(f": {key}" in line for line in found), (place, odd, found)
    assert refused > 50


STRIPS = (
    FRUSTUM.replace("rows = [0.0, 0.5, 1.0]\n", "")
    + """
[[strip]]
from = 0.1
to = 0.15
thickness = 5e-3
material = {E = 70e9, nu = 0.33, rho = 2700.0}
[[strip]]
from = 0.24
to = 0.25
thickness = 12e-3
"""
)


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("from = 0.1\n", "", "strip[1].from: found nothing, expected start along the axis"),
        ("from = 0.1\n", "start = 0.1\n", "strip[1].start: found an unknown key, expected one of from, to, thickness"),
        ("from = 0.1\n", "from = 0.2\n", "strip[1]: found from = 0.2 and to = 0.15, expected from < to"),
        ("to = 0.25\n", "to = 0.26\n", "strip: strip[2] from 0.24 to 0.26 m reaches beyond the shell"),
        ("from = 0.24\n", "from = 0.14\n", "strip: strip[2] from 0.14 to 0.25 m overlaps strip[1]"),
        ("thickness = 12e-3", "thickness = -1.0", "strip[2].thickness: found -1.0, expected greater than 0"),
        ("order = 4", "order = 4\nrows = 3", "mesh: strip[1] from 0.1 to 0.15 m: no element"),
    ],
)
def test_strips_that_do_not_fit_are_named(tmp_path, old, new, line):
    assert old in STRIPS
    found = problems_of(tmp_path, STRIPS.replace(old, new))
    assert any(problem.startswith(f"{tmp_path / 'study.toml'}: {line}") for problem in found), found


BLADE = (STUDIES / "tapered_blade.toml").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("chord = [0.12, 0.10, 0.09]", "chord = [0.12, -0.1]", "chart.chord[2]: found -0.1, expected greater than 0"),
        ("chord = [0.12, 0.10, 0.09]", "chord = []", "chart.chord: "),
        ("chord = [0.12, 0.10, 0.09]", "", "chart.chord: found nothing, expected chord [m]"),
        ("along = [1.0, 0.6]", "along = [1.0, 0.0]", "taper.along[2]: found 0.0, expected greater than or equal"),
        (
            "camber_deg = [35.0, 12.0]",
            "camber_deg = 400",
            "chart.camber_deg: found 400, expected less than or equal to 360",
        ),
        ("camber_deg", "camber", "chart.camber: found an unknown key"),
        (
            "[taper]",
            "[[imperfection]]\nof = 'radius'\nharmonics = [{p = 2, cos = 0.01}]\n[taper]",
            "imperfection[1].of",
        ),
    ],
)
def test_blades_that_are_none_are_named(tmp_path, old, new, line):
    assert old in BLADE
    found = problems_of(tmp_path, BLADE.replace(old, new))
    assert any(problem.startswith(f"{tmp_path / 'study.toml'}: {line}") for problem in found), found
