"""Blades: exact derivatives, other charts as limits, laws and tapers, published and exact frequencies."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from reports.verification import blades as verify_blades
from reports.verification.tapered_beam import cantilever, wedge
from tests.casingfem.slopes import assert_slopes
from tests.casingfem.structure.geometry.complex_step import assert_exact

WHOLE = cf.Blade(
    length=0.2, chord=(0.12, 0.1, 0.09), camber=(0.6, -0.1), twist=(0.1, 0.6), sweep=(0.0, 0.0, 0.02), lean=(0.0, 0.01)
)
A, B = np.meshgrid(np.linspace(0.0, 0.2, 5), np.linspace(-0.5, 0.5, 7))


def test_derivatives_equal_the_complex_step():
    assert_exact(WHOLE, atol=1e-12)


def test_a_twist_alone_is_a_twisted_plate():
    blade, plate = (
        cf.Blade(length=0.2, chord=0.1, twist=(0.0, 0.8)),
        cf.geometry.TwistedPlate(length=0.2, width=0.1, twist=0.8),
    )
    found, expected = blade.surface(A, B, None), plate.surface(A, 0.1 * B, None)
    np.testing.assert_allclose(found.x, expected.x, atol=1e-16)
    np.testing.assert_allclose(found.x11, expected.x11, atol=1e-14)
    np.testing.assert_allclose(found.x22 + 1.0, expected.x22 + 1.0, atol=1e-15)
    np.testing.assert_allclose(blade.directions(A, B), plate.directions(A, 0.1 * B), atol=1e-16)


def test_a_camber_alone_is_a_panel():
    radius, angle = 0.6, 0.5
    blade = cf.Blade(length=0.2, chord=2 * radius * np.sin(angle / 2), camber=angle).surface(A, B, None)
    panel = cf.Panel(radius=radius, length=0.2, angle=angle).surface(A, angle * B, None)
    moved = np.array([panel.x[2], panel.x[1], panel.x[0] - radius * np.cos(angle / 2)])
    np.testing.assert_allclose(blade.x, moved, atol=1e-15)


def test_chord_and_sweep_make_trapezoids_and_rhombs():
    trapezoid = cf.Blade(length=10.0, chord=(5.0, 1.0)).surface(np.array([0.0, 5.0, 10.0]), np.array([0.5]), None)
    np.testing.assert_allclose(trapezoid.x, [[0.0, 5.0, 10.0], [2.5, 1.5, 0.5], [0.0, 0.0, 0.0]], atol=1e-15)
    rhombus = verify_blades.RHOMBUS.surface(np.array([0.0, verify_blades.HEIGHT]), np.array([-0.5]), None)
    assert np.linalg.norm(rhombus.x[:, 1] - rhombus.x[:, 0]) == pytest.approx(10.0, rel=1e-14)


def test_it_is_a_chart_with_orthonormal_directions():
    d = WHOLE.directions(A, B)
    identity = np.broadcast_to(np.eye(3)[:, :, None, None], (3, 3, *A.shape))
    np.testing.assert_allclose(np.einsum("ai...,bi...->ab...", d, d), identity, atol=1e-15)
    assert isinstance(WHOLE, cf.geometry.Chart)


@pytest.mark.parametrize("law", [(), (1.0,) * 9, ((1.0, 2.0), (3.0, 4.0)), "wide", (1.0, np.nan), np.inf])
def test_refuses_laws_that_are_none(law):
    with pytest.raises(cf.errors.ModelError, match=r"chart\.chord: found") as caught:
        cf.Blade(length=0.2, chord=law)
    assert caught.value.code == "law-stations"


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"chord": (0.1, -0.01)}, r"chart\.chord falls to -0\.01 m"),
        ({"chord": (0.1, -0.05, 0.1)}, r"chart\.chord falls to -0\.05 m"),
        ({"camber": 6.3}, r"chart\.camber reaches 6\.3 rad"),
        ({"camber": (0.0, -7.0)}, r"chart\.camber reaches 7 rad"),
    ],
)
def test_refuses_sections_that_are_none(changes, message):
    with pytest.raises(cf.errors.ModelError, match=message) as caught:
        cf.Blade(**({"length": 0.2, "chord": 0.1} | changes))
    assert caught.value.code == "blade-shape"


def test_refuses_a_length_or_a_radius_field(steel):
    with pytest.raises(ValueError, match=r"chart\.length must be positive"):
        cf.Blade(length=0.0, chord=0.1)
    with pytest.raises(ValueError, match="a blade has no radius"):
        WHOLE.surface(A, B, cf.FourierField.of({2: 0.01}).derivatives(A, B))


@pytest.mark.parametrize("name", ["along", "across"])
def test_a_taper_must_leave_a_wall(name):
    with pytest.raises(cf.errors.ModelError, match=rf"taper\.{name} falls to 0") as caught:
        cf.Taper(**{name: (1.0, 0.0)})
    assert caught.value.code == "taper-thickness"


@pytest.mark.slow
def test_mirrored_blades_have_one_spectrum(steel):
    def freq(sign):
        chart = cf.Blade(length=0.2, chord=(0.1, 0.08), camber=(0.5 * sign, 0.2 * sign), twist=(0.0, 0.4 * sign))
        mesh = cf.ShellMesh(order=7, rows=1, around=1)
        return cf.modes(
            cf.Shell(chart=chart, thickness=3e-3, material=steel, supports={"root": cf.Clamped()}, mesh=mesh), 6
        ).freq

    np.testing.assert_allclose(freq(1), freq(-1), rtol=1e-9)


@pytest.mark.slow
def test_derivatives_equal_central_differences():
    shell = replace(verify_blades.fan_blade(), mesh=cf.ShellMesh(order=6, rows=1, around=1))
    names = (
        "chart.length", "chart.chord.2", "chart.camber.1", "chart.twist.2", "chart.sweep.3", "taper.along.2",
        "taper.across.1",
    )  # fmt: skip
    vary = [cf.Parameter(name=name, lower=-1.0, upper=1.0) for name in names]
    assert_slopes(shell, cf.modes(shell, 5), vary, part=1e-4, within=1e-6)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("chart.chord", "the number of a station after it, 1 to 3"),
        ("chart.chord.4", "the number of a station after it, 1 to 3"),
        ("chart.chord.0", "the number of a station after it, 1 to 3"),
        ("chart.length.1", "it is one number"),
        ("taper.along.tip", "the number of a station after it, 1 to 2"),
        ("taper.edge.1", r"'taper\.edge\.1': found no 'edge' in taper, expected one of along, across"),
    ],
)
def test_names_what_a_law_has(name, message):
    with pytest.raises(cf.errors.InputError, match=message):
        cf.updating.get_value(verify_blades.fan_blade(), name)


def test_a_shell_without_a_taper_has_none_to_vary(frustum):
    with pytest.raises(cf.errors.InputError, match="starts with material, chart, shell"):
        cf.updating.get_value(frustum(), "taper.along.1")


@pytest.mark.slow
def test_a_casing_may_taper_along_its_axis(frustum):
    """On the fast path too; a taper around leaves it."""
    casing = frustum(
        chart=cf.Frustum(r_base=0.2, r_top=0.18, height=0.3), thickness=10e-3, taper=cf.Taper(along=(1.2, 0.7)),
        mesh=cf.ShellMesh(order=9, rows=1, around=7),
    )  # fmt: skip
    assert casing.axisymmetric
    shell, meridian = (cf.modes(casing, 4, method=method) for method in ("shell", "fourier"))
    np.testing.assert_allclose(shell.freq, meridian.freq, rtol=1e-8)
    assert not replace(casing, taper=cf.Taper(across=(1.0, 0.9))).axisymmetric
    assert casing.thinnest == pytest.approx(7e-3)


@pytest.mark.slow
def test_tapered_beams_have_their_known_factors():
    """Kirchhoff's sharp wedge 5.315, 15.207, 30.020; a uniform cantilever 3.51602, 22.0345; two ways to one wedge."""
    np.testing.assert_allclose(wedge(0.0, 3), [5.315, 15.207, 30.020], atol=5e-4)
    np.testing.assert_allclose(cantilever(lambda x: 1.0, lambda x: 1.0, 2), [3.5160153, 22.0344916], rtol=1e-7)
    np.testing.assert_allclose(
        cantilever(lambda x: (1 - 0.7 * x) ** 3, lambda x: 1 - 0.7 * x, 2), wedge(0.3, 2), rtol=1e-7
    )


@pytest.mark.slow
@pytest.mark.parametrize(("part", "count"), [("fv32", 12), ("limits", 2)])
def test_exact_rows_pass(part, count):
    rows = getattr(verify_blades, part)()
    assert {row["verdict"] for row in rows} == {"pass"}
    assert len(rows) == count


@pytest.mark.slow
def test_the_rhombus_is_its_ritz_solution_and_the_print_is_not():
    rows = verify_blades.fv22(quick=True)
    assert [row["verdict"] for row in rows[:5]] == ["pass"] * 5
    assert max(abs(row["error %"]) for row in rows[:5]) < 5e-3
    assert max(abs(row["error %"]) for row in rows[5:]) > 0.9


@pytest.mark.slow
def test_a_wedge_flaps_as_a_beam_does():
    rows = verify_blades.beams(quick=True)
    assert max(abs(row["error %"]) for row in rows) < 1e-3


@pytest.mark.slow
def test_a_blade_of_every_law_is_its_solid():
    assert {row["verdict"] for row in verify_blades.against_solid(quick=True)} == {"pass"}


def test_bending_is_not_taken_for_membrane_motion():
    with pytest.raises(ValueError, match="not flat"):
        verify_blades.membrane(replace(verify_blades.fan_blade(), mesh=cf.ShellMesh(order=3, rows=1, around=1)), 2)
