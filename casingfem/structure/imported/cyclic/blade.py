"""Stiffness of some cells of a sector: what the mistuning of its blade changes."""

import numpy as np
from scipy.sparse import csc_array

from casingfem.errors import ModelError
from casingfem.io.arrays import IntArray
from casingfem.structure.imported.assembly import MeshSystem
from casingfem.structure.imported.cells import shell as shell_cells
from casingfem.structure.imported.cells import solid as solid_cells
from casingfem.structure.imported.cells.scatter import cell_dofs, on_free, scatter
from casingfem.structure.imported.checks import check_groups
from casingfem.structure.imported.shell import MeshShell
from casingfem.structure.imported.solid import Solid


def blade_stiffness(structure: Solid | MeshShell, system: MeshSystem, group: str | None) -> csc_array:
    """Elastic stiffness of a group's cells, of all cells if left out, on the free dofs (free, free).

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
            raise ModelError("mesh-group-no-cells", f"{mesh.source}: blade {group!r}")
    nodes = mesh.cells[cells]
    if isinstance(structure, Solid):
        matrices = solid_cells.cell_stiffness(mesh.kind, mesh.points, nodes, structure.constants()[:, cells])
    else:
        normals = shell_cells.directors(mesh)
        matrices = shell_cells.stiffness(structure, normals, shell_cells.tangent_frames(normals), cells)
    size = system.dofs * len(mesh.points)
    return on_free(scatter(matrices, cell_dofs(nodes, system.dofs), size), system.free)
