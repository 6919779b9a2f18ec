"""Rotation of imported parts: K(Omega) = K + Omega^2 K1 + Omega^4 K2 about the shape at rest, or about the steady one.

In the rotating frame, with Green's strain E(u) = e(u) + e2(u, u)/2, e2(u, v) = sym(grad u^T grad v),

    v K1 v = int [sigma1 : grad v^T grad v + 2 e(v) : C : e2(u1, v)] - v S v,   v K2 v = int e2(u1, v) : C : e2(u1, v)
    v S v = int rho |P v|^2,   v' G v = 2 int rho v'.(a x v),   K u1 = f,   f(v) = int rho P(x - c).v

as for shells on charts (`shell/prestress.py`). The terms of an imported shell are in `shell_spin.py`. If the quadratic
strains of Omega^2 u1 exceed the part `LARGE` of the linear ones, the steady state of a solid is computed on the
deformed shape (`solid_spin.py`), and K(Omega) is its tangent. Attached masses rotate with the part
(`attachments/turning.py`).
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.sparse import csc_array

from casingfem.errors import warn
from casingfem.io.arrays import FloatArray, IntArray
from casingfem.linalg.factor import solve_held
from casingfem.structure.geometry.rotation import Rotation
from casingfem.structure.imported.assembly import MeshSystem
from casingfem.structure.imported.attachments.system import enlarged
from casingfem.structure.imported.attachments.turning import AttachedSpin, attached_spin, carried
from casingfem.structure.imported.cells.mapped import cell_dofs, scatter, scatter_forces, symmetric
from casingfem.structure.imported.mesh.joints import WALL
from casingfem.structure.shell.prestress import Products, Spin, products_of

LARGE = 0.01  # quadratic strains over linear ones: from which the steady shape is iterated
WITHIN = 2.5e-3  # relative error of a frequency at the speeds at which a basis is known
BEND = (
    0.09  # that error over quadratic strains and the third power of `aside` (rotors 37 and 67, NASA TP-1659, TP-2879)
)
FARTHEST = 0.75  # of the squared speed


class Inertia(NamedTuple):
    """Spin softening and centrifugal force of each cell at 1 rad/s, and its gyroscopic matrix."""

    softening: FloatArray  # (cells, m, m)
    gyroscopic: FloatArray  # (cells, m, m)
    force: FloatArray  # (cells, m)


class Stiffening(NamedTuple):
    """Stiffness (cells, m, m) that a static state adds, to first and to second order, and the ratio of strains.

    `ratio`: root of the energy of the quadratic strains over that of the linear ones.
    """

    first: FloatArray
    second: FloatArray
    ratio: float


@dataclass(frozen=True, eq=False)
class MeshSpin(Spin):
    """Terms that rotation at 1 rad/s adds to the matrices of an imported part at rest, on its free dofs.

    Attributes
    ----------
    steady
        Speed [rad/s] -> stiffness that the steady state on the deformed shape adds; None for shells.
    """

    steady: Callable[[float], csc_array] | None = None

    def stiffness(self, omega: float) -> csc_array:
        """Addition to K at rest at a speed [rad/s]; for a solid in fast rotation, the addition of its steady state."""
        if self.steady is not None and omega**2 * self.nonlinear > LARGE:
            return self.steady(omega)
        return super().stiffness(omega)


@dataclass(frozen=True, eq=False, kw_only=True)
class MeshTurning:
    """A part at rest and an axis: its centrifugal load, and the terms of rotation computed from the static response.

    Attributes
    ----------
    system
        The part assembled at rest.
    rotation
        Axis, and the speed at which a basis computes its modes.
    inertia
        Inertia of the cells about the axis.
    stiffening
        Nodal fields (nodes, dofs) -> stiffness that their stress and strain add to the cells.
    steady
        Fields at 1 rad/s -> stiffness that the steady state on the deformed shape adds at a speed; None for shells.
    """

    system: MeshSystem
    rotation: Rotation
    inertia: Inertia
    stiffening: Callable[[FloatArray], Stiffening]
    steady: Callable[[FloatArray], Callable[[float], csc_array]] | None = None

    @property
    def rows(self) -> IntArray:
        """Dofs of the cells, (cells, m)."""
        return cell_dofs(self.system.structure.mesh.cells, self.system.dofs)

    @cached_property
    def extra(self) -> AttachedSpin | None:
        """Terms that attachments add to the part."""
        connected = self.system.connected
        return None if connected is None else attached_spin(connected.rows.motions, self.rotation)

    @cached_property
    def on_cells(self) -> FloatArray:
        """Centrifugal force of the cells at 1 rad/s on the dofs of nodes, or of walls' nodes if walls meet."""
        return summed(self.system, self.inertia.force)

    @cached_property
    def force(self) -> FloatArray:
        """Centrifugal force at 1 rad/s on all motions."""
        walls, extra = self.system.walls, self.extra
        force = self.on_cells if walls is None else walls.joints.onto_nodes(self.on_cells)
        return np.asarray(force if extra is None else extra.force + np.pad(force, (0, len(extra.force) - len(force))))

    @property
    def load(self) -> FloatArray:
        """Centrifugal force at 1 rad/s on the free dofs, (free,)."""
        connected = self.system.connected
        return np.asarray(self.force[self.system.free] if connected is None else connected.whole.T @ self.force)

    def spin(self, u: FloatArray) -> MeshSpin:
        """K1, K2, G and the static state, from the static response u (free,) to the load."""
        system, of, extra, walls = self.system, self.inertia, self.extra, self.system.walls
        fields = system.expand(u[:, None])[:, :, 0]
        of_cells = fields if walls is None else walls.joints.of_walls(fields)
        added = self.stiffening(of_cells)
        parts = [sums(system, cells) for cells in (added.first - of.softening, added.second, of.gyroscopic)]
        if walls is not None:
            parts = [walls.joints.on_nodes(part) for part in parts]
            parts[0] = csc_array(parts[0] + walls.joints.arms(self.on_cells - walls.K @ of_cells.ravel()))
        if extra is not None and system.connected is not None:
            on = system.connected
            parts = [enlarged(part, len(self.force)) for part in parts]
            carries = carried(on.rows.motions, on.rows, self.force - on.K @ (on.whole @ u))
            parts[0], parts[2] = parts[0] + extra.stiffness + carries - extra.softening, parts[2] + extra.gyroscopic
        first, second, gyroscopic = (reduced(system, csc_array(part)) for part in parts)
        return MeshSpin(
            K1=symmetric(first), K2=symmetric(second), G=gyroscopic, fields=fields, nonlinear=added.ratio,
            steady=None if self.steady is None else self.steady(fields),
        )  # fmt: skip

    def products(self, u: FloatArray) -> Products:
        """Products of G, K1 and K2 with motions (free, k), from the static response u (free,) to the load.

        If the steady shape matters at the speed of the rotation, K1 and K2 are the coefficients of a parabola in
        Omega^2. It passes through the stiffness at the speed and at squares `aside` lower and higher.

        Warns
        -----
        ModelWarning
            `reduce-steady`, with the range of speeds in which this is valid.
        """
        added, square = self.spin(u), self.rotation.omega**2
        if added.steady is None or square * added.nonlinear <= LARGE:
            return products_of(added)
        part = aside(square * added.nonlinear)
        low, high = (np.sqrt([1.0 - part, 1.0 + part]) * np.sqrt(square)).tolist()
        hz = f"{low / (2.0 * np.pi):.4g} to {high / (2.0 * np.pi):.4g} Hz of rotation"
        warn("reduce-steady", f"rotation: the stiffness is valid from {hz} only")
        apart = part * square
        below, here, above = (added.steady(float(np.sqrt(square + side * apart))) for side in (-1.0, 0.0, 1.0))
        slope, bend = (above - below) / (2.0 * apart), (above - 2.0 * here + below) / (2.0 * apart**2)
        return products_of(replace(added, K1=csc_array(slope - 2.0 * square * bend), K2=csc_array(bend)), (low, high))


def aside(ratio: float) -> float:
    """Part of the squared speed in which a parabola gives frequencies to `WITHIN`, from the quadratic strains.

    >>> [round(aside(ratio), 2) for ratio in (0.01, 0.076, 0.955)]
    [0.75, 0.71, 0.31]
    """
    return float(min(FARTHEST, (WITHIN / (BEND * ratio)) ** (1.0 / 3.0)))


def mesh_spin(turning: MeshTurning) -> MeshSpin:
    """Terms that rotation about an axis adds to a part assembled at rest.

    Raises
    ------
    ModelError
        `static-loose` if the centrifugal force drives a rigid motion that is not restrained.
    """
    return turning.spin(tied_solution(turning.system, turning.system.K, turning.load, solve_held))


def sums(system: MeshSystem, matrices: FloatArray) -> csc_array:
    """Matrices of the cells, summed on the dofs of nodes, or of walls' nodes if walls meet."""
    return scatter(matrices, *numbered(system))


def summed(system: MeshSystem, forces: FloatArray) -> FloatArray:
    """Forces of the cells, summed on the dofs of nodes, or of walls' nodes if walls meet."""
    return scatter_forces(forces, *numbered(system))


def numbered(system: MeshSystem) -> tuple[IntArray, int]:
    """Dofs of the cells, of nodes or of walls' nodes if walls meet, (cells, m), and the number of dofs."""
    cells, dofs, count = system.structure.mesh.cells, system.dofs, len(system.points)
    if system.walls is not None:
        cells, dofs, count = system.walls.joints.cells, WALL, len(system.walls.joints.nodes)
    return cell_dofs(cells, dofs), dofs * count


def reduced(system: MeshSystem, A: csc_array) -> csc_array:
    """A matrix on all motions, reduced to the unknowns."""
    if system.connected is None:
        return csc_array(A[:, system.free][system.free])
    T = system.connected.whole
    return csc_array(T.T @ A @ T)


def tied_solution(
    system: MeshSystem, K: csc_array, force: FloatArray, solve: Callable[[csc_array, FloatArray], FloatArray]
) -> FloatArray:
    """Solution of K u = f on the free dofs, restricted to the motions that the system allows."""
    if system.tie is None:
        return solve(K, force)
    T = system.tie
    return np.asarray(T @ solve(csc_array(T.T @ K @ T), T.T @ force))


def spun(system: MeshSystem, added: MeshSpin, omega: float) -> MeshSystem:
    """A system at rest with the stiffness at a speed added."""
    return replace(system, K=csc_array(system.K + added.stiffness(omega)))
