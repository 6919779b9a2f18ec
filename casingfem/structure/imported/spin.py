"""Rotation of imported parts: K(Omega) = K + Omega^2 K1 + Omega^4 K2 about the shape at rest, or about the steady one.

In the rotating frame, with Green's strain E(u) = e(u) + e2(u, u)/2, e2(u, v) = sym(grad u^T grad v),

    v K1 v = int [sigma1 : grad v^T grad v + 2 e(v) : C : e2(u1, v)] - v S v,   v K2 v = int e2(u1, v) : C : e2(u1, v)
    v S v = int rho |P v|^2,   v' G v = 2 int rho v'.(a x v),   K u1 = f,   f(v) = int rho P(x - c).v

as for the shells on charts (`shell/prestress.py`); those of an imported shell are in `shell_spin.py`. Where the
quadratic strains of Omega^2 u1 pass `LARGE` of the linear ones, the steady state of a solid is found on the deformed
shape instead (`solid_spin.py`), and K(Omega) is its tangent.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.sparse import csc_array, diags_array, kron

from casingfem.errors import ModelError
from casingfem.io.arrays import FloatArray
from casingfem.linalg.factor import solve_held
from casingfem.structure.geometry.rotation import Rotation
from casingfem.structure.imported.assembly import MeshSystem, cell_dofs, on_free, scatter
from casingfem.structure.shell.prestress import Spin

LARGE = 0.01  # quadratic strains over linear ones: from which the steady shape is iterated


class Inertia(NamedTuple):
    """Inertia of the cells (cells, m, m): mass, spin softening at 1 rad/s, gyroscopic; and P(x - c) at the nodes."""

    mass: FloatArray
    softening: FloatArray
    gyroscopic: FloatArray
    away: FloatArray  # (nodes, dofs)


class Stiffening(NamedTuple):
    """Stiffness that a static state adds to the cells (cells, m, m): to first order, to second, and the strains' ratio.

    `ratio`: root of the energy of the quadratic strains over that of the linear ones.
    """

    first: FloatArray
    second: FloatArray
    ratio: float


@dataclass(frozen=True, eq=False)
class MeshSpin(Spin):
    """What rotation at 1 rad/s adds to the matrices of an imported part at rest, on its free dofs.

    Attributes
    ----------
    steady
        Speed [rad/s] -> stiffness that the steady state on the deformed shape adds; None for shells.
    """

    steady: Callable[[float], csc_array] | None = None

    def stiffness(self, omega: float) -> csc_array:
        """What a speed [rad/s] adds to K at rest: of a solid in fast rotation that of its steady state."""
        if self.steady is not None and omega**2 * self.nonlinear > LARGE:
            return self.steady(omega)
        return super().stiffness(omega)


def mesh_spin(
    system: MeshSystem,
    rotation: Rotation,
    inertia: Callable[[Rotation], Inertia],
    stiffening: Callable[[FloatArray], Stiffening],
) -> MeshSpin:
    """What rotation about an axis adds to a part assembled at rest; its speed is not used.

    Parameters
    ----------
    inertia
        Inertia of the cells about an axis.
    stiffening
        Nodal fields (nodes, dofs) -> what their stress and strain add to the stiffness of the cells.

    Raises
    ------
    ModelError
        `static-loose` if the centrifugal force drives a rigid motion that is not held.
    """
    rows = cell_dofs(system.structure.mesh.cells, system.dofs)
    size = system.dofs * len(system.points)
    of, hung = inertia(rotation), point_inertia(system, rotation)
    force = (scatter(of.mass, rows, size) + hung.mass) @ of.away.ravel()
    fields = system.expand(tied_solution(system, system.K, force[system.free], solve_held)[:, None])[:, :, 0]
    added = stiffening(fields)

    def placed(cells: FloatArray) -> csc_array:
        return on_free(scatter(cells, rows, size), system.free)

    gyroscopic = csc_array(scatter(of.gyroscopic, rows, size) + hung.gyroscopic)
    return MeshSpin(
        K1=csc_array(placed(added.first - of.softening) - on_free(hung.softening, system.free)),
        K2=placed(added.second),
        G=csc_array(gyroscopic[:, system.free][system.free]),
        fields=fields,
        nonlinear=added.ratio,
    )


class PointInertia(NamedTuple):
    """The same of the point masses on all dofs of the nodes, (dofs, dofs): mass, softening, gyroscopic."""

    mass: csc_array
    softening: csc_array
    gyroscopic: csc_array


def point_inertia(system: MeshSystem, rotation: Rotation) -> PointInertia:
    """Inertia of the point masses about an axis.

    Raises
    ------
    ModelError
        `mesh-attachment` for connections, and masses that turn: their second-order motions are not computed.
    """
    mesh = system.structure.mesh
    if system.lift is not None or any(mass.turns for mass in mesh.attachments.masses):
        raise ModelError("mesh-attachment", f"{mesh.source}: rotation of a part with {mesh.attachments}")
    masses = np.zeros(len(mesh.points))
    for mass in mesh.attachments.masses:
        masses[mass.node] += mass.mass

    def placed(B: FloatArray) -> csc_array:
        whole = np.zeros((system.dofs, system.dofs))
        whole[:3, :3] = B
        return csc_array(kron(diags_array(masses), whole))

    turn = np.cross(rotation.direction, np.eye(3)).T
    return PointInertia(placed(np.eye(3)), placed(rotation.plane), placed(2.0 * turn))


def tied_solution(
    system: MeshSystem, K: csc_array, force: FloatArray, solve: Callable[[csc_array, FloatArray], FloatArray]
) -> FloatArray:
    """K u = f on the free dofs, among the motions that the system admits."""
    if system.tie is None:
        return solve(K, force)
    T = system.tie
    return np.asarray(T @ solve(csc_array(T.T @ K @ T), T.T @ force))


def spun(system: MeshSystem, added: MeshSpin, omega: float) -> MeshSystem:
    """A system at rest with the stiffness of a speed."""
    return replace(system, K=csc_array(system.K + added.stiffness(omega)))
