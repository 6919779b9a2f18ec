"""Label the modes of a test: nodal diameters and antinodes, and the sensors that are wrong and would spoil them.

A sensor of a circle is wrong in all modes if it is inverted, exchanged, of another scale, or dead.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from casingfem.experiment.circle.orientation import MOST, Circle
from casingfem.experiment.frf.sensor_grid import SensorGrid, radial_signs
from casingfem.experiment.identify.mode import Mode, Sensors
from casingfem.io.arrays import FloatArray, IntArray

MOST_OFF = 0.5  # largest share of the sensors that labels may omit
NEAREST = 0.01  # least relative difference of squared frequencies: imperfections mix nearer modes
FEWEST = 8, 5  # least number of sensors, and of modes, from which sensors are judged
OPPOSES, SILENT = -0.6, 0.4  # correlation over the modes with the other sensors, below which a sensor is named
OTHERS, AS_OTHER = 0.9, 0.6  # of two exchanged sensors: most correlation with their own place, least with the other's
GAIN = 0.1  # least gain of their exchange
SCALE = 2.0  # ratio to the other sensors, or its inverse, beyond which a sensor is named
CLEAR = 1.2  # a mode whose misfit exceeds this number of medians is not used
STEPS, SMALL = 25, 1e-3  # of the fit by least absolute deviations; relative deviation that counts as zero


def labelled(make: Callable[[Sensors], list[Mode]], sensors: Sensors) -> tuple[list[Mode], Sensors, tuple[str, ...]]:
    """Label the modes with the sensors that are not suspected; return both, and notes on the suspected sensors.

    A wrong sensor would spoil the labels. All sensors are used if too few would remain.
    """
    grid, circle, modes = sensors.grid, sensors.circle, make(sensors)
    shapes = _sure_shapes(modes, grid)
    if circle is None or not shapes.size:
        return modes, sensors, ()
    named = suspected(shapes, circle.n_max, grid.theta, grid.points)
    off, notes = sorted({at for some, _ in named for at in some}), tuple(text for _, text in named)
    if not off or len(off) > MOST_OFF * len(grid):
        return modes, sensors, notes
    kept = np.delete(np.arange(len(grid)), off)
    fewer = Sensors.of(grid, sensors.power, Circle(theta=grid.theta[kept], orders=circle.orders), kept)
    return make(fewer), fewer, notes


def oriented(modes: list[Mode], doublets: tuple[tuple[int, int], ...], sensors: Sensors) -> list[Mode]:
    """Add to the uncertainty of each antinode the part that noise and other waves cause.

    An imperfection combines two modes of frequencies f and f_j. It adds to one mode a part of the other in proportion
    to f f_j/|f^2 - f_j^2| (perturbation of symmetric matrices). So a wave that is the label of another mode may be
    larger than usual, by this number over its median. Two modes of the same label may each contain the wave of the
    other.
    """
    partner = {k: j for pair in doublets for k, j in (pair, pair[::-1])}
    freq, done = np.array([mode.freq for mode in modes]), list[Mode]()
    for k, mode in enumerate(modes):
        if not np.isfinite(mode.angle):
            done.append(mode)
            continue
        seen, circle = sensors.seeing(mode.residues)
        alike, sizes = circle.alike(mode.n), np.ones(MOST + 1)
        others = np.delete(np.arange(len(modes)), [k, partner.get(k, k)])
        gap = np.maximum(np.abs(1.0 - (freq[others] / mode.freq) ** 2), NEAREST)
        parts = freq[others] / mode.freq / gap
        for j, part in zip(others.tolist(), (parts / np.median(parts) if len(parts) else parts).tolist(), strict=True):
            waves = [modes[j].n] if modes[j].n != mode.n else alike
            sizes[waves] = np.maximum(sizes[waves], part if modes[j].n >= 0 else 1.0)
        signs = radial_signs(sensors.grid)[seen]
        moved = mode.moved[seen] * signs[:, None]
        angle, sigma = circle.orientation(
            mode.shape[seen] * signs, np.diag(mode.direct[seen]) + moved @ moved.T, mode.n, sizes
        )
        done.append(replace(mode, angle=angle, sigma_angle=sigma))
    return done


def circle_notes(modes: list[Mode], grid: SensorGrid, circle: Circle | None) -> tuple[str, ...]:
    """Notes on modes whose n the sensors do not resolve, or only just resolve."""
    if circle is None or not modes:
        return ()
    if not circle.orders:
        low, high = np.degrees([grid.theta.min(), grid.theta.max()]).tolist()
        where = f"{len(np.unique(grid.theta))} angles from {low:.4g} to {high:.4g} deg"
        return (f"no n is stated: the {len(grid)} sensors have {where}, too few or too close (angles in radians?)",)
    if not any(mode.n == circle.n_max for mode in modes):
        return ()
    return (
        f"n = {circle.n_max} is the largest that {len(grid)} sensors resolve, or that was asked for: modes with a"
        " larger n would appear with a smaller one",
    )


def _sure_shapes(modes: list[Mode], grid: SensorGrid) -> FloatArray:
    """Radial shapes of the modes that are sure, (sensors, modes)."""
    return np.array([mode.shape for mode in modes if not mode.reason]).T * radial_signs(grid)[:, None]


def suspected(
    shapes: FloatArray, most: int, theta: FloatArray, points: IntArray
) -> tuple[tuple[tuple[int, ...], str], ...]:
    """Sensors at angles theta [rad] that are wrong in shapes (sensors, modes) of n up to `most`: indices, and why.

    >>> theta, n = np.arange(12) * np.pi / 6, np.array([2, 2, 3, 3, 4, 4, 1, 1])
    >>> shapes = np.cos(n * theta[:, None] - 0.7 * np.arange(8))
    >>> shapes[4] *= -1.0
    >>> shapes[[7, 9]] = shapes[[9, 7]]
    >>> for sensors, why in suspected(shapes, 5, theta, np.arange(12) + 1):
    ...     print(sensors, why)
    (7, 9) points 8 and 10 seem exchanged: in 6 modes each moves as the other should
    (4,) point 5 seems to have the wrong sign: in 6 modes it moves against the prediction
    """
    if len(theta) < FEWEST[0] or shapes.shape[1] < FEWEST[1]:
        return ()
    expected, misfit = predicted(shapes, most, theta)
    clear = misfit <= CLEAR * np.median(misfit)
    shapes, expected = shapes[:, clear], expected[:, clear]
    sizes = np.outer(np.linalg.norm(shapes, axis=1), np.linalg.norm(expected, axis=1))
    along = shapes @ expected.T / (sizes + 1e-300)
    if np.median(np.diag(along)) < OTHERS:
        return ()  # no majority that agrees: angles or labels are wrong as a whole
    size = np.linalg.norm(shapes, axis=1) / (np.linalg.norm(expected, axis=1) + 1e-300)
    return tuple(_words(along, size, points, shapes.shape[1]))


def predicted(shapes: FloatArray, most: int, theta: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Shapes that most sensors predict (sensors, modes), and the misfit of each mode.

    The fit minimises absolute deviations. A mode takes the n, from 0 to `most`, of least misfit, since wrong sensors
    may have spoilt its own label.
    """
    best, expected = np.full(shapes.shape[1], np.inf), np.zeros_like(shapes)
    small = SMALL * np.sqrt(len(theta)) * np.median(np.abs(shapes), axis=0) + 1e-12  # not of the norm: one may be huge
    for order in range(most + 1):
        waves = np.column_stack([np.cos(order * theta), np.sin(order * theta)])
        squares, weight = np.column_stack([waves**2, waves[:, 0] * waves[:, 1]]).T, np.ones_like(shapes)
        for _ in range(STEPS):
            cc, ss, cs = squares @ weight + [[1e-9], [1e-9], [0.0]]
            c, s = waves.T @ (weight * shapes)
            fitted = waves @ (np.array([ss * c - cs * s, cc * s - cs * c]) / (cc * ss - cs**2))
            weight = 1.0 / np.maximum(np.abs(shapes - fitted), small)
        misfit = np.sum(np.abs(shapes - fitted), axis=0) / np.sum(np.abs(shapes), axis=0)
        expected = np.where(misfit < best, fitted, expected)
        best = np.minimum(misfit, best)
    return expected, best


def _words(along: FloatArray, size: FloatArray, points: IntArray, modes: int) -> Iterator[tuple[tuple[int, ...], str]]:
    """Describe sensors from the correlation of each (rows) with the predictions at places (columns), and from size."""
    own, named = np.diag(along), set[int]()
    better = np.minimum(along - own[:, None], along.T - own) > GAIN
    as_other = (np.minimum(along, along.T) > AS_OTHER) & (np.maximum.outer(own, own) < OTHERS)
    for a, b in np.argwhere(np.triu(better & as_other, 1)).tolist():
        if not named & {a, b}:
            named |= {a, b}
            text = f"points {points[a]} and {points[b]} seem exchanged: in {modes} modes each moves as the other should"
            yield (a, b), text
    for sensor in (sensor for sensor in range(len(own)) if sensor not in named):
        noise = size[sensor] < 1.0 / SCALE and abs(own[sensor]) < OTHERS  # by chance for or against the prediction
        if own[sensor] < OPPOSES and not noise:
            what = f"seems to have the wrong sign: in {modes} modes it moves against the prediction"
            text = f"point {points[sensor]} {what}"
            yield (sensor,), text
        elif own[sensor] < SILENT or noise:
            what = f"does not move as the others predict, in {modes} modes: no signal, loose, or at another angle?"
            yield (sensor,), f"point {points[sensor]} {what}"
        elif not 1.0 / SCALE < size[sensor] < SCALE:
            what = f"{float(f'{size[sensor]:.2g}'):g} times as much as the others predict, in {modes} modes"
            yield (sensor,), f"point {points[sensor]} moves {what}: wrong sensitivity or unit?"
