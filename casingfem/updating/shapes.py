"""Mode shapes where they were measured: the part of a measured shape that the model's modes cannot make.

    r = (1 - P) psi/sigma,   P = Phi Phi^+ the projector on the computed mode, or on both of a doublet, at the sensors

with |psi| = 1. Neither sign, scale nor a doublet's turn matters. Its derivative needs that of the computed shapes,

    dr = -((1 - P) dPhi Phi^+ psi + (Phi^+)^T dPhi^T (1 - P) psi)/sigma,

whose part inside the plane drops out; the rest is exact by the adjoints of the sensors (`modal.adjoint`). Each shape
gives as many residuals as sensors, of which one, or two for a doublet, are no information.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from casingfem.arrays import FloatArray, frozen
from casingfem.experiment.correlation.mac import mac
from casingfem.experiment.correlation.pairing import Match
from casingfem.modal.adjoint import adjoint_space
from casingfem.modal.mode_set import Modes
from casingfem.modal.neighbour import Solution
from casingfem.structure.mesh import Grid
from casingfem.structure.place import interpolation
from casingfem.structure.shell import Shell
from casingfem.updating.parameters import Parameter
from casingfem.updating.sensitivity import product_derivatives


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SensorShapes:
    """Real shapes at sensors, one for each row of the frequency table.

    Parameters
    ----------
    a, b
        Chart parameters of the sensors, (sensors,).
    directions
        Unit vectors they measure along, (sensors, 3).
    shapes
        (sensors, rows), any scale; a column of nan where a row has no shape.
    sigma
        Standard deviation of each component of a shape of unit norm.

    Raises
    ------
    ValueError
        Arrays that do not fit, a shape that is zero or partly nan, sigma that is not positive.
    """

    a: FloatArray
    b: FloatArray
    directions: FloatArray
    shapes: FloatArray
    sigma: float

    def __post_init__(self) -> None:
        sensors = len(self.a)
        if self.b.shape != (sensors,) or self.directions.shape != (sensors, 3) or len(self.shapes) != sensors:
            raise ValueError(
                f"shapes: found {sensors} places, directions {self.directions.shape}, shapes {self.shapes.shape}; "
                "expected (sensors,), (sensors, 3), (sensors, rows)"
            )
        norms = np.linalg.norm(self.shapes, axis=0)
        blank = np.isnan(self.shapes).all(axis=0)
        if not np.all(blank | (norms > 0.0)):
            raise ValueError(f"shapes: column {int(np.argmin(blank | (norms > 0.0))) + 1} is zero or partly nan")
        if not self.sigma > 0.0:
            raise ValueError(f"shapes: sigma must be positive, found {self.sigma!r}")
        object.__setattr__(self, "shapes", frozen(self.shapes / norms))

    @classmethod
    def on_edge(cls, shell: Shell, edge: str, theta: ArrayLike, shapes: ArrayLike, sigma: float) -> "SensorShapes":
        """Radial sensors at angles [rad] on an edge of a casing, as a circle of accelerometers has them."""
        held, end = shell.chart.edges.get(edge, (1, 0))
        if not shell.chart.periodic or held != 0:
            raise ValueError(f"shapes: {edge!r} is no closed edge of this chart")
        b = np.asarray(theta, dtype=float)
        a = np.full(b.shape, shell.chart.bounds[0][end])
        radial = shell.chart.directions(a, b)[0].T
        return cls(a=a, b=b, directions=radial, shapes=np.asarray(shapes, dtype=float), sigma=sigma)

    def only(self, rows: Sequence[int]) -> "SensorShapes":
        """The shapes of some rows of the table."""
        return replace(self, shapes=self.shapes[:, list(rows)])

    def loads(self, grid: Grid) -> FloatArray:
        """The sensors as nodal loads: their readings of nodal fields, (nodes, 5, sensors)."""
        nodes, weights = interpolation(grid, self.a, self.b)
        loads = np.zeros((grid.nodes.shape[1], 5, len(self.a)))
        sensors = np.arange(len(self.a))[:, None]
        np.add.at(loads[:, :3].transpose(0, 2, 1), (nodes, sensors), weights[:, :, None] * self.directions[:, None, :])
        return loads

    def readings(self, modes: Modes) -> FloatArray:
        """Computed shapes at the sensors, (sensors, modes)."""
        return np.asarray(np.einsum("ncs,ncm->sm", self.loads(modes.grid), modes.fields))

    def mac(self, modes: Modes) -> FloatArray:
        """MAC of measured with computed shapes, (rows, modes); all alike for rows without a shape.

        Raises
        ------
        ValueError
            If a computed mode does not move the sensors.
        """
        found = np.zeros((self.shapes.shape[1], len(modes)))
        known = ~np.isnan(self.shapes).any(axis=0)
        found[known] = mac(self.shapes[:, known], self.readings(modes))
        return found

    def seen(self, match: Match) -> list[int]:
        """The rows of a match that have a shape."""
        return [row for row in match.rows if not np.isnan(self.shapes[0, row])]


def plane_at(modes: Modes, match: Match, readings: FloatArray) -> tuple[list[int], FloatArray]:
    """The modes that may make a match's shapes, both of a doublet, and their readings (sensors, 1 or 2)."""
    whole = next((pair for pair in modes.doublets if match.modes[0] in pair), match.modes)
    plane = list(match.modes if len(match.modes) == 2 else whole)
    return plane, readings[:, plane]


def shape_values(modes: Modes, measured: SensorShapes, matches: Sequence[Match]) -> FloatArray:
    """The parts of measured shapes outside the modes that they pair with, over sigma, (rows times sensors,)."""
    readings = measured.readings(modes)
    parts = [np.zeros(0)]
    for match in matches:
        psi = measured.shapes[:, measured.seen(match)]
        _, phi = plane_at(modes, match, readings)
        parts.append((psi - phi @ (np.linalg.pinv(phi) @ psi)).T.ravel() / measured.sigma)
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
        psi = measured.shapes[:, measured.seen(match)]
        plane, phi = plane_at(modes, match, space.readings)
        inverse = np.linalg.pinv(phi)
        left = psi - phi @ (inverse @ psi)
        away = space.values[plane] - space.values[:, None]
        away[plane] = np.inf
        forces = K[:, :, plane] - M[:, :, plane] * space.values[plane]
        change = np.einsum("sy,pyi->psi", space.readings, forces / away)
        outside = change - phi @ (inverse @ change)
        slope = -(outside @ (inverse @ psi) + inverse.T @ (change.transpose(0, 2, 1) @ left))
        parts.append(slope.transpose(2, 1, 0).reshape(-1, len(vary)) / measured.sigma)
    return np.concatenate(parts)


def redundant(modes: Modes, measured: SensorShapes | None, matches: Sequence[Match]) -> int:
    """How many of the shape residuals are no information: the dimension of each plane, for each shape."""
    if measured is None:
        return 0
    readings = np.zeros((len(measured.a), len(modes)))
    return sum(len(plane_at(modes, m, readings)[0]) * len(measured.seen(m)) for m in matches)
