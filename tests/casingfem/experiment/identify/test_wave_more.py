"""One more mode beside those of free residues: a weak partner, a local mode; none where nothing is left."""

import numpy as np
import pytest

from casingfem.experiment.identify.poles.pole_window import Window
from casingfem.experiment.identify.setups.around import Places
from casingfem.experiment.identify.setups.clusters import Cluster
from casingfem.experiment.identify.setups.own_shifts import Modes
from casingfem.experiment.identify.setups.wave_model import waves_of
from casingfem.experiment.identify.setups.wave_search import wave_modes

SETUPS = [np.arange(0, 4), np.arange(4, 8), np.arange(8, 12)]
THETA = np.radians(15.0 * np.arange(12) + np.array([1, -3, 2, 0, 3, -2, 1, 2, -1, 0, 3, -2]))
FREQ = 400.0 * (1.0 + np.array([[-4e-4, 1e-4, 0.0], [6e-4, 1e-3, 5e-4]]))
ZETA = np.array([2.0e-3, 2.1e-3])
LOCAL = 400.8, 8e-3  # frequency [Hz] and damping of a mode that three channels see
SHIFT, NOISE = 5e-4, 0.3
LINES = np.arange(392.0, 408.0, 0.05)


def known():
    """Waves by twenty modes."""
    rng = np.random.default_rng(5)
    shapes = np.cos(np.multiply.outer(rng.integers(1, 10, 20), THETA) - rng.uniform(0.0, 6.0, 20)[:, None])
    shapes = shapes + 0.05j * rng.standard_normal(shapes.shape)
    return waves_of(Places(THETA, np.ones(12), np.zeros(12, int), tuple(range(12))), shapes)


def cluster(residues, local, some):
    """A pair and, where `local` is not 0, a local mode of that size, with noise; known are `some` of the pair."""
    window = Window(freq=LINES, Y=np.zeros((2 * len(LINES), 12)), power=0, residues="complex", weight=np.ones(12),
                    floor=0.0, along=np.ones(len(LINES)))  # fmt: skip
    truth = Modes(FREQ, ZETA, residues.astype(complex))
    seen = np.zeros((1, 12), complex)
    seen[0, 5:8] = local * np.array([0.5, 1.0, 0.5])
    clean = truth.response(window, SETUPS)
    clean = clean + Modes(np.full((1, 3), LOCAL[0]), np.array([LOCAL[1]]), seen).response(window, SETUPS)
    rng = np.random.default_rng(8)
    data = np.concatenate([clean.real, clean.imag]) + NOISE * rng.standard_normal(window.Y.shape)
    window = Window(freq=LINES, Y=data, power=0, residues="complex", weight=np.ones(12), floor=0.0, along=window.along)
    return Cluster(truth.some(some), window, (398.0, 402.0), NOISE**2, 5e-3)


def pair(weak):
    """Residues of a mode and its partner."""
    return np.array([0.8 * np.cos(5 * THETA - 0.3), weak * np.sin(5 * THETA - 0.3)])


@pytest.mark.slow
def test_a_weak_partner_that_free_residues_hid_is_found():
    found = wave_modes(SETUPS, known(), SHIFT, cluster(pair(0.03), 0.0, np.array([0])))
    assert len(found.freq) == 2
    assert found.worth.shape == (1,)
    assert found.worth[0] > 1.0
    assert np.all(np.abs(np.log(found.freq.mean(axis=1) / FREQ.mean(axis=1))) < 3.0 * found.sigma_freq)


@pytest.mark.slow
def test_a_local_mode_is_found_and_no_longer_moves_its_neighbours():
    found = wave_modes(SETUPS, known(), SHIFT, cluster(pair(0.3), 0.2, np.arange(2)))
    assert len(found.freq) == 3
    assert found.freq[2].mean() == pytest.approx(LOCAL[0], rel=1e-3)
    size = np.abs(found.residues[2])
    assert size[5:8].min() > 5.0 * np.delete(size, [5, 6, 7]).max()
    off = np.log(found.freq[:2].mean(axis=1) / FREQ.mean(axis=1)) / found.sigma_freq[:2]
    assert np.abs(off).max() < 3.0


@pytest.mark.slow
def test_nothing_is_found_where_noise_alone_is_left():
    found = wave_modes(SETUPS, known(), SHIFT, cluster(pair(0.3), 0.0, np.arange(2)))
    assert len(found.freq) == 2
    assert found.worth.size == 0
