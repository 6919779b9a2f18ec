"""A frequency axis cut at the valleys between its peaks, so that each fit has few modes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.signal import find_peaks

from casingfem.arrays import Array, FloatArray, IntArray

PROMINENCE_DB = 3.0
ABOVE_NOISE = 6.0  # standard deviations
PEAKS = 3, 5  # in a band: at least, at most
MOST_LINES = 3000  # of a window


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
    rough = np.abs(np.diff(H, 3, axis=1))
    return np.asarray(np.median(rough, axis=1) / np.sqrt(20.0 * 2.0 * np.log(2.0)))


def find_bands(H: Array, noise: FloatArray) -> list[Band]:
    """Bands of three to five peaks of sum |H_c/noise_c|^2, cut at valleys; a window reaches one peak further.

    >>> x = np.linspace(0.0, 50.0, 2000)
    >>> H = sum(1.0 / (1j * (x - at) + 0.1) for at in range(5, 50, 6))[None]
    >>> [(band.core, band.peaks) for band in find_bands(H, np.array([1e-3]))]
    [((0, 1039), 5), ((1039, 2000), 5)]
    """
    power = np.sum(np.abs(H / noise[:, None]) ** 2, axis=0)
    level = 2.0 * len(H) + ABOVE_NOISE * 2.0 * np.sqrt(len(H))
    peaks, _ = find_peaks(10.0 * np.log10(power), prominence=PROMINENCE_DB, height=10.0 * np.log10(level))
    if not peaks.size:
        return []
    cuts = _cuts(power, peaks)
    bands, end = [], 0
    while end < len(peaks):
        start, end = end, _end(power, cuts, end)
        first, last = max(start - 1, 0), min(end + 1, len(peaks))
        reach = MOST_LINES // 2
        window = max(cuts[first], cuts[start] - reach), min(cuts[last], cuts[end] + reach)
        bands.append(Band((cuts[start], cuts[end]), window, last - first))
    return bands


def _end(power: FloatArray, cuts: list[int], start: int) -> int:
    """Peak before which the band from `start` ends: at the deepest valley within reach."""
    last = len(cuts) - 1
    if last - start <= PEAKS[1]:
        return last
    return min(range(start + PEAKS[0], start + PEAKS[1] + 1), key=lambda k: float(power[cuts[k]]))


def _cuts(power: FloatArray, peaks: IntArray) -> list[int]:
    """Line of the lowest value between each two peaks, with both ends of the axis."""
    pairs = zip(peaks[:-1].tolist(), peaks[1:].tolist(), strict=True)
    return [0, *(low + int(np.argmin(power[low:high])) for low, high in pairs), len(power)]
