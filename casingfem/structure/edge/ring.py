"""Rings under the edges of a casing, ring stiffeners between them, and point masses.

A ring is an eccentric curved beam along an edge, with its own support.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any, ClassVar, Literal

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import Array
from casingfem.structure.edge.section import Section
from casingfem.structure.geometry.strip import ON_LINE
from casingfem.structure.material import Material
from casingfem.structure.mesh.edge_form import Numbered, Sprung
from contact.io.brief import brief
from contact.io.keys import Key


@dataclass(frozen=True, slots=True, kw_only=True)
class Ring:
    """A ring fixed to an edge: it follows the edge's displacement and rotation, and adds the rotation about the normal.

    The ring is a curved Timoshenko beam (`structure.curved_beam`) with stretch, torsion, two bendings and two shears.
    Its rotation is that of the edge's node: two dofs of the shell, and one more, the rotation about the wall's normal.

    Parameters
    ----------
    section
        Section of the ring.
    material
        Its material; by default the shell's.
    offset
        (radial, axial) position of the section's centre from the edge [m]; by default half a depth beyond the edge.
    support
        Support of the ring: an `ElasticEdge` or `Bolts`, per metre and angle of the casing's edge; None for no support.
        A face modulus acts on the section's width. To clamp a ring, clamp the edge.
    foot
        (radial, axial) position from the section's centre at which the support acts [m]; by default the face away from
        the shell.

    Raises
    ------
    ModelError
        ring-offset or ring-support.

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
        """Whether the ring is uniform along its length."""
        return self.support is None or self.support.uniform

    def centre(self, outward: int) -> Array:
        """(radial, axial) from the edge to the section's centre; `outward` is -1 at a base, 1 at a top."""
        return np.array((0.0, 0.5 * outward * self.section.depth) if self.offset is None else self.offset)

    def support_point(self, outward: int) -> Array:
        """(radial, axial) from the edge to the point where the support acts."""
        foot = np.array((0.0, 0.5 * outward * self.section.depth) if self.foot is None else self.foot)
        return np.asarray(self.centre(outward) + foot)

    def number(self, path: tuple[str, ...]) -> Any:
        """A number by name: ("section", "width"), ("material", "E"), else one of the ring's own support.

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
        raise KeyError(f"the numbers of this ring are {', '.join(('section.width, ...', 'material.E', *names))}")

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
        held: Any = self.support  # `replace` refuses a support that is no dataclass
        return replace(self, support=replace(held, **changes))


FREE = 5.0 / 6.0  # shear factor of a free rectangle


@dataclass(frozen=True, slots=True, kw_only=True)
class Stiffener:
    """A ring fixed to the wall along a circle: the beam of `Ring`, with stretch, torsion, two bendings, two shears.

    It touches the wall along one line, so the wall under a thick web strains as if it were free. A rectangle on the
    wall with the default shear factor 5/6 gets the factor of a section fixed at its root.

    Parameters
    ----------
    at
        Its position: the chart's first parameter [m], along the axis of a casing or the arc of its meridian.
    section
        Section, width along the radius and depth along the axis.
    offset
        (radial, axial) position of the section's centre from the mid-surface [m]: (width + thickness)/2 radially for a
        ring outside a cylinder, less than zero inside.
    material
        Its material; by default the shell's.

    Raises
    ------
    ModelError
        `ring-offset` for an offset that is not a pair of lengths, `stiffener-place` for a position that is not finite.

    >>> bar = Section.rectangle(width=0.012, depth=0.004)
    >>> Stiffener(at=0.1, section=bar, offset=(0.0075, 0.0)).ring.centre(0).tolist()
    [0.0075, 0.0]
    """

    at: float
    section: Section
    offset: tuple[float, float]
    material: Material | None = None

    __repr__ = brief

    def __post_init__(self) -> None:
        if not np.isfinite(self.at):
            raise ModelError("stiffener-place", f"stiffener.at: found {self.at!r}, expected a finite length")
        if not isinstance(self.offset, tuple | list):  # optional only for a ring on an edge
            raise ModelError("ring-offset", f"stiffener.offset: found {self.offset!r}, expected two lengths")
        _ = self.ring  # refuses an offset that is not a pair of lengths

    @property
    def ring(self) -> Ring:
        """The beam, with the shear factor of a rectangle fixed at its root."""
        free = Ring(section=self.section, material=self.material, offset=self.offset)  # refuses an invalid offset
        arm = float(np.real(abs(self.offset[0]) - 0.5 * self.section.width))
        return replace(free, section=held_at_root(self.section, arm))


def held_at_root(section: Section, arm: float) -> Section:
    """A rectangle with the shear factor for bending about an axis at `arm` below its root; others unchanged.

    The shear flow at z is proportional to int_z^w (arm + x) dx, w the width, without the part of the moment's change
    that the wall takes. This gives k = (w^2/3 + w arm + arm^2)^2/(2 w^4/15 + 5 arm w^3/12 + arm^2 w^2/3), which is 5/6
    at arm = 0.

    >>> bar = Section.rectangle(width=0.012, depth=0.004)
    >>> [round(held_at_root(bar, arm).shear, 4) for arm in (-1.0, 0.0, 0.0015)]
    [0.8333, 0.8333, 1.1784]
    """
    w = section.width
    if not (arm >= 0.0 and section.area == w * section.depth and section.shear == FREE):
        return section
    moment, shears = w**2 / 3.0 + w * arm + arm**2, 2.0 * w**4 / 15.0 + 5.0 * arm * w**3 / 12.0 + (arm * w) ** 2 / 3.0
    return replace(section, shear=moment**2 / shears)


def check_stiffeners(stiffeners: Sequence[Stiffener], ends: tuple[float, float], closed: bool) -> None:
    """Refuse stiffeners on an open shell, at its ends or beyond, and two at one position."""
    if stiffeners and not closed:
        raise ModelError("stiffener-place", "stiffener: found an open shell, expected a closed casing")
    low, high = np.real(ends)
    slack = ON_LINE * (high - low)
    for k, stiffener in enumerate(stiffeners, 1):
        if not low + slack < stiffener.at < high - slack:
            found = f"found {stiffener.at:g} m, expected a place between the edges at {low:g} and {high:g} m"
            raise ModelError("stiffener-place", f"stiffener[{k}].at: {found}")
        if any(abs(other.at - stiffener.at) <= slack for other in stiffeners[: k - 1]):
            found = f"found a second stiffener at {stiffener.at:g} m, expected one at each place"
            raise ModelError("stiffener-place", f"stiffener[{k}].at: {found}")


@dataclass(frozen=True, slots=True, kw_only=True)
class EdgeMass:
    """A mass [kg] on an edge at an angle [rad]; on the section's centre line if the edge has a ring.

    On a straight edge `angle` is its own parameter: the width of a plate [m], for example.

    It has no rotary inertia. On a shear-deformable edge the result for heavy masses changes slowly with mesh refinement
    (with the logarithm of the element size); masses that are small compared with a wavelength of the wall are not
    affected.

    Raises
    ------
    ModelError
        mass-value: the mass is negative or not finite, or the angle is not finite.

    >>> EdgeMass(angle=0.0, mass=0.012).mass
    0.012
    """

    angle: Annotated[float, Key("angle of the mass [degrees]", "turn", degrees=True)]
    mass: Annotated[float, Key("mass [kg]", "not negative")]

    def __post_init__(self) -> None:
        mass = np.real(self.mass)
        if not (np.isfinite(mass) and mass >= 0.0 and np.isfinite(np.real(self.angle))):
            found = f"found a mass of {self.mass!r} kg at {self.angle!r} rad, expected finite numbers, the mass from 0"
            raise ModelError("mass-value", f"masses: {found}")
