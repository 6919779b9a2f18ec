"""Where a frequency axis is cut, line by line; what noise there is on it."""

import numpy as np
import pytest

from casingfem.experiment.identify.poles import bands
from casingfem.experiment.identify.poles.bands import (
    _around,
    _cuts,
    _empty,
    _end,
    _level_scatter,
    find_bands,
    line_noise,
    noise_along,
)

ROUGH = np.sqrt(20.0 * 2.0 * np.log(2.0))


def third(rows):
    return np.abs(rows[:, 3:] - 3.0 * rows[:, 2:-1] + 3.0 * rows[:, 1:-2] - rows[:, :-3])


def test_noise_is_the_median_of_third_differences():
    rng = np.random.default_rng(2)
    H = rng.standard_normal((2, 30)) + 1j * rng.standard_normal((2, 30))
    np.testing.assert_allclose(line_noise(H), np.median(third(H), axis=1) / ROUGH, rtol=1e-12)


@pytest.mark.parametrize("count", [40, 300])
def test_noise_along_the_lines_is_the_rms_of_running_medians(count):
    """Over as many lines as there are differences, 201 at most; one line is lost before, two behind."""
    rng = np.random.default_rng(3)
    H = (rng.standard_normal((3, count)) + 1j * rng.standard_normal((3, count))) * np.linspace(1.0, 5.0, count)
    noise = np.array([0.5, 2.0, 1.0])
    rough, half = third(H) / (ROUGH * noise[:, None]), min(201, count - 3) // 2
    near = min(201, count - 3)
    padded = np.pad(rough, [(0, 0), (half, near - 1 - half)], mode="edge")
    each = np.array([np.sort(padded[:, k : k + near], axis=1)[:, near // 2] for k in range(count - 3)])
    want = np.sqrt(np.mean(each**2, axis=1))
    np.testing.assert_allclose(noise_along(H, noise), np.r_[want[0], want, want[-1], want[-1]], rtol=1e-12)
    level = np.abs(H[0])
    rough = np.pad(third(level[None])[0], (half, near - 1 - half), mode="edge")
    want = np.array([np.sort(rough[k : k + near])[near // 2] for k in range(count - 3)]) / (np.sqrt(20.0) * 0.6745)
    np.testing.assert_allclose(_level_scatter(level), np.r_[want[0], want, want[-1], want[-1]], rtol=1e-12)


def test_cuts_lie_at_the_lowest_line_between_peaks():
    power = np.array([1.0, 9.0, 3.0, 2.0, 5.0, 8.0, 0.5, 7.0, 0.1])
    assert _cuts(power, np.array([1, 5, 7])) == [0, 3, 6, 9]
    assert _cuts(power, np.array([5])) == [0, 9]
    assert _cuts(power, np.array([], int)) == [0, 9]


def test_bands_without_peaks_have_forty_lines_to_fifteen_hundred():
    assert _empty(10, 49) == []
    assert _empty(10, 50) == [((10, 50), (10, 50), 0)]
    assert _empty(0, 1500) == [((0, 1500), (0, 1500), 0)]
    assert [band.core for band in _empty(100, 1602)] == [(100, 851), (851, 1602)]


def test_a_window_shows_its_peaks_and_what_is_about_them():
    """As far as they reach; no more than 200 lines or eight bandwidths, no fewer than 40, and not beyond the axis."""
    freq = np.arange(0.0, 1000.0)
    peaks = np.array([400, 450])
    assert _around(freq, peaks, np.array([60.0, 70.0]), 1.0) == (340, 520)
    assert _around(freq, peaks, np.array([100.0, 20.0]), 1.0) == (300, 500)
    assert _around(freq, peaks, np.array([10.0, 90.0]), 1.0) == (360, 540)
    assert _around(freq, peaks, np.array([300.0, 300.0]), 1.0) == (200, 650)
    assert _around(freq, peaks, np.array([300.0, 300.0]), 30.0) == (160, 690)
    assert _around(freq, peaks, np.array([10.0, 5.0]), 1.0) == (360, 490)
    assert _around(freq, np.array([20, 980]), np.array([5.0, 5.0]), 1.0) == (0, 1000)


def test_a_band_ends_at_a_gap_or_at_the_deepest_valley_within_reach():
    cuts = [0, 1, 2, 3, 4, 5, 6, 7]
    power = np.array([9.0, 5.0, 6.0, 4.0, 3.0, 2.0, 1.0, 9.0])
    freq, reach = np.arange(100.0, 107.0), np.full(7, 0.6)
    assert _end(power, cuts, freq, reach, 0) == 5  # three, four or five peaks: the lowest of lines 3, 4, 5
    assert _end(np.array([9.0, 0, 0, 1, 2, 3, 0, 0]), cuts, freq, reach, 0) == 3
    assert _end(np.array([9.0, 0, 0, 2, 1, 3, 0, 0]), cuts, freq, reach, 0) == 4
    assert _end(power, cuts, freq, reach, 3) == 7  # the last four
    assert _end(power, cuts, freq, reach, 2) == 7  # the last five: nothing is beyond
    far = freq.copy()
    far[2:] += 0.3
    assert _end(power, cuts, far, reach, 0) == 2
    assert _end(power, cuts, far, reach, 2) == 7
    reach[1], reach[2] = 0.4, 0.95
    assert _end(power, cuts, far, reach, 0) == 5  # together they reach over 1.3
    edge = 100.0 + np.array([0.0, 1.25, 3.0])
    assert _end(power, cuts, edge, np.array([0.5, 0.75, 0.5]), 0) == 2


def peaks_of(freq, places, width=0.1):
    return sum(1.0 / (1j * (freq - at) + width) for at in places)[None]


def test_bands_of_picked_peaks_show_a_fortieth_of_the_frequency_about_them():
    freq = np.arange(100.0, 300.0, 0.5)
    H = peaks_of(freq, (190.0,))  # what is picked counts, not what is seen
    found = find_bands(freq, H, np.array([1e-3]), np.array([140.0, 240.0]))
    assert [band.peaks for band in found] == [0, 1, 0, 1, 0]
    windows = [band.window for band in found if band.peaks]
    assert windows == [(40, 120), (240, 320)]  # 40 lines either side: 20 Hz are more than 3.5 and 6
    wide = np.arange(1000.0, 3000.0, 0.5)
    H = peaks_of(wide, (1600.0,))
    found = find_bands(wide, H, np.array([1e-3]), np.array([1600.0]))
    assert [band.window for band in found if band.peaks] == [(1200 - 80, 1200 + 80)]  # 0.025 x 1600 Hz
    assert [band.core for band in found] == [(0, 1120), (1120, 1280), (1280, 2640), (2640, 4000)]


def test_found_peaks_reach_two_bandwidths():
    freq = np.arange(100.0, 300.0, 0.1)
    H = peaks_of(freq, (200.0,), width=4.0)  # half of the power at 4 Hz off: 8 Hz wide
    (band,) = [band for band in find_bands(freq, H, np.array([1e-5])) if band.peaks]
    assert band.window == pytest.approx((1000 - 160, 1000 + 160), abs=2)
    assert band.core == band.window
    assert band.peaks == 1


@pytest.mark.parametrize(("factor", "count"), [(1.02, 1), (0.98, 0)])
def test_a_peak_rises_above_the_noise_by_six_standard_deviations(monkeypatch, factor, count):
    """Of two channels: a mean of 4 and a standard deviation of sqrt 8, both times the noise along the lines."""
    monkeypatch.setattr(bands, "noise_along", lambda H, noise: np.full(H.shape[1], 3.0))
    freq = np.arange(100.0, 120.0, 0.1)
    height = factor * np.sqrt(9.0 * (4.0 + 6.0 * 2.0 * np.sqrt(2.0)))
    shape = 0.1 + (height / np.sqrt(2.0) - 0.1) * np.exp(-(((freq - 110.0) / 0.5) ** 2))
    H = np.vstack([shape, 1j * shape]) * np.array([[2.0], [5.0]])
    found = find_bands(freq, H, np.array([2.0, 5.0]))
    assert sum(band.peaks for band in found) == count


@pytest.mark.parametrize(("decibels", "count"), [(3.2, 2), (2.8, 1)])
def test_a_peak_stands_out_by_three_decibels(decibels, count):
    freq = np.linspace(100.0, 120.0, 400)
    levels = np.interp(freq, [100.0, 106.0, 109.0, 112.0, 120.0], [0.0, 40.0, 40.0 - decibels, 41.0, 0.0])
    H = 10.0 ** (levels / 20.0)[None] + 0j
    found = find_bands(freq, H, np.array([1e-3]))
    assert sum(band.peaks for band in found) == count
