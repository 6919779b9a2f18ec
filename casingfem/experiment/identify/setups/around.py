"""Which mode of one set-up goes on as which mode of the others, by their shapes round a circle.

A mode of n nodal diameters is a cos(n theta) + b sin(n theta) at all sensors, whichever set-up they were measured in.
Two modes that are exchanged in one set-up have the frequencies, damping and sizes of the other there, perhaps no less
likely; but their shapes then are no waves. Channels that belong elsewhere (dead, turned over, exchanged) are told by
all modes together and weigh little.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from casingfem.experiment.circle.orientation import harmonic
from casingfem.io.arrays import Array, FloatArray, IntArray

LEAST = 5, 6  # modes, and channels, from which on shapes tell
PURE = 0.03  # of a mode's rms, that a channel is off a wave at least
SWEEPS = 4  # of finding what channels are off


class Places(NamedTuple):
    """Where channels stand: angles [rad] and signs, (channels,), the reference of each, the n that may be told."""

    theta: FloatArray
    sign: FloatArray
    reference: IntArray
    orders: tuple[int, ...]

    def waves(self, n: int) -> FloatArray:
        """Columns cos n theta, sin n theta for each reference, (channels, columns)."""
        own = self.sign[:, None] * harmonic(self.theta, n)
        parts = [np.where((self.reference == r)[:, None], own, 0.0) for r in np.unique(self.reference)]
        return np.concatenate(parts, axis=1)


class Around(NamedTuple):
    """Orthonormal waves of each n, (channels, columns), of residues that are multiplied by `scale` (channels,).

    `telling` is the number of channels beyond those that a wave needs, each by what it weighs.
    """

    waves: list[FloatArray]
    scale: FloatArray
    telling: float

    @classmethod
    def of(cls, places: Places, residues: Array, weight: FloatArray) -> Around | None:
        """From residues (modes, channels) of all modes; None where they are too few to tell anything.

        `weight` (channels,) is that of data whose residues are to be judged.
        """
        if len(residues) < LEAST[0] or residues.shape[1] < LEAST[1] or not places.orders:
            return None
        shapes = residues / np.sqrt(np.mean(np.abs(residues) ** 2, axis=1, keepdims=True))
        off = np.ones(shapes.shape[1])
        for _ in range(SWEEPS):
            waves = [np.linalg.qr(places.waves(n) / off[:, None])[0] for n in places.orders]
            off = np.hypot(np.median(np.abs(_left(shapes / off, waves)) * off, axis=0), PURE)
        waves = [np.linalg.qr(places.waves(n) / off[:, None])[0] for n in places.orders]
        telling = max(float(np.sum((off.min() / off) ** 2)) - waves[0].shape[1], 0.0)
        return cls(waves, 1.0 / off / weight, telling)

    def mismatch(self, residues: Array, channels: IntArray) -> FloatArray:
        """-2 ln of the likelihood that the modes (columns) of some channels are those of the others (rows).

        What is left beside the best wave has a variance that is not known: modes are more or less pure. Of each column
        its least is taken off.
        """
        scaled = residues * self.scale
        here = np.zeros(len(self.scale), bool)
        here[channels] = True
        own, others = np.where(here, scaled, 0.0), np.where(here, 0.0, scaled)
        whole = np.sum(np.abs(others) ** 2, axis=1)[:, None] + np.sum(np.abs(own) ** 2, axis=1)
        left = np.full(whole.shape, np.inf)
        for Q in self.waves:
            parts = (others @ Q)[:, None] + (own @ Q)[None]
            left = np.minimum(left, whole - np.sum(np.abs(parts) ** 2, axis=2))
        cost = 2.0 * self.telling * np.log(left + PURE**2 * whole + 1e-300)
        return np.asarray(cost - cost.min(axis=0))


def _left(scaled: Array, waves: list[FloatArray]) -> Array:
    """What shapes (modes, channels) leave beside the best wave."""
    rest = np.array([scaled - (scaled @ Q) @ Q.T for Q in waves])
    best = np.sum(np.abs(rest) ** 2, axis=2).argmin(axis=0)
    return np.asarray(rest[best, np.arange(len(scaled))])
