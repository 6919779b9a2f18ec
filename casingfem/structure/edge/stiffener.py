"""Ring stiffeners: eccentric rings on the wall of a casing, between its edges."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from casingfem.errors import ModelError
from casingfem.structure.edge.ring import Ring
from casingfem.structure.edge.section import Section
from casingfem.structure.geometry.strip import ON_LINE
from casingfem.structure.material import Material
from contact.io.brief import brief


@dataclass(frozen=True, slots=True, kw_only=True)
class Stiffener:
    """A ring tied to the wall along a circle: the beam of `Ring`, with stretch, torsion, two bendings, two shears.

    It touches the wall in one line: where a web is thick beside the wall, the wall between its faces bends here as if
    it were alone.

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
        """The beam."""
        return Ring(section=self.section, material=self.material, offset=self.offset)


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
