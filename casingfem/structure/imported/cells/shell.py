"""Cells of a shell: directors and frames at the nodes, stiffness with tied strains, mass."""

from typing import Protocol

import numpy as np

from casingfem.io.arrays import FloatArray
from casingfem.structure.imported.assembly import CHUNK, mapped
from casingfem.structure.imported.cell_kind import shape_functions
from casingfem.structure.imported.mesh_data import MeshData
from casingfem.structure.imported.tying import tied_strains

DOFS = 5
NEAR = 0.7  # least cosine between tied walls of which one takes the other's director


class ShellCells(Protocol):
    """What the cells of a shell ask of it."""

    @property
    def mesh(self) -> MeshData:
        """Its mesh."""
        ...

    @property
    def shear_correction(self) -> float | None:
        """Factor of the transverse shear stiffness; None for 5/(6 - nu)."""
        ...

    def walls(self) -> FloatArray:
        """Thickness, E, nu, rho of each cell, (4, cells)."""
        ...


def cell_normals(mesh: MeshData) -> FloatArray:
    """Unit normals of each cell at its nodes, (cells, nodes, 3)."""
    _, slopes = shape_functions(mesh.kind, np.ascontiguousarray(mesh.cell_kind.places.T))
    tangents = np.einsum("dkq,ekc->deqc", slopes, mesh.points[mesh.cells])
    normals = np.cross(tangents[0], tangents[1])
    size = np.linalg.norm(normals, axis=2, keepdims=True)
    if mesh.collapsed.any():  # to triangles, which have one normal
        normals = np.where(size > 0.0, normals, normals.sum(axis=1, keepdims=True))
        size = np.linalg.norm(normals, axis=2, keepdims=True)
    return np.asarray(normals / size)


def directors(mesh: MeshData) -> FloatArray:
    """Unit normals at the nodes: the mesh's own, or the mean over their cells, (nodes, 3); z where no cell is.

    Nodes that are tied have that of the wall which they follow, as its shape functions give it.
    """
    if mesh.directors is not None:
        return mesh.directors
    total = np.zeros_like(mesh.points)
    np.add.at(total, mesh.cells, cell_normals(mesh))
    size = np.linalg.norm(total, axis=1, keepdims=True)
    normals = np.where(size > 0.0, total / np.maximum(size, np.finfo(float).tiny), [0.0, 0.0, 1.0])
    for tie in mesh.attachments.glued:
        other = np.einsum("ik,ikc->ic", tie.weights, normals[tie.others])
        other /= np.linalg.norm(other, axis=1, keepdims=True)
        near = np.einsum("ic,ic->i", other, normals[tie.nodes]) > NEAR
        normals[tie.nodes[near]] = other[near]
    return normals


def tangent_frames(normals: FloatArray) -> FloatArray:
    """Two tangents e1, e2 = n x e1 at each node, (nodes, 2, 3)."""
    axis = np.eye(3)[np.abs(normals).argmin(axis=1)]
    e1 = np.cross(axis, normals)
    e1 /= np.linalg.norm(e1, axis=1, keepdims=True)
    return np.stack([e1, np.cross(normals, e1)], axis=1)


def stiffness(shell: ShellCells, normals: FloatArray, frames: FloatArray) -> FloatArray:
    """Stiffness of each cell, (cells, 5 nodes, 5 nodes), dofs node by node."""
    mesh = shell.mesh
    root = np.linalg.cholesky(wall_stiffness(shell)).transpose(0, 2, 1)  # D = root^T root
    size = DOFS * mesh.cell_kind.nodes
    matrices = np.empty((len(mesh.cells), size, size))
    step = max(1, CHUNK // (20 * 8 * size))
    for start in range(0, len(mesh.cells), step):
        cells = mesh.cells[start : start + step]
        strains, measure = tied_strains(mesh.kind, mesh.points[cells], normals[cells], frames[cells])
        weighted = (root[start : start + step, None] @ strains) * np.sqrt(measure)[:, :, None, None]
        flat = weighted.reshape(len(cells), -1, size)
        np.matmul(flat.transpose(0, 2, 1), flat, out=matrices[start : start + step])
    return matrices


def wall_stiffness(shell: ShellCells) -> FloatArray:
    """Resultants of the strains (eps, chi, gamma) along orthonormal tangents of each cell, (cells, 8, 8).

    The linear wall of `structure.shell.wall`: directors follow kinks of a mesh, where a metric through the wall would
    take their turn for curvature.
    """
    t, E, nu, _ = shell.walls()
    shear = 5.0 / (6.0 - nu) if shell.shear_correction is None else shell.shear_correction
    C = np.zeros((3, 3, len(t)))
    C[0, 0] = C[1, 1] = E / (1.0 - nu**2)
    C[0, 1] = C[1, 0] = nu * C[0, 0]
    C[2, 2] = E / (2.0 * (1.0 + nu))
    D = np.zeros((len(t), 8, 8))
    D[:, :3, :3], D[:, 3:6, 3:6] = (t * C).transpose(2, 0, 1), (t**3 / 12.0 * C).transpose(2, 0, 1)
    D[:, 6, 6] = D[:, 7, 7] = shear * C[2, 2] * t
    return D


def consistent_mass(shell: ShellCells, frames: FloatArray) -> FloatArray:
    """Mass of each cell, (cells, 5 nodes, 5 nodes): rho t u.v + rho t^3/12 w.w."""
    mesh = shell.mesh
    on = mapped(mesh.kind, mesh.points, mesh.cells)
    products = np.einsum("iq,jq,eq->eij", on.values, on.values, on.measure, optimize=True)
    t, _, _, rho = shell.walls()[:, :, None, None]
    return five_dofs(rho * t * products, rho * t**3 / 12.0 * products, frames[mesh.cells])


def five_dofs(moved: FloatArray, turned: FloatArray, frames: FloatArray) -> FloatArray:
    """Matrices (cells, 5 k, 5 k) from scalar ones (cells, k, k) on u.v and on w.w, tangents (cells, k, 2, 3)."""
    cells, k = moved.shape[:2]
    matrices = np.zeros((cells, k, DOFS, k, DOFS))
    for i in range(3):
        matrices[:, :, i, :, i] = moved
    along = np.einsum("eiac,ejbc->eiajb", frames, frames)
    matrices[:, :, 3:, :, 3:] = turned[:, :, None, :, None] * along
    return matrices.reshape(cells, DOFS * k, DOFS * k)
