"""Windows of hammer records, and the ringing that remains when a record ends.

The force is unchanged at its pulse and set to its rest value elsewhere, where it is noise. An exponential window
exp(-(t - t_0)/tau) on force and responses gives H(i omega + 1/tau): poles move by -1/tau, residues do not change
(Fladung and Rost, Mech. Syst. Signal Process. 11, 1997, 789). `identify` subtracts this damping.
"""

from __future__ import annotations

import numpy as np

from casingfem.experiment.frf.records.hits import Pulse
from casingfem.io.arrays import FloatArray

MARGIN = 2.0  # widths of a pulse that its window keeps on either side, and over which it then falls
PART = 0.05  # of a record, in which the ringing is read at both ends
ENOUGH = 0.01  # of the ringing left at the end: no window is needed
QUIET = 8  # samples before a pulse that show the noise


def force_window(samples: int, pulse: Pulse) -> FloatArray:
    """Window with value 1 at the pulse and cosine ramps to 0 on both sides, (samples,).

    >>> force_window(12, Pulse(4, 5, 1.0)).round(2).tolist()
    [0.0, 0.5, 1.0, 1.0, 1.0, 1.0, 1.0, 0.5, 0.0, 0.0, 0.0, 0.0]
    """
    reach = MARGIN * (pulse.end - pulse.start)
    at = np.arange(samples, dtype=float)
    away = np.maximum(np.maximum(pulse.start - at, at - (pulse.end - 1)), 0.0) / reach - 1.0
    return np.asarray(0.5 + 0.5 * np.cos(np.pi * np.clip(away, 0.0, 1.0)))


def exponential_window(samples: int, fs: float, pulse: Pulse, tau: float | None) -> FloatArray:
    """exp(-(t - t_0)/tau), with t_0 the start of the pulse; constant before the pulse, 1 without tau, (samples,).

    >>> exponential_window(5, 1.0, Pulse(3, 4, 1.0), 2.0).round(2).tolist()
    [2.72, 2.72, 1.65, 1.0, 0.61]
    """
    if tau is None:
        return np.ones(samples)
    first = pulse.start - MARGIN * (pulse.end - pulse.start)
    return np.asarray(np.exp(-(np.maximum(np.arange(samples), first) - pulse.start) / (fs * tau)))


def ringing_left(response: FloatArray, pulse: Pulse) -> float:
    """Part of the ringing amplitude that remains when a record (channels, samples) ends; 0 if none is measurable.

    The amplitude is the rms of all channels over a twentieth of the record at its end and, from the pulse on, the
    largest such rms; the noise before the pulse is subtracted. Both are extrapolated exponentially from the middles of
    these parts to the times of the pulse and of the end.

    >>> t = np.arange(4096) / 1024.0 - 0.1
    >>> ring = np.where(t > 0.0, np.exp(-0.5 * t) * np.sin(700.0 * t), 0.0)
    >>> round(ringing_left(ring[None], Pulse(100, 105, 1.0)), 2)  # exp(-0.5 * 3.9) = 0.142
    0.14

    Eight channels of white noise that is larger than the ringing at the end:

    >>> noise = 0.16 * np.random.default_rng(2).standard_normal((8, 4096))
    >>> 0.1 < ringing_left(ring + noise, Pulse(100, 105, 1.0)) < 0.18
    True
    """
    samples = response.shape[1]
    length = max(4, round(PART * samples))
    scale = np.sqrt(np.mean(response**2, axis=1, keepdims=True))
    power = np.sum((response / np.where(scale > 0.0, scale, 1.0)) ** 2, axis=0)
    noise = float(np.mean(power[: pulse.start - 1])) if pulse.start > QUIET else 0.0
    total = np.cumsum(np.r_[0.0, power])
    parts = (total[length:] - total[:-length]) / length
    first = float(parts[min(pulse.start, len(parts) - 1) :].max()) - noise
    last = float(parts[-1]) - noise
    spread = noise / np.sqrt(0.5 * length * len(response))
    after = samples - pulse.start
    if first <= 0.0 or last <= 3.0 * spread or after <= length:
        return 0.0
    return float(min(last / first, 1.0) ** (0.5 * after / (after - length)))


def longer(left: float, seconds: float) -> tuple[float, float]:
    """Record length [s], or time constant of a window [s], for which one per cent of the ringing remains.

    `left` is the remaining part of the ringing after a record of `seconds`. Exponential decay is assumed.

    >>> [round(value, 3) for value in longer(0.1, 2.0)]
    [4.0, 0.869]
    """
    left = min(left, 0.99)
    return seconds * float(np.log(ENOUGH) / np.log(left)), seconds / float(np.log(left / ENOUGH))
