"""Mode shapes as a test has them: values at points of space in known directions, with their frequencies."""

from __future__ import annotations

import os
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from casingfem.errors import InputError
from casingfem.experiment.frequency_table import FrequencyTable
from casingfem.experiment.uff.read import UniversalFile, read_uff
from casingfem.experiment.uff.set_55 import COMPLEX_MODE, COMPLEX_MODE_2, NORMAL_MODE, Shape
from casingfem.io.arrays import Array, FloatArray, IntArray, frozen

SILENT = 1e-9  # of the largest value: a channel no shape ever exceeds was not measured
AXES = np.eye(3)


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
        Noise of each shape, rms over the shape's own rms; nan where the test does not say, (modes,).
    n
        Nodal diameters, -1 where the test does not say, (modes,).
    path
        Where it was read from.

    Raises
    ------
    InputError
        Arrays that do not fit, values that are not finite, a shape that is zero, frequencies not ascending.

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
        for name in ("freq_hz", "values", "points", "directions", "labels", "sigma", "n"):
            object.__setattr__(self, name, frozen(np.array(getattr(self, name))))
        channels, modes = len(self.labels), len(self.freq_hz)
        if self.sigma.shape != (modes,) or self.n.shape != (modes,) or np.any(self.sigma <= 0.0):
            found = f"sigma {self.sigma.tolist()} and n {self.n.tolist()}"
            raise self.error(found, f"a sigma above 0, or nan, and an n, or -1, for each of {modes} modes")
        if self.values.shape != (channels, modes) or not channels or not modes:
            found = f"values {self.values.shape} of {modes} modes and {channels} channels"
            raise self.error(found, "values (channels, modes), one of each at least")
        if self.points.shape != (channels, 3) or self.directions.shape != (channels, 3):
            found = f"points {self.points.shape} and directions {self.directions.shape}"
            raise self.error(found, f"three numbers for each of {channels} channels")
        numbers = (self.values, self.points, self.directions, self.freq_hz)
        if not all(np.all(np.isfinite(part)) for part in numbers):
            raise self.error("numbers that are not finite", "finite values, points, directions and frequencies")
        if np.any(self.freq_hz <= 0.0) or np.any(np.diff(self.freq_hz) < 0.0):
            raise self.error(f"frequencies {self.freq_hz.tolist()}", "frequencies above 0 in ascending order")
        if not np.all(np.any(self.values, axis=0)):
            mode = int(np.argmin(np.any(self.values, axis=0)))
            raise self.error(f"mode {mode + 1} zero everywhere", "shapes that the sensors see")

    def error(self, found: str, expected: str) -> InputError:
        """An error that names this file, to be raised."""
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
            raise InputError(path, found="a direction of no length", expected="directions that point somewhere")
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

        Translations x, y, z; directions that no mode ever moves in were not measured and are left out.

        Raises
        ------
        InputError
            A file that is damaged.
        InputError
            No modes, no nodes, nodes in a coordinate system of their own, shapes of different nodes.
        """
        return uff_shapes(read_uff(path))

    @property
    def sensors(self) -> IntArray:
        """Labels of the points, each once."""
        return np.unique(self.labels)

    @property
    def real(self) -> FloatArray:
        """Shapes made real: each turned in the complex plane to where its values lie along one line."""
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
    modes = [shape for shape in file.shapes if shape.analysis in kinds and np.isfinite(shape.freq_hz)]
    modes = [shape for shape in modes if shape.freq_hz > 0.0]
    if not modes:
        raise InputError(file.path, found=f"{len(file.shapes)} shapes, none of a mode", expected="modes in sets 55")
    if file.nodes is None:
        raise InputError(file.path, found="no nodes", expected="a set 15 or 2411 with the points of the shapes")
    first = modes[0].nodes
    if any(not np.array_equal(shape.nodes, first) for shape in modes):
        raise InputError(file.path, found="shapes with values at different nodes", expected="one set of nodes")
    place = {label: k for k, label in enumerate(file.nodes.labels.tolist())}
    missing = [label for label in first.tolist() if label not in place]
    if missing:
        raise InputError(file.path, found=f"values at node {missing[0]}, which has no point", expected="its point")
    at = np.array([place[label] for label in first.tolist()])
    if np.any(file.nodes.motions[at]):
        system = int(file.nodes.motions[at].max())
        raise InputError(file.path, found=f"motions in coordinate system {system}", expected="global motions, 0")
    values = np.stack([translations(shape, file.path) for shape in modes], axis=-1)  # (nodes, 3, modes)
    moved = np.abs(values).max(axis=-1) > SILENT * np.abs(values).max()
    node, axis = np.nonzero(moved)
    return MeasuredShapes.from_arrays(
        freq_hz=[shape.freq_hz for shape in modes],
        values=values[node, axis],
        points=file.nodes.points[at][node],
        directions=AXES[axis],
        labels=first[node],
        path=file.path,
    )


def translations(shape: Shape, path: str) -> Array:
    """The translations of a shape, (nodes, 3)."""
    if shape.characteristic not in (2, 3):
        found = f"data characteristic {shape.characteristic}"
        raise InputError(path, found=found, expected="2 or 3: translations x, y, z at each node")
    return shape.values[:, :3]
