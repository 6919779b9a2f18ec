"""Other readings of modes near each other: peaks exchanged in a set-up, a weak one in its noise; alone or not."""

import numpy as np
import pytest

from casingfem.experiment.identify.poles.pole_window import Window
from casingfem.experiment.identify.setups.around import Places
from casingfem.experiment.identify.setups.clusters import Cluster
from casingfem.experiment.identify.setups.inner_products import Problem
from casingfem.experiment.identify.setups.own_shifts import Modes
from casingfem.experiment.identify.setups.wave_fit import WaveRead, fitted, pairs_near
from casingfem.experiment.identify.setups.wave_model import Shapes, WaveProblem, waves_of
from casingfem.experiment.identify.setups.wave_search import _by_odds, _Other, wave_modes
from casingfem.experiment.identify.setups.wave_tries import part_about, tries

SETUPS = [np.arange(0, 4), np.arange(4, 8), np.arange(8, 12)]
THETA = np.radians(15.0 * np.arange(12) + np.array([1, -3, 2, 0, 3, -2, 1, 2, -1, 0, 3, -2]))
FREQ = 400.0 * (1.0 + np.array([[-4e-4, 1e-4, 0.0], [9e-4, 1.5e-3, 1.2e-3], [2e-2, 2e-2, 2.01e-2]]))
ZETA = np.array([2.0e-3, 2.1e-3, 1.5e-3])
KINDS = np.array([4, 4, 2])  # n - 1
SHIFT, NOISE = 1e-3, 0.3
LINES = np.arange(390.0, 420.0, 0.05)


def problem(weak):
    """A pair of n = 5, the second as `weak`, and a mode of n = 3 far from them: with noise, as waves."""
    rng = np.random.default_rng(5)
    shapes = np.cos(np.multiply.outer(rng.integers(1, 10, 20), THETA) - rng.uniform(0.0, 6.0, 20)[:, None])
    shapes = shapes + 0.05j * rng.standard_normal(shapes.shape)
    waves = waves_of(Places(THETA, np.ones(12), np.zeros(12, int), tuple(range(12))), shapes)
    residues = np.array([0.8 * np.cos(5 * THETA - 0.3), weak * np.sin(5 * THETA - 0.3), 0.5 * np.cos(3 * THETA)])
    truth = Modes(FREQ, ZETA, residues.astype(complex))
    plain = Window(freq=LINES, Y=np.zeros((2 * len(LINES), 12)), power=0, residues="complex", weight=np.ones(12),
                   floor=0.0, along=np.ones(len(LINES)))  # fmt: skip
    clean = truth.response(plain, SETUPS)
    data = np.concatenate([clean.real, clean.imag]) + NOISE * rng.standard_normal(plain.Y.shape)
    window = Window(freq=LINES, Y=data, power=0, residues="complex", weight=np.ones(12), floor=0.0, along=plain.along)
    c = Cluster(truth, window, (398.0, 410.0), NOISE**2, 6e-3)
    return WaveProblem(c, Problem.of(window, SETUPS), window.weight, waves, SHIFT)


def read_at(whole, freq):
    """The fit from these frequencies, with the true numbers of nodal diameters."""
    size = np.sqrt(np.mean(np.abs(whole.cluster.modes.residues) ** 2, axis=1))
    shapes = Shapes(KINDS, size)
    return WaveRead(shapes, fitted(whole, shapes, np.log(freq), np.log(ZETA)))


def lost(freq):
    """The weak mode's peak in the second set-up far below where it is."""
    freq = freq.copy()
    freq[1, 1] *= 1.0 - 4e-3
    return freq


@pytest.mark.slow
def test_a_weak_peak_that_lies_in_the_noise_of_a_setup_is_found_again():
    whole = problem(0.02)
    read = read_at(whole, lost(FREQ))
    assert np.abs(np.log(np.exp(read.fit.p) / FREQ)).max() > 1e-3  # steps alone do not lead there
    best = min(tries(whole, read, np.array([1])), key=lambda one: one.fit.unlikely)
    assert best.fit.unlikely < read.fit.unlikely - 10.0
    assert np.abs(np.log(np.exp(best.fit.p) / FREQ)).max() < 5e-4
    start = whole.cluster._replace(modes=whole.cluster.modes._replace(freq=lost(FREQ)))
    found = wave_modes(SETUPS, whole.waves, SHIFT, start)
    assert np.all(np.abs(np.log(found.freq.mean(axis=1) / FREQ.mean(axis=1))) < 3.0 * found.sigma_freq)


@pytest.mark.slow
@pytest.mark.parametrize("s", range(3))
def test_peaks_exchanged_in_a_setup_are_exchanged_back(s):
    whole = problem(0.3)
    swapped = FREQ.copy()
    swapped[:2, s] = FREQ[1::-1, s]
    truth, read = read_at(whole, FREQ), read_at(whole, swapped)
    assert read.fit.unlikely > truth.fit.unlikely + 10.0
    best = min(tries(whole, read, np.array([0, 1])), key=lambda one: one.fit.unlikely)
    assert best.fit.unlikely == pytest.approx(truth.fit.unlikely, abs=1.0)


@pytest.mark.parametrize("off", [0.0, 5e-4])
def test_a_start_whose_steps_overshoot_ends_where_one_at_the_truth_does(off):
    """Damping seven times too large: steps must be shortened until one gains."""
    whole = problem(0.3)
    shapes = Shapes(KINDS, np.sqrt(np.mean(np.abs(whole.cluster.modes.residues) ** 2, axis=1)))
    truth, found = (
        fitted(whole, shapes, np.log(FREQ) + shift, np.log(ZETA) + more) for shift, more in ((0.0, 0.0), (off, 2.0))
    )
    assert found.squares == pytest.approx(truth.squares, abs=0.1 * NOISE**2)
    np.testing.assert_allclose(np.exp(found.q), ZETA, rtol=0.02)


@pytest.mark.parametrize(("share", "pairs"), [(0.99, [(0, 1)]), (1.01, [])])
def test_modes_are_near_within_a_bandwidth_of_the_wider_and_four_usual_shifts_in_some_setup(share, pairs):
    zeta = np.array([2.0e-3, 5.0e-3])
    apart = np.array([3.0, -share, 4.0]) * (4.0 * SHIFT + 2.0 * zeta[1])
    assert pairs_near(problem(0.3), np.vstack([np.full(3, 6.0), 6.0 + apart]), np.log(zeta)) == pairs


@pytest.mark.slow
def test_what_is_tried_alone_is_as_likely_as_among_all():
    whole = problem(0.3)
    swapped = FREQ.copy()
    swapped[:2, 1] = FREQ[1::-1, 1]
    truth, read = read_at(whole, FREQ), read_at(whole, swapped)
    part = part_about(whole, read, (0, 1))
    assert part.some.tolist() == [0, 1]
    assert len(part.problem.cluster.window.freq) < 0.8 * len(LINES)
    best = min(tries(part.problem, part.read, np.array([0, 1])), key=lambda one: one.fit.unlikely)
    gain = read.fit.unlikely - truth.fit.unlikely
    assert part.read.fit.unlikely - best.fit.unlikely == pytest.approx(gain, rel=0.05)
    back = part.put_into(whole, read, best)
    assert back.fit.unlikely == pytest.approx(truth.fit.unlikely, abs=0.5)
    np.testing.assert_allclose(np.exp(back.fit.p), np.exp(truth.fit.p), rtol=1e-6)


def test_readings_weigh_by_their_odds_and_the_same_one_once():
    """Odds 4 : 1 : 1e-4 of three readings; one of them is found twice."""
    rise = 2.0 * np.log(4.0)
    others = [
        _Other(0.0, np.array([0]), np.zeros(1)),
        _Other(rise, np.array([0, 2]), np.array([1e-3, -5e-4])),
        _Other(rise + 1.0, np.array([0, 2]), np.array([1.001e-3, -5e-4])),
        _Other(2.0 * np.log(4e4), np.array([1]), np.array([1e-2])),
    ]
    mean, scatter, rival = _by_odds(others, 3)
    np.testing.assert_allclose(mean, [2e-4, 1e-2 / 5e4, -1e-4], rtol=1e-4)
    np.testing.assert_allclose(scatter, [4e-4, 1e-2 / np.sqrt(5e4), 2e-4], rtol=1e-4)
    np.testing.assert_allclose(rival, [8e-4, 1e-2 / 5e4, 4e-4], rtol=1e-4)
    assert all(np.all(each == 0.0) for each in _by_odds([], 2))
