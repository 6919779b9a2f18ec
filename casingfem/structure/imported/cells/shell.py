"""Cells of a shell: directors and frames at the nodes, stiffness with tied strains, mass.

The wall is that of `structure.shell.wall`, curved or linear, or of layers. Its curvature is that of the directors. At a
kink of the mesh they vary within the adjacent cells, and the wall x + z n is mitred like a solid one, so the metric
through the wall is also correct at kinks. In very short cells the radius of curvature is limited to the thickness.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

from casingfem.io.arrays import FloatArray, IntArray
from casingfem.structure.geometry.rotation import Rotation, Vector
from casingfem.structure.imported.cells.mapped import CHUNK, put
from casingfem.structure.imported.cells.support import MeshSupport, by_group, constants_of
from casingfem.structure.imported.cells.tying import surface, tied_strains
from casingfem.structure.imported.mesh.cell_kind import rule
from casingfem.structure.imported.mesh.mesh_data import MeshData, natives
from casingfem.structure.imported.mesh.walls import Apart, mean_normals, walls_apart
from casingfem.structure.material import Material, plane_stress
from casingfem.structure.shell.plies import Ply, layered_inertia, layered_wall
from casingfem.structure.shell.wall import curved_inertia, curved_wall, linear_wall

DOFS = 5
NEAR = 0.7  # least cosine between tied walls of which one takes the other's director


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ShellCells:
    """The fields of a `MeshShell` that its cells need; they are not checked here."""

    mesh: MeshData
    thickness: float
    material: Material
    supports: Mapping[str, MeshSupport] = field(default_factory=dict)
    shear_correction: float | None = None
    rotation: Rotation | None = None
    thicknesses: Mapping[str, float] = field(default_factory=dict)
    materials: Mapping[str, Material] = field(default_factory=dict)
    wall: str = "curved"
    plies: tuple[Ply, ...] = ()
    angle_from: Vector = (0.0, 0.0, 1.0)
    apart: Apart = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "apart", walls_apart(self.mesh))

    def walls(self) -> FloatArray:
        """Thickness, E, nu, rho of each cell, (4, cells)."""
        t = by_group(self.mesh, (self.thickness,), {name: (value,) for name, value in self.thicknesses.items()})
        own = {name: constants_of(material) for name, material in self.materials.items()}
        return np.concatenate([t, by_group(self.mesh, constants_of(self.material), own)])

    @property
    def fibres(self) -> FloatArray | None:
        """Direction from which the plies' angles count, (3,); None without plies."""
        return np.asarray(self.angle_from, dtype=float) if self.plies else None

    def inertia(self, part: IntArray, b: FloatArray) -> FloatArray:
        """Moments of the wall's mass per area, (3, cells, q or 1) [kg/m^2, kg/m, kg], of some cells.

        b (3, cells, q) is their curvature; a linear wall is the same at all points of a cell.
        """
        t, _, _, rho = self.walls()[:, part, None]
        if self.plies:
            return np.asarray(layered_inertia(self.plies, self.material, rho, t))
        if self.wall == "linear":
            return np.stack([rho * t, 0.0 * rho * t, rho * t**3 / 12.0])
        b = no_sharper(b, t)
        return np.asarray(curved_inertia(rho, t, 0.5 * (b[0] + b[1]), b[0] * b[1] - b[2] ** 2))


def directors(mesh: MeshData) -> FloatArray:
    """Unit normals at the nodes: the mesh's own, or the mean over their cells, (nodes, 3); z for nodes without cells.

    A tied node has the director of the wall that it follows, interpolated by the wall's shape functions.
    """
    if mesh.directors is not None:
        return mesh.directors
    normals = mean_normals(mesh)
    normals[~normals.any(axis=1)] = [0.0, 0.0, 1.0]
    for tie in mesh.attachments.glued:
        other = np.einsum("ik,ikc->ic", tie.weights, normals[tie.others])
        other /= np.linalg.norm(other, axis=1, keepdims=True)
        near = np.einsum("ic,ic->i", other, normals[tie.nodes]) > NEAR
        normals[tie.nodes[near]] = other[near]
    return normals


def tangent_frames(normals: FloatArray) -> FloatArray:
    """Two tangents e1, e2 = n x e1 at each node, (nodes, 2, 3)."""
    e1 = np.cross(np.eye(3)[np.abs(normals).argmin(axis=1)], normals)
    e1 /= np.linalg.norm(e1, axis=1, keepdims=True)
    return np.stack([e1, np.cross(normals, e1)], axis=1)


def stiffness(shell: ShellCells, normals: FloatArray, frames: FloatArray, only: IntArray | None = None) -> FloatArray:
    """Stiffness of each cell, or of some by index, (cells, 5 nodes, 5 nodes), dofs node by node."""
    mesh = shell.apart.mesh
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
    """Chunks of cells whose strains fit into memory: kind, cells, own nodes."""
    for kind, rows, slots in natives(mesh, mesh.cells[numbers]):
        step = max(1, CHUNK // (20 * 8 * DOFS * len(slots)))
        for start in range(0, len(rows), step):
            yield kind, rows[start : start + step], slots


def wall_stiffness(shell: ShellCells, part: IntArray, b: FloatArray) -> FloatArray:
    """Resultants of the strains (eps, chi, gamma) in the frame of `tied_strains`, (cells, q or 1, 8, 8).

    For some cells, whose curvature is b (3, cells, q); a linear wall is the same at all points of a cell.
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
        D = curved_wall(E, nu, shear, t, no_sharper(b, t))
    return np.asarray(np.moveaxis(D, (0, 1), (-2, -1)))


def no_sharper(b: FloatArray, t: FloatArray) -> FloatArray:
    """Curvature b (3, ...) limited to radii of at least the thickness t."""
    sharpest = t * (0.5 * np.abs(b[0] + b[1]) + np.hypot(0.5 * (b[0] - b[1]), b[2]))
    return np.asarray(b / np.maximum(sharpest, 1.0))


def mass_moments(shell: ShellCells, normals: FloatArray) -> FloatArray:
    """Integrals of m_p N_i N_j over each cell, p = 0, 1, 2 (`ShellCells.inertia`), (3, cells, k, k)."""
    mesh = shell.apart.mesh
    whole = np.zeros((3, *mesh.cells.shape, mesh.cells.shape[1]))
    for kind, rows, slots in natives(mesh):
        cells, N = mesh.cells[rows][:, slots], rule(kind)[2]
        _, measure, b = surface(kind, mesh.points[cells], normals[cells])
        own = np.einsum("iq,jq,pmq->pmij", N, N, shell.inertia(rows, b) * measure, optimize=True)
        whole[:, rows[:, None, None], slots[:, None], slots] = own
    return whole


def consistent_mass(shell: ShellCells, normals: FloatArray, frames: FloatArray) -> FloatArray:
    """Mass of each cell, (cells, 5 nodes, 5 nodes): m0 u.v + m1 (u.y + v.w) + m2 w.y."""
    return five_dofs(mass_moments(shell, normals), frames[shell.apart.mesh.cells])


def five_dofs(moments: FloatArray, frames: FloatArray, B: FloatArray | None = None) -> FloatArray:
    """Matrices (cells, 5 k, 5 k) of forms v.B v that act on u, on u and w, and on w by `moments` (3, cells, k, k).

    w is along the tangents (cells, k, 2, 3) of the nodes; B (3, 3) is the identity by default.
    """
    _, cells, k, _ = moments.shape
    B = np.eye(3) if B is None else B
    motions = np.zeros((cells, k, DOFS, 3))  # what a dof moves: u, then w
    motions[:, :, :3], motions[:, :, 3:] = np.eye(3), frames
    pulled = motions @ B.T
    matrices = np.einsum("eiac,ejbc->eiajb", motions, pulled, optimize=True)
    u, w = slice(0, 3), slice(3, DOFS)
    for p, (a, b) in ((0, (u, u)), (1, (u, w)), (1, (w, u)), (2, (w, w))):
        matrices[:, :, a, :, b] *= moments[p][:, :, None, :, None]
    return np.asarray(matrices.reshape(cells, DOFS * k, DOFS * k))
