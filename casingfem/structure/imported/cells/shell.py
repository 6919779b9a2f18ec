"""Cells of a shell: directors and frames at the nodes, stiffness with tied strains, mass.

The wall is that of `structure.shell.wall`, curved or linear, or of layers. Its curvature is that of the directors. At a
kink of the mesh they turn within the cells beside it, and the wall x + z n is mitred there as a solid one is; so the
metric through the wall is right at kinks too. Where cells are so short that it would be bent more sharply than it is
thick, it is taken as bent with its thickness as the radius.
"""

from collections.abc import Iterator
from typing import Protocol

import numpy as np

from casingfem.io.arrays import FloatArray, IntArray
from casingfem.structure.imported.cells.mapped import shape_products
from casingfem.structure.imported.cells.scatter import CHUNK, put
from casingfem.structure.imported.cells.tying import tied_strains
from casingfem.structure.imported.mesh.cell_kind import KINDS, shape_functions
from casingfem.structure.imported.mesh.mesh_data import MeshData, natives
from casingfem.structure.material import Material, plane_stress
from casingfem.structure.shell.plies import Ply, layered_wall
from casingfem.structure.shell.wall import curved_wall, linear_wall

DOFS = 5
NEAR = 0.7  # least cosine between tied walls of which one takes the other's director


class ShellCells(Protocol):
    """What the cells of a shell ask of it."""

    @property
    def mesh(self) -> MeshData:
        """Its mesh."""

    @property
    def shear_correction(self) -> float | None:
        """Factor of the transverse shear stiffness; None for 5/(6 - nu)."""

    @property
    def wall(self) -> str:
        """Curved or linear."""

    @property
    def plies(self) -> tuple[Ply, ...]:
        """Layers along the normals of the cells; none of a wall of one material."""

    @property
    def material(self) -> Material:
        """Its material, that of plies without a lamina."""

    @property
    def fibres(self) -> FloatArray | None:
        """Direction from which the plies' angles count, (3,); None without plies."""

    def walls(self) -> FloatArray:
        """Thickness, E, nu, rho of each cell, (4, cells)."""

    def inertia(self) -> FloatArray:
        """Mass and rotary inertia per area of each cell, (2, cells)."""


def cell_normals(mesh: MeshData) -> FloatArray:
    """Unit normals of each cell at its nodes, (cells, nodes, 3); 0 where a six-noded triangle has a node again."""
    found = np.zeros((*mesh.cells.shape, 3))
    for kind, rows, slots in natives(mesh):
        _, slopes = shape_functions(kind, np.ascontiguousarray(KINDS[kind].places.T))
        tangents = np.einsum("dkq,ekc->deqc", slopes, mesh.points[mesh.cells[rows][:, slots]])
        normals = np.cross(tangents[0], tangents[1])
        size = np.linalg.norm(normals, axis=2, keepdims=True)
        if not size.all():  # squares collapsed to triangles, which have one normal
            normals = np.where(size > 0.0, normals, normals.sum(axis=1, keepdims=True))
            size = np.linalg.norm(normals, axis=2, keepdims=True)
        found[rows[:, None], slots] = normals / size
    return found


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


def stiffness(shell: ShellCells, normals: FloatArray, frames: FloatArray, only: IntArray | None = None) -> FloatArray:
    """Stiffness of each cell, or of some by their numbers, (cells, 5 nodes, 5 nodes), dofs node by node."""
    mesh = shell.mesh
    numbers = np.arange(len(mesh.cells)) if only is None else only
    whole = DOFS * mesh.cell_kind.nodes
    matrices = np.zeros((len(numbers), whole, whole))
    for kind, rows, slots in chunks(mesh, numbers):
        cells = mesh.cells[numbers[rows]][:, slots]
        strains, measure, b = tied_strains(kind, mesh.points[cells], normals[cells], frames[cells], shell.fibres)
        D = wall_stiffness(shell, numbers[rows], b)
        root = np.linalg.cholesky(D).swapaxes(-1, -2)  # D = root^T root
        weighted = (root @ strains) * np.sqrt(measure)[:, :, None, None]
        flat = weighted.reshape(len(cells), -1, DOFS * len(slots))
        put(matrices, rows, slots, flat.transpose(0, 2, 1) @ flat, DOFS)
    return matrices


def chunks(mesh: MeshData, numbers: IntArray) -> Iterator[tuple[str, IntArray, IntArray]]:
    """Cells of some numbers, so many at a time that their strains fit into memory: kind, which of them, own nodes."""
    for kind, rows, slots in natives(mesh, mesh.cells[numbers]):
        step = max(1, CHUNK // (20 * 8 * DOFS * len(slots)))
        for start in range(0, len(rows), step):
            yield kind, rows[start : start + step], slots


def wall_stiffness(shell: ShellCells, part: IntArray, b: FloatArray) -> FloatArray:
    """Resultants of the strains (eps, chi, gamma) in the frame of `tied_strains`, (cells, q or 1, 8, 8).

    Of some cells with curvature b (3, cells, q); a linear wall is the same at all points of a cell.
    """
    t, E, nu, _ = shell.walls()[:, part, None]
    usual = 5.0 / (6.0 - nu) if shell.wall == "curved" else 5.0 / 6.0
    factor = np.full_like(nu, usual if shell.shear_correction is None else shell.shear_correction)
    shear = factor * E / (2.0 * (1.0 + nu))
    if shell.plies:
        D = layered_wall(shell.plies, shell.material, E, nu, t, factor)
    elif shell.wall == "linear":
        D = linear_wall(plane_stress(E, nu), shear, t)
    else:
        E, nu, shear, t = (np.broadcast_to(value, b.shape[1:]) for value in (E, nu, shear, t))
        sharpest = t * (0.5 * np.abs(b[0] + b[1]) + np.hypot(0.5 * (b[0] - b[1]), b[2]))
        D = curved_wall(E, nu, shear, t, b / np.maximum(sharpest, 1.0))
    return np.asarray(np.moveaxis(D, (0, 1), (-2, -1)))


def consistent_mass(shell: ShellCells, frames: FloatArray) -> FloatArray:
    """Mass of each cell, (cells, 5 nodes, 5 nodes): u.v and w.w by `ShellCells.inertia`."""
    mesh = shell.mesh
    products, _ = shape_products(mesh.points, mesh.cells, natives(mesh))
    moved, turned = shell.inertia()[:, :, None, None] * products
    return five_dofs(moved, turned, frames[mesh.cells])


def five_dofs(moved: FloatArray, turned: FloatArray, frames: FloatArray) -> FloatArray:
    """Matrices (cells, 5 k, 5 k) from scalar ones (cells, k, k) on u.v and on w.w, tangents (cells, k, 2, 3)."""
    cells, k = moved.shape[:2]
    matrices = np.zeros((cells, k, DOFS, k, DOFS))
    for i in range(3):
        matrices[:, :, i, :, i] = moved
    along = np.einsum("eiac,ejbc->eiajb", frames, frames)
    matrices[:, :, 3:, :, 3:] = turned[:, :, None, :, None] * along
    return matrices.reshape(cells, DOFS * k, DOFS * k)
