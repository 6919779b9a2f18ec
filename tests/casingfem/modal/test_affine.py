"""One reduced basis for many changes: against full solutions, and its derivatives."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from casingfem.modal.affine import affine_model, bolt_changes, mass_changes

BOLTS = cf.Bolts(count=8, k=1e8, k_rot=1e3)
COARSE = cf.ShellMesh(order=6, rows=(0.0, 0.05, 1.0), around=8)


@pytest.fixture(scope="module")
def casing(frustum):
    return frustum(supports={"base": BOLTS}, mesh=COARSE)


@pytest.fixture(scope="module")
def model(casing):
    system = cf.shell.assemble(casing)
    return affine_model(system, bolt_changes(system, "base"), 60)


@pytest.mark.slow
@pytest.mark.parametrize("loose", [{3: 0.3}, {2: 0.3, 7: 0.5}])
def test_loose_bolts_are_as_in_full_solutions(casing, model, loose):
    x = np.zeros(8)
    x[[bolt - 1 for bolt in loose]] = [factor - 1.0 for factor in loose.values()]
    found = model.modes(x, 10)
    full = cf.modes(replace(casing, supports={"base": replace(BOLTS, loose=loose)}), 10)
    np.testing.assert_allclose(found.freq, full.freq, rtol=1e-5)
    assert np.array_equal(found.nodal_diameters, full.nodal_diameters)
    assert found.doublets == full.doublets
    turn = np.sin(np.radians(found.angle_deg - full.angle_deg) * found.nodal_diameters)
    np.testing.assert_allclose(turn, 0.0, atol=1e-3)


def test_the_unchanged_casing_is_exact_and_its_pairs_are_cosine_and_sine(model):
    found = model.modes(np.zeros(8), 8)
    np.testing.assert_allclose(found.freq, model.nominal.freq[:8], rtol=1e-9)
    np.testing.assert_allclose(found.purity, model.nominal.purity[:8], atol=1e-4)  # fewer diameters are known
    assert np.array_equal(found.meridional, model.nominal.meridional[:8])
    low, high = next(pair for pair in found.doublets if found.nodal_diameters[pair[0]] % 4)
    n = found.nodal_diameters[low]
    first, second = (found.rings.profile(k, n)[0] for k in (low, high))
    assert abs(first.imag) < 1e-6 * abs(first)
    assert abs(second.real) < 1e-6 * abs(second)


def test_a_pair_hardly_parted_has_no_orientation_yet(model):
    """A bolt that is looser by almost nothing does not turn the pair to itself: it stays cosine and sine."""
    found = model.modes(np.where(np.arange(8) == 2, -1e-7, 0.0), 8)
    low, high = next(pair for pair in found.doublets if found.nodal_diameters[pair[0]] % 4)
    n = found.nodal_diameters[low]
    first, second = (found.rings.profile(k, n)[0] for k in (low, high))
    assert abs(first.imag) < 1e-6 * abs(first)
    assert abs(second.real) < 1e-6 * abs(second)


@pytest.mark.slow
def test_bolts_under_a_ring(frustum):
    ring = cf.Ring(section=cf.edge.Section.rectangle(width=0.03, depth=0.03), support=BOLTS)
    shell = frustum(supports={"base": ring}, mesh=COARSE)
    system = cf.shell.assemble(shell)
    model = affine_model(system, bolt_changes(system, "base"), 30)
    loose = replace(ring, support=replace(BOLTS, loose={5: 0.2}))
    found = model.modes(np.where(np.arange(8) == 4, -0.8, 0.0), 10)
    np.testing.assert_allclose(found.freq, cf.modes(replace(shell, supports={"base": loose}), 10).freq, rtol=1e-4)


@pytest.mark.slow
def test_masses_are_as_in_full_solutions(casing):
    system = cf.shell.assemble(casing)
    angles = np.array([0.4, 2.5])
    model = affine_model(system, mass_changes(system, "top", angles), 30)
    heavy = [cf.edge.EdgeMass(angle=a, mass=m) for a, m in zip(angles, (0.02, 0.05), strict=True)]
    full = cf.modes(replace(casing, masses={"top": heavy}), 10)
    found = model.modes(np.array([0.02, 0.05]), 10)
    np.testing.assert_allclose(found.freq, full.freq, rtol=1e-5)
    assert np.all(found.freq < model.modes(np.zeros(2), 10).freq)


@pytest.mark.slow
def test_motions_of_a_free_casing_as_a_whole_stay_without_diameters(frustum, coarse):
    system = cf.shell.assemble(frustum(supports={}, mesh=coarse))
    model = affine_model(system, mass_changes(system, "top", np.array([0.3])), 12)
    found = model.modes(np.array([0.05]), 8)
    assert found.rigid == 6
    assert found.nodal_diameters.tolist() == [-1] * 6 + [2] * 2
    lighter = model.modes(np.array([-0.05]), 8)  # what is taken away weighs on the shift as well
    np.testing.assert_allclose(lighter.freq[:6], 0.0, atol=1e-4 * lighter.freq[6])


def test_derivatives_are_those_of_the_squares(model):
    x = np.linspace(-0.6, -0.1, 8)
    G = model.derivatives(model.modes(x, 8))
    for change in (0, 5):
        step = 1e-4 * np.eye(8)[change]
        ahead, behind = (model.modes(x + side * step, 8).omega ** 2 for side in (1.0, -1.0))
        slope = np.diagonal(G[change])
        np.testing.assert_allclose(slope, (ahead - behind) / 2e-4, rtol=1e-4, atol=1e-6 * slope.max())


def test_derivatives_by_masses_in_a_basis_for_bolts_are_those_of_the_squares(model):
    heavy = model.with_changes(mass_changes(model.system, "top", np.array([0.4, 2.5, 4.0])))
    assert heavy.changes == 3
    assert heavy.stiffness is None
    x = np.array([0.02, 0.05, 0.03])
    found = heavy.modes(x, 8)
    G = heavy.derivatives(found)
    assert G.shape == (3, 8, 8)
    for change in (0, 2):
        step = 1e-5 * np.eye(3)[change]
        ahead, behind = (heavy.modes(x + side * step, 8).omega ** 2 for side in (1.0, -1.0))
        slope = np.diagonal(G[change])
        np.testing.assert_allclose(slope, (ahead - behind) / 2e-5, rtol=1e-4, atol=-1e-6 * slope.min())
    shared = G / found.omega[:, None] ** 2  # phi_i^T M_c phi_j
    np.testing.assert_allclose(shared, shared.swapaxes(1, 2), atol=1e-10 * np.abs(shared).max())


def test_a_bolt_that_is_loose_already_changes_as_a_tight_one(casing, model):
    shell = replace(casing, supports={"base": replace(BOLTS, loose={3: 0.5})})
    changes = bolt_changes(replace(model.system, shell=shell), "base")
    for loose, tight in zip(changes, bolt_changes(model.system, "base"), strict=True):
        assert np.array_equal(loose.stiffness.dofs, tight.stiffness.dofs)
        assert np.array_equal(loose.stiffness.D, tight.stiffness.D)


def test_an_open_shell_is_refused(steel):
    plate = cf.Shell(chart=cf.Plate(length=1.0, width=0.5), thickness=0.01, material=steel)
    with pytest.raises(ValueError, match="open shell has no nodal diameters"):
        affine_model(cf.shell.assemble(plate), [], 4)


@pytest.mark.parametrize("direction", [0, 1, 2])
def test_a_unit_of_a_change_is_a_tight_bolt_or_a_kilogram(model, direction):
    """Moved as a whole by one, a bolt resists with its stiffness, a kilogram weighs one."""
    system = model.system
    motion = np.zeros((len(system.points), 5, 1))
    motion[:, direction] = 1.0
    masses = mass_changes(system, "top", np.array([0.3, 1.0, 2.0]))
    assert len(masses) == 3
    for change in masses:
        assert change.stiffness is None
        np.testing.assert_allclose(change.mass.product(motion.reshape(-1, 1)), [[1.0]], rtol=1e-12)
    bolts = bolt_changes(system, "base")
    assert len(bolts) == BOLTS.count
    for change in bolts:
        assert change.mass is None
        np.testing.assert_allclose(change.stiffness.product(motion.reshape(-1, 1)), [[1e8]], rtol=1e-9)
