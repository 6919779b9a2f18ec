"""Rings: sections, closed forms of free rings, energy of rigid motions, the shell and its harmonics alike, masses."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from reports.verification.rubs.harmonic_basis import harmonic_basis
from tests.casingfem.slopes import assert_slopes

BAR = cf.edge.Section.rectangle(width=0.04, depth=0.03)
COARSE = cf.ShellMesh(order=6, rows=1, around=9)
HELD = cf.Ring(section=BAR, support=cf.ElasticEdge(k_r=3e8, k_theta=2e8, k_z=4e8, k_rot=1e5))


@pytest.mark.slow
def test_the_shell_with_a_ring_is_its_harmonics(frustum):
    """Eccentric ring on springs: the two-dimensional shell against one small problem for each n."""
    eccentric = replace(HELD, offset=(0.02, -0.05), foot=(-0.01, -0.03))
    casing = frustum(supports={"base": eccentric}, mesh=cf.ShellMesh(order=7, rows=1, around=19))
    exact, found = cf.modes(casing, 12), cf.modes(casing, 12, method="shell")
    np.testing.assert_allclose(found.freq, exact.freq, rtol=2e-6)
    assert found.splits.max() < 1e-9
    np.testing.assert_array_equal(found.nodal_diameters, exact.nodal_diameters)
    for pair in exact.doublets[:2]:  # the rings' own turns, in the space of the pair
        a, b = exact.own[:, pair], found.own[:, pair]
        np.testing.assert_allclose(np.abs(np.linalg.det(np.linalg.lstsq(a, b, rcond=None)[0])), 1.0, rtol=1e-4)
        assert np.linalg.norm(a @ np.linalg.lstsq(a, b, rcond=None)[0] - b) < 1e-3 * np.linalg.norm(b)


@pytest.mark.slow
@pytest.mark.parametrize("heavy", ["ring", "masses"])
def test_modes_of_a_tube_on_what_outweighs_it_are_not_rigid(steel, heavy):
    """As if clamped there: its lowest bending mode resembles a turn about the heavy end, which does not move."""
    lead = replace(steel, rho=10.0 * steel.rho)
    parts = {
        "ring": {
            "supports": {"base": cf.Ring(section=cf.edge.Section.rectangle(width=0.05, depth=0.6), material=lead)}
        },
        "masses": {"masses": {"base": [cf.edge.EdgeMass(angle=angle, mass=400.0) for angle in (0.0, 2.1, 4.2)]}},
    }
    tube = cf.Shell(
        chart=cf.Cylinder(radius=0.05, height=2.0),
        thickness=5e-3,
        material=steel,
        mesh=cf.ShellMesh(order=6, rows=3, around=5),
        **parts[heavy],
    )
    found = cf.modes(tube, 8)
    assert found.rigid == 6
    assert found.freq[5] < 1e-3 * found.freq[6]


@pytest.fixture(scope="module")
def heavy(frustum):
    """A casing on a ring whose masses part all pairs, and its modes."""
    masses = {"base": [cf.edge.EdgeMass(angle=0.2, mass=3.0), cf.edge.EdgeMass(angle=1.1, mass=2.0)]}
    casing = frustum(supports={"base": HELD}, mesh=COARSE, masses=masses)
    return casing, cf.modes(casing, 6)


@pytest.mark.slow
def test_derivatives_with_a_ring_and_a_mass(heavy):
    """Against central differences of single modes; the ring's steel is the casing's."""
    names = ("material.E", "material.rho", "shell.thickness", "chart.r_base", "support.base.k_z")
    vary = [cf.Parameter(name=name, lower=0.0, upper=1e15) for name in names]
    assert_slopes(*heavy, vary, part=3e-5, within=1e-6)


@pytest.mark.slow
def test_reduction_of_a_casing_on_a_ring(frustum):
    """Free modes with residual compliance answer a static push as the harmonics do."""
    casing = frustum(supports={"base": HELD}, mesh=cf.ShellMesh(order=7, rows=1, around=11))
    rim = cf.Rim("top", n_max=4)
    whole, exact = cf.reduce(casing, rim, modes=10), harmonic_basis(casing, rim, orders=2)
    scale = np.abs(exact.compliance).max()
    np.testing.assert_allclose(whole.compliance, exact.compliance, atol=1e-6 * scale)
    held = cf.reduce(casing, rim, modes=10, method="craig-bampton")
    np.testing.assert_allclose(held.compliance, exact.compliance, atol=1e-6 * scale)


@pytest.mark.slow
def test_a_stiff_massless_ring_keeps_the_edge_round(frustum, steel):
    """A ring without mass only stiffens; a huge one on stiff springs is a clamp."""
    light = cf.Material(E=steel.E, nu=steel.nu, rho=1e-6)
    springs = cf.ElasticEdge(k_face=1e12)
    bare = cf.modes(frustum(supports={"base": springs}), 8).freq
    ringed = cf.modes(frustum(supports={"base": cf.Ring(section=BAR, material=light, support=springs)}), 8).freq
    assert np.all(ringed > bare)
    block = cf.Ring(
        section=cf.edge.Section.rectangle(width=0.2, depth=0.2),
        material=cf.Material(E=2e15, nu=0.3, rho=1e-3),
        support=cf.ElasticEdge(k_face=1e16),
    )
    clamped = cf.modes(frustum(supports={"base": cf.Clamped()}), 8).freq
    np.testing.assert_allclose(cf.modes(frustum(supports={"base": block}), 8).freq, clamped, rtol=1e-3)


@pytest.mark.slow
def test_bolts_under_a_ring_split_only_what_their_number_allows(frustum):
    ring = cf.Ring(section=BAR, support=cf.Bolts(count=8, k=5e7))
    found = cf.modes(frustum(supports={"base": ring}, mesh=cf.ShellMesh(order=6, rows=1, around=16)), 16)
    n = np.array([found.nodal_diameters[low] for low, _ in found.doublets])
    assert found.splits[2 * n % 8 != 0].max() < 1e-9
    assert found.splits[2 * n % 8 == 0].max() > 1e-4
    assert cf.updating.get_value(found.shell, "bolts.3.k") == 5e7
    assert cf.updating.with_value(found.shell, "bolts.3.k", 1e7).supports["base"].support.loose[3] == pytest.approx(0.2)


@pytest.mark.parametrize(
    ("make", "code"),
    [
        (lambda: cf.edge.Section.rectangle(width=-0.04, depth=0.03), "ring-section"),
        (lambda: cf.edge.Section.circle(diameter=float("nan")), "ring-section"),
        (lambda: replace(BAR, J=0.0), "ring-section"),
        (lambda: cf.Ring(section=BAR, offset=(0.0, float("inf"))), "ring-offset"),
        (lambda: cf.Ring(section=BAR, foot=(0.0,)), "ring-offset"),
        (lambda: cf.Ring(section=BAR, support=cf.Clamped()), "ring-support"),
        (lambda: cf.edge.EdgeMass(angle=0.0, mass=-1.0), "mass-value"),
        (lambda: cf.edge.EdgeMass(angle=float("nan"), mass=1.0), "mass-value"),
        (lambda: cf.edge.EdgeMass(angle=0.0, mass=float("inf")), "mass-value"),
    ],
)
def test_refuses_rings_and_masses_that_are_none(make, code):
    with pytest.raises(cf.errors.ModelError) as caught:
        make()
    assert caught.value.code == code


def test_a_mass_of_nothing_is_a_mass():
    """An update may start from it, and a sweep pass through it."""
    assert cf.edge.EdgeMass(angle=0.0, mass=0.0).mass == 0.0


def test_rings_and_masses_are_on_edges_that_run_around(steel, frustum):
    panel = cf.Panel(radius=0.6, length=0.3, angle=0.5)
    with pytest.raises(cf.errors.ModelError, match="ring-edge"):
        cf.Shell(chart=panel, thickness=3e-3, material=steel, supports={"left": cf.Ring(section=BAR)})
    with pytest.raises(cf.errors.ModelError, match="ends on the fixed edge 'left'"):
        cf.Shell(
            chart=panel, thickness=3e-3, material=steel, supports={"root": cf.Ring(section=BAR), "left": cf.Clamped()}
        )
    with pytest.raises(cf.errors.ModelError, match="mass-edge"):
        frustum(masses={"rim": [cf.edge.EdgeMass(angle=0.0, mass=1.0)]})


@pytest.mark.parametrize(
    ("sides", "factor"),
    [(1.0, 0.1406), (1.2, 0.166), (1.5, 0.196), (2.0, 0.229), (3.0, 0.263), (5.0, 0.291), (10.0, 0.312)],
)
def test_the_torsion_of_a_rectangle_is_the_published_one(sides, factor):
    """J = factor a b^3, whichever side is named first (Timoshenko & Goodier, Theory of Elasticity, art. 109)."""
    a, b = sides * 4e-3, 4e-3
    for section in (cf.edge.Section.rectangle(width=a, depth=b), cf.edge.Section.rectangle(width=b, depth=a)):
        assert section.J == pytest.approx(factor * a * b**3, abs=5.1e-4 * a * b**3)
