"""Sections of beams: area, moments, torsion and shear of a rectangle or a circle."""

from dataclasses import dataclass, replace

import numpy as np

from casingfem.structure.geometry.chart import require_positive
from contact.io.brief import brief


@dataclass(frozen=True, slots=True, kw_only=True)
class Section:
    """Section of a ring: radial width and axial depth [m] outside, area [m^2] and second moments [m^4].

    I_r is about the radial axis (bending out of the ring's plane), I_z about the axial one (bending in its plane),
    J the torsion constant, `shear` the factor of the shear area.

    Raises
    ------
    ModelError
        ring-section: a value is not positive and finite.

    >>> square = Section.rectangle(width=0.04, depth=0.04)
    >>> f"{square.J / 0.04**4:.6f}"
    '0.140577'
    """

    width: float
    depth: float
    area: float
    I_r: float
    I_z: float
    J: float
    shear: float = 5.0 / 6.0

    __repr__ = brief

    def __post_init__(self) -> None:
        require_positive("section", "ring-section", **{name: getattr(self, name) for name in NUMBERS})

    @classmethod
    def rectangle(cls, *, width: float, depth: float) -> "Section":
        """A solid rectangle.

        J = a b^3 (1/3 - 64/pi^5 (b/a) sum over odd n of tanh(n pi a/(2 b))/n^5) with b <= a (Timoshenko & Goodier,
        Theory of Elasticity, art. 109).
        """
        require_positive("section", "ring-section", width=width, depth=depth)
        a, b = (width, depth) if np.real(width) >= np.real(depth) else (depth, width)
        n = np.arange(1, 40, 2)
        torsion = 1.0 / 3.0 - 64.0 / np.pi**5 * b / a * np.sum(np.tanh(0.5 * n * np.pi * a / b) / n**5)
        radial, axial = width * depth**3 / 12.0, depth * width**3 / 12.0
        return cls(width=width, depth=depth, area=width * depth, I_r=radial, I_z=axial, J=a * b**3 * torsion)

    @classmethod
    def circle(cls, *, diameter: float) -> "Section":
        """A solid circle; shear factor .9.

        >>> round(Section.circle(diameter=0.1).area, 6)
        0.007854
        """
        require_positive("section", "ring-section", diameter=diameter)
        area, inertia = np.pi * diameter**2 / 4.0, np.pi * diameter**4 / 64.0
        return cls(width=diameter, depth=diameter, area=area, I_r=inertia, I_z=inertia, J=2.0 * inertia, shear=0.9)

    def number(self, name: str) -> float:
        """A number of the section by name; `diameter` is that of a circle.

        Raises
        ------
        KeyError
            If there is no such number.
        """
        if name == "diameter" and self == Section.circle(diameter=self.width):
            return self.width
        if name not in NUMBERS:
            raise KeyError(f"the numbers of a section are {', '.join(NUMBERS)}; of a circle, diameter too")
        value: float = getattr(self, name)
        return value

    def with_number(self, name: str, value: float) -> "Section":
        """The same section with a number replaced: a rectangle or a circle keeps its shape, area and moments follow.

        >>> Section.rectangle(width=0.04, depth=0.04).with_number("width", 0.02).area
        0.0008
        """
        self.number(name)
        if name == "diameter":
            return Section.circle(diameter=value)
        if name in ("width", "depth") and self == Section.rectangle(width=self.width, depth=self.depth):
            return Section.rectangle(**{"width": self.width, "depth": self.depth, name: value})
        return replace(self, **{name: value})


NUMBERS = ("width", "depth", "area", "I_r", "I_z", "J", "shear")
