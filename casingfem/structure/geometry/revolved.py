"""Surfaces of revolution with a curved meridian: bowls, domes, rounded casings; whole or a sector.

The first parameter is the arc length s along the meridian (r(s), z(s)), the second the angle theta. s is the first
coordinate of fields, and a relative radius defect scales r, as on every chart of revolution.
"""

from dataclasses import dataclass
from typing import Annotated, NamedTuple, Protocol

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import Array, FloatArray
from casingfem.structure.field.field import FieldValues
from casingfem.structure.geometry.chart import (
    Bounds,
    Chart,
    ClosedOfRevolution,
    Open,
    Surface,
    require_positive,
    revolve,
)
from contact.io.keys import Key


class MeridianPoints(NamedTuple):
    """Radius and height of a meridian at points, with first and second derivatives by s."""

    r: Array
    r1: Array
    r2: Array
    z: Array
    z1: Array
    z2: Array


class Meridian(Protocol):
    """A meridian, which `Revolved` and `RevolvedPanel` rotate about the z axis.

    >>> import casingfem as cf
    >>> arc: Meridian = cf.geometry.Arc(radius=0.2, start=0.0, end=0.5, r0=0.3)
    >>> round(arc.length, 3)
    0.1
    """

    @property
    def length(self) -> float:
        """End of s, which starts at 0 [m]."""

    def at(self, s: Array) -> MeridianPoints:
        """Radius, height and their derivatives at s."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Arc:
    """A circular meridian: r = r0 + radius cos phi, z = z0 + radius sin phi, phi from `start` to `end` [rad].

    With r0 = 0 a spherical band, phi its latitude; s = radius |phi - start|.

    Raises
    ------
    ModelError
        `meridian-axis` if the meridian reaches the axis, where the chart has a pole.

    >>> bowl = Arc(radius=10.0, start=0.0, end=np.radians(72.0))
    >>> round(float(bowl.length), 4), bowl.at(np.array(0.0)).r.tolist()
    (12.5664, 10.0)
    """

    radius: Annotated[float, Key("radius of the meridian [m]", "length", "reach")]
    start: Annotated[float, Key("angle of the meridian at the base [degrees], 0 at the equator", "turn", degrees=True)]
    end: Annotated[float, Key("angle of the meridian at the top [degrees], 0 at the equator", "turn", degrees=True)]
    r0: Annotated[float, Key("distance of the centre of the meridian's arc from the axis [m]", "place", "reach")] = 0.0
    z0: float = 0.0

    def __post_init__(self) -> None:
        require_positive("chart.profile", radius=self.radius)
        if not 1e-6 < abs(np.real(self.end - self.start)) < 2.0 * np.pi:
            raise ModelError(
                "meridian-arc", f"chart.profile: found an arc from start = {self.start!r} to end = {self.end!r} rad"
            )
        lowest = float(np.real(self.at(np.linspace(0.0, np.real(self.length), 721)).r).min())
        if lowest < 1e-9 * np.real(self.radius):
            found = f"a radius of {lowest:.3g} m on the meridian, with r0 = {np.real(self.r0):g} m"
            raise ModelError("meridian-axis", f"chart.profile: found {found}")

    @property
    def length(self) -> float:
        """Arc length [m]."""
        return self.radius * (self.end - self.start) * float(np.sign(np.real(self.end - self.start)))

    def at(self, s: Array) -> MeridianPoints:
        """Radius, height and their derivatives at s."""
        sense = float(np.sign(np.real(self.end - self.start)))
        phi = self.start + sense * s / self.radius
        c, d = np.cos(phi), np.sin(phi)
        r, z = self.r0 + self.radius * c, self.z0 + self.radius * d
        return MeridianPoints(r, -sense * d, -c / self.radius, z, sense * c, -d / self.radius)


def revolved_surface(profile: Meridian, s: Array, theta: Array, defect: FieldValues | None) -> Surface:
    """Position and derivatives of a meridian rotated about z."""
    s, theta = np.broadcast_arrays(s, theta)
    at = profile.at(s)
    return revolve(s, theta, at.r, at.r1, defect, bend=at.r2, height=(at.z, at.z1, at.z2))


@dataclass(frozen=True, slots=True, kw_only=True)
class Revolved(ClosedOfRevolution):
    """A meridian rotated once about the z axis. Edges: base (s = 0), top (s = length).

    >>> bowl = Revolved(profile=Arc(radius=0.1, start=-1.4, end=0.0))
    >>> bool(np.allclose(bowl.surface(np.array([bowl.profile.length]), np.zeros(1), None).x.ravel(), [0.1, 0.0, 0.0]))
    True
    """

    profile: Meridian

    @property
    def bounds(self) -> Bounds:
        """S from 0 to the meridian's length, theta once around."""
        return (0.0, self.profile.length), (0.0, 2.0 * np.pi)

    @property
    def lines(self) -> FloatArray:
        """Values of s at which the curvature of a meridian of several pieces jumps: element lines."""
        return np.asarray(getattr(self.profile, "lines", np.zeros(0)))

    def surface(self, a: Array, b: Array, defect: FieldValues | None) -> Surface:
        """Position and derivatives at s = a, theta = b."""
        return revolved_surface(self.profile, a, b, defect)


@dataclass(frozen=True, slots=True, kw_only=True)
class RevolvedPanel(Open):
    """A sector of a surface of revolution: theta from -angle/2 to angle/2 [rad].

    Edges: root (s = 0), tip (s = length), left and right (theta = -+ angle/2).

    >>> RevolvedPanel(profile=Arc(radius=10.0, start=0.0, end=1.2), angle=np.pi / 2).periodic
    False
    """

    profile: Meridian
    angle: float

    def __post_init__(self) -> None:
        require_positive("chart", angle=self.angle)
        if np.real(self.angle) >= 2.0 * np.pi:
            raise ModelError("chart-angle", f"chart.angle must be below 2 pi, found {self.angle!r}")

    @property
    def bounds(self) -> Bounds:
        """S from 0 to the meridian's length, theta across the sector."""
        return (0.0, self.profile.length), (-self.angle / 2.0, self.angle / 2.0)

    def surface(self, a: Array, b: Array, defect: FieldValues | None) -> Surface:
        """Position and derivatives at s = a, theta = b."""
        return revolved_surface(self.profile, a, b, defect)


def chart_lines(chart: Chart) -> list[float]:
    """Values of the first parameter that must be element lines: ends of pieces of a meridian."""
    return [float(line) for line in getattr(chart, "lines", ())]
