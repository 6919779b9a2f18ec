"""Properties of groups of an imported mesh: supports, materials, thicknesses.

A support fixes directions; `Clamped` and `ElasticEdge(k_face=...)` can be used too.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Literal, TypeAlias

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import FloatArray
from casingfem.structure.edge.support import Clamped, ElasticEdge
from casingfem.structure.imported.mesh.mesh_data import MeshData
from casingfem.structure.material import Material


@dataclass(frozen=True, slots=True, kw_only=True)
class Fixed:
    """Displacements fixed along some of the axes x, y, z; on groups of an imported mesh.

    Raises
    ------
    ValueError
        If a direction is unknown or repeated, or there is none.

    >>> Fixed(directions=("x", "z")).held
    (0, 2)
    """

    directions: tuple[str, ...]

    frame: ClassVar[Literal["cartesian", "edge"]] = "cartesian"

    def __post_init__(self) -> None:
        found = tuple(self.directions)
        if not found or len(set(found)) < len(found) or not set(found) <= {"x", "y", "z"}:
            raise ValueError(f"directions must name some of x, y, z, each once, found {found}")
        object.__setattr__(self, "directions", found)

    @property
    def held(self) -> tuple[int, ...]:
        """Displacements among the dofs of a node that the support fixes."""
        return tuple("xyz".index(direction) for direction in self.directions)


MeshSupport: TypeAlias = Clamped | Fixed | ElasticEdge


def check_support(mesh: MeshData, name: str, support: MeshSupport) -> None:
    """Refuse line springs, and foundations on groups without facets."""
    where = f"{mesh.source}: support.{name}"
    if isinstance(support, ElasticEdge):
        if any((support.k_r, support.k_theta, support.k_z, support.k_rot)) or support.pattern("k_face") is not None:
            raise ModelError("mesh-support", f"{where}: found line springs or a pattern around, expected k_face alone")
        if not len(mesh.group_facets(name)):
            raise ModelError("mesh-group-no-facets", f"{where}: found k_face on a group without facets")
    elif not isinstance(support, Clamped | Fixed):
        raise ModelError("mesh-support", f"{where}: found {type(support).__name__}")


Constants = tuple[float, ...]


def constants_of(material: Material) -> Constants:
    """E, nu and rho of a material."""
    return (material.E, material.nu, material.rho)


def by_group(mesh: MeshData, common: Constants, own: Mapping[str, Constants]) -> FloatArray:
    """Values for each cell (numbers, cells): the values of the cell's group, or the common ones.

    Raises
    ------
    ModelError
        `mesh-group-no-cells`; `mesh-material-twice` for a cell in two groups with values of their own.
    """
    values = np.tile(np.array(common)[:, None], len(mesh.cells))
    owner = np.full(len(mesh.cells), "", dtype=object)
    for name, numbers in own.items():
        cells = mesh.groups[name].cells
        if not len(cells):
            raise ModelError("mesh-group-no-cells", f"{mesh.source}: found a material for group {name!r} without cells")
        taken = cells[owner[cells] != ""]
        if len(taken):
            found = f"cell {mesh.cell_numbers[taken[0]]} has the materials of {owner[taken[0]]!r} and {name!r}"
            raise ModelError("mesh-material-twice", f"{mesh.source}: {found}")
        owner[cells] = name
        values[:, cells] = np.array(numbers)[:, None]
    return values
