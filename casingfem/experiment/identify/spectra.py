"""Properties of the responses before any fit: noise, visible peaks, the duration of the ringing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.ndimage import median_filter

from casingfem.experiment.identify.thresholds import USUAL, Thresholds
from casingfem.io.arrays import Array, FloatArray, IntArray, freeze

ROUGH = np.sqrt(20.0 * 2.0 * np.log(2.0))  # median of third differences of complex noise of unit deviation
ALIKE = 201  # lines over which the noise is taken as constant


def line_noise(H: Array) -> FloatArray:
    """Standard deviation of the real (or imaginary) part of each channel's noise, (channels,).

    From third differences over the lines, var = 20 sigma^2; their median ignores the few lines on peaks.

    >>> rng = np.random.default_rng(5)
    >>> float(line_noise(0.3 * (rng.normal(size=(1, 4000)) + 1j * rng.normal(size=(1, 4000))))[0].round(1))
    0.3
    """
    return np.asarray(np.median(np.abs(np.diff(H, 3, axis=1)), axis=1) / ROUGH)


def noise_along(Y: Array) -> FloatArray:
    """Noise of each line, rms over the channels, of weighted responses Y (lines, channels), (lines,)."""
    rough = np.sqrt(np.mean(np.abs(np.diff(Y, 3, axis=0)) ** 2, axis=1) / 40.0)
    near = median_filter(rough, min(ALIKE, len(rough)), mode="nearest")
    return np.asarray(np.pad(near, (1, 2), mode="edge"))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Peaks:
    """Visible peaks of the mode indicator: lines (peaks,) and half-power bandwidths in lines (peaks,)."""

    at: IntArray
    width: FloatArray

    def __post_init__(self) -> None:
        freeze(self, "at", "width")


class Responses(NamedTuple):
    """Responses Y (lines, channels) divided by their `noise` (channels,), at `freq` [Hz].

    `along` (lines,) has the weights of the lines. `peaks` are the visible peaks. `end` is the duration of the recorded
    ringing [s], `left` the share of the ringing that is left then. `leak` is the distance of lines [Hz] over which a
    Hann window leaks, else 0.
    """

    freq: FloatArray
    Y: Array
    noise: FloatArray
    along: FloatArray
    peaks: Peaks
    end: float = np.inf
    left: float = 0.0
    leak: float = 0.0

    @property
    def step(self) -> float:
        """Distance of lines [rad/s]."""
        return 2.0 * np.pi * float(self.freq[1] - self.freq[0])

    def some(self, channels: IntArray, rules: Thresholds = USUAL) -> Responses:
        """The responses of some channels, with the visible peaks of these channels."""
        Y = self.Y[:, channels]
        return self._replace(Y=Y, noise=self.noise[channels], peaks=visible_peaks(Y, rules))


def over_noise(freq: FloatArray, H: Array, along: FloatArray, rules: Thresholds = USUAL) -> Responses:
    """Responses H (channels, lines) over the noise of their channels, with their peaks and the end of their ringing."""
    noise = np.maximum(line_noise(H), 1e-9 * np.sqrt(np.mean(np.abs(H) ** 2, axis=1)))
    end, left = ringing(freq, H)
    faded = tapered(freq, H, end)
    quiet = noise if not np.isfinite(end) else np.maximum(line_noise(faded), 1e-9 * np.abs(H).max(axis=1))
    peaks = visible_peaks((faded / quiet[:, None]).T, rules)
    return Responses(freq, (H / noise[:, None]).T, noise, along, peaks, end, left)


def visible_peaks(Y: Array, rules: Thresholds = USUAL) -> Peaks:
    """Peaks of sum |Y|^2 over the channels that a person would see: above their surroundings and above the noise.

    Y (lines, channels) are responses over the noise of their channels.

    Examples
    --------
    >>> f = np.arange(100.0, 200.0, 0.05)
    >>> Y = sum(1e3 / (1j * (f - at) + 0.1) for at in (120.0, 121.0, 150.0))[:, None]
    >>> noise = np.random.default_rng(1).normal(size=(2, 2000, 1))
    >>> f[visible_peaks(Y + noise[0] + 1j * noise[1]).at].round(1).tolist()
    [120.0, 121.0, 150.0]
    """
    from scipy.signal import find_peaks, peak_widths  # loads scipy.interpolate, which most commands do not need

    power = np.sum(np.abs(Y) ** 2, axis=1) + 1e-300
    least = 2.0 * Y.shape[1] * np.maximum(noise_along(Y), 1e-9) ** 2
    level = 10.0 * np.log10(power)
    at, _ = find_peaks(level, prominence=rules.prominence_db, height=10.0 * np.log10(least) + rules.above_noise_db)
    return Peaks(at=at, width=peak_widths(power, at)[0] if len(at) else np.zeros(0))


def ringing(freq: FloatArray, H: Array) -> tuple[float, float]:
    """Duration of the recorded ringing after the hit [s], and the share of the ringing left at its end.

    A record of length T that starts d before the hit ends T - d after it. Where the ringing has not decayed, the
    impulse response of H (channels, lines) ends there with a step, and is empty in the last d seconds. (inf, 0) where
    there is no such step.

    Examples
    --------
    >>> f, D = np.arange(50.0, 150.0), 0.9
    >>> q = 3.0 + 2j * np.pi * (f - 100.3)
    >>> end, left = ringing(f, ((1.0 - np.exp(-q * D)) / q)[None])
    >>> round(end, 1), 0.04 < left < 0.1  # exp(-3 D) = 0.07, of the mean over the first lines
    (0.9, True)
    """
    lines = len(freq)
    step = float(freq[1] - freq[0])
    shape = np.hanning(lines + 2)[1:-1]
    impulse = np.fft.ifft(H * shape, axis=1)
    energy = np.sum(np.abs(impulse) ** 2 / np.sum(np.abs(impulse) ** 2, axis=1, keepdims=True), axis=0)
    near = max(3, lines // 60)
    total = np.cumsum(np.r_[0.0, energy, energy[: 2 * near]])
    before = (total[near:lines] - total[: lines - near]) / near  # energy[k - near : k], k = near ... lines - 1
    after = (total[2 * near : lines + near] - total[near:lines]) / near
    skirt = 4  # times at both ends that belong to the hit: the main lobe of the taper
    inside = np.arange(near, lines) < lines - skirt - near // 2
    inside &= np.arange(near, lines) > lines // 4
    drop = np.where(inside, before / (np.maximum(after, 1e-14 * energy.max()) + 1e-300), 0.0)
    k = int(np.argmax(drop))
    if drop[k] < 10.0:
        return float("inf"), 0.0
    start = float(np.mean(energy[2 : 2 + near]))
    left = float(np.sqrt(before[k] / max(start, 1e-300)))
    return (k + near) / (lines * step), min(left, 1.0)


def tapered(freq: FloatArray, H: Array, end: float) -> Array:
    """Responses whose ringing is faded out towards `end` [s], which removes the ripples of a cut-off record."""
    if not np.isfinite(end):
        return H
    lines = len(freq)
    t = np.arange(lines) / (lines * float(freq[1] - freq[0]))
    fade = np.where(t < end, np.cos(0.5 * np.pi * t / end) ** 2, 0.0)
    return np.asarray(np.fft.fft(np.fft.ifft(H, axis=1) * fade, axis=1))
