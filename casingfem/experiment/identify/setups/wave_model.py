"""What modes of several set-ups are as waves round a circle: columns, what channels are off most of them, kinds."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from casingfem.experiment.identify.setups.around import Places, left_of, most_say
from casingfem.experiment.identify.setups.clusters import Cluster
from casingfem.experiment.identify.setups.inner_products import Problem
from casingfem.io.arrays import Array, BoolArray, FloatArray, IntArray

SURE = 0.03  # of a mode's size, that a channel is off a wave at least
WIDE = 3.0  # times the size of a mode, that the parts of its wave, or residues without a wave, may well be
LEAST = 5, 6  # modes, and channels beyond those that a wave needs, from which on shapes tell
BELONGS = 0.3  # of it, below which a channel belongs where it is said to stand
SWEEPS = 8
SIGMA = 1.4826  # standard deviation over the median of absolute deviations
SPREAD = 1.3  # times that: a channel's phase counts where the mode is large, a median does not see it


class Waves(NamedTuple):
    """Columns (kinds, channels, columns) of each n, zeros for kinds that are no wave; what channels are off.

    `off` and `lag` (kinds, channels) are the standard deviations of real and imaginary parts over the mode's size.
    """

    columns: FloatArray
    off: FloatArray
    lag: FloatArray

    @property
    def is_wave(self) -> BoolArray:
        """Which kinds are waves, (kinds,)."""
        return np.asarray(self.columns.any(axis=(1, 2)))

    @property
    def spread(self) -> IntArray:
        """A number of each kind, the same for those that channels are off by the same, (kinds,)."""
        numbers = dict[bytes, int]()
        return np.array([numbers.setdefault(row.tobytes(), len(numbers)) for row in np.hstack([self.off, self.lag])])

    def seen_by(self, channels: IntArray) -> Waves:
        """With one more kind, the last: a local mode that so many channels see, the others next to nothing of it."""
        spread = np.full(self.columns.shape[1], SURE)
        spread[channels] = WIDE
        columns = np.concatenate([self.columns, np.zeros((1, *self.columns.shape[1:]))])
        return Waves(columns, np.vstack([self.off, spread]), np.vstack([self.lag, spread]))


class WaveProblem(NamedTuple):
    """A cluster's data, the weight of each channel's residues, what is known of shapes, and the usual shift."""

    cluster: Cluster
    data: Problem
    weight: FloatArray
    waves: Waves
    shift: float

    def products(self, p: FloatArray, q: FloatArray) -> Products:
        """At ln f (modes, setups), ln zeta (modes,)."""
        return Products(p, *self.data.products(p, np.repeat(q[:, None], p.shape[1], axis=1)))

    @property
    def order(self) -> IntArray:
        """The channels, set-up by set-up."""
        return np.concatenate(self.data.setups)

    @property
    def counts(self) -> IntArray:
        """How many channels each set-up has."""
        return np.array([len(channels) for channels in self.data.setups])


class Products(NamedTuple):
    """Inner products of resonances and slopes with each other and with the data, at ln f (modes, setups)."""

    p: FloatArray
    own: FloatArray
    by_data: FloatArray


class Shapes(NamedTuple):
    """The kind of wave that each mode is, and its size, both (modes,)."""

    kind: IntArray
    size: FloatArray


def waves_of(places: Places, residues: Array) -> Waves | None:
    """From residues (modes, channels) of all modes; None where they are too few to tell anything."""
    orders = [n for n in places.orders if n]
    if not orders or len(residues) < LEAST[0]:
        return None
    columns = np.array([places.waves(n) for n in orders])
    if residues.shape[1] < LEAST[1] + columns.shape[2]:
        return None
    shapes = residues / np.sqrt(np.mean(np.abs(residues) ** 2, axis=1, keepdims=True))
    said, misfit = most_say((shapes.real * places.sign).T, max(orders), places.theta)
    clear = misfit <= np.median(misfit)
    first = _size((shapes.real * places.sign).T[:, clear].T - said[:, clear].T)
    starts = np.ones(len(first)), np.hypot(first, SURE)
    off = min((_settled(shapes.real, columns, start) for start in starts), key=lambda each: float(np.log(each).sum()))
    lag, belongs = np.hypot(_size(shapes.imag), SURE), off < BELONGS
    if belongs.sum() < LEAST[1]:
        return None
    off, lag = (SPREAD * np.maximum(each, np.median(each[belongs])) for each in (off, lag))
    nothing = np.zeros((1, *columns.shape[1:]))
    free = np.full(len(off), WIDE)
    return Waves(
        np.concatenate([columns, nothing]),
        np.array([off] * len(orders) + [free]),
        np.array([lag] * len(orders) + [free]),
    )


def belonging(waves: Waves) -> BoolArray:
    """Which channels move as they should where they are said to stand, (channels,)."""
    return np.asarray(waves.off[0] < SPREAD * BELONGS)


def _settled(shapes: FloatArray, columns: FloatArray, off: FloatArray) -> FloatArray:
    """What channels are off the best wave of each shape (modes, channels), which weighs them by that."""
    for _ in range(SWEEPS):
        waves = [np.linalg.qr(each / off[:, None])[0] for each in columns]
        off = np.hypot(_size(left_of(shapes / off, waves) * off), SURE)
    return off


def _size(deviations: FloatArray) -> FloatArray:
    """Standard deviation of each channel over the modes (modes, channels), by medians."""
    return np.asarray(SIGMA * np.median(np.abs(deviations), axis=0))
