"""A pretwisted plate: the simplest blade whose flap and torsion couple."""

from dataclasses import dataclass
from typing import NoReturn

import numpy as np
from numpy.typing import ArrayLike

from casingfem.errors import ModelError
from casingfem.io.arrays import Array
from casingfem.structure.field.field import Field, FieldValues
from casingfem.structure.geometry.chart import Bounds, Open, Surface, require_positive


@dataclass(frozen=True, slots=True, kw_only=True)
class TwistedPlate(Open):
    """Rectangular plate twisted about its own axis: length [m] along x, width [m], tip twist [rad].

    The section turns about the x axis in proportion to x,

        X = (x, y cos phi, y sin phi),   phi = twist x/length,

    the helicoid of Kielb, Leissa, MacBain & Carney, NASA RP-1150, 1985. A positive twist turns the tip from y
    towards z; none gives a `Plate`. Edges: root (x = 0), tip (x = length), left and right (y = -+ width/2). Line
    springs take the section's own directions: r = its normal, theta = along y, z = x. There is no radius, so no
    radius defect.

    >>> blade = TwistedPlate(length=0.3, width=0.1, twist=np.pi / 2)
    >>> blade.surface(np.array([0.3]), np.array([0.05]), None).x.ravel().round(6).tolist()
    [0.3, 0.0, 0.05]
    """

    length: float
    width: float
    twist: float

    def __post_init__(self) -> None:
        require_positive("chart", length=self.length, width=self.width)
        if not np.isfinite(np.real(self.twist)):
            raise ModelError("chart-twist", f"chart.twist must be finite [rad], found {self.twist!r}")

    @property
    def bounds(self) -> Bounds:
        """X from 0 to length, y across the width."""
        return (0.0, self.length), (-self.width / 2.0, self.width / 2.0)

    def surface(self, a: Array, b: Array, defect: FieldValues | None) -> Surface:
        """Position and derivatives at x = a, y = b."""
        if defect is not None:
            raise ModelError("field-no-radius", "radius_defect: a twisted plate has no radius to be defective")
        rate = self.twist / self.length
        x, y, angle = np.broadcast_arrays(a, b, rate * np.asarray(a))
        c, s = np.cos(angle), np.sin(angle)
        zero, one = np.zeros_like(c), np.ones_like(c)
        return Surface(
            x=np.stack([x + zero, y * c, y * s]),
            x1=np.stack([one, -rate * y * s, rate * y * c]),
            x2=np.stack([zero, c, s]),
            x11=np.stack([zero, -(rate**2) * y * c, -(rate**2) * y * s]),
            x12=np.stack([zero, -rate * s, rate * c]),
            x22=np.stack([zero, zero, zero]),
        )

    @property
    def section_thickness(self) -> Field:
        """Thickness field of a blade whose thickness is given in its section x = constant, not along the normal.

        Turned rectangular sections, as a solid is drawn, are thinner along the normal of their mid-surface, which
        leans out of the section: t (1 + (twist y/length)^2)^(-1/2). At 60 degrees over a square plate: 11 % at the
        edges.

        >>> blade = TwistedPlate(length=1.0, width=1.0, twist=np.pi / 3)
        >>> round(float(blade.section_thickness.derivatives(0.0, 0.5).value), 3)
        -0.114
        """
        return SectionThickness(self.twist / self.length)

    def directions(self, a: Array, b: Array) -> Array:
        """Normal of the section, y turned with it, and x."""
        a, b = np.broadcast_arrays(a, b)
        angle = self.twist / self.length * a
        c, s = np.cos(angle), np.sin(angle)
        zero, one = np.zeros_like(c), np.ones_like(c)
        return np.array([[zero, -s, c], [zero, c, s], [one, zero, zero]])


@dataclass(frozen=True, slots=True)
class SectionThickness:
    """Relative thickness (1 + (rate y)^2)^(-1/2) - 1: the cosine of the normal's lean out of its section.

    `rate` is the twist per length [rad/m]; see `TwistedPlate.section_thickness`.
    """

    rate: float

    def derivatives(self, z: ArrayLike, theta: ArrayLike) -> FieldValues:
        """Value and derivatives at x = z, y = theta."""
        x, y = np.broadcast_arrays(z, theta)
        square, zero = 1.0 + (self.rate * y) ** 2, 0.0 * (x + y)
        slope = -(self.rate**2) * y * square**-1.5
        bend = -(self.rate**2) * square**-1.5 + 3.0 * self.rate**4 * y**2 * square**-2.5
        return FieldValues(square**-0.5 - 1.0 + zero, zero, slope, zero, zero, bend)

    def rotated(self, angle: float) -> NoReturn:
        """Refused: nothing turns around a blade."""
        raise ValueError(f"the thickness of a twisted plate cannot be turned by {angle!r} rad: it does not close")
