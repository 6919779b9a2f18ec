"""Walls of layers: published frequencies, the isotropic limit, both ways of solving a casing, refusals."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
GRAPHITE = cf.shell.Lamina(E1=25e9, E2=1e9, nu12=0.25, G12=0.5e9, G13=0.5e9, G23=0.2e9, rho=1500.0)
LIKE_STEEL = cf.shell.Lamina(E1=210e9, E2=210e9, nu12=0.3, G12=STEEL.shear_modulus, G13=STEEL.shear_modulus,
                    G23=STEEL.shear_modulus, rho=7800.0)  # fmt: skip

# omega a^2/h sqrt(rho/E2) of square panels on shear diaphragms, first-order shear deformation with k = 5/6:
# J. N. Reddy, Exact solutions of moderately thick laminated shells, J. Eng. Mech. 110 (1984) 794-809
PUBLISHED = {  # plies from the inside out, a/h, R/a (none: a plate)
    ((0, 90), 100, None): 9.687, ((0, 90, 0), 100, None): 15.183, ((0, 90, 90, 0), 100, None): 15.184,
    ((0, 90), 10, None): 8.900, ((0, 90, 0), 10, None): 12.162, ((0, 90, 90, 0), 10, None): 12.226,
    ((0, 90), 100, 5): 16.668, ((0, 90, 0), 100, 5): 20.332, ((0, 90, 90, 0), 100, 5): 20.361,
    ((0, 90), 10, 5): 8.9082, ((0, 90, 0), 10, 5): 12.207, ((0, 90, 90, 0), 10, 5): 12.267,
}  # fmt: skip


def plies(angles, lamina=GRAPHITE):
    return tuple(cf.shell.Ply(thickness=1.0, angle_deg=angle, lamina=lamina) for angle in angles)


@pytest.mark.parametrize("case", PUBLISHED)
def test_cross_ply_panels_have_the_published_frequencies(case):
    """0.2 % at most, of the thick panel of two layers; 0.02 % elsewhere."""
    angles, slender, bent = case
    chart = cf.Plate(length=1.0, width=1.0) if bent is None else cf.Panel(radius=bent, length=1.0, angle=1.0 / bent)
    own = cf.Material(E=1e9, nu=0.25, rho=1500.0)
    held = dict.fromkeys(chart.edges, cf.edge.ShearDiaphragm())
    panel = cf.Shell(chart=chart, thickness=1.0 / slender, material=own, wall="linear", plies=plies(angles),
                     supports=held, mesh=cf.ShellMesh(order=6, rows=1, around=1))  # fmt: skip
    found = cf.modes(panel, 1).freq[0] * 2.0 * np.pi * slender * np.sqrt(1500.0 / 1e9)
    np.testing.assert_allclose(found, PUBLISHED[case], rtol=2e-3 if case == ((0, 90), 10, 5) else 2e-4)


def casing(**changes):
    given = {"chart": cf.Cylinder(radius=0.3, height=0.2), "thickness": 4e-3, "material": STEEL, "wall": "linear",
             "supports": {"base": cf.Clamped()}, "mesh": cf.ShellMesh(order=4, rows=2, around=9)}  # fmt: skip
    return cf.Shell(**(given | changes))


@pytest.mark.slow
def test_equal_layers_of_the_shells_own_material_are_no_layers():
    whole = cf.modes(casing(), 2).freq
    np.testing.assert_allclose(cf.modes(casing(plies=plies((0, 30, 77), LIKE_STEEL)), 2).freq, whole, rtol=1e-9)
    np.testing.assert_allclose(cf.modes(casing(plies=plies((0, 0), None)), 2).freq, whole, rtol=1e-9)


@pytest.mark.slow
def test_a_casing_by_harmonics_is_the_casing_as_a_whole():
    layered = casing(
        plies=(cf.shell.Ply(thickness=1.0), *plies((0, 90))),
        thickness=0.03,
        mesh=cf.ShellMesh(order=6, rows=1, around=7),
    )
    assert layered.axisymmetric
    one, other = (cf.modes(layered, 2, method=method) for method in ("fourier", "shell"))
    np.testing.assert_allclose(one.freq, other.freq, rtol=2e-5)
    assert one.nodal_diameters.tolist() == other.nodal_diameters.tolist()


@pytest.mark.slow
def test_layers_are_counted_from_the_inside_out():
    """Under pressure waves a stiff layer far out raises the ring's bending with its radius, 1/R^4 of inextension."""
    inner, outer = (casing(plies=p) for p in (plies((90, 0)), plies((0, 90))))
    assert inner.layers == inner.plies[::-1]  # the normal of a cylinder points in
    freq = [cf.modes(shell, 1).freq[0] for shell in (inner, outer)]
    assert freq[0] != pytest.approx(freq[1], rel=1e-4)
    flat = casing(
        chart=cf.Plate(length=0.2, width=0.2), supports={"root": cf.Clamped()}, plies=plies((90, 0)), mesh=None
    )
    assert flat.layers == flat.plies


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"wall": "curved"}, "found wall 'curved', expected \"linear\""),
        ({"strips": (cf.Strip(start=0.0, end=0.1, thickness=4e-3, material=STEEL),)}, "material of its own"),
        ({"plies": plies((0, 45)), "supports": {"base": cf.edge.Symmetry()}}, "plane of symmetry"),
        ({"plies": ("steel",)}, "found .*steel.*Ply"),
    ],
)
def test_refuses_what_layers_cannot_are_beside(changes, told):
    with pytest.raises(cf.errors.ModelError, match=told + ".*shell-plies"):
        casing(**({"plies": plies((0, 90))} | changes))


@pytest.mark.parametrize("change", [{"E1": 0.0}, {"G23": np.nan}, {"rho": -1.0}, {"nu12": 6.0}])
def test_refuses_laminae_that_are_none(change):
    with pytest.raises(cf.errors.ModelError, match=f"lamina.{next(iter(change))}.*shell-plies"):
        replace(GRAPHITE, **change)


@pytest.mark.parametrize("given", [{"thickness": 0.0}, {"thickness": 1.0, "angle_deg": np.inf}])
def test_refuses_plies_that_are_none(given):
    with pytest.raises(cf.errors.ModelError, match="shell-plies"):
        cf.shell.Ply(**given)
