"""What a rig's own modes are on a circle of probes, and what masses do to what its modes leave out: by hand."""

import numpy as np
import pytest

import casingfem as cf
from casingfem.experiment.rig.files import truth
from casingfem.experiment.rig.rig import SYNTHETIC
from casingfem.experiment.rig.structure import damping_spread, loaded, residual_shapes


def ring(waves, first=0.4, count=7):
    """Modes a cos n(theta - psi) + b at seven probes round a circle, after one that is elsewhere."""
    theta = first + 2.0 * np.pi * np.arange(count) / count
    probes = [
        cf.rig.Probe(9, 1, (0.0, 0.0, 0.0), 0.0),
        *(cf.rig.Probe(k, 1, (0.0, 0.0, 0.0), t) for k, t in enumerate(theta)),
    ]
    rows = [np.r_[5.0, a * np.cos(n * (theta - np.radians(psi))) + b] for n, psi, a, b in waves]
    omega = 100.0 * np.arange(1.0, len(waves) + 1.0)
    return cf.rig.Rig.of(omega=omega, zeta=np.linspace(0.01, 0.02, len(waves)), rows=np.array(rows).T, probes=probes)


def test_modes_on_a_circle_have_the_n_of_their_largest_wave_and_its_antinode():
    """Amplitudes of n from 1 on are halved between n and -n: a mean of .4 is less than a wave of 1, one of .6 more."""
    waves = [(2, 71.0, 1.0, 0.1), (3, 44.0, -1.0, 0.0), (1, 170.0, 2.0, 0.9), (2, 30.0, 1.0, 0.4), (1, 30.0, 1.0, 0.6)]
    rig = ring(waves)
    found = truth(rig, range(1, 8), ["made by hand"])
    assert found.n.tolist() == [2, 3, 1, 2, 0]
    np.testing.assert_allclose(found.angle_deg, [71.0, 44.0, 170.0, 30.0, np.nan], rtol=1e-10)
    np.testing.assert_allclose(found.freq_hz, rig.omega / (2.0 * np.pi), rtol=1e-14)
    np.testing.assert_allclose(found.sigma_hz, 1e-9 * rig.omega / (2.0 * np.pi), rtol=1e-12)
    np.testing.assert_array_equal(found.zeta, rig.zeta)
    assert found.card[0] == SYNTHETIC
    assert found.card[-1] == "made by hand"
    assert found.synthetic


def test_without_a_circle_modes_have_no_labels():
    found = truth(ring([(2, 71.0, 1.0, 0.1), (3, 44.0, -1.0, 0.0)]))
    assert found.n.tolist() == [-1, -1]
    assert np.isnan(found.angle_deg).all()


@pytest.mark.parametrize(("small", "count"), [(1.01e-12, 2), (0.99e-12, 1), (0.0, 1)])
def test_what_modes_leave_out_has_as_many_coordinates_as_directions_give_way(small, count):
    """B B^T is S where the masses sit, and S everywhere by what they move there."""
    turn = np.array([[0.6, -0.8, 0.0], [0.8, 0.6, 0.0], [0.0, 0.0, 1.0]])
    S = turn @ np.diag([2.0, 2.0 * small, 1.0]) @ turn.T
    S[2, :2] = S[:2, 2] = [0.3, 0.4]
    B = residual_shapes(S, [0, 1])
    assert B.shape == (3, count)
    if count == 1:
        np.testing.assert_allclose(B[:2] @ B[:2].T, S[:2, :2], atol=1e-11)
        np.testing.assert_allclose(np.abs(B[2, 0]), 0.5 / np.sqrt(2.0), rtol=1e-9)


def test_where_nothing_is_left_out_there_are_no_coordinates():
    assert residual_shapes(np.zeros((3, 3)), [0, 2]).shape == (3, 0)


def test_no_mass_changes_nothing_and_one_number_is_that_of_all():
    rows = np.array([[1.0, 0.2], [-0.4, 0.9], [0.3, 0.3]])
    half = np.array([[2.0, 0.0, 0.0], [0.5, 1.5, 0.0], [0.3, -0.4, 1.2]])
    bare = cf.rig.Rig.of(omega=[900.0, 1300.0], zeta=[0.01, 0.02], rows=rows, S=1e-7 * half @ half.T)
    same = loaded(bare, [0, 1], 0.0)
    for name in ("omega", "zeta", "S"):
        np.testing.assert_allclose(getattr(same, name), getattr(bare, name), rtol=1e-9)
    np.testing.assert_allclose(np.abs(same.rows), np.abs(rows), rtol=1e-9)
    one, each = loaded(bare, [0, 1], 0.2), loaded(bare, [0, 1], [0.2, 0.2])
    np.testing.assert_array_equal(one.omega, each.omega)
    assert one.omega[0] < 0.99 * bare.omega[0]
    np.testing.assert_array_equal(one.S, one.S.T)
    assert one.probes == bare.probes


def test_damping_is_spread_by_the_exponential_of_normal_numbers():
    drawn = np.random.default_rng(5).standard_normal(4)
    np.testing.assert_allclose(damping_spread(0.02, 0.3, 4, seed=5), 0.02 * np.exp(0.3 * drawn), rtol=1e-14)
