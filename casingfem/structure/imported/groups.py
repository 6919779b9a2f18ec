"""What groups of cells have of their own: materials, thicknesses."""

from collections.abc import Mapping

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import FloatArray
from casingfem.structure.imported.mesh.mesh_data import MeshData
from casingfem.structure.material import Material

Constants = tuple[float, ...]


def constants_of(material: Material) -> Constants:
    """E, nu, rho."""
    return (material.E, material.nu, material.rho)


def by_group(mesh: MeshData, common: Constants, own: Mapping[str, Constants]) -> FloatArray:
    """Numbers of each cell (numbers, cells): those of its group, or the common ones.

    Raises
    ------
    ModelError
        `mesh-group-no-cells`; `mesh-material-twice` for a cell in two groups with numbers of their own.
    """
    values = np.tile(np.array(common)[:, None], len(mesh.cells))
    owner = np.full(len(mesh.cells), "", dtype=object)
    for name, numbers in own.items():
        cells = mesh.groups[name].cells
        if not len(cells):
            raise ModelError("mesh-group-no-cells", f"{mesh.source}: material of group {name!r}")
        taken = cells[owner[cells] != ""]
        if len(taken):
            number = mesh.cell_numbers[taken[0]]
            found = f"cell {number} has the materials of {owner[taken[0]]!r} and {name!r}"
            raise ModelError("mesh-material-twice", f"{mesh.source}: {found}")
        owner[cells] = name
        values[:, cells] = np.array(numbers)[:, None]
    return values
