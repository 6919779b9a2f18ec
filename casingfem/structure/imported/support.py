"""Supports on groups of an imported mesh: directions held. `Clamped` and `ElasticEdge(k_face=...)` serve there too."""

from dataclasses import dataclass
from typing import ClassVar, Literal, TypeAlias

from casingfem.errors import ModelError
from casingfem.structure.edge.support import Clamped, ElasticEdge
from casingfem.structure.imported.mesh.mesh_data import MeshData


@dataclass(frozen=True, slots=True, kw_only=True)
class Fixed:
    """Displacements held along some of the axes x, y, z; on groups of an imported mesh.

    Raises
    ------
    ValueError
        If a direction is unknown, named twice, or none is named.

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
        """Held displacements among the dofs of a node."""
        return tuple("xyz".index(direction) for direction in self.directions)


MeshSupport: TypeAlias = Clamped | Fixed | ElasticEdge


def check_support(mesh: MeshData, name: str, support: MeshSupport) -> None:
    """Refuse line springs, and foundations on groups without facets."""
    where = f"{mesh.source}: support.{name}"
    if isinstance(support, ElasticEdge):
        if any((support.k_r, support.k_theta, support.k_z, support.k_rot)) or support.pattern("k_face") is not None:
            raise ModelError("mesh-support", f"{where}: found line springs or a pattern around, expected k_face alone")
        if not len(mesh.group_facets(name)):
            raise ModelError("mesh-group-no-facets", where)
    elif not isinstance(support, Clamped | Fixed):
        raise ModelError("mesh-support", f"{where}: found {type(support).__name__}")
