"""Clusters of modes that were fitted from a poor place, and find the good one."""

from dataclasses import replace

import numpy as np
import pytest

from casingfem.experiment.identify.band_fits import _by_misfit
from casingfem.experiment.identify.poles.pole_fit import fit_poles
from casingfem.experiment.identify.poles.pole_window import Window
from casingfem.experiment.identify.setups.channels_alone import channels_alone
from casingfem.experiment.identify.setups.cluster_modes import ClusterModes, _one_more, fit_again, improved
from casingfem.experiment.identify.setups.clusters import Cluster, _noise, best_beside, places
from casingfem.experiment.identify.setups.own_shifts import Modes
from casingfem.experiment.identify.setups.shifted import _as_good

SETUPS = [np.arange(4), np.arange(4, 8), np.arange(8, 12)]
FREQ = np.array([[400.0, 400.4, 399.7], [403.0, 402.6, 403.3], [406.0, 406.3, 405.8]])
ZETA = np.array([3.0e-3, 2.5e-3, 3.5e-3])
SPAN = 395.0, 411.0


@pytest.fixture(scope="module")
def window():
    """Three modes in twelve channels, three set-ups, noise of one."""
    rng = np.random.default_rng(61)
    lines = np.arange(380.0, 426.0, 0.125)
    shape = (len(lines), 12)
    empty = Window(freq=lines, Y=np.zeros((2 * len(lines), 12)), power=0, residues="complex", weight=np.ones(12),
                   floor=0.0, along=np.ones(len(lines)))  # fmt: skip
    residues = 0.3 * (rng.standard_normal((3, 12)) + 0.2j * rng.standard_normal((3, 12)))
    H = Modes(FREQ, ZETA, residues).response(empty, SETUPS)
    H = H + rng.standard_normal(shape) + 1j * rng.standard_normal(shape)
    return replace(empty, Y=np.concatenate([H.real, H.imag]))


def cluster(window, freq, zeta):
    return Cluster(Modes(freq, zeta, np.ones((len(zeta), 12), complex)), window, SPAN, 1.0)


STARTS = {
    "one set-up far off": (np.column_stack([FREQ[:, :2], [395.2, 395.6, 405.8]]), ZETA),
    "one mode missed": (FREQ[:2], ZETA[:2]),
    "one mode twice": (np.concatenate([FREQ, FREQ[:1] + 1.0]), np.append(ZETA, 3e-3)),
}


@pytest.mark.slow
@pytest.mark.parametrize("start", STARTS.values(), ids=STARTS)
def test_a_cluster_fitted_from_a_poor_place_finds_the_good_one(window, start):
    c = cluster(window, *start)
    stays = fit_again(c, SETUPS, *start)
    assert stays.freq.shape != FREQ.shape or np.abs(stays.freq - FREQ).max() > 0.5  # steps alone stay there
    own = improved(SETUPS, 0.05, c).own
    order = np.argsort(own.freq[:, 0])
    np.testing.assert_allclose(own.freq[order], FREQ, atol=0.02)
    np.testing.assert_allclose(own.zeta[order, 0], ZETA, rtol=0.03)


def test_one_more_mode_is_tried_where_one_is_missed_and_none_where_noise_is_left(window):
    c = cluster(window, FREQ, ZETA)
    assert list(_one_more(c, SETUPS, fit_again(c, SETUPS, FREQ, ZETA))) == []
    lacking = fit_again(c, SETUPS, FREQ[:2], ZETA[:2])
    ((freq, zeta),) = _one_more(c, SETUPS, lacking)
    assert freq[:2].tolist() == lacking.freq.tolist()
    at, gain = best_beside(window, SETUPS, lacking.freq, lacking.zeta[:, 0], lacking.zeta[:, 0].mean(), SPAN)
    assert gain > 1e3
    np.testing.assert_allclose(freq[2], at, rtol=1e-12)
    np.testing.assert_allclose(zeta, [*lacking.zeta[:, 0], lacking.zeta[:, 0].mean()], rtol=1e-12)


def test_one_cluster_that_is_not_understood_does_not_outvote_the_others(window):
    c = cluster(window, FREQ, ZETA)
    single = [np.array([k]) for k in range(12)]
    many = FREQ[:, np.repeat(np.arange(3), 4)]
    few_read, many_read = fit_again(c, SETUPS, FREQ, ZETA), fit_again(c, single, many, ZETA)
    spans = [(SPAN[0] + k, SPAN[1]) for k in range(3)]
    fewer, more = ([ClusterModes(c._replace(span=span), own) for span in spans] for own in (few_read, many_read))
    fewer[1] = fewer[1]._replace(own=few_read._replace(squares=10.0 * few_read.squares))
    assert _as_good(fewer, SETUPS, more, single)
    fewer[2] = fewer[2]._replace(own=fewer[1].own)
    assert not _as_good(fewer, SETUPS, more, single)


def test_what_a_fit_lacks_raises_its_uncertainty_and_noise_does_not(window):
    straight = window.cut(slice(None))
    first = replace(straight, Y=straight.Y[:, :4], weight=np.ones(4))  # one set-up: common poles fit it
    whole, lacking = (fit_poles(first, FREQ[:n, 0], ZETA[:n]) for n in (3, 2))
    assert _by_misfit(whole).max() < 1.3
    assert _by_misfit(lacking)[1] > 2.0


@pytest.mark.parametrize(("averaged", "alike"), [(1, 1.0), (2, 5.0 / 3.0), (3, 19.0 / 9.0)])
def test_noise_that_is_alike_over_lines_counts_as_many_times(averaged, alike):
    """Running means of m lines of white noise: correlations 1 - k/m, Bartlett's sum of them over two lines."""
    rng = np.random.default_rng(7)
    white = rng.standard_normal((4, 20000)) + 1j * rng.standard_normal((4, 20000))
    means = np.array([np.convolve(row, np.full(averaged, 1.0 / averaged), mode="valid") for row in white])
    assert _noise(means) == pytest.approx(alike / averaged, rel=0.02)


PAIR = [np.array([0, 2]), np.array([1, 3])]


def clean(freq, zeta, residues):
    """Lines from 85 to 125 Hz of four channels, two set-ups, without noise."""
    lines = np.arange(85.0, 125.0, 0.1)
    empty = Window(freq=lines, Y=np.zeros((2 * len(lines), 4)), power=0, residues=residues, weight=np.ones(4),
                   floor=0.0, along=np.ones(len(lines)))  # fmt: skip
    shapes = np.array([[1.0, -0.6, 0.8, 0.4], [-0.5, 0.9, 0.7, -1.0]]) * (1.0 if residues == "real" else 1.0 - 0.4j)
    H = Modes(freq, zeta, shapes + 0j).response(empty, PAIR)
    return replace(empty, Y=np.concatenate([H.real, H.imag]))


def test_modes_of_channels_alone_are_put_together_by_their_frequencies():
    """Two modes damped alike, each large in the channels where the other is small: their sizes say the opposite."""
    rng = np.random.default_rng(3)
    freq, zeta = np.array([[100.0, 100.13], [101.0, 100.93]]), np.array([3e-3, 3e-3])
    lines = np.arange(96.0, 105.0, 0.03)
    empty = Window(freq=lines, Y=np.zeros((2 * len(lines), 4)), power=0, residues="complex", weight=np.ones(4),
                   floor=0.0, along=np.ones(len(lines)))  # fmt: skip
    residues = np.array([[1.0, -0.6, 0.1, 0.9], [-0.2, 0.9, 0.9, -0.1]]) + 0j
    H = Modes(freq, zeta, residues).response(empty, PAIR)
    sigma = 1e-3 * np.abs(H).max()
    H = H + sigma * (rng.standard_normal(H.shape) + 1j * rng.standard_normal(H.shape))
    window = replace(empty, Y=np.concatenate([H.real, H.imag]))
    c = Cluster(Modes(freq.mean(axis=1, keepdims=True), zeta, residues), window, (98.5, 102.5), sigma**2)
    alone = channels_alone([c], np.arange(4), 0.05, 0.03)
    np.testing.assert_allclose(alone.peaks[0].freq, freq[:, [0, 1, 0, 1]], atol=5e-3)
    assert alone.leak == 0.0
    assert alone.evidence[0] > 100.0


@pytest.mark.parametrize("residues", ["real", "complex"])
@pytest.mark.parametrize(
    ("span", "damping", "count"), [((100.0, 100.9), 0.01, 10), ((100.0, 104.0), 5e-3, 16), ((95.0, 110.0), 1e-3, 120)]
)
def test_one_more_mode_stands_at_the_best_of_ten_places_to_120(span, damping, count, residues):
    """Four to the half-power bandwidth of the lowest; the sum of squares falls by all that the known mode leaves."""
    at = np.linspace(*span, count)[4]
    known, zeta = np.array([[97.0, 97.2]]), np.array([3e-3])
    window = clean(np.vstack([known, [at, at]]), np.append(zeta, damping), residues)
    left = 0.0
    for own, channels in zip(known.T, PAIR, strict=True):
        terms, data = np.hstack([window.values(own, zeta), window.polynomials()]), window.as_complex[:, channels]
        left += np.sum(np.abs(data - terms @ np.linalg.lstsq(terms, data, rcond=None)[0]) ** 2)
    found, gain = best_beside(window, PAIR, known, zeta, damping, span)
    assert found == pytest.approx(at, rel=1e-12)
    assert gain == pytest.approx(left, rel=1e-9)


@pytest.mark.parametrize("residues", ["real", "complex"])
@pytest.mark.parametrize(("span", "count"), [((99.2, 100.7), 14), ((95.0, 110.0), 100), ((88.0, 122.0), 120)])
def test_modes_start_at_the_best_of_places_in_each_setup(span, count, residues):
    """With the damping of the nearest known pole; four to its bandwidth, not fewer than 14 nor more than 120."""
    grid = np.linspace(*span, count)
    freq = grid[[[5, 4], [-4, -3]]]
    known = freq.mean(axis=1)
    zeta = np.array([0.3 / known[0], 5e-3])  # bandwidths of 0.6 Hz and more
    window = clean(freq, zeta, residues)
    one, two = places(window, PAIR, known, zeta, 2, span)
    assert one.shape == (1, 2)
    np.testing.assert_allclose(two, freq, rtol=1e-12)
