"""Supports on groups of an imported mesh: directions held. `Clamped` and `ElasticEdge(k_face=...)` serve there too."""

from dataclasses import dataclass
from typing import ClassVar, Literal


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
