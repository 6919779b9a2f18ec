"""A frequency axis cut at the valleys between its peaks, so that each fit has few modes."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.ndimage import median_filter
from scipy.signal import find_peaks, peak_widths

from casingfem.io.arrays import Array, FloatArray, IntArray

PROMINENCE_DB, SCATTERS = 3.0, 5.0  # of a peak: at least, and in standard deviations of a line's level about it
ABOVE_NOISE = 6.0  # standard deviations
NEAR = 201  # lines over which noise is taken for alike
PEAKS = 3, 5  # in a band: at least, where there are more near by, and at most
MARGIN = 0.025, 2.0  # of a peak's frequency, or half-power bandwidths: what a window shows around its peaks
ROUGH = np.sqrt(20.0 * 2.0 * np.log(2.0))  # median of third differences of complex noise of unit deviation
LINES = 40, 1500  # around peaks at least; in a band without peaks at most
ENOUGH = 200, 8.0  # lines around peaks that are enough, or half-power bandwidths


class Band(NamedTuple):
    """Lines `core` (first, end) whose modes count, those of the `window` around it, and the peaks in the window."""

    core: tuple[int, int]
    window: tuple[int, int]
    peaks: int


def line_noise(H: Array) -> FloatArray:
    """Standard deviation of the real (or imaginary) part of each channel's noise, (channels,).

    From third differences over the lines, var = 20 sigma^2; their median does not see the few lines on peaks.

    >>> rng = np.random.default_rng(5)
    >>> float(line_noise(0.3 * (rng.normal(size=(1, 4000)) + 1j * rng.normal(size=(1, 4000))))[0].round(1))
    0.3
    """
    return np.asarray(np.median(np.abs(np.diff(H, 3, axis=1)), axis=1) / ROUGH)


def noise_along(H: Array, noise: FloatArray) -> FloatArray:
    """Rms over the channels of each line's noise over `noise`, (lines,): it rises at low frequencies, and with H.

    As `line_noise`, by running medians.
    """
    rough = np.abs(np.diff(H, 3, axis=1)) / (ROUGH * noise[:, None])
    near = min(NEAR, rough.shape[1])
    each = np.array([median_filter(row, near, mode="nearest") for row in rough])  # of one axis it is much faster
    return np.asarray(np.pad(np.sqrt(np.mean(each**2, axis=0)), (1, 2), mode="edge"))


def _level_scatter(level: FloatArray) -> FloatArray:
    """Standard deviation of a line's level [dB] about it, (lines,): third differences, by running medians."""
    rough = median_filter(np.abs(np.diff(level, 3)), min(NEAR, len(level) - 3), mode="nearest")
    return np.asarray(np.pad(rough / (np.sqrt(20.0) * 0.6745), (1, 2), mode="edge"))


def find_bands(freq: FloatArray, H: Array, noise: FloatArray, picked: FloatArray | None = None) -> list[Band]:
    """Bands of a few peaks of sum |H_c/noise_c|^2, cut at valleys, and the bands without peaks between them.

    Frequencies `picked` [Hz], ascending, are the peaks if they are given.

    >>> f = np.arange(100.0, 200.0, 0.05)
    >>> H = sum(1.0 / (1j * (f - at) + 0.1) for at in (120.0, 121.0, 150.0))[None]
    >>> for band in find_bands(f, H, np.array([1e-3])):
    ...     print(f[band.core[0]].round(1), f[band.core[1] - 1].round(1), band.peaks)
    100.0 116.9 0
    117.0 124.0 2
    124.0 146.2 0
    146.2 153.7 1
    153.8 199.9 0
    """
    power = np.sum(np.abs(H / noise[:, None]) ** 2, axis=0) + 1e-300
    peaks = np.unique(np.searchsorted(freq, [] if picked is None else picked))
    if picked is None:
        level = 10.0 * np.log10(power)
        least = 10.0 * np.log10(2.0 * len(H) + ABOVE_NOISE * 2.0 * np.sqrt(len(H)))
        height = least + 20.0 * np.log10(np.maximum(noise_along(H, noise), 1e-9))
        prominence = np.maximum(PROMINENCE_DB, SCATTERS * _level_scatter(level))
        peaks, _ = find_peaks(level, prominence=prominence, height=height)
    cuts, widths = _cuts(power, peaks), peak_widths(power, peaks)[0] if picked is None else np.zeros(len(peaks))
    reach = np.maximum(MARGIN[0] * freq[peaks], MARGIN[1] * widths * (freq[1] - freq[0]))
    bands: list[Band] = []
    reached, end = 0, 0
    while end < len(peaks):
        start, end = end, _end(power, cuts, freq[peaks], reach, end)
        low, high = _around(freq, peaks[start:end], reach[start:end], float(widths[start:end].max()))
        core = max(low, cuts[start]), min(high, cuts[end])
        bands += _empty(reached, core[0])
        bands.append(Band(core, (low, high), int(np.sum((peaks >= low) & (peaks < high)))))
        reached = core[1]
    return bands + _empty(reached, len(freq))


def _around(freq: FloatArray, peaks: IntArray, reach: FloatArray, width: float) -> tuple[int, int]:
    """Lines about some peaks, that reach so far [Hz], of half-power bandwidths up to `width` lines."""
    first, last = int(peaks[0]), int(peaks[-1])
    low, high = np.searchsorted(freq, [(freq[peaks] - reach).min(), (freq[peaks] + reach).max()]).tolist()
    enough = max(ENOUGH[0], int(ENOUGH[1] * width))
    low, high = max(low, first - enough), min(high, last + enough)
    return max(min(low, first - LINES[0]), 0), min(max(high, last + LINES[0]), len(freq))


def _empty(low: int, high: int) -> list[Band]:
    """Bands without peaks; slivers are left to none."""
    if high - low < LINES[0]:
        return []
    edges = np.linspace(low, high, -(-(high - low) // LINES[1]) + 1).astype(int).tolist()
    return [Band((a, b), (a, b), 0) for a, b in pairwise(edges)]


def _end(power: FloatArray, cuts: list[int], freq: FloatArray, reach: FloatArray, start: int) -> int:
    """Peak before which the band from `start` ends: at a wide gap, or the deepest valley within reach."""
    most = min(len(freq), start + PEAKS[1])
    far = (k for k in range(start + 1, most) if freq[k] - freq[k - 1] > reach[k] + reach[k - 1])
    gap = next(far, most)
    if gap < start + PEAKS[1] or gap == len(freq):
        return gap
    return min(range(start + PEAKS[0], gap + 1), key=lambda k: float(power[cuts[k]]))


def _cuts(power: FloatArray, peaks: IntArray) -> list[int]:
    """Line of the lowest value between each two peaks, with both ends of the axis."""
    return [0, *(a + int(np.argmin(power[a:b])) for a, b in pairwise(peaks.tolist())), len(power)]
