"""Visible peaks of the power spectra of the references, and bands of a few peaks.

The spectra are those of the correlations, whose jackknife over the blocks shows which peaks are significant.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.signal import find_peaks, peak_widths
from scipy.signal.windows import blackmanharris

from casingfem.experiment.identify.lscf import bands
from casingfem.experiment.identify.output_only.correlations import EDGE, Correlations
from casingfem.experiment.identify.thresholds import Thresholds
from casingfem.io.arrays import BoolArray, FloatArray, IntArray

LOBES = 1e-8  # of the largest power: ten times the side lobes of the window
WIDEST = 4.0  # lines: half-power width of the window's main lobe, and more
NORMAL = 2.0  # least standard deviations of the power of a peak
EMPTY = 6  # a band wider than this number of times the lines around its peaks is divided
MARGIN = 1.3  # widening of a band at each end, in edges of its filter


class Spectrum(NamedTuple):
    """Power of the references at lines [Hz], and its standard deviation, each (lines,)."""

    freq: FloatArray
    power: FloatArray
    scatter: FloatArray

    def at(self, lines: BoolArray) -> Spectrum:
        """The spectrum at some lines."""
        return Spectrum(self.freq[lines], self.power[lines], self.scatter[lines])

    @property
    def step(self) -> float:
        """Distance of lines [Hz]."""
        return float(self.freq[1] - self.freq[0])


class Band(NamedTuple):
    """Frequencies [Hz] from `low` up to `high` within which poles count, those of the filter, visible peaks inside."""

    low: float
    high: float
    ends: tuple[float, float]
    seen: FloatArray


def spectrum_of(found: Correlations) -> Spectrum:
    """Power spectrum of the references, with its scatter by jackknife over the blocks."""
    freq = np.asarray(np.fft.rfftfreq(found.R.shape[-1], 1.0 / found.fs), np.float64)
    whole, count = _power(found, found.mean), len(found.R)
    power = np.array([_power(found, found.without(block)) for block in range(count)])
    scatter = np.sqrt((count - 1) / count * np.sum((power - power.mean(axis=0)) ** 2, axis=0))
    return Spectrum(freq, np.asarray(np.maximum(whole, 1e-12 * whole.max())), np.asarray(scatter))


def _power(found: Correlations, R: FloatArray) -> FloatArray:
    """Power of the references (lines,) from correlations R (sensors, references, 2 L).

    The window over the lags has no side lobes of tones. It is zero at its ends, where the correlations of modes that
    have not decayed have a kink.
    """
    window = blackmanharris(R.shape[-1], sym=False)
    own = R[found.references, np.arange(len(found.references))]
    return np.asarray(np.fft.rfft(own * np.fft.ifftshift(window - window[0]), axis=-1).real.sum(axis=0))


def peaks_of(spectrum: Spectrum, rules: Thresholds) -> IntArray:
    """Lines of peaks that are above their surroundings, significant by their scatter, and not too wide for a mode."""
    freq, power, scatter = spectrum
    at, _ = find_peaks(10.0 * np.log10(power), prominence=rules.prominence_db)
    at = at[power[at] > np.maximum(NORMAL * scatter[at], LOBES * power.max())]
    width = spectrum.step * (peak_widths(power, at)[0] if len(at) else np.zeros(0))
    return np.asarray(at[width < np.maximum(2.0 * rules.zeta_most * freq[at], WIDEST * spectrum.step)])


def bands_about(spectrum: Spectrum, at: IntArray, most: float, rules: Thresholds) -> list[Band]:
    """Bands of a few peaks, which are `at` these lines; `most` [Hz] is the largest frequency of a filter."""
    freq, seen, done = spectrum.freq, spectrum.freq[at], list[Band]()
    for core in (part for band in bands(spectrum.power, at, rules) for part in _around(band.core, at, rules)):
        low, high = float(freq[core.start]), float(freq[core.stop - 1])
        reach = MARGIN * EDGE * (high - low) / (1.0 - 2.0 * MARGIN * EDGE)
        ends = max(0.0, low - reach), min(most, high + reach)
        done.append(Band(low, high + float(freq[1] - freq[0]), ends, seen[(seen >= low) & (seen <= high)]))
    return done


def _around(core: slice, at: IntArray, rules: Thresholds) -> list[slice]:
    """Divide a band into the lines around its peaks and the lines beyond, if the latter are many more.

    The step between the lags of a band is its inverse width. A wide band with few peaks would not resolve close modes.
    """
    inside = at[(at >= core.start) & (at < core.stop)]
    if not len(inside):
        return [core]
    margin = max(rules.reach_lines, int(inside[-1] - inside[0]) // 2)
    start, stop = max(core.start, int(inside[0]) - margin), min(core.stop, int(inside[-1]) + margin)
    if core.stop - core.start < EMPTY * (stop - start):
        return [core]
    return [part for part in (slice(core.start, start), slice(start, stop), slice(stop, core.stop)) if _lines(part)]


def _lines(part: slice) -> int:
    return int(part.stop - part.start)
