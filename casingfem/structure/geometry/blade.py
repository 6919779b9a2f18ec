"""Blades: pretwisted plates (the simplest with coupled flap and torsion), and cambered sections of any chord."""

from dataclasses import dataclass
from typing import Annotated, NoReturn

import numpy as np
from numpy.typing import ArrayLike

from casingfem.errors import ModelError
from casingfem.io.arrays import Array
from casingfem.structure.field.field import Field, FieldValues
from casingfem.structure.geometry.chart import Bounds, Open, Surface, require_positive
from casingfem.structure.geometry.jet import Jet, cos, jets, reciprocal, sin, sinc, surface
from casingfem.structure.geometry.stations import MOST, Law, along, lowest, stations
from contact.io.keys import Key


@dataclass(frozen=True, slots=True, kw_only=True)
class TwistedPlate(Open):
    """Rectangular plate twisted about its own axis: length [m] along x, width [m], tip twist [rad].

    The section rotates about the x axis in proportion to x,

        X = (x, y cos phi, y sin phi),   phi = twist x/length,

    the helicoid of Kielb, Leissa, MacBain & Carney, NASA RP-1150, 1985. A positive twist rotates the tip from y towards
    z; zero twist gives a `Plate`. Edges: root (x = 0), tip (x = length), left and right (y = -+ width/2). Line springs
    use the section's own directions: r = its normal, theta = along y, z = x. There is no radius, so no radius defect.

    >>> blade = TwistedPlate(length=0.3, width=0.1, twist=np.pi / 2)
    >>> blade.surface(np.array([0.3]), np.array([0.05]), None).x.ravel().round(6).tolist()
    [0.3, 0.0, 0.05]
    """

    length: Annotated[float, Key("length from root to tip [m]", "length", "reach")]
    width: Annotated[float, Key("width [m]", "length", "reach")]
    twist: Annotated[float, Key("twist of the tip relative to the root [degrees]", "turn", degrees=True)]

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
            raise ModelError(
                "field-no-radius",
                "radius_defect: found one on a twisted plate, expected none: a twisted plate has no radius",
            )
        rate = self.twist / self.length
        x, y, angle = np.broadcast_arrays(a, b, rate * np.asarray(a))
        c, s = np.cos(angle), np.sin(angle)
        zero, one = np.zeros_like(c), np.ones_like(c)
        first = np.stack([x + zero, y * c, y * s]), np.stack([one, -rate * y * s, rate * y * c]), np.stack([zero, c, s])
        bent, twisted = np.stack([zero, -(rate**2) * y * c, -(rate**2) * y * s]), np.stack([zero, -rate * s, rate * c])
        return Surface(*first, bent, twisted, np.stack([zero, zero, zero]))

    @property
    def section_thickness(self) -> Field:
        """Thickness field of a blade whose thickness is measured in its section x = constant, not along the normal.

        Rotated rectangular sections, as in a solid model, are thinner along the normal of their mid-surface, which is
        inclined to the section: t (1 + (twist y/length)^2)^(-1/2). For 60 degrees over a square plate this is 11 % at
        the edges.

        >>> blade = TwistedPlate(length=1.0, width=1.0, twist=np.pi / 3)
        >>> round(float(blade.section_thickness.derivatives(0.0, 0.5).value), 3)
        -0.114
        """
        return SectionThickness(self.twist / self.length)

    def directions(self, a: Array, b: Array) -> Array:
        """Normal of the section, its rotated y direction, and x."""
        return turned_directions(self.twist / self.length * np.broadcast_arrays(a, b)[0])


@dataclass(frozen=True, slots=True)
class SectionThickness:
    """Relative thickness (1 + (rate y)^2)^(-1/2) - 1: the cosine of the normal's inclination to its section, minus 1.

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
        """Refused, since a blade is not a body of revolution."""
        raise ValueError(f"the thickness of a twisted plate cannot be turned by {angle!r} rad: it does not close")


@dataclass(frozen=True, slots=True, kw_only=True)
class Blade(Open):
    """Blade along x: its section x = constant is a circular arc over a chord, rotated and shifted.

    With eta = -1/2 to 1/2 along the arc, p along the chord and q across it,

        p = c eta sinc(k eta)/sinc(k/2),   q = c k (sinc^2(k/4)/8 - eta^2 sinc^2(k eta/2)/2)/sinc(k/2),
        X = (x, sweep + p cos phi - q sin phi, lean + p sin phi + q cos phi),

    c the chord, k the camber (opening angle of the arc; 0 is a straight section), phi the twist. Each is a constant, or
    values at equally spaced stations from root to tip, (root, tip) or more, interpolated by a polynomial. Without
    camber, sweep, lean and taper it is a `TwistedPlate`; with a camber alone a `Panel` of radius c/(2 sin(k/2)); with a
    sweep alone a skew plate; with a variable chord alone a trapezoid.

    Parameters
    ----------
    length
        Span [m], x from 0 (root) to length (tip).
    chord
        c [m], straight from leading to trailing edge.
    camber, twist
        k and phi [rad]. A positive twist rotates y towards z.
    sweep, lean
        Shift of the middle of the chord along y and z [m].

    Edges: root, tip, left and right (eta = -+ 1/2). The second parameter is eta. Line springs use the section's own
    directions: r = across the chord, theta = along it, z = x. There is no radius, so no radius defect.

    Raises
    ------
    ModelError
        `law-stations`: invalid stations; `blade-shape`: the chord is not positive everywhere, or the section is closed.

    Examples
    --------
    >>> trapezoid = Blade(length=10.0, chord=(5.0, 1.0))
    >>> trapezoid.surface(np.array([10.0]), np.array([0.5]), None).x.ravel().tolist()
    [10.0, 0.5, 0.0]
    """

    length: Annotated[float, Key("span from root to tip [m]", "length", "reach")]
    chord: Annotated[
        Law,
        Key(
            "chord [m], one number, or values at equally spaced stations from root to tip",
            "length",
            "reach",
            stations=MOST,
        ),
    ]
    camber: Annotated[
        Law, Key("camber as the opening angle of the section's arc [degrees]", "turn", degrees=True, stations=MOST)
    ] = 0.0
    twist: Annotated[Law, Key("angle of the section about the span [degrees]", "turn", degrees=True, stations=MOST)] = (
        0.0
    )
    sweep: Annotated[Law, Key("shift of the section along y [m]", check="reach", stations=MOST)] = 0.0
    lean: Annotated[Law, Key("shift of the section along z [m]", check="reach", stations=MOST)] = 0.0

    def __post_init__(self) -> None:
        require_positive("chart", length=self.length)
        for name in ("chord", "camber", "twist", "sweep", "lean"):
            object.__setattr__(self, name, stations(f"chart.{name}", getattr(self, name)))
        if not lowest(self.chord) > 0.0:
            raise ModelError("blade-shape", f"chart.chord falls to {lowest(self.chord):.3g} m")
        largest = float(np.abs(np.real(along(self.camber, np.linspace(0.0, 1.0, 129)))).max())
        if largest >= 2.0 * np.pi:
            raise ModelError("blade-shape", f"chart.camber reaches {largest:.3g} rad, a closed section")

    @property
    def bounds(self) -> Bounds:
        """X from 0 to length, eta from -1/2 to 1/2."""
        return (0.0, self.length), (-0.5, 0.5)

    def section(self, xi: Jet, eta: Jet) -> tuple[Jet, Jet]:
        """Camber line in the section's own axes: along the chord and across it [m]."""
        chord, k = along(self.chord, xi), along(self.camber, xi)
        scale = chord * reciprocal(sinc(k * 0.5))
        rise, drop = sinc(k * 0.25), eta * sinc(k * eta * 0.5)
        return scale * eta * sinc(k * eta), scale * k * (rise * rise * 0.125 - drop * drop * 0.5)

    def surface(self, a: Array, b: Array, defect: FieldValues | None) -> Surface:
        """Position and derivatives at x = a, eta = b."""
        if defect is not None:
            raise ValueError("radius_defect: found one on a blade, expected none: a blade has no radius; use a Panel")
        x, eta = jets(a, b)
        xi = x * (1.0 / self.length)
        p, q = self.section(xi, eta)
        turn = along(self.twist, xi)
        c, s = cos(turn), sin(turn)
        y = along(self.sweep, xi) + p * c - q * s
        z = along(self.lean, xi) + p * s + q * c
        return surface(x, y, z)

    def directions(self, a: Array, b: Array) -> Array:
        """Across the chord, along it, and x."""
        return turned_directions(along(self.twist, np.broadcast_arrays(a, b)[0] / self.length))


def turned_directions(angle: Array) -> Array:
    """Directions across and along a section that is rotated about x, and x, (3, 3, ...)."""
    c, s, zero, one = np.cos(angle), np.sin(angle), np.zeros_like(angle), np.ones_like(angle)
    return np.array([[zero, -s, c], [zero, c, s], [one, zero, zero]])
