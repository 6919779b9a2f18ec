"""Measured mode shapes: values at points in known directions, with their frequencies.

They come from universal files with sets 55, or are the modes that `casingfem identify` found.
"""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from casingfem.errors import InputError
from casingfem.experiment.frequency_table import FrequencyTable
from casingfem.experiment.frf.files import UNIVERSAL
from casingfem.experiment.frf.sensor_grid import SensorGrid
from casingfem.experiment.uff.read import UniversalFile, read_uff
from casingfem.experiment.uff.set_55 import COMPLEX_MODE, COMPLEX_MODE_2, NORMAL_MODE
from casingfem.io.arrays import Array, FloatArray, IntArray, freeze

if TYPE_CHECKING:
    from casingfem.experiment.identify.identified import Identified

SILENT = 1e-9  # of the largest value: a channel no shape ever exceeds was not measured
IDENTIFIED = ".npz"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class MeasuredShapes:
    """Shapes over channels: one channel is a direction at a point. Arrays are read-only.

    Parameters
    ----------
    freq_hz
        Frequencies [Hz], ascending, (modes,).
    values
        Displacements, real or complex, any scale for each mode, (channels, modes).
    points, directions
        Position [m] and unit vector of every channel, (channels, 3).
    labels
        Number of every channel's point, (channels,): channels of one sensor share it.
    sigma
        Rms noise of each shape over the shape's own rms; nan if the test does not state it, (modes,).
    n
        Nodal diameters, -1 if the test does not state them, (modes,).
    path
        The file that was read.

    Raises
    ------
    InputError
        Arrays do not fit each other, values are not finite, a shape is zero, or frequencies do not ascend.

    Examples
    --------
    >>> theta = np.arange(8) * np.pi / 4
    >>> out = np.column_stack([np.cos(theta), np.sin(theta), 0 * theta])
    >>> values = np.cos(3 * theta)[:, None]
    >>> MeasuredShapes.from_arrays(freq_hz=[366.0], values=values, points=0.45 * out, directions=out)
    MeasuredShapes(1 modes, 8 channels at 8 points, 366 to 366 Hz)
    """

    freq_hz: FloatArray
    values: Array
    points: FloatArray
    directions: FloatArray
    labels: IntArray
    sigma: FloatArray = field(default_factory=lambda: np.array(np.nan))
    n: IntArray = field(default_factory=lambda: np.array(-1))
    path: str = "shapes"

    def __post_init__(self) -> None:
        for name in ("sigma", "n"):
            values = getattr(self, name)
            object.__setattr__(self, name, np.broadcast_to(values, self.freq_hz.shape) if values.ndim == 0 else values)
        freeze(self, "freq_hz", "values", "points", "directions", "labels", "sigma", "n")
        channels, modes = len(self.labels), len(self.freq_hz)
        if self.sigma.shape != (modes,) or self.n.shape != (modes,) or np.any(self.sigma <= 0.0):
            found = f"sigma {self.sigma.tolist()} and n {self.n.tolist()}"
            raise self.error(found, f"a sigma above 0, or nan, and an n, or -1, for each of {modes} modes")
        if self.values.shape != (channels, modes) or not channels or not modes:
            found = f"values {self.values.shape} of {modes} modes and {channels} channels"
            raise self.error(found, "values of shape (channels, modes), with at least one channel and one mode")
        if self.points.shape != (channels, 3) or self.directions.shape != (channels, 3):
            found = f"points {self.points.shape} and directions {self.directions.shape}"
            raise self.error(found, f"three numbers for each of {channels} channels")
        if not all(np.isfinite(part).all() for part in (self.values, self.points, self.directions, self.freq_hz)):
            raise self.error("numbers that are not finite", "finite values, points, directions and frequencies")
        if np.any(self.freq_hz <= 0.0) or np.any(np.diff(self.freq_hz) < 0.0):
            raise self.error(f"frequencies {self.freq_hz.tolist()}", "frequencies above 0 in ascending order")
        seen = np.any(self.values, axis=0)
        if not seen.all():
            mode = int(np.argmin(seen))
            raise self.error(f"mode {mode + 1} zero everywhere", "shapes with motion at the sensors")

    def error(self, found: str, expected: str) -> InputError:
        """An error that names this file, ready to be raised."""
        return InputError(self.path, found=found, expected=expected)

    @classmethod
    def from_arrays(
        cls,
        *,
        freq_hz: ArrayLike,
        values: ArrayLike,
        points: ArrayLike,
        directions: ArrayLike,
        labels: ArrayLike | None = None,
        sigma: ArrayLike = np.nan,
        n: ArrayLike = -1,
        path: str = "shapes",
    ) -> MeasuredShapes:
        """Build from arrays in any order of frequency; directions are normalised, channels numbered if not labelled."""
        freq = np.atleast_1d(np.asarray(freq_hz, float))
        shapes, towards = np.asarray(values), np.asarray(directions, float)
        order = np.argsort(freq, kind="stable")
        lengths = np.linalg.norm(towards, axis=-1, keepdims=True)
        if np.any(lengths == 0.0):
            raise InputError(path, found="a direction of no length", expected="directions of nonzero length")
        if shapes.ndim != 2 or shapes.shape[1] != len(freq):
            raise InputError(path, found=f"values {shapes.shape}", expected=f"(channels, {len(freq)} modes)")
        each = {"sigma": np.asarray(sigma, float), "n": np.asarray(n, np.int64)}
        for name, numbers in each.items():
            if numbers.shape not in ((), freq.shape):
                raise InputError(path, found=f"{name} {numbers.shape}", expected=f"one for each of {len(freq)} modes")
        return cls(
            freq_hz=freq[order],
            values=shapes[:, order],
            points=np.asarray(points, float),
            directions=towards / lengths,
            labels=np.arange(1, len(shapes) + 1) if labels is None else np.asarray(labels),
            **{name: np.broadcast_to(numbers, freq.shape)[order] for name, numbers in each.items()},
            path=path,
        )

    @classmethod
    def from_uff(cls, path: str | os.PathLike[str]) -> MeasuredShapes:
        """Read the mode shapes of a universal file: sets 55 at the nodes of a set 15 or 2411.

        Translations x, y, z; directions without motion in any mode count as not measured and are left out.

        Raises
        ------
        InputError
            The file is damaged; it has no modes or no nodes, nodes in local coordinate systems, or shapes at different
            nodes.
        """
        return uff_shapes(read_uff(path))

    @property
    def sensors(self) -> IntArray:
        """Labels of the points, each once."""
        return np.unique(self.labels)

    @property
    def real(self) -> FloatArray:
        """Shapes made real: each is rotated in the complex plane until its values lie along one line."""
        turn = np.exp(-0.5j * np.angle(np.sum(self.values.astype(complex) ** 2, axis=0)))
        return np.asarray((self.values * turn).real if np.iscomplexobj(self.values) else self.values)

    @property
    def collinearity(self) -> FloatArray:
        """Share of each shape's energy that is in phase: 1 for a real shape, (modes,)."""
        return np.asarray(np.sum(self.real**2, axis=0) / np.sum(np.abs(self.values) ** 2, axis=0))

    def table(self, sigma: float = 1e-3) -> FrequencyTable:
        """The frequencies as a table without nodal diameters; `sigma` relative."""
        return FrequencyTable.from_arrays(freq_hz=self.freq_hz, sigma_hz=sigma * self.freq_hz, path=self.path)

    def __len__(self) -> int:
        return len(self.freq_hz)

    def __repr__(self) -> str:
        low, high = self.freq_hz[[0, -1]]
        where = f"{len(self.labels)} channels at {len(self.sensors)} points"
        return f"MeasuredShapes({len(self)} modes, {where}, {low:g} to {high:g} Hz)"


def uff_shapes(file: UniversalFile) -> MeasuredShapes:
    """The mode shapes of a universal file; see `MeasuredShapes.from_uff`."""
    kinds = (NORMAL_MODE, COMPLEX_MODE, COMPLEX_MODE_2)
    modes = [shape for shape in file.shapes if shape.analysis in kinds and 0.0 < shape.freq_hz < np.inf]
    if not modes:
        raise InputError(file.path, found=f"{len(file.shapes)} shapes, none of a mode", expected="modes in sets 55")
    if file.nodes is None:
        raise InputError(file.path, found="no nodes", expected="a set 15 or 2411 with the points of the shapes")
    first = modes[0].nodes
    if any(not np.array_equal(shape.nodes, first) for shape in modes):
        raise InputError(file.path, found="shapes with values at different nodes", expected="one set of nodes")
    place = {label: k for k, label in enumerate(file.nodes.labels.tolist())}
    at = np.array([place[label] for label in first.tolist()])
    if np.any(file.nodes.motions[at]):
        system = int(file.nodes.motions[at].max())
        raise InputError(file.path, found=f"motions in coordinate system {system}", expected="global motions, 0")
    for shape in modes:
        if shape.characteristic not in (2, 3):
            found = f"data characteristic {shape.characteristic}"
            raise InputError(file.path, found=found, expected="2 or 3: translations x, y, z at each node")
    values = np.stack([shape.values[:, :3] for shape in modes], axis=-1)  # (nodes, 3, modes)
    moved = np.abs(values).max(axis=-1) > SILENT * np.abs(values).max()
    node, axis = np.nonzero(moved)
    return MeasuredShapes.from_arrays(
        freq_hz=[shape.freq_hz for shape in modes],
        values=values[node, axis],
        points=file.nodes.points[at][node],
        directions=np.eye(3)[axis],
        labels=first[node],
        path=file.path,
    )


def read_shapes(path: str | os.PathLike[str]) -> MeasuredShapes:
    """Shapes of a universal file (sets 55 with their nodes) or of an identified npz, by the file's ending.

    Raises
    ------
    InputError, InputError, InputError
        The ending is unknown, the reader refuses the file, or the sensors of the identification have no positions.

    Examples
    --------
    >>> import tempfile
    >>> import casingfem as cf
    >>> theta, x = np.arange(8) * np.pi / 4, np.arange(80.0, 120.0, 0.1)
    >>> H = np.cos(2 * theta)[:, None] * 100.0**2 / (100.0**2 - x**2 + 2j * 0.004 * 100.0 * x)
    >>> frfs = cf.frf.FrfSet.from_arrays(kind="frf", x=x, responses=H, unit="m/N", response_point=np.arange(8),
    ...                                  response_direction=1)
    >>> at = {k: (0.45 * np.cos(a), 0.45 * np.sin(a), 0.25) for k, a in enumerate(theta)}
    >>> found = cf.identify(frfs, angles=dict(enumerate(np.degrees(theta))), places=at)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     shapes = read_shapes(found.save(f"{folder}/identified.npz"))
    >>> shapes.freq_hz.round(2).tolist()
    [100.0]
    """
    ending = Path(path).suffix.lower()
    if ending == IDENTIFIED:
        from casingfem.experiment.identify.identified import Identified  # not loaded by every study

        return identified_shapes(Identified.load(path), str(path))
    if ending in UNIVERSAL:
        return MeasuredShapes.from_uff(path)
    expected = f"{', '.join(UNIVERSAL)} with mode shapes (sets 55), or {IDENTIFIED} of casingfem identify --out"
    raise InputError(str(path), found=f"ending {ending!r}", expected=expected)


def identified_shapes(found: Identified, path: str = "identified") -> MeasuredShapes:
    """Shapes of identified modes at the positions of their sensors, with n and uncertainties.

    Directions 1, 2, 3 are radial, hoop and axial if the sensors are around an axis (they have angles), else x, y, z; a
    minus sign reverses them. The noise of a shape of unit norm is sqrt(sum sigma_shapes^2).

    Raises
    ------
    InputError
        There are no modes, or sensors without position or direction.

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
    """Directions in which the sensors measure, (sensors, 3)."""
    codes = sensors.directions
    wrong = np.flatnonzero(~np.isin(np.abs(codes), (1, 2, 3)))
    if wrong.size:
        found = f"direction {codes[wrong[0]]} of point {sensors.points[wrong[0]]}"
        expected = "1, 2, 3 (radial, hoop, axial around an axis, else x, y, z), signed"
        raise InputError(path, found=found, expected=expected)
    theta = np.where(np.isnan(sensors.theta), 0.0, sensors.theta)
    c, s, zero = np.cos(theta), np.sin(theta), np.zeros(len(theta))
    frames = np.array([[c, s, zero], [-s, c, zero], [zero, zero, zero + 1.0]])
    return np.asarray(np.sign(codes)[:, None] * frames[np.abs(codes) - 1, :, np.arange(len(codes))])
