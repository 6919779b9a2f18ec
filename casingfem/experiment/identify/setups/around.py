"""What shapes round a circle tell: which mode of a set-up goes on as which of the others, and which channels are off.

A mode of n nodal diameters is a cos(n theta) + b sin(n theta) at all sensors, whichever set-up they were measured in.
Two modes that are exchanged in one set-up have the frequencies, damping and sizes of the other there, perhaps no less
likely; but their shapes then are no waves. Channels that belong elsewhere (dead, turned over, exchanged) are told by
all modes together and weigh little. Where one channel is off in one mode its shape is impure; where it is off in the
same way in all modes, it is the channel: turned over, exchanged, of another scale.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from typing import NamedTuple

import numpy as np

from casingfem.experiment.circle.orientation import harmonic
from casingfem.io.arrays import Array, BoolArray, FloatArray, IntArray

LEAST = 5, 6  # modes, and channels, from which on shapes tell
PURE = 0.03  # of a mode's rms, that a channel is off a wave at least
SWEEPS = 4  # of finding what channels are off
FEWEST = 8, 5  # sensors, and modes, from which on something is said
OPPOSES, SILENT = -0.6, 0.4  # correlation over the modes with what the others say, below which a sensor is named
OTHERS, AS_OTHER, GAIN = 0.9, 0.6, 0.1  # of exchanged ones: at most with their own places; with the other's, how much
SCALE = 2.0  # times what the others say, or a part of it, beyond which a sensor is named
USUAL = 1.2  # times the median misfit of a mode, beyond which it tells nothing
STEPS, SMALL = 25, 1e-3  # of the fit by least absolute deviations; deviation, of the usual size, that counts as none


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
            off = np.hypot(np.median(np.abs(left_of(shapes / off, waves)) * off, axis=0), PURE)
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


def left_of(scaled: Array, waves: list[FloatArray]) -> Array:
    """What shapes (modes, channels) leave beside the best wave."""
    rest = np.array([scaled - (scaled @ Q) @ Q.T for Q in waves])
    best = np.sum(np.abs(rest) ** 2, axis=2).argmin(axis=0)
    return np.asarray(rest[best, np.arange(len(scaled))])


def suspected(
    shapes: FloatArray, most: int, theta: FloatArray, points: IntArray, trusted: BoolArray | None = None
) -> tuple[str, ...]:
    """What is said of sensors at angles theta [rad] whose shapes (sensors, modes) of n up to `most` are off, in words.

    Where it is known by other means which sensors are right, `trusted` (sensors,), they alone say what each should do.

    >>> theta, n = np.arange(12) * np.pi / 6, np.array([2, 2, 3, 3, 4, 4, 1, 1])
    >>> shapes = np.cos(n * theta[:, None] - 0.7 * np.arange(8))
    >>> shapes[4] *= -1.0
    >>> shapes[[7, 9]] = shapes[[9, 7]]
    >>> for line in suspected(shapes, 5, theta, np.arange(12) + 1):
    ...     print(line)
    points 8 and 10 look exchanged: in 6 modes each moves as the other should
    point 5 looks turned over: in 6 modes it moves against what the others say
    """
    return tuple(text for _, text in _suspects(shapes, most, theta, points, trusted))


def suspect_sensors(
    shapes: FloatArray, most: int, theta: FloatArray, points: IntArray, trusted: BoolArray | None = None
) -> IntArray:
    """Indices of the sensors of which `suspected` says something, ascending."""
    named = {sensor for sensors, _ in _suspects(shapes, most, theta, points, trusted) for sensor in sensors}
    return np.array(sorted(named), np.int64)


def _suspects(
    shapes: FloatArray, most: int, theta: FloatArray, points: IntArray, trusted: BoolArray | None
) -> tuple[tuple[tuple[int, ...], str], ...]:
    if len(theta) < FEWEST[0] or shapes.shape[1] < FEWEST[1]:
        return ()
    said, misfit = most_say(shapes, most, theta, trusted)
    clear = misfit <= USUAL * np.median(misfit)
    shapes, said = shapes[:, clear], said[:, clear]
    along = shapes @ said.T / (np.outer(np.linalg.norm(shapes, axis=1), np.linalg.norm(said, axis=1)) + 1e-300)
    if np.median(np.diag(along)) < OTHERS:
        return ()  # no majority that agrees: angles or labels are wrong as a whole
    size = np.sum(shapes * said, axis=1) / (np.sum(said**2, axis=1) + 1e-300)
    return tuple(_words(along, size, points, shapes.shape[1]))


def most_say(
    shapes: FloatArray, most: int, theta: FloatArray, trusted: BoolArray | None = None
) -> tuple[FloatArray, FloatArray]:
    """What most sensors, or those that are `trusted`, say of each, (sensors, modes), and the misfit of each mode.

    By least absolute deviations. A mode has the n, 0 to `most`, of least misfit: its label may have suffered from what
    is looked for.
    """
    heard = np.ones(len(theta)) if trusted is None else trusted.astype(float)
    best, said = np.full(shapes.shape[1], np.inf), np.zeros_like(shapes)
    small = SMALL * np.sqrt(len(theta)) * np.median(np.abs(shapes), axis=0) + 1e-12  # not of the norm: one may be huge
    for order in range(most + 1):
        waves = np.column_stack([np.cos(order * theta), np.sin(order * theta)])
        weight = np.repeat(heard[:, None], shapes.shape[1], axis=1)
        for _ in range(STEPS):
            gram = np.einsum("si,sm,sj->mij", waves, weight, waves) + 1e-9 * np.eye(2)
            right = np.einsum("si,sm,sm->mi", waves, weight, shapes)
            fitted = waves @ np.linalg.solve(gram, right[:, :, None])[:, :, 0].T
            weight = heard[:, None] / np.maximum(np.abs(shapes - fitted), small)
        misfit = heard @ np.abs(shapes - fitted) / (heard @ np.abs(shapes))
        said = np.where(misfit < best, fitted, said)
        best = np.minimum(misfit, best)
    return said, best


def _words(along: FloatArray, size: FloatArray, points: IntArray, modes: int) -> Iterator[tuple[tuple[int, ...], str]]:
    """What is said of sensors by their correlation (rows) with what is said of each place (columns), and their size."""
    own, named = np.diag(along), set[int]()
    for a, b in combinations(range(len(own)), 2):
        better = min(along[a, b] - own[a], along[b, a] - own[b])
        as_other = min(along[a, b], along[b, a]) > AS_OTHER and max(own[a], own[b]) < OTHERS
        if better > GAIN and as_other and not named & {a, b}:
            named |= {a, b}
            text = f"points {points[a]} and {points[b]} look exchanged: in {modes} modes each moves as the other should"
            yield (a, b), text
    for sensor in (sensor for sensor in range(len(own)) if sensor not in named):
        if own[sensor] < OPPOSES:
            text = f"point {points[sensor]} looks turned over: in {modes} modes it moves against what the others say"
            yield (sensor,), text
        elif own[sensor] < SILENT:
            what = f"does not move as the others say, in {modes} modes: dead, loose, or not at its angle?"
            yield (sensor,), f"point {points[sensor]} {what}"
        elif not 1.0 / SCALE < size[sensor] < SCALE:
            what = f"{float(f'{size[sensor]:.2g}'):g} times as much as the others say, in {modes} modes"
            yield (sensor,), f"point {points[sensor]} moves {what}: its sensitivity or unit?"
