"""Curved meridians: area, the cylinder as a limit, one problem a harmonic against the whole shell, what is refused."""

import numpy as np
import pytest

import casingfem as cf

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)


def shell(chart, **changes):
    parts = {"thickness": 2e-3, "material": STEEL, "supports": {"base": cf.Clamped()}}
    return cf.Shell(chart=chart, **(parts | changes))


@pytest.mark.slow
def test_a_meridian_of_great_radius_is_a_cylinder():
    """The arc's bow h^2/(8 R) changes frequencies by its share in the radius."""
    mesh = cf.ShellMesh(order=7, rows=2, around=11)
    straight = cf.modes(shell(cf.Cylinder(radius=0.3, height=0.2), mesh=mesh), 6).freq
    bows = []
    for radius in (1e3, 1e4):
        half = 0.1 / radius
        chart = cf.Revolved(profile=cf.geometry.Arc(radius=radius, start=-half, end=half, r0=0.3 - radius))
        bows.append(np.abs(cf.modes(shell(chart, mesh=mesh), 6).freq / straight - 1.0).max())
    assert bows[0] < 2e-3
    assert bows[0] / bows[1] == pytest.approx(10.0, rel=0.05)


@pytest.mark.slow
def test_bowl_by_harmonics_and_as_a_whole_agree():
    chart = cf.Revolved(profile=cf.geometry.Arc(radius=0.1, start=0.0, end=-1.3))
    bowl = shell(chart, supports={"top": cf.Clamped()}, mesh=cf.ShellMesh(order=7, rows=2, around=15))
    by_n, whole = (cf.modes(bowl, 8, method=method) for method in ("fourier", "shell"))
    np.testing.assert_allclose(whole.freq, by_n.freq, rtol=1e-7)
    assert by_n.nodal_diameters[:4].tolist() == whole.nodal_diameters[:4].tolist()


@pytest.mark.slow
def test_the_sense_of_the_meridian_does_not_matter():
    down, up = cf.geometry.Arc(radius=0.1, start=0.0, end=-1.2), cf.geometry.Arc(radius=0.1, start=-1.2, end=0.0)
    found = [
        cf.modes(shell(cf.Revolved(profile=arc), supports={edge: cf.Clamped()}), 6).freq
        for arc, edge in ((down, "top"), (up, "base"))
    ]
    np.testing.assert_allclose(*found, rtol=1e-9)


@pytest.mark.slow
def test_symmetry_plane_of_a_closed_shell_keeps_its_even_modes():
    whole = shell(
        cf.Cylinder(radius=0.3, height=0.4),
        supports={"base": cf.Clamped(), "top": cf.Clamped()},
        mesh=cf.ShellMesh(order=7, rows=4, around=27),
    )
    half = shell(
        cf.Cylinder(radius=0.3, height=0.2),
        supports={"base": cf.Clamped(), "top": cf.edge.Symmetry()},
        mesh=cf.ShellMesh(order=7, rows=2, around=27),
    )
    found, even = cf.modes(whole, 30), cf.modes(half, 6)
    first = {int(n): f for n, f in zip(found.nodal_diameters[::-1], found.freq[::-1], strict=True)}
    np.testing.assert_allclose(even.freq, [first[n] for n in even.nodal_diameters.tolist()], rtol=1e-5)
    np.testing.assert_allclose(cf.modes(half, 4, method="shell").freq, even.freq[:4], rtol=1e-7)


@pytest.mark.parametrize(
    ("start", "end", "code"),
    [
        (0.0, np.pi / 2, "meridian-axis"),
        (0.3, 0.3, "meridian-arc"),
        (0.0, 7.0, "meridian-arc"),
        (1.0, 3.0, "meridian-axis"),
    ],
)
def test_arcs_refused(start, end, code):
    with pytest.raises(cf.errors.ModelError) as caught:
        cf.geometry.Arc(radius=1.0, start=start, end=end)
    assert caught.value.code == code
