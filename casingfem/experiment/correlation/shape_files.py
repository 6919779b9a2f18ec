"""Measured shapes from files: universal files with sets 55, or the modes that `casingfem identify` found."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from casingfem.errors import InputError
from casingfem.experiment.correlation.measured_shapes import AXES, MeasuredShapes
from casingfem.experiment.frf.files import UNIVERSAL
from casingfem.experiment.frf.sensor_grid import SensorGrid
from casingfem.experiment.identify.identified import Identified
from casingfem.io.arrays import FloatArray

IDENTIFIED = ".npz"


def read_shapes(path: str | os.PathLike[str]) -> MeasuredShapes:
    """Shapes of a universal file (sets 55 with their nodes) or of an identified npz, by the file's ending.

    Raises
    ------
    InputError, InputError, InputError
        Another ending; what the readers refuse; an identification whose sensors have no places.
    """
    ending = Path(path).suffix.lower()
    if ending == IDENTIFIED:
        return identified_shapes(Identified.load(path), str(path))
    if ending in UNIVERSAL:
        return MeasuredShapes.from_uff(path)
    expected = f"{', '.join(UNIVERSAL)} with mode shapes (sets 55), or {IDENTIFIED} of casingfem identify --out"
    raise InputError(str(path), found=f"ending {ending!r}", expected=expected)


def identified_shapes(found: Identified, path: str = "identified") -> MeasuredShapes:
    """The shapes of identified modes at the places of their sensors, with n and uncertainties.

    Directions 1, 2, 3 are radial, hoop and axial where the sensors stand around an axis (they have angles), else x, y,
    z; a sign turns them over. The noise of a shape of unit norm is sqrt(sum sigma_shapes^2).

    Raises
    ------
    InputError
        No modes, sensors without places or without a direction.

    Examples
    --------
    >>> theta, x = np.arange(8) * np.pi / 4, np.arange(80.0, 120.0, 0.1)
    >>> H = np.cos(2 * theta)[:, None] * 100.0**2 / (100.0**2 - x**2 + 2j * 0.004 * 100.0 * x)
    >>> from casingfem.experiment.frf.frf_set import FrfSet
    >>> from casingfem.experiment.identify.identification import identify
    >>> frfs = FrfSet.from_arrays(kind="frf", x=x, responses=H, unit="m/N", response_point=np.arange(8),
    ...                           response_direction=1)
    >>> at = {k: (0.45 * np.cos(a), 0.45 * np.sin(a), 0.25) for k, a in enumerate(theta)}
    >>> found = identify(frfs, angles=dict(enumerate(np.degrees(theta))), places=at)
    >>> identified_shapes(found)
    MeasuredShapes(1 modes, 8 channels at 8 points, 100 to 100 Hz)
    """
    if not len(found):
        raise InputError(path, found="no mode", expected="at least one")
    sensors = found.sensors
    lost = sensors.points[np.isnan(sensors.places).any(axis=1)]
    if lost.size:
        expected = "positions: responses in a universal file with geometry, or --angles with radius_m and z_m"
        raise InputError(path, found=f"no position of point {lost[0]}", expected=expected)
    return MeasuredShapes.from_arrays(
        freq_hz=found.freq,
        values=found.shapes,
        points=sensors.places,
        directions=unit_vectors(sensors, path),
        labels=sensors.points,
        sigma=np.linalg.norm(found.sigma_shapes, axis=0),
        n=found.n,
        path=path,
    )


def unit_vectors(sensors: SensorGrid, path: str) -> FloatArray:
    """Where the sensors measure along, (sensors, 3)."""
    codes = sensors.directions
    wrong = np.flatnonzero(~np.isin(np.abs(codes), (1, 2, 3)))
    if wrong.size:
        found = f"direction {codes[wrong[0]]} of point {sensors.points[wrong[0]]}"
        expected = "1, 2, 3 (radial, hoop, axial around an axis, else x, y, z), signed"
        raise InputError(path, found=found, expected=expected)
    theta = np.where(np.isnan(sensors.theta), 0.0, sensors.theta)
    c, s, zero = np.cos(theta), np.sin(theta), np.zeros(len(theta))
    frames = np.stack([np.stack([c, s, zero]), np.stack([-s, c, zero]), np.tile(AXES[2][:, None], len(theta))])
    axes = frames[np.abs(codes) - 1, :, np.arange(len(codes))]
    return np.asarray(np.sign(codes)[:, None] * axes)
