"""Which fitted poles are one mode, and what a common one is known to: made-up fits against closed forms."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from casingfem.experiment.identify.found_modes import CHANCE, FoundMode, _distinct, _merged, _one_of, _same
from casingfem.experiment.identify.setups.shifted import Shifted


def mode(freq, **changes):
    given = {
        "freq": freq, "sigma_freq": 1.0, "zeta": 0.01, "sigma_zeta": 0.1, "n": 3, "purity": 0.9, "angle": 0.2,
        "sigma_angle": 0.01, "shape": np.array([1.0, 0.0]), "sigma_shape": np.zeros(2), "residues": np.zeros((1, 2)),
        "residue_scale": 1.0, "collinearity": 1.0, "signal": 5.0, "split_bound": 0.1, "double": False,
    }  # fmt: skip
    return FoundMode(**given | changes)


def fit(freq, zeta, covariance, noise=4.0, apart=0.0):
    apart = np.full(len(freq) - 1, apart)
    given = {"noise": noise, "covariance": covariance / noise, "apart": apart, "A": np.ones((len(freq), 2, 3))}
    return SimpleNamespace(freq=np.array(freq), zeta=np.array(zeta), **given)


def test_two_bands_find_one_mode_within_half_a_half_power_width_and_of_one_shape():
    first = mode(100.0)
    assert _same(first, mode(100.49))
    assert _same(mode(100.49), first)
    assert not _same(first, mode(100.51))
    for off, same in ((0.91, True), (-0.91, True), (0.89, False)):
        assert _same(first, mode(100.0, shape=np.array([off, np.sqrt(1.0 - off**2)]))) is same


@pytest.mark.parametrize(("apart", "told"), [(1.001, True), (0.999, False)])
def test_poles_are_told_apart_beyond_chance(apart, told):
    """By ln f and ln zeta together: sigma 0.001 and 0.02 of the differences, correlated by a half."""
    each = np.array([[0.001**2, 0.5 * 0.001 * 0.02], [0.5 * 0.001 * 0.02, 0.02**2]]) / 2.0
    covariance = np.kron(each, np.eye(2))  # ln f of both, then ln zeta of both
    step = np.array([0.001, 0.02])
    size = step @ np.linalg.solve(2.0 * each, step)
    change = apart * np.sqrt(CHANCE / size) * step
    two = fit([100.0, 100.0 * np.exp(change[0])], [0.05, 0.05 * np.exp(change[1])], covariance)
    assert _distinct(two, 0, 1) is told
    for last, cancel in ((-0.8, False), (-0.83, True)):  # of their residues 0.111 and 0.093 are left
        two.A[1] = last
        assert _distinct(two, 0, 1) is (told and not cancel)
    third = np.kron(each, np.eye(3))  # one below them, far more uncertain and of other damping
    third[[0, 3], [0, 3]] = 1.0
    three = fit([50.0, *two.freq], [0.3, *two.zeta], third)
    assert _distinct(three, 1, 2) is told
    far = fit([100.0, 110.1 if told else 109.9], [0.02, 0.05], 1e9 * covariance)  # twice the wider half-width
    assert _distinct(far, 0, 1) is told


def test_poles_whose_means_meet_are_told_apart_by_their_set_ups():
    """Differences of (1, -1) and (3, 4) sigma in two set-ups: chi-squared 2 and 25."""
    sigma = 1e-4
    logs = np.array([[0.0, 0.0], [1.0, -1.0], [4.0, 3.0]]) * sigma
    setups, half = [np.array([0, 2]), np.array([1, 3])], np.full((3, 2), 0.5 * sigma**2)
    chi = shifted(100.0 * np.exp(logs), half, 1e-3, setups).apart(np.array([1, 2]), np.array([0, 1]))
    np.testing.assert_allclose(chi, [2.0, 25.0], rtol=1e-9)
    alone = shifted(100.0 * np.exp(logs), half, 1e-3, [np.array([0]), np.array([1, 2])])  # one channel tells nothing
    np.testing.assert_allclose(alone.apart(np.array([1]), np.array([0])), 1.0, rtol=1e-9)
    same = [100.0, 100.0], [0.01, 0.01], 1e9 * np.eye(4)
    assert not _distinct(fit(*same, apart=0.999 * CHANCE), 0, 1)
    assert _distinct(fit(*same, apart=1.001 * CHANCE), 0, 1)


def test_a_common_pole_is_the_weighted_mean_of_two():
    """Sigmas 0.01 and 0.02 of ln f, uncorrelated: weights 4 to 1; the stronger one's shape."""
    covariance = np.diag([0.01**2, 0.02**2, 0.1**2, 0.3**2])
    two = fit([100.0, 101.0], [0.01, 0.02], covariance)
    modes = [mode(100.0, signal=5.0, n=7), mode(101.0, signal=6.0, n=8)]
    one = _one_of(two, modes, 0, 1)
    freq = np.exp((4.0 * np.log(100.0) + np.log(101.0)) / 5.0)
    bound = np.log(1.01) + 2.0 * np.hypot(0.01, 0.02)
    assert one.n == 8
    assert one.freq == pytest.approx(freq, rel=1e-12)
    assert one.split_bound == pytest.approx(bound, rel=1e-12)
    assert one.sigma_freq == pytest.approx(freq * np.hypot(1.0 / np.sqrt(1e4 + 2.5e3), 0.5 * bound), rel=1e-12)
    weights = np.array([1.0 / 0.1**2, 1.0 / 0.3**2])
    zeta = np.exp(weights @ np.log([0.01, 0.02]) / weights.sum())
    assert (one.zeta, one.sigma_zeta) == pytest.approx((zeta, zeta / np.sqrt(weights.sum())), rel=1e-12)
    assert np.isnan([one.angle, one.sigma_angle]).all()
    assert one.unresolved
    assert _one_of(two, modes[::-1], 0, 1).n == 8
    two.A[1] = -0.9  # 0.1/1.9 of their residues is left
    cancelled = np.log(1.01) * 19.0 + 2.0 * np.hypot(0.01, 0.02)
    assert _one_of(two, modes, 0, 1).split_bound == pytest.approx(cancelled, rel=1e-9)


def test_which_neighbours_are_put_into_one():
    close = fit([100.0, 100.01, 100.02, 200.0], [0.01] * 4, np.eye(8))
    modes = [mode(freq) for freq in close.freq]
    assert [one.unresolved for one in _merged(close, modes, [])] == [True, False, False]
    assert [one.freq for one in _merged(close, modes, [0])][-1] == 200.0
    assert len(_merged(close, modes, [1])) == 3
    assert len(_merged(close, [modes[0], replace(modes[1], n=4), modes[2], modes[3]], [])) == 4


def shifted(freq, variance, shift, setups, residues=None):
    modes = SimpleNamespace(freq=np.array(freq), residues=residues)
    nothing = np.zeros(len(freq))
    return Shifted(modes, np.array(variance), nothing, nothing, nothing, setups, 0.0, shift, 1.0)


def test_the_mean_over_set_ups_weighs_them_by_what_they_know():
    """Two set-ups of one mode: with much scatter the plain mean, with none the weighted one."""
    logs, variance = np.log([100.0, 104.0]), np.array([1e-8, 4e-8])
    setups = [np.array([0]), np.array([1])]
    found, sigma = shifted([[100.0, 104.0]], [variance], 0.02, setups).mean()
    weight = 1.0 / (variance + 4e-4)
    centre = weight @ logs / weight.sum()
    each = centre + 4e-4 * weight * (logs - centre)
    assert found[0] == pytest.approx(np.mean(np.exp(each)), rel=1e-12)
    assert sigma[0] == pytest.approx(np.sqrt(np.mean(variance * 4e-4 * weight) / 2.0), rel=1e-9)
    found, _ = shifted([[100.0, 104.0]], [variance], 0.0, setups).mean()
    assert found[0] == pytest.approx(np.exp((4.0 * logs[0] + logs[1]) / 5.0), rel=1e-9)


def test_the_share_of_set_ups_that_see_a_mode():
    """(sum e)^2/(k sum e^2) of the energies: 1 where all have as much, 1/k where one has all."""
    setups = [np.array([0, 1]), np.array([2]), np.array([3, 4])]
    residues = np.array([[1.0, 1.0, np.sqrt(2.0), 1j, 1.0], [0.0, 0.0, 3j, 0.0, 0.0], [3.0, 0.0, 0.0, 0.0, 4j]])
    seen = shifted([[1.0] * 3] * 3, np.zeros((3, 3)), 0.0, setups, residues).seen()
    assert seen.tolist() == pytest.approx([1.0, 1.0 / 3.0, 25.0**2 / (9.0**2 + 16.0**2) / 3.0])
