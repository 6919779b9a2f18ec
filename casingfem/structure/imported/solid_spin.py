"""Rotating solids: prestress of the linear state, and the steady state on the deformed shape by Newton's method.

    int E'(u; v) : C : E(u) = Omega^2 int rho P(x + u - c).v   for all v

with Green's strain E and the stiffness C of the material (St. Venant-Kirchhoff): large rotations, small strains. Its
tangent is material, stress and spin softening. (Bathe, Finite Element Procedures, 1996, ch. 6.)
"""

from collections.abc import Iterator

import numpy as np
from scipy.sparse import csc_array

from casingfem.errors import NumericsError
from casingfem.io.arrays import FloatArray
from casingfem.linalg.factor import factorise
from casingfem.structure.geometry.rotation import Rotation
from casingfem.structure.imported.assembly import CHUNK, Mapped, MeshSystem, cell_dofs, mapped, on_free, scatter
from casingfem.structure.imported.cells.solid import VOIGT, SolidCells, consistent_mass, elasticity, strain_table
from casingfem.structure.imported.spin import Inertia, MeshSpin, Stiffening, mesh_spin, point_inertia, tied_solution

STEPS, SETTLED = 30, 1e-9  # Newton's steps at most; relative size of the last one


def solid_spin(system: MeshSystem, solid: SolidCells, rotation: Rotation) -> MeshSpin:
    """What rotation adds to a solid assembled at rest.

    Raises
    ------
    ModelError
        `static-loose` if the centrifugal force drives a rigid motion that is not held.
    """
    on, constants = mapped(solid.mesh.kind, solid.mesh.points, solid.mesh.cells), solid.constants()
    linear = mesh_spin(
        system,
        rotation,
        lambda axis: solid_inertia(solid, on, constants[2], axis),
        lambda fields: solid_stiffening(solid, on, constants, fields),
    )

    def steady(omega: float) -> csc_array:
        return steady_stiffness(system, solid, rotation.at(omega), omega**2 * linear.fields)

    return MeshSpin(linear.K1, linear.K2, linear.G, linear.fields, linear.nonlinear, steady)


def solid_inertia(solid: SolidCells, on: Mapped, rho: FloatArray, rotation: Rotation) -> Inertia:
    """Inertia of the cells about an axis."""
    P, a = rotation.plane, rotation.direction
    turn = np.cross(a, np.eye(3)).T  # turn v = a x v
    return Inertia(
        mass=consistent_mass(on, rho),
        softening=consistent_mass(on, rho, P),
        gyroscopic=2.0 * consistent_mass(on, rho, turn),
        away=(solid.mesh.points - np.asarray(rotation.centre)) @ P,
    )


def batches(solid: SolidCells, on: Mapped, fields: FloatArray) -> Iterator[tuple[slice, FloatArray, FloatArray]]:
    """Cells in batches: dN/dx (cells, q, 3, nodes) and du_k/dx_i (cells, q, 3 k, 3 i)."""
    nodes, points = on.values.shape
    step = max(1, CHUNK // (points * 6 * nodes * 3))
    for start in range(0, len(solid.mesh.cells), step):
        part = slice(start, start + step)
        slopes = np.linalg.inv(on.tangents[part]) @ on.slopes.transpose(2, 0, 1)
        moved = fields[solid.mesh.cells[part]].transpose(0, 2, 1)
        yield part, slopes, moved[:, None] @ slopes.swapaxes(2, 3)


def geometric(slopes: FloatArray, stress: FloatArray) -> FloatArray:
    """Int stress_ij dN_a/dx_i dN_b/dx_j of cells, the same in each direction, (cells, 3 nodes, 3 nodes).

    Stress by `VOIGT` with the weights of the quadrature, (cells, q, 6).
    """
    tensor = np.zeros((*stress.shape[:2], 3, 3))
    for k, (i, j) in enumerate(VOIGT):
        tensor[..., i, j] = tensor[..., j, i] = stress[..., k]
    scalar = (slopes.swapaxes(2, 3) @ (tensor @ slopes)).sum(axis=1)
    cells, nodes = scalar.shape[:2]
    return np.asarray(np.einsum("cab,kl->cakbl", scalar, np.eye(3)).reshape(cells, 3 * nodes, 3 * nodes))


def products(left: FloatArray, right: FloatArray) -> FloatArray:
    """Sum over points and strains of left^T right: tables (cells, q, 6, m) -> (cells, m, m)."""
    cells, _, _, m = left.shape
    return np.asarray(left.reshape(cells, -1, m).transpose(0, 2, 1) @ right.reshape(cells, -1, m))


def solid_stiffening(solid: SolidCells, on: Mapped, constants: FloatArray, fields: FloatArray) -> Stiffening:
    """What a static state adds to the stiffness of the cells."""
    D, m = elasticity(constants)[:, None], 3 * solid.mesh.cells.shape[1]
    first, second = np.empty((2, len(solid.mesh.cells), m, m))
    bowed = strained = 0.0
    for part, slopes, gradient in batches(solid, on, fields):
        weight = on.measure[part][:, :, None]
        moved = fields[solid.mesh.cells[part]].reshape(len(slopes), 1, m, 1)
        B, quadratic = strain_table(slopes), strain_table(slopes, gradient)
        strain, bow = (B @ moved)[..., 0], 0.5 * (quadratic @ moved)[..., 0]
        stress = (D[part] @ strain[..., None])[..., 0] * weight
        pulled = D[part] @ quadratic * weight[..., None]
        cross = products(B, pulled)
        first[part] = geometric(slopes, stress) + cross + cross.transpose(0, 2, 1)
        second[part] = products(quadratic, pulled)
        strained += float((stress * strain).sum())
        bowed += float(((D[part] @ bow[..., None])[..., 0] * bow * weight).sum())
    return Stiffening(first, second, float(np.sqrt(bowed / strained)) if strained > 0.0 else 0.0)


def steady_stiffness(system: MeshSystem, solid: SolidCells, rotation: Rotation, start: FloatArray) -> csc_array:
    """What the steady state at a speed adds to the stiffness at rest: the tangent there, spin softening included.

    `start`: displacements to begin with, (nodes, 3).

    Raises
    ------
    NumericsError
        If Newton's method does not settle: the part leaves its shape at this speed.
    """
    mesh, omega = solid.mesh, rotation.omega
    on, constants = mapped(mesh.kind, mesh.points, mesh.cells), solid.constants()
    rows, size = cell_dofs(mesh.cells, 3), 3 * len(mesh.points)
    of = solid_inertia(solid, on, constants[2], rotation)
    hung = point_inertia(system, rotation)
    soft = omega**2 * (scatter(of.softening, rows, size) + hung.softening)
    pull = omega**2 * ((scatter(of.mass, rows, size) + hung.mass) @ of.away.ravel())
    at_rest = on_free(tangent(solid, on, constants, np.zeros_like(start))[0], system.free)
    springs = csc_array(system.K - at_rest)
    fields = start.copy()
    for _ in range(STEPS):
        K, inner = tangent(solid, on, constants, fields)
        K = csc_array(on_free(csc_array(K - soft), system.free) + springs)
        free = fields.ravel()[system.free]
        residual = (pull + soft @ fields.ravel() - inner)[system.free] - springs @ free
        step = tied_solution(system, K, residual, lambda K, f: factorise(K).solve(f))
        fields = fields + system.expand(step[:, None])[:, :, 0]
        if np.linalg.norm(step) <= SETTLED * np.linalg.norm(fields):
            K, _ = tangent(solid, on, constants, fields)
            return csc_array(on_free(csc_array(K - soft), system.free) - at_rest)
    raise NumericsError(
        f"rotation: found no steady state at {omega / (2.0 * np.pi):.4g} turns a second in {STEPS} steps"
    )


def tangent(solid: SolidCells, on: Mapped, constants: FloatArray, fields: FloatArray) -> tuple[csc_array, FloatArray]:
    """Tangent stiffness and inner forces of a deformed solid, on all dofs."""
    D, m = elasticity(constants)[:, None], 3 * solid.mesh.cells.shape[1]
    rows, size = cell_dofs(solid.mesh.cells, 3), 3 * len(solid.mesh.points)
    matrices, forces = np.empty((len(solid.mesh.cells), m, m)), np.empty((len(solid.mesh.cells), m))
    for part, slopes, gradient in batches(solid, on, fields):
        weight = on.measure[part][:, :, None]
        deformation = gradient + np.eye(3)
        stretch = deformation.swapaxes(2, 3) @ deformation - np.eye(3)
        strain = np.stack([stretch[..., i, j] * (0.5 if i == j else 1.0) for i, j in VOIGT], axis=-1)
        stress = (D[part] @ strain[..., None])[..., 0] * weight
        B = strain_table(slopes, deformation)
        matrices[part] = products(B, D[part] @ B * weight[..., None]) + geometric(slopes, stress)
        forces[part] = np.einsum("cqsm,cqs->cm", B, stress)
    inner = np.zeros(size)
    np.add.at(inner, rows, forces)
    return scatter(matrices, rows, size), inner
