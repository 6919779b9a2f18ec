"""The elastic ring under a casing: an eccentric curved beam along an edge, with a support of its own."""

from dataclasses import dataclass, replace
from typing import Any, ClassVar, Literal

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import Array
from casingfem.structure.edge.section import Section
from casingfem.structure.material import Material
from casingfem.structure.mesh.edge_form import Numbered, Sprung
from contact.io.brief import brief


@dataclass(frozen=True, slots=True, kw_only=True)
class Ring:
    """A ring tied to an edge: it moves with the edge's displacement and rotation, and adds the turn about the normal.

    The ring is a curved Timoshenko beam (`structure.curved_beam`) with stretch, torsion, two bendings and two shears.
    The edge's node carries its rotation: two from the shell, and one more dof, the turn about the wall's normal.

    Parameters
    ----------
    section
        Section of the ring.
    material
        Its material; the shell's if left out.
    offset
        (radial, axial) place of the section's centre from the edge [m]; half a depth beyond the edge if left out.
    support
        What holds the ring from below: an `ElasticEdge` or `Bolts`, per metre and angle of the casing's edge; None for
        nothing. A face modulus acts on the section's width. To clamp a ring, clamp the edge.
    foot
        (radial, axial) place from the section's centre at which the support acts [m]; the face away from the shell
        if left out.

    Raises
    ------
    ModelError
        ring-offset, ring-support.

    >>> Ring(section=Section.rectangle(width=0.04, depth=0.04)).centre(-1)
    array([ 0.  , -0.02])
    """

    section: Section
    material: Material | None = None
    offset: tuple[float, float] | None = None
    support: Sprung | None = None
    foot: tuple[float, float] | None = None

    held: ClassVar[tuple[int, ...]] = ()
    frame: ClassVar[Literal["cartesian", "edge"]] = "cartesian"

    __repr__ = brief

    def __post_init__(self) -> None:
        for name in ("offset", "foot"):
            place = getattr(self, name)
            if place is not None and not (len(place) == 2 and np.all(np.isfinite(np.real(place)))):
                raise ModelError("ring-offset", f"ring.{name} must be two finite lengths, found {place!r}")
        held: object = self.support
        if held is not None and not isinstance(held, Sprung):
            found = type(held).__name__
            raise ModelError("ring-support", f"ring.support must be elastic or bolts, found {found}")

    @property
    def uniform(self) -> bool:
        """Whether nothing varies along the ring."""
        return self.support is None or self.support.uniform

    def centre(self, outward: int) -> Array:
        """(radial, axial) from the edge to the section's centre; `outward` is -1 at a base, 1 at a top."""
        return np.array((0.0, 0.5 * outward * self.section.depth) if self.offset is None else self.offset)

    def support_point(self, outward: int) -> Array:
        """(radial, axial) from the edge to where the support acts."""
        foot = np.array((0.0, 0.5 * outward * self.section.depth) if self.foot is None else self.foot)
        return np.asarray(self.centre(outward) + foot)

    def number(self, path: tuple[str, ...]) -> Any:
        """A named number: ("section", "width"), ("material", "E"), else one of the ring's own support.

        Raises
        ------
        KeyError
            If there is no such number.
        """
        match path:
            case ("section", name):
                return self.section.number(name)
            case ("material", "E" | "nu" | "rho" as name):
                if self.material is None:
                    raise KeyError("this ring has no material of its own; vary the shell's")
                return getattr(self.material, name)
        if isinstance(self.support, Numbered):
            return self.support.number(path)
        names = getattr(self.support, "stiffness_names", ())
        if len(path) == 1 and path[0] in names:
            return getattr(self.support, path[0])
        raise KeyError(f"this ring has section.width and the like, {', '.join(('material.E', *names))}")

    def with_number(self, path: tuple[str, ...], value: Any) -> "Ring":
        """The same ring with a named number replaced."""
        self.number(path)
        changes: dict[str, Any] = {path[-1]: value}
        match path:
            case ("section", name):
                return replace(self, section=self.section.with_number(name, value))
            case ("material", _) if self.material is not None:
                return replace(self, material=replace(self.material, **changes))
        if isinstance(self.support, Numbered):
            return replace(self, support=self.support.with_number(path, value))
        held: Any = self.support  # the protocol does not say dataclass; `replace` refuses what is none
        return replace(self, support=replace(held, **changes))
