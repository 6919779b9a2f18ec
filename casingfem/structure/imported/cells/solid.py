"""Cells of a solid: strains over the dofs of the nodes, stiffness and consistent mass."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from casingfem.io.arrays import FloatArray, IntArray
from casingfem.structure.geometry.rotation import Rotation
from casingfem.structure.imported.cells.mapped import CHUNK, Mapped, mapped, put
from casingfem.structure.imported.cells.support import MeshSupport, by_group, constants_of
from casingfem.structure.imported.mesh.collapsed import native
from casingfem.structure.imported.mesh.mesh_data import MeshData
from casingfem.structure.material import Material

VOIGT = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))
COMPONENTS = ("xx", "yy", "zz", "yz", "xz", "xy")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SolidCells:
    """The fields of a `Solid` that its cells need; they are not checked here."""

    mesh: MeshData
    material: Material
    materials: Mapping[str, Material] = field(default_factory=dict)
    supports: Mapping[str, MeshSupport] = field(default_factory=dict)
    rotation: Rotation | None = None

    def constants(self) -> FloatArray:
        """E, nu, rho of each cell, (3, cells); a cell in two groups of `materials` is refused."""
        return by_group(self.mesh, constants_of(self.material), {g: constants_of(m) for g, m in self.materials.items()})


def cell_matrices(
    kind: str, points: FloatArray, cells: IntArray, *of: Callable[[Mapped, IntArray], FloatArray]
) -> list[FloatArray]:
    """Matrices of cells, (cells, 3 nodes, 3 nodes) each, by `of` (mapped cells, rows), kind by kind."""
    parts = list(native(kind, cells))
    if parts[0][0] == kind:
        on = mapped(kind, points, cells)
        return [make(on, parts[0][1]) for make in of]
    size = 3 * cells.shape[1]
    total = [np.zeros((len(cells), size, size)) for _ in of]
    for name, rows, slots in parts:
        on = mapped(name, points, cells[rows][:, slots])
        for matrices, make in zip(total, of, strict=True):
            put(matrices, rows, slots, make(on, rows), 3)
    return total


def cell_stiffness(kind: str, points: FloatArray, cells: IntArray, constants: FloatArray) -> FloatArray:
    """Stiffness of each cell, (cells, 3 nodes, 3 nodes), from the values E, nu, rho (3, cells)."""
    return cell_matrices(kind, points, cells, lambda on, rows: stiffness(on, constants[:, rows]))[0]


def stiffness(on: Mapped, constants: FloatArray) -> FloatArray:
    """Stiffness of each cell, (cells, 3 nodes, 3 nodes), dofs node by node."""
    root = np.linalg.cholesky(elasticity(constants))  # D = root root^T
    nodes, points = on.values.shape
    cells = constants.shape[1]
    matrices = np.empty((cells, 3 * nodes, 3 * nodes))
    step = max(1, CHUNK // (points * 6 * nodes * 3))
    for start in range(0, cells, step):
        part = slice(start, start + step)
        slopes = np.linalg.inv(on.tangents[part]) @ on.slopes.transpose(2, 0, 1)  # dN/dx, (cells, q, 3, nodes)
        B = strain_table(slopes) * np.sqrt(on.measure[part])[:, :, None, None]
        flat = (root[part].transpose(0, 2, 1)[:, None] @ B).reshape(len(slopes), points * 6, 3 * nodes)
        np.matmul(flat.transpose(0, 2, 1), flat, out=matrices[part])
    return matrices


def elasticity(constants: FloatArray) -> FloatArray:
    """Stiffness from strain to stress, both in the order of `COMPONENTS`, (cells, 6, 6), from E, nu, rho (3, cells)."""
    E, nu, _ = constants
    mu, lam = E / (2.0 * (1.0 + nu)), E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu))
    D = np.zeros((len(E), 6, 6))
    D[:, :3, :3] = lam[:, None, None]
    D[:, range(6), range(6)] += np.stack([2 * mu] * 3 + [mu] * 3, axis=1)
    return D


def strain_table(slopes: FloatArray, gradient: FloatArray | None = None) -> FloatArray:
    """Strains, `COMPONENTS`, over the dofs of a cell's nodes, (..., 6, 3 nodes), from dN/dx (..., 3, nodes).

    With a gradient F_ki (..., 3, 3) the table gives the strains of F^T grad v: for Green's strain about F, or for e2(u,
    v) with F = grad u.
    """
    *places, _, nodes = slopes.shape
    B = np.zeros((*places, 6, nodes, 3))
    for row, (i, j) in enumerate(VOIGT):
        for one, other in {(i, j), (j, i)}:
            if gradient is None:
                B[..., row, :, one] += slopes[..., other, :]
            else:
                B[..., row, :, :] += slopes[..., other, :, None] * gradient[..., None, :, one]
    return B.reshape(*places, 6, 3 * nodes)


def consistent_mass(on: Mapped, rho: FloatArray, block: FloatArray | None = None) -> FloatArray:
    """Mass of each cell, (cells, 3 nodes, 3 nodes), dofs node by node: int rho v.B u, B = `block` (3, 3) or 1."""
    nodes, points = on.values.shape
    products = (on.values[:, None] * on.values[None, :]).reshape(-1, points)
    scalar = ((on.measure * rho[:, None]) @ products.T).reshape(-1, nodes, nodes)
    matrices = np.zeros((len(rho), nodes, 3, nodes, 3))
    B = np.eye(3) if block is None else block
    for i, j in np.argwhere(B).tolist():
        matrices[:, :, i, :, j] = B[i, j] * scalar
    return matrices.reshape(len(rho), 3 * nodes, 3 * nodes)
