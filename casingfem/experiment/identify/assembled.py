"""Assemble the modes of a test: label them, note faults of sensors, list their columns."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from casingfem.experiment.circle.orientation import MOST, Circle
from casingfem.experiment.frf.sensor_grid import SensorGrid, radial_signs
from casingfem.experiment.identify.mode import Mode, Sensors
from casingfem.experiment.identify.suspects import suspect_sensors, suspected
from casingfem.io.arrays import FloatArray, IntArray

MOST_OFF = 0.5  # largest share of the sensors that labels may omit
NEAREST = 0.01  # least relative difference of squared frequencies: imperfections mix nearer modes


def labelled(make: Callable[[Sensors], list[Mode]], sensors: Sensors) -> tuple[list[Mode], Sensors]:
    """Label the modes with the sensors that are not suspected, and return both; a wrong sensor would spoil labels."""
    grid, circle, modes = sensors.grid, sensors.circle, make(sensors)
    kept = _belonging(modes, grid, circle)
    if circle is None or len(kept) == len(grid):
        return modes, sensors
    fewer = Sensors.of(grid, sensors.power, Circle(theta=grid.theta[kept], orders=circle.orders), kept)
    return make(fewer), fewer


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
        return (f"no n is given: the {len(grid)} sensors have {where}, too few or too near (angles in radians?)",)
    if not any(mode.n == circle.n_max for mode in modes):
        return ()
    return (
        f"n = {circle.n_max} is the largest that {len(grid)} sensors resolve, or that was asked for: modes of a larger"
        " n would be given a smaller one",
    )


def sensor_notes(modes: list[Mode], grid: SensorGrid, circle: Circle | None) -> tuple[str, ...]:
    """Find sensors of a circle whose values disagree with the sure modes."""
    shapes = _sure_shapes(modes, grid)
    return () if circle is None or not shapes.size else suspected(shapes, circle.n_max, grid.theta, grid.points)


def _sure_shapes(modes: list[Mode], grid: SensorGrid) -> FloatArray:
    """Radial shapes of the modes that are sure, (sensors, modes)."""
    return np.array([mode.shape for mode in modes if not mode.reason]).T * radial_signs(grid)[:, None]


def _belonging(modes: list[Mode], grid: SensorGrid, circle: Circle | None) -> IntArray:
    """Sensors that label the modes: those not suspected, or all sensors if too few remain."""
    every, shapes = np.arange(len(grid)), _sure_shapes(modes, grid)
    if circle is None or not shapes.size:
        return every
    off = suspect_sensors(shapes, circle.n_max, grid.theta, grid.points)
    return np.delete(every, off) if len(off) <= MOST_OFF * len(every) else every


def columns_of(modes: list[Mode], doublets: tuple[tuple[int, int], ...], grid: SensorGrid) -> dict[str, Any]:
    """Return the fields of `Identified` that have one entry for each mode."""

    def column(name: str) -> FloatArray:
        return np.array([getattr(mode, name) for mode in modes], float)

    count = len(grid), len(grid.references)
    names = ("freq", "sigma_freq", "zeta", "sigma_zeta", "purity", "collinearity", "signal", "residue_scale")
    members = {k for pair in doublets for k in pair}
    bound = np.array([np.nan if k in members or mode.n == 0 else mode.split_bound for k, mode in enumerate(modes)])
    return {
        **{name: column(name) for name in names},
        "n": np.array([mode.n for mode in modes], np.int64),
        "angle_deg": np.degrees(column("angle")),
        "sigma_angle": np.degrees(column("sigma_angle")),
        "shapes": np.array([mode.shape for mode in modes]).reshape(-1, count[0]).T,
        "sigma_shapes": np.array([mode.sigma_shape for mode in modes]).reshape(-1, count[0]).T,
        "residues": np.array([mode.residues for mode in modes], complex).reshape(-1, *count).transpose(1, 2, 0),
        "split_bound": bound.reshape(-1),
    }
