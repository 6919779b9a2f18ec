"""Excitation of a structure: random, burst random, impact, stepped sine, each with `force(time, rng)`.

Forces have no content above their band, so that their samples define them completely.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from casingfem.errors import InputError
from casingfem.io.arrays import FloatArray

RAMP = 0.05  # part of a burst, or of a dwell's step, in which it rises and falls


class Excitation(Protocol):
    """Interface of a force for a simulated record."""

    @property
    def highest(self) -> float:
        """Frequency [Hz] above which the force is negligible."""

    def force(self, time: FloatArray, block: float, rng: np.random.Generator) -> FloatArray:
        """Force [N] at evenly spaced times [s], (samples,); a periodic force has the period `block` seconds."""


def require(name: str, value: float, least: float = 0.0) -> None:
    """Refuse a value that is not a finite number above `least`."""
    if not (np.isfinite(value) and value > least):
        raise InputError(f"{name}: found {value!r}, expected a number above {least:g}")


def require_band(band: tuple[float, float]) -> None:
    """Refuse a band that does not ascend from 0 or more."""
    if not 0.0 <= band[0] < band[1] < np.inf:
        raise InputError(f"band: found {band[0]!r} to {band[1]!r} Hz, expected from lower to higher")


def band_noise(count: int, step: float, band: tuple[float, float], rng: np.random.Generator) -> FloatArray:
    """Gaussian noise of rms 1 inside a band [Hz] and 0 outside: independent lines of a Fourier series."""
    freq = np.fft.rfftfreq(count, step)
    lines = (freq >= band[0]) & (freq <= band[1]) & (freq > 0.0)
    if not lines.any():
        raise InputError(f"band: found no line of a record of {count * step:g} s in {band[0]:g} to {band[1]:g} Hz")
    spectrum = np.zeros(len(freq), complex)
    parts = rng.standard_normal((2, int(lines.sum())))
    spectrum[lines] = parts[0] + 1j * parts[1]
    values = np.fft.irfft(spectrum, count)
    return np.asarray(values / np.sqrt(np.mean(values**2)))


def bump(phase: FloatArray) -> FloatArray:
    """Smooth window: 1 for phases between 0 and 1, with cosine ramps of `RAMP` at both ends, 0 outside."""
    rise = np.clip(np.minimum(phase, 1.0 - phase) / RAMP, 0.0, 1.0)
    return np.asarray(0.5 - 0.5 * np.cos(np.pi * rise))


@dataclass(frozen=True, slots=True, kw_only=True)
class Random:
    """Stationary Gaussian force of `rms` [N] in `band` [Hz].

    >>> Random(rms=1.0, band=(200.0, 900.0)).highest
    900.0
    """

    rms: float
    band: tuple[float, float]

    def __post_init__(self) -> None:
        require("rms", self.rms)
        require_band(self.band)

    @property
    def highest(self) -> float:
        """Upper end of the band."""
        return self.band[1]

    def force(self, time: FloatArray, block: float, rng: np.random.Generator) -> FloatArray:
        """Noise without repetition."""
        return self.rms * band_noise(len(time), float(time[1] - time[0]), self.band, rng)


@dataclass(frozen=True, slots=True, kw_only=True)
class BurstRandom(Random):
    """Random force during the first `part` of every block, then zero.

    No leakage if the response decays within the block.

    The ramps of its bursts smear the upper end of the band by a few Hz.

    >>> BurstRandom(rms=1.0, band=(200.0, 900.0), part=0.5).part
    0.5
    """

    part: float = 0.5

    def __post_init__(self) -> None:
        Random.__post_init__(self)
        if not 0.0 < self.part < 1.0:
            raise InputError(f"part: found {self.part!r}, expected a part of the block between 0 and 1")

    def force(self, time: FloatArray, block: float, rng: np.random.Generator) -> FloatArray:
        """Noise in bursts."""
        return Random.force(self, time, block, rng) * bump(np.mod(time / block, 1.0) / self.part)


@dataclass(frozen=True, slots=True, kw_only=True)
class Impact:
    """A hammer: one pulse F = peak (1 - cos(2 pi t/width))/2 in every block, `delay` [s] after its start.

    Its spectrum has its first zero at 2/width and is at least 31 dB down beyond it.

    >>> Impact(peak=50.0, width=1e-3).highest
    2000.0
    """

    peak: float
    width: float
    delay: float = 0.01

    def __post_init__(self) -> None:
        require("peak", self.peak)
        require("width", self.width)
        require("delay", self.delay, -1e-300)

    @property
    def highest(self) -> float:
        """First zero of the spectrum, 2/width."""
        return 2.0 / self.width

    def force(self, time: FloatArray, block: float, rng: np.random.Generator) -> FloatArray:
        """The pulses, which are not random."""
        phase = (np.mod(time, block) - self.delay) / self.width
        inside = (phase > 0.0) & (phase < 1.0)
        return np.asarray(np.where(inside, 0.5 * self.peak * (1.0 - np.cos(2.0 * np.pi * phase)), 0.0))


@dataclass(frozen=True, slots=True, kw_only=True)
class StepSine:
    """A sine of `amplitude` [N] whose frequency steps through `freq` [Hz], one for each block, with continuous phase.

    With a single frequency it is a dwell.

    >>> StepSine(amplitude=2.0, freq=(371.0, 371.5)).highest
    371.5
    """

    amplitude: float
    freq: tuple[float, ...]

    def __post_init__(self) -> None:
        require("amplitude", self.amplitude)
        if not self.freq or min(self.freq) <= 0.0:
            raise InputError(f"freq: found {self.freq!r}, expected frequencies above 0 Hz")

    @property
    def highest(self) -> float:
        """The highest frequency."""
        return max(self.freq)

    def force(self, time: FloatArray, block: float, rng: np.random.Generator) -> FloatArray:
        """The sine, with a smooth rise at the start."""
        index = np.minimum((time / block + 1e-9).astype(np.int64), len(self.freq) - 1)
        step = float(time[1] - time[0])
        phase = 2.0 * np.pi * step * np.r_[0.0, np.cumsum(np.asarray(self.freq)[index])[:-1]]
        return np.asarray(self.amplitude * np.sin(phase) * bump(np.minimum(time / block, 0.5)))
