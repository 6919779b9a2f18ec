"""Rotating solids: prestress of the linear state, and the steady state on the deformed shape by Newton's method.

    int E'(u; v) : C : E(u) = Omega^2 int rho P(x + u - c).v   for all v

with Green's strain E and the stiffness C of the material (St. Venant-Kirchhoff): large rotations, small strains. Its
tangent is material, stress and spin softening. (Bathe, Finite Element Procedures, 1996, ch. 6.)
"""

from collections.abc import Callable, Iterator
from functools import partial
from typing import NamedTuple

import numpy as np
from scipy.sparse import csc_array

from casingfem.errors import NumericsError
from casingfem.io.arrays import FloatArray, IntArray
from casingfem.linalg.factor import factorise
from casingfem.structure.geometry.rotation import Rotation
from casingfem.structure.imported.assembly import MeshSystem
from casingfem.structure.imported.attachments.turning import attached_spin
from casingfem.structure.imported.cells.mapped import (
    CHUNK,
    Mapped,
    cell_dofs,
    mapped,
    on_free,
    put,
    scatter,
    scatter_forces,
)
from casingfem.structure.imported.cells.solid import (
    VOIGT,
    SolidCells,
    cell_matrices,
    consistent_mass,
    elasticity,
    strain_table,
)
from casingfem.structure.imported.mesh.cell_kind import rule
from casingfem.structure.imported.mesh.collapsed import native
from casingfem.structure.imported.spin import Inertia, MeshSpin, MeshTurning, Stiffening, mesh_spin, tied_solution

STEPS, SETTLED = 30, 1e-9  # Newton's steps at most; relative size of the last one


def solid_spin(system: MeshSystem, solid: SolidCells, rotation: Rotation) -> MeshSpin:
    """Terms that rotation adds to a solid assembled at rest.

    Raises
    ------
    ModelError
        `static-loose` if the centrifugal force drives a rigid motion that is not restrained.
    """
    return mesh_spin(solid_turning(system, solid, rotation))


def solid_turning(system: MeshSystem, solid: SolidCells, rotation: Rotation) -> MeshTurning:
    """Data for the rotation of a solid: its system at rest, and an axis."""

    def steady(fields: FloatArray) -> Callable[[float], csc_array]:
        return lambda omega: steady_state(system, solid, rotation.at(omega), omega**2 * fields).stiffness

    return MeshTurning(
        system=system, rotation=rotation, inertia=solid_inertia(solid, rotation),
        stiffening=partial(solid_stiffening, solid),
        steady=None if system.lift is not None else steady,  # connections: in their shape at rest
    )  # fmt: skip


def solid_inertia(solid: SolidCells, rotation: Rotation) -> Inertia:
    """Inertia of the cells about an axis."""
    mesh, rho = solid.mesh, solid.constants()[2]
    P, a = rotation.plane, rotation.direction
    turn = np.cross(a, np.eye(3)).T  # turn v = a x v

    def of(block: FloatArray | None) -> Callable[[Mapped, IntArray], FloatArray]:
        return lambda on, rows: consistent_mass(on, rho[rows], block)

    mass, softening, coriolis = cell_matrices(mesh.kind, mesh.points, mesh.cells, of(None), of(P), of(turn))
    away = ((mesh.points - np.asarray(rotation.centre)) @ P)[mesh.cells].reshape(len(mesh.cells), -1, 1)
    return Inertia(softening=softening, gyroscopic=2.0 * coriolis, force=(mass @ away)[:, :, 0])


class Batch(NamedTuple):
    """Cells of one kind at their quadrature points.

    Rows of the mesh, their nodes (cells, k), and positions of these in the cell.

    dN/dx `slopes` (cells, q, 3, nodes), du_k/dx_i `gradient` (cells, q, 3 k, 3 i), weights (cells, q, 1), elasticity
    (cells, 1, 6, 6).
    """

    rows: IntArray
    nodes: IntArray
    slots: IntArray
    slopes: FloatArray
    gradient: FloatArray
    weight: FloatArray
    D: FloatArray

    def add(self, total: FloatArray, matrices: FloatArray) -> None:
        """Add matrices of the cells to the matrices of all cells, (cells, m, m)."""
        put(total, self.rows, self.slots, matrices, 3)


def batches(solid: SolidCells, fields: FloatArray) -> Iterator[Batch]:
    """The cells in batches, each of one kind."""
    mesh, D = solid.mesh, elasticity(solid.constants())[:, None]
    for kind, rows, slots in native(mesh.kind, mesh.cells):
        step = max(1, CHUNK // (rule(kind)[0].shape[1] * 6 * len(slots) * 3))
        for start in range(0, len(rows), step):
            part = rows[start : start + step]
            nodes = mesh.cells[part][:, slots]
            on = mapped(kind, mesh.points, nodes)
            slopes = np.linalg.inv(on.tangents) @ on.slopes.transpose(2, 0, 1)
            gradient = fields[nodes].transpose(0, 2, 1)[:, None] @ slopes.swapaxes(2, 3)
            yield Batch(part, nodes, slots, slopes, gradient, on.measure[:, :, None], D[part])


def geometric(slopes: FloatArray, stress: FloatArray) -> FloatArray:
    """Integral of stress_ij dN_a/dx_i dN_b/dx_j over cells, the same in each direction, (cells, 3 nodes, 3 nodes).

    `stress`, in the order of `VOIGT`, is multiplied by the quadrature weights, (cells, q, 6).
    """
    tensor = np.zeros((*stress.shape[:2], 3, 3))
    for k, (i, j) in enumerate(VOIGT):
        tensor[..., i, j] = tensor[..., j, i] = stress[..., k]
    scalar = (slopes.swapaxes(2, 3) @ (tensor @ slopes)).sum(axis=1)
    cells, nodes = scalar.shape[:2]
    return np.asarray(np.einsum("cab,kl->cakbl", scalar, np.eye(3)).reshape(cells, 3 * nodes, 3 * nodes))


def products(left: FloatArray, right: FloatArray) -> FloatArray:
    """Sum of left^T right over points and strains: tables (cells, q, 6, m) -> (cells, m, m)."""
    cells, _, _, m = left.shape
    return np.asarray(left.reshape(cells, -1, m).transpose(0, 2, 1) @ right.reshape(cells, -1, m))


def solid_stiffening(solid: SolidCells, fields: FloatArray) -> Stiffening:
    """Geometric stiffness of the cells in a static state."""
    m = 3 * solid.mesh.cells.shape[1]
    first, second = np.zeros((2, len(solid.mesh.cells), m, m))
    bowed = strained = 0.0
    for part in batches(solid, fields):
        moved = fields[part.nodes].reshape(len(part.nodes), 1, -1, 1)
        B, quadratic = strain_table(part.slopes), strain_table(part.slopes, part.gradient)
        strain, bow = (B @ moved)[..., 0], 0.5 * (quadratic @ moved)[..., 0]
        stress = (part.D @ strain[..., None])[..., 0] * part.weight
        pulled = part.D @ quadratic * part.weight[..., None]
        cross = products(B, pulled)
        part.add(first, geometric(part.slopes, stress) + cross + cross.transpose(0, 2, 1))
        part.add(second, products(quadratic, pulled))
        strained += float((stress * strain).sum())
        bowed += float(((part.D @ bow[..., None])[..., 0] * bow * part.weight).sum())
    return Stiffening(first, second, float(np.sqrt(bowed / strained)) if strained > 0.0 else 0.0)


class SteadyState(NamedTuple):
    """Displacements [m], (nodes, 3), and the tangent stiffness minus that at rest; spin softening is included."""

    fields: FloatArray
    stiffness: csc_array


def steady_state(system: MeshSystem, solid: SolidCells, rotation: Rotation, start: FloatArray) -> SteadyState:
    """The steady state at a speed, by Newton's method on the deformed shape.

    `start` are initial displacements, (nodes, 3).

    Raises
    ------
    NumericsError
        If Newton's method does not converge: the part has no steady shape at this speed.
    """
    mesh, omega = solid.mesh, rotation.omega
    rows, size = cell_dofs(mesh.cells, 3), 3 * len(mesh.points)
    of = solid_inertia(solid, rotation)
    soft, pull = scatter(of.softening, rows, size), scatter_forces(of.force, rows, size)
    if system.connected is not None:
        extra = attached_spin(system.connected.rows.motions, rotation)
        soft, pull = soft + extra.softening, pull + extra.force
    soft, pull = csc_array(omega**2 * soft), omega**2 * pull
    at_rest = on_free(tangent(solid, np.zeros_like(start))[0], system.free)
    springs = csc_array(system.K - at_rest)
    fields = start.copy()
    for _ in range(STEPS):
        K, inner = tangent(solid, fields)
        K = csc_array(on_free(csc_array(K - soft), system.free) + springs)
        free = fields.ravel()[system.free]
        residual = (pull + soft @ fields.ravel() - inner)[system.free] - springs @ free
        step = tied_solution(system, K, residual, lambda K, f: factorise(K).solve(f))
        fields = fields + system.expand(step[:, None])[:, :, 0]
        if np.linalg.norm(step) <= SETTLED * np.linalg.norm(fields):
            K, _ = tangent(solid, fields)
            return SteadyState(fields, csc_array(on_free(csc_array(K - soft), system.free) - at_rest))
    turns = omega / (2.0 * np.pi)
    found = (
        f"rotation: Newton's method found no steady state at {60.0 * turns:.4g} rpm ({turns:.4g} Hz) in {STEPS} steps"
    )
    raise NumericsError(f"{found}; use a lower speed")


def tangent(solid: SolidCells, fields: FloatArray) -> tuple[csc_array, FloatArray]:
    """Tangent stiffness and inner forces of a deformed solid, on all dofs."""
    mesh = solid.mesh
    m = 3 * mesh.cells.shape[1]
    rows, size = cell_dofs(mesh.cells, 3), 3 * len(mesh.points)
    matrices, inner = np.zeros((len(mesh.cells), m, m)), np.zeros(size)
    for part in batches(solid, fields):
        deformation = part.gradient + np.eye(3)
        stretch = deformation.swapaxes(2, 3) @ deformation - np.eye(3)
        strain = np.stack([stretch[..., i, j] * (0.5 if i == j else 1.0) for i, j in VOIGT], axis=-1)
        stress = (part.D @ strain[..., None])[..., 0] * part.weight
        B = strain_table(part.slopes, deformation)
        part.add(matrices, products(B, part.D @ B * part.weight[..., None]) + geometric(part.slopes, stress))
        np.add.at(inner, cell_dofs(part.nodes, 3), np.einsum("cqsm,cqs->cm", B, stress))
    return scatter(matrices, rows, size), inner
