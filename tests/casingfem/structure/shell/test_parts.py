"""What a shell is made of: what varies around, where rings stand, geometry at points; bolts it does not follow."""

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.mesh.shell_mesh import make_grid
from casingfem.structure.shell.edges import edge_line
from casingfem.structure.shell.parts import ShellParts
from casingfem.structure.shell.variation import springs_per_wave, spurious_split

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
BRASS = cf.Material(E=90e9, nu=0.34, rho=8400.0)
CONE = cf.Frustum(r_base=0.5, r_top=0.4, height=0.3)
BAR = cf.edge.Section.rectangle(width=0.02, depth=0.01)
CARBON = cf.shell.Lamina(E1=140e9, E2=10e9, nu12=0.3, G12=5e9, G13=4e9, G23=3e9, rho=1600.0)


def parts(**changes):
    return ShellParts(**{"chart": CONE, "thickness": 0.02, "material": STEEL} | changes)


def laid(*angles):
    return tuple(cf.shell.Ply(thickness=1.0, angle_deg=angle, lamina=CARBON) for angle in angles)


@pytest.mark.parametrize(
    ("changes", "even"),
    [
        ({}, True),
        ({"taper": cf.Taper(along=(1.0, 0.5))}, True),
        ({"taper": cf.Taper(across=(1.0, 0.5))}, False),
        ({"masses": {"top": (cf.edge.EdgeMass(angle=0.0, mass=1.0),)}}, False),
        ({"rotation": cf.Rotation(omega=1.0)}, False),
        ({"plies": laid(0.0, 90.0)}, True),
        ({"plies": laid(0.0, 45.0)}, False),
        ({"supports": {"base": cf.Bolts(count=3, k=1.0)}}, False),
        ({"supports": {"base": cf.Ring(section=BAR)}}, True),
        ({"supports": {"base": cf.Ring(section=BAR, support=cf.Bolts(count=3, k=1.0))}}, False),
        ({"supports": {"base": cf.Clamped(), "top": cf.ElasticEdge(k_r=1.0)}}, True),
        ({"modulus_defect": cf.FourierField.of({0: 0.1})}, False),
        ({"chart": cf.Panel(radius=0.5, length=0.3, angle=1.0)}, False),
        ({"strips": (cf.Strip(start=0.0, end=0.1, thickness=0.01),)}, True),
    ],
)
def test_what_varies_around(changes, even):
    assert parts(**changes).axisymmetric is even


def test_rings_by_the_lines_that_carry_them():
    ring, web = cf.Ring(section=BAR), cf.edge.Stiffener(at=0.1, section=BAR, offset=(0.02, 0.0))
    shell = parts(
        supports={"top": ring, "base": cf.Clamped()},
        stiffeners=(web, cf.edge.Stiffener(at=0.2, section=BAR, offset=(0.02, 0.0))),
    )
    assert shell.stations == {"stiffener 1": 0.1, "stiffener 2": 0.2}
    assert list(shell.rings) == ["top", "stiffener 1", "stiffener 2"]
    assert (shell.rings["top"], shell.rings["stiffener 1"]) == (ring, web.ring)
    assert [shell.line_at(name) for name in ("base", "top", "stiffener 2")] == [0.0, 0.3, 0.2]
    field = cf.FourierField.of({2: 0.1})
    assert parts(radius_defect=field, density_defect=field).defects == {"radius": field, "density": field}


def test_wall_and_material_at_points():
    """In a strip of brass, tapered to a half, each quantity with its own field."""
    waves = {"radius": 0.01, "thickness": 0.2, "modulus": -0.3, "density": 0.4}
    fields = {f"{name}_defect": cf.FourierField.of({1: wave}) for name, wave in waves.items()}
    strips = (
        cf.Strip(start=0.1, end=0.2, thickness=0.03, material=BRASS),
        cf.Strip(start=0.2, end=0.3, thickness=0.04),
    )
    shell = parts(strips=strips, taper=cf.Taper(along=(1.0, 0.5)), **fields)
    at = shell.geometry(np.array([0.15, 0.25]), np.array([0.0, np.pi]))
    np.testing.assert_allclose(at.thickness, [0.03 * 0.75 * 1.2, 0.04 * (1 - 0.25 / 0.6) * 0.8], rtol=1e-13)
    np.testing.assert_allclose(at.E, [90e9 * 0.7, 210e9 * 1.3], rtol=1e-13)
    np.testing.assert_allclose(at.nu, [0.34, 0.3])
    np.testing.assert_allclose(at.rho, [8400.0 * 1.4, 7800.0 * 0.6], rtol=1e-13)
    np.testing.assert_allclose(at.surface.x[0], [0.45 * 1.01, -(0.5 - 0.25 / 3) * 0.99], rtol=1e-13)
    line = np.array([0.2, 0.2, 0.2])
    whose = shell.geometry(line, np.zeros(3), np.array([0.15, 0.25, 0.05])).thickness / (2 / 3 * 1.2)
    np.testing.assert_allclose(whose, [0.03, 0.04, 0.02], rtol=1e-13)


def test_an_edge_as_its_supports_see_it():
    """The top of the cone: 0.4 m around, curved towards the normal; the left side of a plate, its strips apart."""
    shell = cf.Shell(chart=CONE, thickness=0.02, material=STEEL, mesh=cf.ShellMesh(order=2, rows=1, around=9))
    line = edge_line(shell, make_grid(CONE, shell.mesh), "top")
    assert (line.order, line.closed, len(line.nodes)) == (2, True, 27)
    np.testing.assert_allclose(line.breaks, 2.0 * np.pi * np.arange(10) / 9, rtol=1e-14)
    np.testing.assert_allclose(line.nodal.stretch, 0.4, rtol=1e-14)
    assert line.weights.sum() == pytest.approx(2.0 * np.pi, rel=1e-14)
    np.testing.assert_allclose(
        line.nodal.bend, 3 / np.sqrt(10) / 0.4, rtol=1e-12
    )  # cosine of the slope over the radius
    flat = cf.Shell(chart=CONE, thickness=0.02, material=STEEL, wall="linear", mesh=shell.mesh)
    assert np.abs(edge_line(flat, make_grid(CONE, shell.mesh), "top").nodal.bend).max() == 0.0
    there = line.frame(np.array([0.3, 1.0]))
    np.testing.assert_allclose([there.a, there.b], [[0.3, 0.3], [0.3, 1.0]])
    strips = (cf.Strip(start=0.0, end=0.1, thickness=5e-3),)
    plate = cf.Shell(chart=cf.Plate(length=0.4, width=0.2), thickness=2e-3, material=STEEL, strips=strips,
                  mesh=cf.ShellMesh(order=2, rows=(0.0, 0.25, 1.0), around=1))  # fmt: skip
    side = edge_line(plate, make_grid(plate.chart, plate.mesh), "left")
    np.testing.assert_allclose(side.nodal.thickness, np.repeat([5e-3, 2e-3], 3))
    np.testing.assert_allclose(side.breaks, [0.0, 0.1, 0.4], atol=1e-15)
    there = side.frame(np.array([0.3, 0.05]))
    np.testing.assert_allclose([there.a, there.b], [[0.3, 0.05], [-0.1, -0.1]])


@pytest.mark.parametrize("ringed", [False, True])
def test_bolts_that_a_mesh_does_not_follow_are_told_by_what_they_hold(ringed):
    """The wall, or the ring on it: its width and material."""
    bolts, mesh = cf.Bolts(count=24, k=5e8, k_rot=1e4), cf.ShellMesh(order=5, rows=1, around=21)
    wide = cf.edge.Section.rectangle(width=0.05, depth=0.02)
    held = cf.Ring(section=wide, material=BRASS, support=bolts) if ringed else bolts
    ratio = springs_per_wave(bolts, 90e9, 0.34, 0.05) if ringed else springs_per_wave(bolts, 210e9, 0.3, 0.02)
    words = (
        f"support.base: 24 bolts on 21 elements around split pairs .* by some {spurious_split(bolts, mesh, ratio):.0e}"
    )
    with pytest.warns(cf.errors.ModelWarning, match=words):
        cf.Shell(chart=CONE, thickness=0.02, material=STEEL, mesh=mesh, supports={"base": held})


def test_bolts_along_a_side_lie_on_its_length():
    def plate(first):
        bolts = cf.Bolts(count=2, k=1e6, spacing=0.2, first_angle=first, width=0.08)
        cf.Shell(chart=cf.Plate(length=0.3, width=0.1), thickness=2e-3, material=STEEL, supports={"left": bolts})

    plate(0.04)
    plate(0.06)
    for first in (0.039, 0.061):
        with pytest.raises(ValueError, match=r"support\.left: patches from .* on an edge from 0 to 0\.3"):
            plate(first)


def test_a_plain_fit_is_what_a_survey_is_given(tmp_path):
    """A stray point is told and not set aside; a part beside its axis is told and not moved."""
    theta = np.arange(0.0, 360.0, 5.0)
    value = 0.5 + 1e-3 * np.cos(np.radians(theta)) + 1e-6 * np.cos(np.radians(17.0 * theta**2))
    path = tmp_path / "rig.csv"
    path.write_text(
        "theta_deg,z_m,radius_m\n" + "".join(f"{t},0,{v!r}\n" for t, v in zip(theta, value.tolist(), strict=True))
    )
    for read in (
        lambda: cf.SurveyField.from_csv(path, n_max=4),
        lambda: cf.SurveyField.from_points(np.radians(theta), 0.0 * theta, value, n_max=4),
    ):
        with pytest.warns(cf.errors.ModelWarning, match="the part stood 1 mm off the axis towards 0 deg"):
            survey = read()
        assert survey.axis is None
        assert survey.set_aside == ()
        assert survey.fit.amplitude(1) == pytest.approx(2e-3, rel=1e-3)
    value[10] += 1e-3
    with pytest.warns(cf.errors.ModelWarning) as told:
        doubted = cf.SurveyField.from_points(np.radians(theta), 0.0 * theta, value, n_max=4)
    assert [str(w.message).rsplit("[", 1)[1] for w in told] == ["survey-stray]", "survey-eccentric]"]
    assert [round(theta) for theta, _, _ in doubted.doubted] == [50]
    assert doubted.set_aside == ()
    lines = [f"{t},0,{v!r}\n" for t, v in zip(theta, value.tolist(), strict=True)]
    path.write_text("theta_deg,z_m,radius_m\n" + "".join(lines))
    with pytest.warns(cf.errors.ModelWarning):
        assert cf.SurveyField.from_csv(path, n_max=4).doubted == doubted.doubted
