"""The whole wheel made from one sector: mesh, joined at the faces, fields, and stiffness of the blades."""

from dataclasses import replace
from typing import Any

import numpy as np
from scipy.sparse import csc_array

from casingfem.errors import ModelError
from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.structure.imported.assembly import MeshSystem
from casingfem.structure.imported.cells.mapped import cell_dofs, on_free, scatter
from casingfem.structure.imported.cells.shell import directors, stiffness, tangent_frames
from casingfem.structure.imported.cells.solid import cell_stiffness
from casingfem.structure.imported.checks import check_groups
from casingfem.structure.imported.cyclic.sector import CyclicSector
from casingfem.structure.imported.mesh.mesh_data import Group, MeshData
from casingfem.structure.imported.shell import MeshShell
from casingfem.structure.imported.solid import Solid


def wheel_nodes(sector: CyclicSector) -> IntArray:
    """Number in the wheel of each node of each sector, (sectors, nodes).

    The high face of a sector is the next sector's low face.
    """
    count, (low, high) = len(sector.structure.mesh.points), sector.pairs
    own = low != high
    kept = np.ones(count, dtype=bool)
    kept[high] = False
    numbers = np.full((sector.sectors, count), -1)
    numbers[:, kept] = np.arange(sector.sectors * kept.sum()).reshape(sector.sectors, -1)
    numbers[:, high[own]] = np.roll(numbers[:, low[own]], -1, axis=0)
    numbers[:, low[~own]] = sector.sectors * kept.sum() + np.arange(np.count_nonzero(~own))
    return numbers


def wheel_mesh(sector: CyclicSector) -> MeshData:
    """The wheel's mesh, with cells and nodes sector by sector. A group contains the members of all sectors.

    The faces are no groups.
    """
    mesh, nodes, N = sector.structure.mesh, wheel_nodes(sector), sector.sectors
    points = np.empty((nodes.max() + 1, 3))
    for j in reversed(range(N)):  # the first sector's faces as they are
        points[nodes[j]] = sector.turn.places(mesh.points, j)
    step = len(mesh.cells)
    shift = step * np.arange(N)
    groups = {}
    for name, group in mesh.groups.items():
        if name in (sector.faces or ()):
            continue
        facets = None
        if group.facets is not None:
            owners = (group.facets[None, :, 0] + shift[:, None]).ravel()
            facets = np.stack([owners, np.tile(group.facets[:, 1], N)], axis=1)
        cells = (group.cells[None] + shift[:, None]).ravel()
        groups[name] = Group(nodes=nodes[:, group.nodes].ravel(), cells=cells, facets=facets)
    whole = nodes[:, mesh.cells].reshape(N * step, -1)
    return MeshData(kind=mesh.kind, points=points, cells=whole, groups=groups, source=f"wheel of {mesh.source}")


def wheel_structure(sector: CyclicSector) -> Solid | MeshShell:
    """The wheel as one structure."""
    whole: Any = replace(sector.structure, mesh=wheel_mesh(sector))
    return whole  # type: ignore[no-any-return]


def wheel_fields(sector: CyclicSector, fields: Array, n: IntArray, whole: MeshData) -> tuple[FloatArray, FloatArray]:
    """Real and imaginary part of z e^(2 pi i n j/N) for shapes z of sector 0, (wheel nodes, dofs, modes) each."""
    mesh, nodes, dofs = sector.structure.mesh, wheel_nodes(sector), fields.shape[1]
    found = np.empty((len(whole.points), dofs, fields.shape[2]), dtype=complex)
    R = np.eye(3)
    if dofs > 3:
        own, others = tangent_frames(directors(mesh)), tangent_frames(directors(whole))
        leaning = np.einsum("nac,nam->ncm", own, fields[:, 3:])
    for j in range(sector.sectors):
        phase = np.exp(1j * sector.turn.angle * j * n)
        found[nodes[j], :3] = np.einsum("cd,ndm,m->ncm", R, fields[:, :3], phase)
        if dofs > 3:
            found[nodes[j], 3:] = np.einsum("nac,cd,ndm,m->nam", others[nodes[j]], R, leaning, phase)
        R = sector.turn.matrix @ R
    return found.real, found.imag


def blade_stiffness(structure: Solid | MeshShell, system: MeshSystem, group: str | None) -> csc_array:
    """Elastic stiffness of a group's cells, by default of all cells, on the free dofs (free, free).

    Raises
    ------
    ModelError
        `mesh-no-group`, or `mesh-group-no-cells`.
    """
    mesh = structure.mesh
    if group is None:
        cells: IntArray = np.arange(len(mesh.cells))
    else:
        check_groups(mesh, [group])
        cells = mesh.groups[group].cells
        if not len(cells):
            raise ModelError("mesh-group-no-cells", f"{mesh.source}: found a blade group {group!r} without cells")
    nodes = mesh.cells[cells]
    if isinstance(structure, Solid):
        matrices = cell_stiffness(mesh.kind, mesh.points, nodes, structure.constants()[:, cells])
    else:
        normals = directors(mesh)
        matrices = stiffness(structure, normals, tangent_frames(normals), cells)
    return on_free(scatter(matrices, cell_dofs(nodes, system.dofs), system.dofs * len(mesh.points)), system.free)
