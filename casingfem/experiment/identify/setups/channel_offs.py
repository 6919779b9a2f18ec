"""What each channel is off the waves that most modes are round a circle."""

from __future__ import annotations

import numpy as np

from casingfem.experiment.identify.setups.around import Places
from casingfem.experiment.identify.setups.suspects import most_say
from casingfem.experiment.identify.setups.wave_model import SURE, WIDE, Waves
from casingfem.io.arrays import Array, BoolArray, FloatArray

LEAST = 5, 6  # modes, and channels beyond those that a wave needs, from which on shapes tell
BELONGS = 0.3  # of it, below which a channel belongs where it is said to stand
SWEEPS = 8
SIGMA = 1.4826  # standard deviation over the median of absolute deviations
SPREAD = 1.3  # times that: a channel's phase counts where the mode is large, a median does not see it


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
        scaled, waves = shapes / off, [np.linalg.qr(each / off[:, None])[0] for each in columns]
        rest = np.array([scaled - (scaled @ Q) @ Q.T for Q in waves])
        best = np.sum(rest**2, axis=2).argmin(axis=0)
        off = np.hypot(_size(rest[best, np.arange(len(shapes))] * off), SURE)
    return off


def _size(deviations: FloatArray) -> FloatArray:
    """Standard deviation of each channel over the modes (modes, channels), by medians."""
    return np.asarray(SIGMA * np.median(np.abs(deviations), axis=0))
