"""Ring stiffeners: eccentric rings on the wall of a casing, between its edges."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from casingfem.errors import ModelError
from casingfem.structure.edge.ring import Ring
from casingfem.structure.edge.section import Section
from casingfem.structure.geometry.strip import ON_LINE
from casingfem.structure.material import Material
from contact.io.brief import brief

FREE = 5.0 / 6.0  # shear factor of a free rectangle


@dataclass(frozen=True, slots=True, kw_only=True)
class Stiffener:
    """A ring tied to the wall along a circle: the beam of `Ring`, with stretch, torsion, two bendings, two shears.

    It touches the wall in one line: where a web is thick beside the wall, the wall between its faces strains here as if
    it were alone. A rectangle on the wall, with the shear factor 5/6 of a free one, gets that of one held at its root.

    Parameters
    ----------
    at
        Where it stands: the chart's first parameter [m], the axis of a casing or the arc of its meridian.
    section
        Section, width along the radius and depth along the axis.
    offset
        (radial, axial) place of the section's centre from the mid-surface [m]: (width + thickness)/2 radially for a
        ring outside a cylinder, less than zero inside.
    material
        Its material; the shell's if left out.

    Raises
    ------
    ModelError
        `ring-offset` for an offset that is no pair of lengths, `stiffener-place` for a station that is not finite.

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
            raise ModelError("stiffener-place", f"stiffener.at: found {self.at!r}")
        if not isinstance(self.offset, tuple | list):  # a ring on an edge may leave it out
            raise ModelError("ring-offset", f"stiffener.offset: found {self.offset!r}")
        _ = self.ring  # refuses what is no pair of lengths

    @property
    def ring(self) -> Ring:
        """The beam, its shear factor that of a rectangle held at its root."""
        free = Ring(section=self.section, material=self.material, offset=self.offset)  # refuses what is no offset
        arm = float(np.real(abs(self.offset[0]) - 0.5 * self.section.width))
        return replace(free, section=held_at_root(self.section, arm))


def held_at_root(section: Section, arm: float) -> Section:
    """A rectangle with the shear factor of one that bends about an axis at `arm` below its root; others as they are.

    Held by the wall along its root it carries tau(z) ~ int_z^w (arm + x) dx, all of the moment's change but what the
    wall carries: k = (w^2/3 + w arm + arm^2)^2/(2 w^4/15 + 5 arm w^3/12 + arm^2 w^2/3), w the width, 5/6 at arm = 0.

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
    """Refuse stiffeners on an open shell, at its ends or beyond, and two at one place."""
    if stiffeners and not closed:
        raise ModelError("stiffener-place", "stiffener: found an open shell, expected a closed casing")
    low, high = np.real(ends)
    slack = ON_LINE * (high - low)
    for k, stiffener in enumerate(stiffeners, 1):
        if not low + slack < stiffener.at < high - slack:
            raise ModelError("stiffener-place", f"stiffener[{k}].at: found {stiffener.at:g} m, {low:g} to {high:g} m")
        if any(abs(other.at - stiffener.at) <= slack for other in stiffeners[: k - 1]):
            raise ModelError("stiffener-place", f"stiffener[{k}].at: found a second one at {stiffener.at:g} m")
