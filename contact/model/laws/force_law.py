"""Contacts whose force is a function of depth and rate: Hertz, tables, and a law of your own."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import KW_ONLY, InitVar, dataclass, field
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from contact.base.arrays import Array, keep_readonly, readonly, require_not_negative, require_positive
from contact.base.errors import InputError
from contact.io.keys import Key

Function = Callable[[float, float, Array], tuple[float, float]]
AT, WEIGHT = np.polynomial.legendre.leggauss(32)  # points of the integral over a depth, from -1 to 1


def spring(depth: float, rate: float, values: Array) -> tuple[float, float]:
    """Linear spring and dashpot, force = k depth + c rate; `values` k [N/m], c [N s/m]."""
    return values[0] * depth + values[1] * rate, values[0]


def hertz(depth: float, rate: float, values: Array) -> tuple[float, float]:
    """Force = k depth^p (1 + a rate); `values` k, p, a [s/m]."""
    stiff = values[0] * depth ** (values[1] - 1.0) * (1.0 + values[2] * rate)
    return stiff * depth, values[1] * stiff


def table(depth: float, rate: float, values: Array) -> tuple[float, float]:
    """Piecewise linear force, the last line continued; `values`: depths from 0 [m], as many forces [N], c [N s/m]."""
    n = values.size // 2
    low, high = 0, n - 1
    while high - low > 1:
        middle = (low + high) // 2
        if values[middle] <= depth:
            low = middle
        else:
            high = middle
    slope = (values[n + high] - values[n + low]) / (values[high] - values[low])
    return values[n + low] + slope * (depth - values[low]) + values[2 * n] * rate, slope


@dataclass(frozen=True, eq=False, slots=True)
class Response:
    """Force of a contact at a depth: `response(depth, rate)` is (force [N], slope [N/m]).

    `depth` > 0 [m]: overlap of the bodies; `rate` [m/s]: rate of the depth; slope: d force / d depth. A negative force
    counts as zero. `function(depth, rate, values)` takes numbers and the array `values` and uses `math` and numpy's
    functions of numbers alone: numba compiles it into the step loop. The force should not decrease with depth;
    otherwise a step may have several solutions, of which one is taken.

    >>> stiffening = Response(lambda depth, rate, k: (k[0] * depth**3, 3.0 * k[0] * depth**2), (1e12,))
    >>> [round(value, 3) for value in stiffening(1e-4)]
    [1.0, 30000.0]
    """

    function: Function
    values: ArrayLike = ()

    def __post_init__(self) -> None:
        values = readonly(np.atleast_1d(np.asarray(self.values, dtype=float)))
        if values.ndim != 1 or not np.isfinite(values).all():
            raise InputError(f"values: found {self.values!r}, expected a list of finite numbers")
        object.__setattr__(self, "values", values)

    def __call__(self, depth: float, rate: float = 0.0) -> tuple[float, float]:
        """Force [N] and slope [N/m]."""
        force, slope = self.function(depth, rate, np.asarray(self.values))
        return float(force), float(slope)

    def energy(self, depth: float) -> float:
        """Energy stored at a depth [J]: integral of the force at rate 0 over the depth, by 32 Gauss points."""
        if not depth > 0.0:
            return 0.0
        forces = [max(self(0.5 * depth * (1.0 + x))[0], 0.0) for x in AT]
        return float(0.5 * depth * WEIGHT @ forces)


class _GivesWay:
    """Base of laws whose force is that of a response."""

    __slots__ = ()
    stiffness: ClassVar[float] = 0.0
    updates: ClassVar[int] = 0
    tolerance: ClassVar[float] = 0.0
    coating: ClassVar[None] = None


@dataclass(frozen=True, eq=False, slots=True)
class ForceLaw(_GivesWay):
    """A contact law of your own: `response` gives force and slope at a depth and rate; `mu` of Coulomb friction.

    Pass a `Response`, or a function of (depth, rate, values). The force is evaluated at the mean of three steps,
    (gap_{n+1} + 2 gap_n + gap_{n-1})/4, or at gap_{n+1} with `ExactModal(law="forward")`, and is solved together with
    the motion of the step. For the exact-modal scheme. Raises InputError.

    >>> law = ForceLaw(lambda depth, rate, values: (1e6 * depth + 10.0 * rate, 1e6))
    >>> law.response(1e-4, 0.0)
    (100.0, 1000000.0)
    """

    of: InitVar[Any]  # Response | Function
    _: KW_ONLY
    mu: float = 0.0
    words: str = "a force law"
    response: Response = field(init=False)

    def __post_init__(self, of: Any) -> None:
        require_not_negative(mu=self.mu)
        if not callable(of):
            expected = "a function of depth, rate and values, or ct.laws.Response"
            raise InputError(f"response: found {of!r}, expected {expected}")
        object.__setattr__(self, "response", of if isinstance(of, Response) else Response(of))


@dataclass(frozen=True, slots=True, kw_only=True)
class Hertz(_GivesWay):
    """Two round bodies: force = k depth^exponent (1 + dissipation rate); the exponent 3/2 is an elastic point contact.

    `k` [N/m^exponent]: 4/3 E* sqrt(R) for a sphere of radius R on a plane, 1/E* = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2
    (Johnson, Contact Mechanics, 1985, 4.2). `dissipation` [s/m]: about 3 (1 - e)/(2 v) for a coefficient of
    restitution e near 1 at impact speed v (Hunt, Crossley, J. Appl. Mech. 42, 1975, 440). `mu` of Coulomb friction.

    >>> [round(value) for value in Hertz(k=1e10).response(1e-4)]
    [10000, 150000000]
    """

    k: Annotated[
        float, Key("constant of the law, 4/3 E* sqrt(R) for a sphere, p being the exponent [N/m^p]", "positive")
    ]
    exponent: Annotated[
        float, Key("exponent of the depth, 3/2 for an elastic point contact [-]", least=1.0, most=10.0)
    ] = 1.5
    dissipation: Annotated[float, Key("dissipation constant of Hunt and Crossley's law [s/m]", "not negative")] = 0.0
    mu: float = 0.0

    def __post_init__(self) -> None:
        require_positive(k=self.k)
        require_not_negative(dissipation=self.dissipation, mu=self.mu)
        if not 1.0 <= self.exponent <= 10.0:
            raise InputError(f"exponent: found {self.exponent!r}, expected 1 to 10 (3/2 for a point contact)")

    @property
    def words(self) -> str:
        """Name in the label of a run."""
        return f"Hertz, {self.k:.3g} N/m^{self.exponent:g}"

    @property
    def response(self) -> Response:
        """Force and slope."""
        return Response(hertz, (self.k, self.exponent, self.dissipation))


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class ForceTable(_GivesWay):
    """A bumper's measured curve: force [N] over depth [m], linear between points; the last line is continued.

    `depth` increases from 0; `force` starts at 0 and never decreases. `damping` [N s/m] adds damping times rate. `mu`
    of Coulomb friction. Raises InputError naming the point.

    >>> bumper = ForceTable(depth=[0.0, 1e-3, 1.5e-3], force=[0.0, 50.0, 300.0])
    >>> [round(value) for value in bumper.response(1.25e-3)]
    [175, 500000]
    """

    depth: ArrayLike
    force: ArrayLike
    damping: Annotated[float, Key("damping constant of a parallel dashpot [N s/m]", "not negative")] = 0.0
    mu: float = 0.0
    words: ClassVar[str] = "force by table"

    def __post_init__(self) -> None:
        keep_readonly(self, "depth", "force")
        depth, force = np.asarray(self.depth), np.asarray(self.force)
        require_not_negative(damping=self.damping, mu=self.mu)
        if depth.ndim != 1 or depth.size < 2 or depth.shape != force.shape:
            raise InputError(
                f"depth, force: found shapes {depth.shape}, {force.shape}, expected two or more of "
                "each, in equal numbers"
            )
        for name, values, strictly in (("depth", depth, True), ("force", force, False)):
            if not np.isfinite(values).all() or values[0] != 0.0:
                raise InputError(f"{name}: found {values.tolist()[:4]}, expected finite values that begin with 0")
            falls = np.flatnonzero(np.diff(values) <= 0.0 if strictly else np.diff(values) < 0.0)
            if falls.size:
                k = int(falls[0]) + 1
                rising = "more than" if strictly else "at least"
                raise InputError(f"{name}: found {values[k]:g} at point {k + 1}, expected {rising} {values[k - 1]:g}")

    @property
    def response(self) -> Response:
        """Force and slope."""
        return Response(table, np.concatenate([np.asarray(self.depth), np.asarray(self.force), [self.damping]]))
