"""What the measuring chain adds: noise of a stated ratio, and the steps of a converter. All seeded."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from casingfem.errors import InputError
from casingfem.experiment.frf.frf_set import FrfSet
from casingfem.io.arrays import Array, FloatArray

BITS = (4, 32)


def noise(values: Array, snr_db: float, rng: np.random.Generator) -> Array:
    """Gaussian noise for each row: its rms is 10^(-snr_db/20) of the row's, complex where the values are.

    >>> values = np.ones((1, 4000))
    >>> float(np.sqrt(np.mean(noise(values, 20.0, np.random.default_rng(7)) ** 2)).round(2))
    0.1
    """
    if not np.isfinite(snr_db):
        raise InputError(f"snr_db: found {snr_db!r}, expected the ratio of signal to noise in dB")
    rms = np.sqrt(np.mean(np.abs(values) ** 2, axis=-1, keepdims=True)) * 10.0 ** (-snr_db / 20.0)
    if not np.iscomplexobj(values):
        return np.asarray(rms * rng.standard_normal(values.shape))
    parts = rng.standard_normal((2, *values.shape))
    return np.asarray(rms * (parts[0] + 1j * parts[1]) / np.sqrt(2.0))


def noisy(frfs: FrfSet, snr_db: float, *, seed: int) -> FrfSet:
    """The set with noise on every channel, `snr_db` below the channel's rms over its lines; the card says so.

    >>> from casingfem.experiment.rig.rig import Rig
    >>> rig = Rig.of(omega=[600.0], zeta=[0.01], rows=[[1.0]])
    >>> noisy(rig.frfs([80.0, 95.0, 110.0], sensors=[0], drives=[0]), 40.0, seed=5).card[-1]
    'noise: 40 dB below the rms of each channel, seed 5'
    """
    added = frfs.responses + noise(frfs.responses, snr_db, np.random.default_rng(seed))
    note = f"noise: {snr_db:g} dB below the rms of each channel, seed {seed}"
    return replace(frfs, responses=added, card=(*frfs.card, note))


@dataclass(frozen=True, slots=True, kw_only=True)
class Converter:
    """An analogue-digital converter of `bits` over +-`full_scale`; rounding, and clipping at the ends.

    The error of a signal that is busy against a step is uniform, of variance LSB^2/12 (Widrow & Kollar,
    Quantization Noise, 2008, chapter 1).

    >>> Converter(bits=4, full_scale=8.0).convert(np.array([0.4, 0.6, 99.0])).tolist()
    [0.0, 1.0, 7.0]
    """

    bits: int
    full_scale: float

    def __post_init__(self) -> None:
        if not BITS[0] <= self.bits <= BITS[1]:
            raise InputError(f"bits: found {self.bits!r}, expected {BITS[0]} to {BITS[1]}")
        if not (np.isfinite(self.full_scale) and self.full_scale > 0.0):
            raise InputError(f"full_scale: found {self.full_scale!r}, expected the largest value the converter takes")

    @property
    def lsb(self) -> float:
        """The smallest step, 2 full_scale/2^bits."""
        return float(2.0 * self.full_scale / 2.0**self.bits)

    def convert(self, values: FloatArray) -> FloatArray:
        """The values as the converter gives them."""
        half = 2.0 ** (self.bits - 1)
        return np.asarray(np.clip(np.rint(values / self.lsb), -half, half - 1.0) * self.lsb)
