"""What modes of several set-ups are as waves round a circle: columns, what channels are off, kinds and sizes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from casingfem.experiment.identify.setups.clusters import Cluster
from casingfem.experiment.identify.setups.inner_products import Problem
from casingfem.io.arrays import BoolArray, FloatArray, IntArray

SURE = 0.03  # of a mode's size, that a channel is off a wave at least
WIDE = 3.0  # times the size of a mode, that the parts of its wave, or residues without a wave, may well be


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
