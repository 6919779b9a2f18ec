"""Modes near each other as clusters: where they are cut, what they cost, what their modes are worth."""

from dataclasses import replace

import numpy as np
import pytest

from casingfem.experiment.identify.poles.pole_window import Window
from casingfem.experiment.identify.setups.cluster_modes import (
    ClusterModes,
    _price,
    fit_again,
    held,
    joined,
    leaking,
    only_peaks,
    rematched,
    worth,
)
from casingfem.experiment.identify.setups.clusters import Cluster, _few_each, _noise, clusters
from casingfem.experiment.identify.setups.own_shifts import Modes, OwnPeaks, squares_at

SETUPS = [np.array([0, 2]), np.array([1, 3, 4])]
LINES = np.arange(80.0, 140.0, 0.1)


def window(modes=None, setups=SETUPS, lines=LINES, sigma=0.0, residues="complex", leak=0.0):
    rng = np.random.default_rng(6)
    weight = np.array([1.0, 2.0, 0.5, 1.5, 0.7])
    empty = Window(freq=lines, Y=np.zeros((2 * len(lines), 5)), power=1, residues=residues, weight=weight, floor=0.0,
                   along=np.ones(len(lines)), leak=leak)  # fmt: skip
    H = np.zeros((len(lines), 5)) if modes is None else modes.response(empty, setups)
    H = H + sigma * (rng.standard_normal(H.shape) + 1j * rng.standard_normal(H.shape))
    return replace(empty, Y=np.vstack([H.real, H.imag]))


def modes(freq, zeta, seed=9):
    rng = np.random.default_rng(seed)
    shapes = rng.standard_normal((len(zeta), 5)) + 0.3j * rng.standard_normal((len(zeta), 5))
    return Modes(np.array(freq, float), np.array(zeta, float), shapes)


def peaks(freq, zeta, squares=5.0, on_peaks=0.0):
    freq, zeta = np.array(freq, float), np.array(zeta, float)
    tiny = np.full(freq.shape, 1e-9)
    return OwnPeaks(freq, zeta, tiny, tiny, np.ones((len(freq), 5)) + 0j, squares, on_peaks)


@pytest.mark.parametrize(("noise", "divisor"), [(0.2, 0.5), (0.8, 0.8)])
@pytest.mark.parametrize(("residues", "columns"), [("real", 1), ("complex", 2)])
def test_a_reading_costs_its_squares_over_the_noise_and_a_price_for_each_number(noise, divisor, residues, columns):
    c = Cluster(modes([[100.0]], [0.01]), window(residues=residues), (99.0, 101.0), 0.5)
    want = 7.0 / divisor + np.log(2 * len(LINES) * 5) * 3 * (5 * columns + 4)
    assert c.cost(7.0, 3, 4, noise) == pytest.approx(want, rel=1e-12)
    assert c.apart == np.inf


@pytest.mark.parametrize(("factor", "count"), [(1.001, 2), (0.999, 1)])
def test_clusters_are_cut_where_the_reaches_of_neighbours_end(factor, count):
    """A thousandth of the frequency times (2 + 500 zeta) on either side, from the highest to the lowest set-up."""
    zeta, top = [0.004, 0.002], 100.5
    low = 100.0 * (2e-3 + 0.5 * 0.004)
    gap = factor * (low + top * (2e-3 + 0.5 * 0.002)) / (1.0 - factor * (2e-3 + 0.5 * 0.002))
    own = modes([[top + gap + 0.3, top + gap], [100.0, top]], zeta[::-1])
    found = list(clusters(window(own), own, SETUPS))
    assert len(found) == count
    assert found[0].modes.freq[0].tolist() == [100.0, top]
    span = [found[0].span[0], found[-1].span[1]]
    assert span == pytest.approx([100.0 - low, own.freq[0, 0] + own.freq[0, 1] * (2e-3 + 0.5 * 0.002)], rel=1e-12)
    assert found[0].apart == np.inf


def test_a_cluster_is_alone_in_its_lines_and_knows_its_noise():
    own = modes([[100.0, 100.2], [120.0, 119.9]], [0.004, 0.002])
    own = own._replace(residues=1e-3 * own.residues)
    noise = window(sigma=0.3)
    whole = replace(noise, Y=noise.Y + window(own).Y)
    first, second = clusters(whole, own, SETUPS, shift=2e-3)
    for c, k in ((first, 0), (second, 1)):
        zeta = own.zeta[k]
        beyond = 1.0 + 8.0 * zeta
        a, b = np.searchsorted(LINES, [c.span[0] * (2.0 - beyond), c.span[1] * beyond]).tolist()
        np.testing.assert_array_equal(c.window.freq, LINES[a:b])
        alone = own.some(np.array([k])).response(c.window, SETUPS) + noise.as_complex[a:b]
        np.testing.assert_allclose(c.window.as_complex, alone, atol=1e-9)
        assert c.noise == pytest.approx(0.09, rel=0.3)
        assert c.apart == 0.01  # five usual shifts
    assert [c.apart for c in clusters(whole, own, SETUPS, shift=1e-5)] == [2e-3, 2e-3]
    clean = next(clusters(window(own), own, SETUPS))
    assert clean.noise == pytest.approx(0.5 * 9e-8 * np.mean(np.abs(clean.window.as_complex) ** 2), rel=1e-9)


@pytest.mark.parametrize(("at", "lines"), [(80.5, (0, 40)), (139.9, (560, 600)), (100.0, None)])
def test_a_cluster_has_forty_lines_at_least(at, lines):
    own = modes([[at, at]], [1e-5])
    (c,) = clusters(window(own), own, SETUPS)
    assert len(c.window.freq) >= 40
    if lines:
        np.testing.assert_array_equal(c.window.freq, LINES[slice(*lines)])


def test_of_many_lines_every_so_many_are_taken_while_the_narrowest_peak_keeps_eight():
    lines = np.arange(80.0, 140.0, 0.01)
    for zeta, most, stride in ((0.004, 300, 2), (0.0078, 100, 13), (0.0022, 10, 5), (0.0007, 10, 1)):
        own = modes([[100.0, 100.0]], [zeta])
        (c,) = clusters(window(own, lines=lines), own, SETUPS, most)
        assert c.window.freq[1] - c.window.freq[0] == pytest.approx(0.01 * stride, rel=1e-6)


def test_many_modes_are_cut_at_the_widest_gap_that_leaves_both_sides_some():
    freq = np.cumsum([1.0] * 15)
    assert [part.tolist() for part in _few_each(np.arange(14), freq)] == [list(range(14))]
    for at, cut in ((7, 7), (4, 4), (11, 11), (2, 4), (14, 4)):  # beyond three of either side no gap counts
        spread = np.arange(15.0)
        spread[at:] += 5.0
        assert [len(part) for part in _few_each(np.arange(15), spread)] == [cut, 15 - cut]
    assert [len(part) for part in _few_each(np.arange(5, 20), np.r_[np.zeros(5), freq])] == [4, 11]


def cluster(freq=((100.0, 100.2), (102.0, 101.9)), zeta=(0.004, 0.006), sigma=0.5, span=(98.0, 104.0)):
    own = modes(freq, zeta)
    lines = np.arange(96.0, 106.0, 0.1)
    return Cluster(own, window(own, lines=lines, sigma=sigma), span, sigma**2 if sigma else 1e-9)


def test_a_mode_is_worth_what_the_squares_rise_without_it_over_its_price():
    c = cluster()
    one = ClusterModes(c, fit_again(c, SETUPS, c.modes.freq, c.modes.zeta))
    own = one.own
    whole = squares_at(c.window, SETUPS, own.freq, own.zeta[:, 0])
    noise = max(own.on_peaks, c.noise)
    for k in range(2):
        left = squares_at(c.window, SETUPS, own.freq[[1 - k]], own.zeta[[1 - k], 0])
        price = np.log(c.window.Y.size) * (2 * 5 + 3)
        assert worth(one, SETUPS)[k] == pytest.approx((left - whole) / noise / price, rel=1e-9)
    assert one.cost(2, 100.0) == pytest.approx(c.cost(own.squares, 2, 3, 100.0), rel=1e-12)
    assert _price(c, SETUPS, own) == pytest.approx(noise * np.log(c.window.Y.size) * 13, rel=1e-9)


def test_the_ridge_holds_residues_to_three_times_their_usual_size():
    c = cluster()
    weighted = c.modes.residues * c.window.weight * c.window.freq.mean()
    sizes = [np.median([np.mean(np.abs(row[channels]) ** 2) for channels in SETUPS]) for row in weighted]
    np.testing.assert_allclose(held(c, SETUPS), c.noise / (9.0 * np.array(sizes)), rtol=1e-9)


def test_modes_that_run_away_in_half_of_the_set_ups_or_are_too_damped_are_no_peaks():
    c = cluster(zeta=(0.004, 0.002))
    highest = 2.0 * c.modes.zeta[(np.linalg.norm(c.modes.residues, axis=1) / c.modes.zeta).argmax()]
    good = [100.0, 100.2]
    for row, zeta, kept in (
        ([101.9, 102.0], 0.001, 2),
        ([97.9, 102.0], 0.001, 1),
        ([104.1, 102.0], 0.001, 1),
        ([101.9, 102.0], highest * 1.01, 1),
        ([101.9, 102.0], highest * 0.99, 2),
    ):
        own = peaks([good, row], [[0.001] * 2, [zeta] * 2])
        found = only_peaks(c, SETUPS, own, 1e-4)
        assert len(found.freq) == kept
        assert (found is own) == (kept == 2)
    none = peaks([[90.0, 90.0]], [[0.001] * 2])
    assert only_peaks(c, SETUPS, none, 1e-4) is none
    wide = peaks([good, [101.9, 102.0]], [[0.001] * 2, [0.02] * 2])
    assert only_peaks(c, SETUPS, wide, 0.0201) is wide


def test_modes_of_all_clusters_are_put_together_in_the_units_of_the_data():
    first, second = cluster(), cluster(freq=((101.0, 101.1),), zeta=(0.005,))
    parts = [ClusterModes(c, fit_again(c, SETUPS, c.modes.freq, c.modes.zeta)) for c in (first, second)]
    whole = joined(parts)
    np.testing.assert_array_equal(whole.freq, np.vstack([part.own.freq for part in parts]))
    np.testing.assert_array_equal(whole.zeta, np.concatenate([part.own.zeta[:, 0] for part in parts]))
    want = np.vstack([part.own.residues / first.window.weight / first.window.freq.mean() for part in parts])
    np.testing.assert_allclose(whole.residues, want, rtol=1e-12)
    assert leaking(first, 0.3).window.leak == 0.3


def test_modes_exchanged_in_a_set_up_are_exchanged_back_where_damping_tells_and_rows_stay():
    c = cluster(freq=((100.0, 100.3), (101.6, 101.2)), zeta=(0.002, 0.01), sigma=0.05)
    own = fit_again(c, SETUPS, c.modes.freq, c.modes.zeta)
    np.testing.assert_allclose(rematched(ClusterModes(c, own), SETUPS, 1e-2, None), own.freq, rtol=1e-12)
    wrong = own._replace(freq=np.column_stack([own.freq[:, 0], own.freq[::-1, 1]]))
    np.testing.assert_allclose(rematched(ClusterModes(c, wrong), SETUPS, 1e-2, None), own.freq, rtol=1e-12)


def test_lines_are_taken_from_about_the_widest_mode_of_a_cluster():
    own = modes([[100.0, 100.1], [101.0, 101.0]], [0.004, 0.01])
    (c,) = clusters(window(own), own, SETUPS)
    low, high = 100.0 * (1.0 - 4e-3), 101.0 * (1.0 + 7e-3)
    assert c.span == pytest.approx((low, high), rel=1e-12)
    a, b = np.searchsorted(LINES, [low * 0.92, high * 1.08])
    np.testing.assert_array_equal(c.window.freq, LINES[a:b])


@pytest.mark.parametrize("smooth", [0.1, 1.0, 100.0])
def test_noise_is_what_neighbouring_lines_tell_or_what_is_left_up_to_forty_times_that(smooth):
    rng = np.random.default_rng(15)
    rest = rng.standard_normal((2, 200)) + 1j * rng.standard_normal((2, 200))
    rest = rest + smooth * np.exp(0.05j * np.arange(200)) * np.array([[1.0], [-2.0]])
    third = np.abs(np.diff(rest, 3, axis=1))
    rough = np.mean((np.median(third, axis=1) / np.sqrt(40.0 * np.log(2.0))) ** 2)
    power = np.sum(np.abs(rest) ** 2)
    rho = [np.sum((rest[:, k:] * rest[:, :-k].conj()).real) / power for k in (1, 2)]
    left = 0.5 * power / 400 * max(1.0 + 2.0 * (2.0 / 3.0 * rho[0] + rho[1] / 3.0), 1.0)
    assert _noise(rest) == pytest.approx(max(rough, min(left, 40.0 * rough)), rel=1e-10)
    assert (left > 40.0 * rough) == (smooth == 100.0)
    assert _noise(0.0 * rest) == 0.0
