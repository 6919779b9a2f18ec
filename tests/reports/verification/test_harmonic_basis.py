"""Bases of a perfect casing by harmonics, against its meridian problems and the two-dimensional reduction."""

import numpy as np
import pytest

import casingfem as cf
from reports.verification.rubs.harmonic_basis import harmonic_basis

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
RIM = cf.Rim("top", n_max=8)


def casing(**changes):
    given = {
        "chart": cf.Frustum(r_base=0.5, r_top=0.45, height=0.25),
        "thickness": 3e-3,
        "material": STEEL,
        "supports": {"base": cf.ElasticEdge(k_face=1e13)},
        "mesh": cf.ShellMesh(order=7, rows=(0.0, 0.97, 1.0), around=17),
    }
    return cf.Shell(**(given | changes))


def scaled_difference(a, b):
    scale = np.sqrt(np.outer(np.diag(b), np.diag(b)))
    return np.abs(a - b).max() / scale.max(), (np.abs(a - b) / scale).max()


@pytest.mark.slow
@pytest.mark.parametrize(
    "orders", [1, pytest.param(3, marks=pytest.mark.campaign), pytest.param(9, marks=pytest.mark.campaign)]
)
def test_static_push_does_not_depend_on_the_modes_kept(orders):
    few, many = harmonic_basis(casing(), RIM, orders=orders), harmonic_basis(casing(), RIM, orders=10)
    assert scaled_difference(few.compliance, many.compliance)[0] < 1e-10


@pytest.mark.campaign
def test_agrees_with_the_two_dimensional_reduction():
    shell, rim = casing(), cf.Rim("top", n_max=14)
    plane, ring = cf.reduce(shell, rim, modes=30), harmonic_basis(shell, rim, orders=2)
    assert scaled_difference(ring.compliance, plane.compliance)[1] < 1e-3
    np.testing.assert_allclose(ring.freq[:8], plane.freq[:8], rtol=1e-5)
    own, other = (basis.rows[:, :8] @ basis.rows[:, :8].T for basis in (ring, plane))  # doublets may be turned
    np.testing.assert_allclose(own, other, atol=1e-4 * np.abs(other).max())


@pytest.mark.campaign
def test_rotation_splits_pairs_as_in_the_two_dimensional_reduction():
    """Frequencies of q'' + Omega G q' + (omega^2 + Omega^2 K1) q = 0 at 20 turns/s."""
    shell, rim, omega = casing(), cf.Rim("top", n_max=14), 40.0 * np.pi
    found = []
    for basis in (harmonic_basis(shell, rim, orders=2), cf.reduce(shell, rim, modes=58)):
        m = len(basis.omega)
        K = np.diag(basis.omega**2) + omega**2 * basis.stiffness_by_speed
        A = np.block([[np.zeros((m, m)), np.eye(m)], [-K, -omega * basis.gyroscopic]])
        w = np.linalg.eigvals(A).imag
        found.append(np.sort(w[w > 0.0])[:12])
    np.testing.assert_allclose(found[0], found[1], rtol=1e-5)
    assert np.abs(found[0] - np.sort(basis.omega)[:12]).max() > 1e-3 * found[0][0]


def test_without_residual_the_rim_is_too_stiff():
    stiff = harmonic_basis(casing(), RIM, orders=1, residual=False)
    full = harmonic_basis(casing(), RIM, orders=1)
    assert np.all(stiff.S == 0.0)
    assert np.linalg.eigvalsh(full.compliance - stiff.compliance).min() > -1e-9 * np.abs(full.compliance).max()
    assert np.trace(stiff.compliance) < 0.95 * np.trace(full.compliance)


def test_orders_may_depend_on_n():
    basis = harmonic_basis(casing(), RIM, orders=lambda n: 1 if n <= 2 else 0)
    assert len(basis) == 2 + 2 * 2  # n = 0 holds a radial and a torsional motion


@pytest.mark.campaign
def test_an_edge_fixed_in_its_own_frame():
    shell = casing(supports={"base": cf.ShearDiaphragm(), "top": cf.ElasticEdge(k_r=1e8)})
    plane, ring = cf.reduce(shell, RIM, modes=10), harmonic_basis(shell, RIM, orders=2)
    assert scaled_difference(ring.compliance, plane.compliance)[0] < 1e-4


def test_imperfect_casings_and_unknown_edges_are_refused():
    with pytest.raises(ValueError, match="axisymmetric casing at rest"):
        harmonic_basis(casing(radius_defect=cf.FourierField.of({4: 1e-3})), RIM, orders=1)
    with pytest.raises(ValueError, match="no edge 'rim'"):
        harmonic_basis(casing(), cf.Rim("rim"), orders=1)


@pytest.mark.slow
def test_participation_is_that_of_the_two_dimensional_reduction():
    """Effective masses by frequency, pair by pair; those of n > 1 are none."""
    shell = casing(mesh=cf.ShellMesh(order=6, rows=1, around=9))
    rim = cf.Rim("top", n_max=3)
    found, full = harmonic_basis(shell, rim, orders=2), cf.reduce(shell, rim, modes=120)
    for k in range(3):
        moving = np.flatnonzero(found.participation[k] ** 2 > 1e-3)
        assert (found.omega[moving] < full.omega[-1]).sum() > 0
        for mode in moving[found.omega[moving] < 0.95 * full.omega[-1]]:
            near = np.abs(full.omega / found.omega[mode] - 1.0) < 1e-6
            expected = float(np.sum(full.participation[k, near] ** 2))
            assert found.participation[k, mode] ** 2 == pytest.approx(expected, rel=1e-6)
    assert np.count_nonzero(found.participation[0] ** 2 > 1e-3) == 2
    # the sign too: a pull along x moves the rim along cos of one diameter, along y along sin, and towards it
    sag = found.rows @ (found.participation.T / found.omega[:, None] ** 2)
    assert sag[1, 0] > 0.0
    assert sag[rim.n_max + 1, 1] == pytest.approx(sag[1, 0], rel=1e-9)
    exact = full.rows @ (full.participation.T / full.omega[:, None] ** 2)
    assert np.sign(exact[1, 0]) == np.sign(exact[rim.n_max + 1, 1]) == 1.0
