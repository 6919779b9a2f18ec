"""Correlate responses with those of reference sensors, block by block, and select their part in a band.

    R(tau) = mean of y(t + tau) y_ref(t)^T = sum_k A_k exp(p_k tau) + conjugates,  tau > 0

for loads that are white in the band (James, Carne and Lauffer, Int. J. Anal. Exp. Modal Anal. 10, 1995, 260). Each
block of the record gives a sum over its own instants. The blocks add up to R, and their scatter gives the uncertainty
of R. The part in a band is a complex sequence with one sample for each inverse bandwidth; its first lags have a
transient of the filter.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.linalg import qr

from casingfem.io.arrays import Array, FloatArray, IntArray

BLOCKS = 20  # of a record, whose scatter gives the uncertainty
REFERENCES, ALL = 4, 6  # number of reference sensors; number of sensors up to which all are references
EDGE = 0.12  # of a band, over which its filter rises and falls
SKIPPED = 8  # lags that the filter's ends reach: one over EDGE


class Correlations(NamedTuple):
    """Correlations R (blocks, sensors, references, 2 L) at the lags 0 ... L - 1, -L ... -1 samples.

    `fs` [Hz]; `references` index the sensors.
    """

    R: FloatArray
    fs: float
    references: IntArray

    @property
    def mean(self) -> FloatArray:
        """R of the whole record, (sensors, references, 2 L)."""
        return np.asarray(self.R.mean(axis=0))

    def without(self, block: int) -> FloatArray:
        """R of the record without a block."""
        count = len(self.R)
        return np.asarray((count * self.mean - self.R[block]) / (count - 1))


class Zoomed(NamedTuple):
    """The part of correlations in a band: z (sensors, references, lags), `step` between lags [s], `low` [Hz]."""

    z: Array
    step: float
    low: float


def chosen_references(y: FloatArray) -> IntArray:
    """Select the sensors whose responses (sensors, samples) best explain the others: pivots of the covariance.

    >>> t = np.arange(200.0)
    >>> chosen_references(np.array([k * np.sin(0.1 * t) + (k == 2) * np.cos(t) for k in range(1, 8)])).tolist()[:2]
    [6, 1]
    """
    if len(y) <= ALL:
        return np.arange(len(y))
    covariance = y @ y.T
    return np.asarray(qr(covariance, mode="r", pivoting=True)[1][:REFERENCES], np.int64)


def correlated(y: FloatArray, fs: float, lags: int, references: IntArray) -> Correlations:
    """Correlate responses (sensors, samples), without their means, each divided by its rms."""
    count = (y.shape[1] - 2 * lags) // BLOCKS
    size = 1 << int(np.ceil(np.log2(count + 2 * lags)))
    R = np.empty((BLOCKS, len(y), len(references), 2 * lags))
    for block in range(BLOCKS):
        first = block * count
        seen = np.fft.rfft(y[:, first : first + count + 2 * lags], size)
        base_values = np.zeros((len(references), count + lags))
        base_values[:, lags:] = y[references, first + lags : first + lags + count]
        base = np.fft.rfft(base_values, size).conj()
        for k, reference in enumerate(base):
            both = np.fft.irfft(seen * reference, size) / count
            R[block, :, k] = np.concatenate([both[:, :lags], both[:, -lags:]], axis=1)
    return Correlations(R, fs, references)


def zoomed(R: FloatArray, fs: float, low: float, high: float) -> Zoomed:
    """Part of correlations (sensors, references, 2 L) between `low` and `high` [Hz].

    The filter is flat except at its ends.

    >>> lag = np.r_[0:2000, -2000:0] / 1000.0
    >>> R = np.exp(-10.0 * abs(lag)) * np.cos(2 * np.pi * 103.0 * lag)
    >>> part = zoomed(R[None, None], 1000.0, 60.0, 140.0)
    >>> t, decay = part.step * np.arange(8, 32), part.z[0, 0, 8:32]  # exp((p - 2 pi i 60) t), p = -10 + 2 pi i 103
    >>> slope = np.polyfit(t, np.unwrap(np.angle(decay)) + 1j * np.log(abs(decay)), 1)[0]
    >>> round(float(slope.imag), 3), round(float(slope.real / (2 * np.pi)) % 80, 3)  # known but for 80 Hz = 1 / step
    (-10.0, 43.0)
    """
    lags = R.shape[-1]
    spectrum, freq = np.fft.rfft(R, axis=-1), np.fft.rfftfreq(lags, 1.0 / fs)
    kept = np.flatnonzero((freq >= low) & (freq < high))
    at = np.arange(len(kept)) + 0.5
    rise = np.minimum(at, len(kept) - at) / (EDGE * len(kept))
    shape = np.sin(0.5 * np.pi * np.clip(rise, 0.0, 1.0)) ** 2
    z = np.fft.ifft(spectrum[..., kept] * shape, axis=-1) * (len(kept) / lags)
    return Zoomed(z, lags / (fs * len(kept)), float(freq[kept[0]]))
