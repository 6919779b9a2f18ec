"""Noise that channels have in common: guessed from the others, peaks that a fit has missed keep their poles."""

import numpy as np
import pytest

from casingfem.experiment.identify.poles.pole_window import Window
from casingfem.experiment.identify.setups.as_waves import _one_factor, common_share, without_common_noise
from casingfem.experiment.identify.setups.own_shifts import Modes
from casingfem.experiment.identify.setups.shifted import Shifted

CHANNELS, LINES, SHARE = 12, 1200, 0.3
SIZE = np.random.default_rng(20).uniform(0.5, 3.0, CHANNELS)


def complex_normal(rng, *shape):
    return (rng.standard_normal(shape) + 1j * rng.standard_normal(shape)) / np.sqrt(2.0)


def noise(share, seed=21):
    """So much of its power is common, with a phase of each channel."""
    rng = np.random.default_rng(seed)
    turn = np.exp(2j * np.pi * rng.uniform(size=CHANNELS))
    own, common = complex_normal(rng, LINES, CHANNELS), complex_normal(rng, LINES)
    return SIZE * (np.sqrt(1.0 - share) * own + np.sqrt(share) * common[:, None] * turn)


def left_of(data):
    return np.mean(np.abs(data / SIZE) ** 2)


def test_what_is_left_is_what_the_other_channels_do_not_tell():
    """1/(R^-1)_cc of R = (1 - s) 1 + s t t^H: with r = s/(1 - s), (1 - s)(1 + C r)/(1 + (C - 1) r)."""
    ratio = SHARE / (1.0 - SHARE)
    best = (1.0 - SHARE) * (1.0 + CHANNELS * ratio) / (1.0 + (CHANNELS - 1) * ratio)
    data = noise(SHARE)
    share = common_share(data)
    assert np.all(np.diag(share) == 0.0)
    assert left_of(data - data @ share.T) / left_of(data) == pytest.approx(best, rel=0.02)


def test_noise_of_each_channel_alone_stays():
    data = noise(0.0)
    assert left_of(data - data @ common_share(data).T) / left_of(data) == pytest.approx(1.0, abs=0.02)


def test_few_lines_and_few_channels_tell_nothing():
    assert not common_share(noise(SHARE)[:200]).any()
    assert not common_share(noise(SHARE)[:, :2]).any()
    assert not common_share(np.zeros((LINES, CHANNELS), complex)).any()


def test_a_missed_peak_keeps_its_pole_and_a_gap_in_the_lines_is_not_filled():
    freq = np.linspace(90.0, 110.0, LINES)
    along = np.ones(LINES)
    along[300:310] = 0.0
    bare = Window(freq=freq, Y=np.zeros((2 * LINES, CHANNELS)), power=0, residues="complex", weight=np.ones(CHANNELS),
                  floor=0.0, along=along)  # fmt: skip
    setups = [np.arange(CHANNELS)]
    known = Modes(np.array([[97.0]]), np.array([2e-3]), 0.5 * np.cos(2.0 * np.arange(CHANNELS))[None].astype(complex))
    missed = Modes(np.array([[103.0]]), np.array([1e-3]), 0.05 * np.sin(np.arange(CHANNELS))[None].astype(complex))
    quiet = noise(SHARE) * 1e-3 * along[:, None]
    data = known.response(bare, setups) + missed.response(bare, setups) + quiet
    whole = Window(freq=freq, Y=np.concatenate([data.real, data.imag]), power=0, residues="complex",
                   weight=np.ones(CHANNELS), floor=0.0, along=along)  # fmt: skip
    none = np.zeros(1)
    found = Shifted(known, none[:, None], none, none, none, setups, 0.0, 1e-3, 1.0)
    clean = without_common_noise(found, whole).as_complex
    assert not clean[300:310].any()
    rest = clean - known.response(bare, setups)
    peak = bare.values(np.array([103.0]), np.array([1e-3]))
    inside = np.abs(freq - 103.0) < 1.0
    shape = np.linalg.lstsq(peak[inside], rest[inside], rcond=None)[0]
    left = rest[inside] - peak[inside] @ shape
    assert left_of(left) < 0.85 * left_of(quiet)  # of another pole more would be left
    assert np.linalg.norm(shape) > 0.5 * np.linalg.norm(missed.residues)


@pytest.mark.parametrize("most", [0.8, 0.999])
def test_the_loads_of_one_factor_are_those_of_the_correlations(most):
    """Of a noise that is all common no more than 95 % count."""
    rng = np.random.default_rng(4)
    load = np.sqrt(rng.uniform(0.1, 0.6, 6)) * np.exp(2j * np.pi * rng.uniform(size=6))
    load[2] *= np.sqrt(most) / np.abs(load[2])
    R = np.outer(load, load.conj())
    np.fill_diagonal(R, 1.0)
    found = _one_factor(R)
    if most < 0.95:
        np.testing.assert_allclose(np.outer(found, found.conj()), np.outer(load, load.conj()), atol=1e-6)
    else:
        assert np.abs(found[2]) == pytest.approx(np.sqrt(0.95), rel=1e-9)
    np.testing.assert_allclose(np.abs(_one_factor(np.ones((3, 3)) + 0j)), np.sqrt(0.95), rtol=1e-12)
    assert not _one_factor(np.zeros((3, 3)) + 0j).any()


def test_the_guess_is_the_best_linear_one_by_second_differences_of_quiet_lines():
    """Of each channel by all others, R_co R_oo^-1 with the common part alone of R_co."""
    left = noise(0.4)[:800]
    left[::100] *= 30.0  # no noise: these, and lines beside them, do not count
    rough = left[1:-1] - 0.5 * (left[2:] + left[:-2])
    scaled = rough / np.sqrt(np.median(np.abs(rough) ** 2, axis=0))
    energy = np.mean(np.abs(scaled) ** 2, axis=1)
    quiet = rough[energy < 4.0 * np.median(energy)]
    assert 700 < len(quiet) < 780
    size = np.sqrt(np.mean(np.abs(quiet) ** 2, axis=0))
    unit = quiet / size
    load = _one_factor(unit.T @ unit.conj() / len(unit))
    R = np.outer(load, load.conj())
    common = R.copy()
    np.fill_diagonal(R, 1.0)
    found = common_share(left)
    for c in range(CHANNELS):
        o = np.delete(np.arange(CHANNELS), c)
        want = size[c] * common[c, o] @ np.linalg.inv(R[np.ix_(o, o)]) / size[o]
        np.testing.assert_allclose(found[c, o], want, rtol=1e-8, atol=1e-12)


def test_three_channels_and_twenty_lines_for_each_tell_a_correlation():
    assert common_share(noise(SHARE)[:, :3]).any()
    assert common_share(noise(SHARE)[: 20 * CHANNELS + 2]).any()
    assert not common_share(noise(SHARE)[: 20 * CHANNELS + 1]).any()
    dead = noise(SHARE)
    dead[:, 4] = 0.0
    assert not common_share(dead).any()
    assert not common_share(dead[:2]).any()
