"""Charts: mid-surfaces X(z, theta) with exact first and second derivatives.

A chart maps a rectangle of parameters to space. For bodies of revolution the parameters are the axial
coordinate z [m] and the angle theta [rad]; a relative radius defect f(z, theta) enters exactly,

    X = (r cos theta, r sin theta, z),   r = r0(z) (1 + f(z, theta)),

so that the metric of the imperfect surface is not linearised. A chart of your own only has to satisfy the `Chart`
protocol; `Closed` and `Open` are base classes.
"""

from dataclasses import dataclass
from typing import Annotated, NamedTuple, Protocol, runtime_checkable

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import Array
from casingfem.structure.field.field import FieldValues
from contact.io.keys import Key

Bounds = tuple[tuple[float, float], tuple[float, float]]

BASE, TOP, LEFT, RIGHT = (0, 0), (0, 1), (1, 0), (1, 1)  # (parameter held, its lower | upper end)


class Surface(NamedTuple):
    """A mid-surface at points: position and derivatives by the two parameters, each (3, ...).

    >>> x = np.zeros((3, 1))
    >>> found = Surface(x=x, x1=x + 1.0, x2=x, x11=x, x12=x, x22=x)
    >>> found.x1.ravel().tolist()
    [1.0, 1.0, 1.0]
    """

    x: Array
    x1: Array
    x2: Array
    x11: Array
    x12: Array
    x22: Array


@runtime_checkable
class Chart(Protocol):
    """Interface of a mid-surface for a shell.

    >>> import casingfem as cf
    >>> tube: Chart = cf.Cylinder(radius=0.5, height=0.3)
    >>> tube.bounds, tube.periodic, tube.axisymmetric
    (((0.0, 0.3), (0.0, 6.283185307179586)), True, True)
    """

    @property
    def bounds(self) -> Bounds:
        """((first parameter from, to), (second from, to))."""

    @property
    def periodic(self) -> bool:
        """Whether the second parameter closes on itself; it then runs over 2 pi."""

    @property
    def axisymmetric(self) -> bool:
        """Whether the surface is that at b = 0 rotated about z by b. False if the chart does not state it."""
        return False

    @property
    def edges(self) -> dict[str, tuple[int, int]]:
        """Edge name -> (constant parameter, 0 lower or 1 upper end)."""

    def surface(self, a: Array, b: Array, defect: FieldValues | None) -> Surface:
        """Position and derivatives at parameters (a, b); `defect` is the relative radius field there."""

    def directions(self, a: Array, b: Array) -> Array:
        """The unit vectors (r, theta, z) along which line springs act, (3 directions, 3, ...)."""


def is_axisymmetric(chart: Chart) -> bool:
    """Whether the chart declares itself axisymmetric; without the attribute it is not.

    >>> is_axisymmetric(Cylinder(radius=1.0, height=2.0)), is_axisymmetric(Plate(length=1.0, width=0.5))
    (True, False)
    """
    return bool(getattr(chart, "axisymmetric", False))


def require_positive(owner: str, code: str = "chart-dimension", /, **values: float) -> None:
    """Raise ModelError unless every named value is finite and above zero."""
    for name, value in values.items():
        real = np.real(value)
        if not (np.isfinite(real) and real > 0.0):
            raise ModelError(code, f"{owner}.{name} must be positive and finite, found {real!r}")


def revolve(
    z: Array,
    theta: Array,
    r0: Array,
    slope: Array | float,
    defect: FieldValues | None,
    *,
    bend: Array | float = 0.0,
    height: tuple[Array, Array, Array] | None = None,
) -> Surface:
    """Surface of revolution with meridian r0(z), dr0/dz = slope, d2r0/dz2 = bend, and a relative radius defect.

    `height` is the axial coordinate and its two derivatives, if the first parameter is not z.
    """
    z, theta, r0 = np.broadcast_arrays(z, theta, r0)
    zero, one = np.zeros_like(r0), np.ones_like(r0)
    up, up_1, up_2 = height or (z, one, zero)
    if defect is None:
        r, r_z, r_t, r_zz, r_zt, r_tt = r0, zero + slope, zero, zero + bend, zero, zero
    else:
        f, f_z, f_t, f_zz, f_zt, f_tt = defect
        r = r0 * (1.0 + f)
        r_z = slope * (1.0 + f) + r0 * f_z
        r_t = r0 * f_t
        r_zz = bend * (1.0 + f) + 2.0 * slope * f_z + r0 * f_zz
        r_zt = slope * f_t + r0 * f_zt
        r_tt = r0 * f_tt
    c, s = np.cos(theta), np.sin(theta)

    def along(radial: Array, hoop: Array, axial: Array) -> Array:
        return np.stack([radial * c - hoop * s, radial * s + hoop * c, axial + 0.0 * radial])

    first = along(r, zero, up), along(r_z, zero, up_1), along(r_t, r, zero)
    second = along(r_zz, zero, up_2), along(r_zt, r_z, zero), along(r_tt - r, 2.0 * r_t, zero)
    return Surface(*first, *second)


def cylindrical_directions(z: Array, theta: Array) -> Array:
    """Unit vectors e_r, e_theta, e_z at theta, (3, 3, ...)."""
    z, theta = np.broadcast_arrays(z, theta)
    c, s, zero, one = np.cos(theta), np.sin(theta), np.zeros_like(theta), np.ones_like(theta)
    return np.array([[c, s, zero], [-s, c, zero], [zero, zero, one]])


class Closed:
    """Base of closed charts: edges base and top, springs along e_r, e_theta, e_z; not axisymmetric.

    >>> import casingfem as cf
    >>> tube = cf.Cylinder(radius=0.5, height=0.3)
    >>> isinstance(tube, Closed), sorted(tube.edges)
    (True, ['base', 'top'])
    """

    __slots__ = ()

    @property
    def axisymmetric(self) -> bool:
        """False by default; charts of revolution state True."""
        return False

    @property
    def periodic(self) -> bool:
        """True: the second parameter closes on itself."""
        return True

    @property
    def edges(self) -> dict[str, tuple[int, int]]:
        """Base and top."""
        return {"base": BASE, "top": TOP}

    def directions(self, a: Array, b: Array) -> Array:
        """The cylindrical unit vectors."""
        return cylindrical_directions(a, b)


class ClosedOfRevolution(Closed):
    """Base of closed charts of revolution about z: as `Closed`, axisymmetric.

    >>> import casingfem as cf
    >>> tube = cf.Cylinder(radius=0.5, height=0.3)
    >>> isinstance(tube, ClosedOfRevolution), tube.axisymmetric
    (True, True)
    """

    __slots__ = ()

    @property
    def axisymmetric(self) -> bool:
        """True: the second parameter is the angle about z, and the surface does not change around."""
        return True


class Open:
    """Base of open charts: edges root, tip, left and right; on a sector, springs act along e_r, e_theta, e_z.

    >>> import casingfem as cf
    >>> plate = cf.Plate(length=0.2, width=0.1)
    >>> isinstance(plate, Open), sorted(plate.edges)
    (True, ['left', 'right', 'root', 'tip'])
    """

    __slots__ = ()

    @property
    def axisymmetric(self) -> bool:
        """False for open surfaces."""
        return False

    @property
    def periodic(self) -> bool:
        """False for open surfaces."""
        return False

    @property
    def edges(self) -> dict[str, tuple[int, int]]:
        """Root and tip (first parameter), left and right (second)."""
        return {"root": BASE, "tip": TOP, "left": LEFT, "right": RIGHT}

    def directions(self, a: Array, b: Array) -> Array:
        """The cylindrical unit vectors."""
        return cylindrical_directions(a, b)


@dataclass(frozen=True, slots=True, kw_only=True)
class Frustum(ClosedOfRevolution):
    """Frustum of a cone about the z axis: mean radius r_base [m] at z = 0, r_top at z = height [m].

    Edges: base (z = 0), top (z = height).

    >>> Frustum(r_base=0.5, r_top=0.45, height=0.25).edges
    {'base': (0, 0), 'top': (0, 1)}
    """

    r_base: Annotated[float, Key("mean radius at z = 0 [m]", "length", "reach")]
    r_top: Annotated[float, Key("mean radius at z = height [m]", "length", "reach")]
    height: Annotated[float, Key("length along the axis [m]", "length", "reach")]

    def __post_init__(self) -> None:
        require_positive("chart", r_base=self.r_base, r_top=self.r_top, height=self.height)

    @property
    def bounds(self) -> Bounds:
        """Z from 0 to height, theta once around."""
        return (0.0, self.height), (0.0, 2.0 * np.pi)

    def radius(self, z: Array) -> Array:
        """Mean radius r0(z) [m]."""
        return self.r_base + (self.r_top - self.r_base) / self.height * np.asarray(z)

    def surface(self, a: Array, b: Array, defect: FieldValues | None) -> Surface:
        """Position and derivatives at z = a, theta = b."""
        return revolve(a, b, self.radius(a), (self.r_top - self.r_base) / self.height, defect)


@dataclass(frozen=True, slots=True, kw_only=True)
class Cylinder(ClosedOfRevolution):
    """Circular cylinder about the z axis: mean radius [m], height [m]. Edges: base, top.

    >>> Cylinder(radius=1.0, height=2.0).bounds[0]
    (0.0, 2.0)
    """

    radius: Annotated[float, Key("mean radius [m]", "length", "reach")]
    height: Annotated[float, Key("length along the axis [m]", "length", "reach")]

    def __post_init__(self) -> None:
        require_positive("chart", radius=self.radius, height=self.height)

    @property
    def bounds(self) -> Bounds:
        """Z from 0 to height, theta once around."""
        return (0.0, self.height), (0.0, 2.0 * np.pi)

    def surface(self, a: Array, b: Array, defect: FieldValues | None) -> Surface:
        """Position and derivatives at z = a, theta = b."""
        return revolve(a, b, self.radius + 0.0 * np.asarray(a), 0.0, defect)


@dataclass(frozen=True, slots=True, kw_only=True)
class Panel(Open):
    """Open cylindrical panel: radius [m], length [m] along z, opening angle [rad] about theta = 0.

    Edges: root (z = 0) and tip (z = length) are curved; left and right (theta = -+ angle/2) are straight.

    >>> Panel(radius=0.6096, length=0.3048, angle=0.5).periodic
    False
    """

    radius: Annotated[float, Key("mean radius [m]", "length", "reach")]
    length: Annotated[float, Key("length along the axis [m]", "length", "reach")]
    angle: Annotated[float, Key("opening angle [rad]", "below a turn")]

    def __post_init__(self) -> None:
        require_positive("chart", radius=self.radius, length=self.length, angle=self.angle)
        if np.real(self.angle) >= 2.0 * np.pi:
            raise ModelError("chart-angle", f"chart.angle must be below 2 pi, found {self.angle!r}")

    @property
    def bounds(self) -> Bounds:
        """Z from 0 to length, theta across the opening angle."""
        return (0.0, self.length), (-self.angle / 2.0, self.angle / 2.0)

    def surface(self, a: Array, b: Array, defect: FieldValues | None) -> Surface:
        """Position and derivatives at z = a, theta = b."""
        return revolve(a, b, self.radius + 0.0 * np.asarray(a), 0.0, defect)


@dataclass(frozen=True, slots=True, kw_only=True)
class Plate(Open):
    """Flat rectangular plate: length [m] along x, width [m] along y, centred on y = 0; normal along z.

    Edges: root (x = 0), tip (x = length), left and right (y = -+ width/2). Line springs use r = z (normal), theta = y,
    z = x. A plate has no radius, so it has no radius defect.

    >>> Plate(length=1.0, width=0.5).edges["tip"]
    (0, 1)
    """

    length: Annotated[float, Key("length from root to tip [m]", "length", "reach")]
    width: Annotated[float, Key("width [m]", "length", "reach")]

    def __post_init__(self) -> None:
        require_positive("chart", length=self.length, width=self.width)

    @property
    def bounds(self) -> Bounds:
        """X from 0 to length, y across the width."""
        return (0.0, self.length), (-self.width / 2.0, self.width / 2.0)

    def surface(self, a: Array, b: Array, defect: FieldValues | None) -> Surface:
        """Position and derivatives at x = a, y = b."""
        if defect is not None:
            raise ModelError(
                "field-no-radius", "radius_defect: found one on a flat plate, expected none: a flat plate has no radius"
            )
        a, b = np.broadcast_arrays(a, b)
        zero, one = np.zeros_like(a), np.ones_like(a)
        flat = np.stack([zero, zero, zero])
        along, across = np.stack([one, zero, zero]), np.stack([zero, one, zero])
        return Surface(np.stack([a, b, zero]), along, across, flat, flat, flat)

    def directions(self, a: Array, b: Array) -> Array:
        """Normal, y and x."""
        a, b = np.broadcast_arrays(a, b)
        zero, one = np.zeros_like(a), np.ones_like(a)
        return np.array([[zero, zero, one], [zero, one, zero], [one, zero, zero]])
