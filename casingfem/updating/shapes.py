"""Residuals of mode shapes at sensors: the part of a measured shape that the model's modes cannot represent.

    r = (1 - P) psi/sigma,   P = Phi Phi^+ the projector on the computed mode, or on both of a doublet, at the sensors

with |psi| = 1. The residual does not depend on sign, scale or the rotation of a doublet. Its derivative needs that of
the computed shapes,

    dr = -((1 - P) dPhi Phi^+ psi + (Phi^+)^T dPhi^T (1 - P) psi)/sigma,

The part of dPhi inside the plane drops out; the rest is exact by the adjoints of the sensors (`modal.adjoint`). Each
shape gives as many residuals as sensors. One of them, or two for a doublet, has no information.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike

from casingfem.experiment.correlation.correlate import seen_mac
from casingfem.experiment.correlation.matches import Match
from casingfem.experiment.correlation.measured_shapes import MeasuredShapes
from casingfem.experiment.correlation.sensors import on_wall
from casingfem.experiment.frequency_table import FrequencyTable
from casingfem.io.arrays import FloatArray, IntArray, frozen
from casingfem.modal.adjoint import adjoint_space
from casingfem.modal.mode_set import Modes
from casingfem.modal.neighbour import Solution
from casingfem.structure.mesh.place import interpolation
from casingfem.structure.mesh.shell_mesh import Grid
from casingfem.structure.shell.shell import Shell
from casingfem.updating.parameters import Parameter
from casingfem.updating.sensitivity import product_derivatives
from casingfem.updating.shape_rows import REACH, columns, rows_of_shapes
from contact.io.brief import brief


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SensorShapes:
    """Real shapes at sensors, one for each row of the frequency table.

    Parameters
    ----------
    a, b
        Chart parameters of the sensors, (sensors,).
    directions
        Unit vectors of the measured directions, (sensors, 3).
    shapes
        Shapes of any scale, (sensors, rows); a column of nan for a row without a shape.
    sigma
        Standard deviation of each component of a shape of unit norm, one number or (rows,).
    labels
        Number of every sensor's point, (sensors,); by default counted from 1.
    unused_hz
        Frequencies of measured shapes that belong to no row [Hz].

    Raises
    ------
    ValueError
        Arrays of inconsistent shapes, a mode shape that is zero or partly nan, sigma that is not positive.

    Examples
    --------
    >>> out = np.tile([1.0, 0.0, 0.0], (3, 1))
    >>> angle = np.array([0.0, 2.0, 4.0])
    >>> found = SensorShapes(a=np.full(3, 0.25), b=angle, directions=out, shapes=np.eye(3), sigma=0.02)
    >>> found.labels.tolist()
    [1, 2, 3]
    """

    a: FloatArray
    b: FloatArray
    directions: FloatArray
    shapes: FloatArray
    sigma: FloatArray | float
    labels: IntArray = field(default_factory=lambda: np.zeros(0, np.int64))
    unused_hz: tuple[float, ...] = ()

    __repr__ = brief

    def __post_init__(self) -> None:
        sensors = len(self.a)
        if not len(self.labels):
            object.__setattr__(self, "labels", frozen(np.arange(1, sensors + 1)))
        if self.b.shape != (sensors,) or self.directions.shape != (sensors, 3) or len(self.shapes) != sensors:
            raise ValueError(
                f"shapes: found {sensors} places, directions {self.directions.shape}, shapes {self.shapes.shape}; "
                "expected (sensors,), (sensors, 3), (sensors, rows)"
            )
        norms = np.linalg.norm(self.shapes, axis=0)
        blank = np.isnan(self.shapes).all(axis=0)
        if not np.all(blank | (norms > 0.0)):
            column = int(np.argmin(blank | (norms > 0.0))) + 1
            raise ValueError(
                f"shapes: found column {column} with only zeros or with some nan; expected a measured shape, or a "
                "column of nan for a mode without one"
            )
        spread = np.asarray(self.sigma, float)
        if spread.shape not in ((), norms.shape) or not np.all(blank | (spread > 0.0)):
            expected = f"expected one number above 0, or {len(norms)}, one for each shape"
            raise ValueError(f"shapes: sigma: found {self.sigma!r}, {expected}")
        object.__setattr__(self, "sigma", frozen(np.where(blank, np.nan, spread)))
        object.__setattr__(self, "shapes", frozen(self.shapes / norms))

    @classmethod
    def on_edge(cls, shell: Shell, edge: str, theta: ArrayLike, shapes: ArrayLike, sigma: float) -> "SensorShapes":
        """Radial sensors at angles [rad] on an edge of a casing, like a circle of accelerometers."""
        held, end = shell.chart.edges.get(edge, (1, 0))
        if not shell.chart.periodic or held != 0:
            raise ValueError(f"shapes: found edge {edge!r}, expected an edge that runs around a closed casing")
        b = np.asarray(theta, dtype=float)
        a = np.full(b.shape, shell.chart.bounds[0][end])
        radial = shell.chart.directions(a, b)[0].T
        return cls(a=a, b=b, directions=radial, shapes=np.asarray(shapes, dtype=float), sigma=sigma)

    @classmethod
    def of(
        cls,
        measured: MeasuredShapes,
        shell: Shell,
        table: FrequencyTable,
        *,
        reach: float = REACH,
        sigma: float | None = None,
        error: float = 0.0,
    ) -> "SensorShapes":
        """Place measured shapes on a shell, and assign each to a row of the table.

        Parameters
        ----------
        reach
            Largest relative distance of a shape's frequency from its row's (`rows_of_shapes`).
        sigma
            Noise of the shapes, its rms over the rms of the shape; by default that of `measured`.
        error
            Error of the model's shapes, in the same measure, added in squares.

        Raises
        ------
        InputError
            No noise is known; shapes that fit no row or more than one.
        ModelError
            `sensor-far` for a sensor that is not on the shell.
        """
        if sigma is None and np.isnan(measured.sigma).any():
            raise measured.error(
                "no uncertainty of the shapes", "a relative sigma, as the file of the shapes states none"
            )
        rows = rows_of_shapes(measured, table, reach=reach)
        a, b, _ = on_wall(shell, measured.points, measured.labels)
        spread = np.hypot(measured.sigma if sigma is None else np.full(len(measured), sigma), error)
        return cls(
            a=a,
            b=b,
            directions=measured.directions,
            shapes=columns(measured.real, rows, len(table)),
            sigma=columns(spread / np.sqrt(len(a)), rows, len(table)),
            labels=measured.labels,
            unused_hz=tuple(measured.freq_hz[rows < 0].tolist()),
        )

    def only(self, rows: Sequence[int]) -> "SensorShapes":
        """The shapes of some rows of the table."""
        kept = list(rows)
        return replace(self, shapes=self.shapes[:, kept], sigma=np.asarray(self.sigma)[kept])

    def sigma_of(self, rows: Sequence[int]) -> FloatArray:
        """Standard deviations of the shapes of some rows, (rows,)."""
        return np.asarray(np.asarray(self.sigma)[list(rows)])

    def loads(self, grid: Grid) -> FloatArray:
        """Nodal loads that read nodal fields at the sensors, (nodes, 5, sensors)."""
        nodes, weights = interpolation(grid, self.a, self.b)
        loads = np.zeros((grid.nodes.shape[1], 5, len(self.a)))
        sensors = np.arange(len(self.a))[:, None]
        np.add.at(loads[:, :3].transpose(0, 2, 1), (nodes, sensors), weights[:, :, None] * self.directions[:, None, :])
        return loads

    def readings(self, modes: Modes) -> FloatArray:
        """Computed shapes at the sensors, (sensors, modes)."""
        return np.asarray(np.einsum("ncs,ncm->sm", self.loads(modes.grid), modes.fields))

    def mac(self, modes: Modes) -> FloatArray:
        """MAC of measured with computed shapes, (rows, modes).

        0 for rows without a shape and modes that no sensor sees.
        """
        found = np.zeros((self.shapes.shape[1], len(modes)))
        known = ~np.isnan(self.shapes).any(axis=0)
        found[known] = seen_mac(self.shapes[:, known], self.readings(modes))
        return found

    def seen(self, match: Match) -> list[int]:
        """Rows of a match that have a shape."""
        return [row for row in match.rows if not np.isnan(self.shapes[0, row])]


def plane_at(modes: Modes, match: Match, readings: FloatArray) -> tuple[list[int], FloatArray]:
    """Modes that represent a match's shapes, both of a doublet, and their readings (sensors, 1 or 2)."""
    whole = next((pair for pair in modes.doublets if match.modes[0] in pair), match.modes)
    plane = list(match.modes if len(match.modes) == 2 else whole)
    return plane, readings[:, plane]


def shape_values(modes: Modes, measured: SensorShapes, matches: Sequence[Match]) -> FloatArray:
    """Parts of measured shapes outside the plane of their paired modes, over sigma, (rows times sensors,)."""
    readings = measured.readings(modes)
    parts = [np.zeros(0)]
    for match in matches:
        seen = measured.seen(match)
        psi = measured.shapes[:, seen]
        _, phi = plane_at(modes, match, readings)
        parts.append(((psi - phi @ (np.linalg.pinv(phi) @ psi)) / measured.sigma_of(seen)).T.ravel())
    return np.concatenate(parts)


def shape_jacobian(
    solution: Solution, vary: Sequence[Parameter], measured: SensorShapes, matches: Sequence[Match]
) -> FloatArray:
    """Derivatives of `shape_values`, (rows times sensors, parameters)."""
    modes = solution.modes
    space = adjoint_space(solution, measured.loads(modes.grid))
    K, M = product_derivatives(modes, vary, space.fields, space.own)
    parts = [np.zeros((0, len(vary)))]
    for match in matches:
        seen = measured.seen(match)
        psi = measured.shapes[:, seen]
        plane, phi = plane_at(modes, match, space.readings)
        inverse = np.linalg.pinv(phi)
        left = psi - phi @ (inverse @ psi)
        away = space.values[plane] - space.values[:, None]
        away[plane] = np.inf
        forces = K[:, :, plane] - M[:, :, plane] * space.values[plane]
        change = np.einsum("sy,pyi->psi", space.readings, forces / away)
        outside = change - phi @ (inverse @ change)
        slope = -(outside @ (inverse @ psi) + inverse.T @ (change.transpose(0, 2, 1) @ left))
        slope = slope / measured.sigma_of(seen)
        parts.append(slope.transpose(2, 1, 0).reshape(-1, len(vary)))
    return np.concatenate(parts)


def redundant(modes: Modes, measured: SensorShapes | None, matches: Sequence[Match]) -> int:
    """Number of shape residuals without information: the dimension of each plane, for each shape."""
    if measured is None:
        return 0
    readings = np.zeros((len(measured.a), len(modes)))
    return sum(len(plane_at(modes, m, readings)[0]) * len(measured.seen(m)) for m in matches)
