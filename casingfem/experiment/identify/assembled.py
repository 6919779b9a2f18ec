"""Assemble the modes of a test: labels from sensors that agree, notes on the circle, columns by mode."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from casingfem.experiment.circle.orientation import Circle
from casingfem.experiment.frf.sensor_grid import SensorGrid, radial_signs
from casingfem.experiment.identify.mode import Mode, Sensors
from casingfem.experiment.identify.suspects import suspect_sensors, suspected
from casingfem.io.arrays import FloatArray, IntArray

MOST_OFF = 0.5  # share of the sensors that labels may do without


def labelled(make: Callable[[Sensors], list[Mode]], sensors: Sensors) -> list[Mode]:
    """Modes with labels by the sensors that are not suspected; sensors at a wrong place would spoil the labels."""
    grid, circle, modes = sensors.grid, sensors.circle, make(sensors)
    kept = _belonging(modes, grid, circle)
    if circle is None or len(kept) == len(grid):
        return modes
    return make(Sensors.of(grid, sensors.power, Circle(theta=grid.theta[kept], orders=circle.orders), kept))


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
    """Sensors of a circle that are off in the sure modes."""
    shapes = _sure_shapes(modes, grid)
    return () if circle is None or not shapes.size else suspected(shapes, circle.n_max, grid.theta, grid.points)


def _sure_shapes(modes: list[Mode], grid: SensorGrid) -> FloatArray:
    """Radial shapes of the modes that are sure, (sensors, modes)."""
    return np.array([mode.shape for mode in modes if not mode.reason]).T * radial_signs(grid)[:, None]


def _belonging(modes: list[Mode], grid: SensorGrid, circle: Circle | None) -> IntArray:
    """Sensors by which modes are labelled: those that are not suspected; all where too few would be left."""
    every, shapes = np.arange(len(grid)), _sure_shapes(modes, grid)
    if circle is None or not shapes.size:
        return every
    off = suspect_sensors(shapes, circle.n_max, grid.theta, grid.points)
    return np.delete(every, off) if len(off) <= MOST_OFF * len(every) else every


def columns_of(modes: list[Mode], doublets: tuple[tuple[int, int], ...], grid: SensorGrid) -> dict[str, Any]:
    """Fields of `Identified` that have one entry for each mode."""

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
