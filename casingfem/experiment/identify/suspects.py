"""Find sensors of a circle that are wrong in all modes: inverted, exchanged, of another scale, dead."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from casingfem.io.arrays import BoolArray, FloatArray, IntArray

FEWEST = 8, 5  # least number of sensors, and of modes, from which sensors are judged
OPPOSES, SILENT = -0.6, 0.4  # correlation over the modes with the other sensors, below which a sensor is named
OTHERS, AS_OTHER, GAIN = (
    0.9,
    0.6,
    0.1,
)  # of two exchanged sensors: most correlation with their own place, least with the other's, least gain
SCALE = 2.0  # ratio to the other sensors, or its inverse, beyond which a sensor is named
USUAL = 1.2  # a mode with a misfit above so many medians is not used
STEPS, SMALL = 25, 1e-3  # of the fit by least absolute deviations; relative deviation that counts as zero


def suspected(
    shapes: FloatArray, most: int, theta: FloatArray, points: IntArray, trusted: BoolArray | None = None
) -> tuple[str, ...]:
    """Describe sensors at angles theta [rad] that are wrong in shapes (sensors, modes) of n up to `most`.

    `trusted` (sensors,) marks sensors known to be right. If it is given, they alone predict the others.

    >>> theta, n = np.arange(12) * np.pi / 6, np.array([2, 2, 3, 3, 4, 4, 1, 1])
    >>> shapes = np.cos(n * theta[:, None] - 0.7 * np.arange(8))
    >>> shapes[4] *= -1.0
    >>> shapes[[7, 9]] = shapes[[9, 7]]
    >>> for line in suspected(shapes, 5, theta, np.arange(12) + 1):
    ...     print(line)
    points 8 and 10 seem exchanged: in 6 modes each moves as the other should
    point 5 seems to have the wrong sign: in 6 modes it moves against the prediction
    """
    return tuple(text for _, text in _suspects(shapes, most, theta, points, trusted))


def suspect_sensors(
    shapes: FloatArray, most: int, theta: FloatArray, points: IntArray, trusted: BoolArray | None = None
) -> IntArray:
    """Indices of the sensors that `suspected` names, ascending."""
    named = {sensor for sensors, _ in _suspects(shapes, most, theta, points, trusted) for sensor in sensors}
    return np.array(sorted(named), np.int64)


def _suspects(
    shapes: FloatArray, most: int, theta: FloatArray, points: IntArray, trusted: BoolArray | None
) -> tuple[tuple[tuple[int, ...], str], ...]:
    if len(theta) < FEWEST[0] or shapes.shape[1] < FEWEST[1]:
        return ()
    expected, misfit = predicted(shapes, most, theta, trusted)
    clear = misfit <= USUAL * np.median(misfit)
    shapes, expected = shapes[:, clear], expected[:, clear]
    sizes = np.outer(np.linalg.norm(shapes, axis=1), np.linalg.norm(expected, axis=1))
    along = shapes @ expected.T / (sizes + 1e-300)
    if np.median(np.diag(along)) < OTHERS:
        return ()  # no majority that agrees: angles or labels are wrong as a whole
    size = np.sum(shapes * expected, axis=1) / (np.sum(expected**2, axis=1) + 1e-300)
    return tuple(_words(along, size, points, shapes.shape[1]))


def predicted(
    shapes: FloatArray, most: int, theta: FloatArray, trusted: BoolArray | None = None
) -> tuple[FloatArray, FloatArray]:
    """Shapes that most sensors, or the `trusted` ones, predict (sensors, modes), and the misfit of each mode.

    The fit minimises absolute deviations. A mode takes the n, from 0 to `most`, of least misfit, since wrong sensors
    may have spoilt its own label.
    """
    used = np.ones(len(theta)) if trusted is None else trusted.astype(float)
    best, expected = np.full(shapes.shape[1], np.inf), np.zeros_like(shapes)
    small = SMALL * np.sqrt(len(theta)) * np.median(np.abs(shapes), axis=0) + 1e-12  # not of the norm: one may be huge
    for order in range(most + 1):
        waves = np.column_stack([np.cos(order * theta), np.sin(order * theta)])
        weight = np.repeat(used[:, None], shapes.shape[1], axis=1)
        for _ in range(STEPS):
            gram = np.einsum("si,sm,sj->mij", waves, weight, waves) + 1e-9 * np.eye(2)
            right = np.einsum("si,sm,sm->mi", waves, weight, shapes)
            fitted = waves @ np.linalg.solve(gram, right[:, :, None])[:, :, 0].T
            weight = used[:, None] / np.maximum(np.abs(shapes - fitted), small)
        misfit = used @ np.abs(shapes - fitted) / (used @ np.abs(shapes))
        expected = np.where(misfit < best, fitted, expected)
        best = np.minimum(misfit, best)
    return expected, best


def _words(along: FloatArray, size: FloatArray, points: IntArray, modes: int) -> Iterator[tuple[tuple[int, ...], str]]:
    """Describe sensors from the correlation of each (rows) with the predictions at places (columns), and from size."""
    own, named = np.diag(along), set[int]()
    for a, b in combinations(range(len(own)), 2):
        better = min(along[a, b] - own[a], along[b, a] - own[b])
        as_other = min(along[a, b], along[b, a]) > AS_OTHER and max(own[a], own[b]) < OTHERS
        if better > GAIN and as_other and not named & {a, b}:
            named |= {a, b}
            text = f"points {points[a]} and {points[b]} seem exchanged: in {modes} modes each moves as the other should"
            yield (a, b), text
    for sensor in (sensor for sensor in range(len(own)) if sensor not in named):
        if own[sensor] < OPPOSES:
            what = f"seems to have the wrong sign: in {modes} modes it moves against the prediction"
            text = f"point {points[sensor]} {what}"
            yield (sensor,), text
        elif own[sensor] < SILENT:
            what = f"does not move as the others predict, in {modes} modes: dead, loose, or not at its angle?"
            yield (sensor,), f"point {points[sensor]} {what}"
        elif not 1.0 / SCALE < size[sensor] < SCALE:
            what = f"{float(f'{size[sensor]:.2g}'):g} times as much as the others predict, in {modes} modes"
            yield (sensor,), f"point {points[sensor]} moves {what}: its sensitivity or unit?"
