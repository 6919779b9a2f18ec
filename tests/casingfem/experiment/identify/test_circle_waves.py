"""Modes that are fitted as waves round a circle: pairs that meet in a set-up, channels that belong elsewhere."""

import numpy as np
import pytest

from casingfem.experiment.identify.poles.pole_window import Window
from casingfem.experiment.identify.setups.around import Places, suspect_sensors, suspected
from casingfem.experiment.identify.setups.clusters import Cluster
from casingfem.experiment.identify.setups.inner_products import Problem
from casingfem.experiment.identify.setups.own_shifts import Modes
from casingfem.experiment.identify.setups.wave_fit import wave_fit
from casingfem.experiment.identify.setups.wave_model import BELONGS, Shapes, WaveProblem, belonging, waves_of
from casingfem.experiment.identify.setups.wave_residues import eliminated, unlikely_at, unlikely_kinds, unlikely_local
from casingfem.experiment.identify.setups.wave_search import wave_modes

SETUPS = [np.arange(0, 4), np.arange(4, 8), np.arange(8, 12)]
THETA = np.radians(15.0 * np.arange(12) + np.array([1, -3, 2, 0, 3, -2, 1, 2, -1, 0, 3, -2]))
FREQ = 400.0 * (1.0 + np.array([[-4e-4, 1e-4, 0.0], [6e-4, -2e-4, 5e-4]]))  # they cross in the second set-up
ZETA = np.array([2.0e-3, 2.1e-3])
SHAPES = np.array([0.8 * np.cos(5 * THETA - 0.3), 0.6 * np.sin(5 * THETA - 0.3)])
SHIFT, NOISE = 5e-4, 0.3
SPOILT = 2, 9


def known():
    """Waves by twenty modes, of which one channel is silent and one turned over."""
    rng = np.random.default_rng(5)
    shapes = np.cos(np.multiply.outer(rng.integers(1, 10, 20), THETA) - rng.uniform(0.0, 6.0, 20)[:, None])
    shapes[:, SPOILT[0]] = 0.0
    shapes[:, SPOILT[1]] *= -1.0
    shapes = shapes + 0.05j * rng.standard_normal(shapes.shape)
    return waves_of(Places(THETA, np.ones(12), np.zeros(12, int), tuple(range(12))), shapes)


def cluster(start):
    """A pair with noise, read from a start (modes, setups)."""
    lines = np.arange(392.0, 408.0, 0.05)
    window = Window(freq=lines, Y=np.zeros((2 * len(lines), 12)), power=0, residues="complex", weight=np.ones(12),
                    floor=0.0, along=np.ones(len(lines)))  # fmt: skip
    truth = Modes(FREQ, ZETA, SHAPES.astype(complex))
    rng = np.random.default_rng(8)
    clean = truth.response(window, SETUPS)
    data = np.concatenate([clean.real, clean.imag]) + NOISE * rng.standard_normal(window.Y.shape)
    window = Window(freq=lines, Y=data, power=0, residues="complex", weight=np.ones(12), floor=0.0, along=window.along)
    return Cluster(Modes(start, ZETA, SHAPES.astype(complex)), window, (398.0, 402.0), NOISE**2, 5e-3)


def test_channels_that_belong_elsewhere_are_told():
    waves = known()
    good = np.setdiff1d(np.arange(12), SPOILT)
    assert waves.off[0, list(SPOILT)].min() > BELONGS > 3 * waves.off[0, good].max()
    assert np.flatnonzero(~belonging(waves)).tolist() == list(SPOILT)


@pytest.mark.slow
@pytest.mark.parametrize("setup", [0, 1, 2])
def test_members_that_meet_are_told_by_their_waves_whichever_start(setup):
    start = FREQ.copy()
    start[:, setup] = start[::-1, setup]
    found = wave_modes(SETUPS, known(), SHIFT, cluster(start))
    order = np.argsort(found.freq.mean(axis=1))
    sigma = np.sqrt(found.variance[order])
    assert sigma.max() < 1e-4
    assert np.all(np.abs(np.log(found.freq[order] / FREQ)) < 4.0 * sigma)
    assert np.all(np.abs(np.log(found.freq[order].mean(axis=1) / FREQ.mean(axis=1))) < 4.0 * found.sigma_freq[order])
    assert found.sigma_matching.max() < 2e-5


def test_slopes_of_the_squares_are_those_of_differences():
    c = cluster(FREQ)
    problem = WaveProblem(c, Problem.of(c.window, SETUPS), np.ones(12), known(), 0.02 * SHIFT)  # a stiff one shows
    shapes, p, q = Shapes(np.array([4, 4]), np.array([0.6, 0.4])), np.log(FREQ * (1 + 2e-4)), np.log(ZETA * 1.1)
    at, step = wave_fit(problem, shapes, p, q), 1e-6
    for k in range(8):
        moved = []
        for side in (-step, step):
            both = np.r_[p.ravel(), q]
            both[k] += side
            moved.append(wave_fit(problem, shapes, both[:6].reshape(2, 3), both[6:]).squares)
        assert 2.0 * at.gradient[k] == pytest.approx((moved[1] - moved[0]) / (2 * step), rel=1e-3, abs=1e-2)


def test_kinds_and_local_modes_are_as_likely_together_as_one_by_one():
    c = cluster(FREQ)
    problem = WaveProblem(c, Problem.of(c.window, SETUPS), np.linspace(0.8, 1.2, 12), known(), SHIFT)
    shapes, at = Shapes(np.array([4, 2]), np.array([0.6, 0.4])), problem.products(np.log(FREQ), np.log(ZETA))
    rest = eliminated(problem, shapes, at)
    for which in ([0], [1], [0, 1]):
        kinds = np.repeat(shapes.kind[None], len(problem.waves.columns), axis=0)
        kinds[:, which] = np.arange(len(kinds))[:, None]
        each = [unlikely_at(problem, shapes._replace(kind=kind), at) for kind in kinds]
        np.testing.assert_allclose(unlikely_kinds(problem, shapes, at, rest, np.array(which)), each, rtol=1e-9)
    order = np.array([5, 0, 11, 7])
    local = shapes._replace(kind=np.array([4, len(problem.waves.columns)]))
    each = [
        unlikely_at(problem._replace(waves=problem.waves.seen_by(order[:count])), local, at) for count in range(1, 5)
    ]
    np.testing.assert_allclose(unlikely_local(problem, shapes, at, order), each, rtol=1e-9)


def test_suspect_sensors_are_those_that_are_named():
    n = np.array([2, 2, 3, 3, 4, 4, 1, 1])
    theta = np.arange(12) * np.pi / 6
    shapes = np.cos(n * theta[:, None] - 0.7 * np.arange(8))
    shapes[4] *= -1.0
    shapes[[7, 9]] = shapes[[9, 7]]
    assert suspect_sensors(shapes, 4, theta, np.arange(12) + 1).tolist() == [4, 7, 9]


def test_sensors_of_half_a_rim_are_named_by_those_that_are_trusted():
    """Four of twelve are off on half a circle: waves of another n follow them, unless the others alone are asked."""
    rng = np.random.default_rng(12)
    n, wrong, theta = rng.integers(2, 10, 20), [0, 2, 6, 11], THETA
    shapes = np.cos(n * theta[:, None] - rng.uniform(0.0, 6.0, 20))
    shapes[[0, 2]] = shapes[[2, 0]]
    shapes[6] *= -1.0
    shapes[11] = 0.05 * rng.standard_normal(20)
    trusted = ~np.isin(np.arange(12), wrong)
    assert suspect_sensors(shapes, 9, theta, np.arange(12) + 1, trusted).tolist() == wrong
    said = suspected(shapes, 9, theta, np.arange(12) + 1, trusted)
    assert [" ".join(line.split()[:4]) for line in said] == [
        "points 1 and 3", "point 7 looks turned", "point 12 does not",
    ]  # fmt: skip
