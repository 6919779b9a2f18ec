"""Prescribed histories of a rub: closing of the gap, whirl, and the rim's measured profile."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated

import numpy as np

from contact.base.arrays import Array, keep_readonly, readonly, require_finite, require_not_negative
from contact.base.errors import InputError
from contact.io.brief import brief
from contact.io.keys import Key
from contact.model.speed import require_table


@dataclass(frozen=True, eq=False, slots=True)
class Closing:
    """Reduction of every clearance over time [m]: linear between the points, constant outside them.

    >>> Closing(time=[0.0, 10.0], by=[0.0, 1e-4]).at(5.0)
    5e-05
    """

    time: Array
    by: Array

    def __post_init__(self) -> None:
        for name in ("time", "by"):
            object.__setattr__(self, name, readonly(np.atleast_1d(getattr(self, name))))
        require_table("closing", self.time, self.by)

    @staticmethod
    def none() -> Closing:
        """No reduction: constant clearances."""
        return Closing(readonly([0.0]), readonly([0.0]))

    @staticmethod
    def exponential(by: float, time_constant: float, *, points: int = 400) -> Closing:
        """Reduction by (1 - exp(-t/time_constant)) up to twelve time constants, as a table within 1e-4 of `by`."""
        require_finite(by=by)
        if not (math.isfinite(time_constant) and time_constant > 0.0):
            raise InputError(f"time_constant: found {time_constant!r}, expected seconds > 0")
        share = np.linspace(0.0, 1.0 - math.exp(-12.0), points)
        dense = np.unique(np.concatenate([-np.log1p(-share), np.linspace(0.0, 12.0, points)]))
        return Closing(readonly(time_constant * dense), readonly(-by * np.expm1(-dense)))

    def at(self, t: float) -> float:
        """Reduction at t [m]."""
        return float(np.interp(t, self.time, self.by))


@dataclass(frozen=True, slots=True, kw_only=True)
class Whirl:
    """Rigid circular offset of the casing's centre from the rotor's: gap += amplitude cos(phi - beta(t)).

    beta = phase + per_rev angle(t) + 2 pi hz t in the casing's frame. For a sag that is fixed in the casing, both are
    zero; an offset fixed in the blades' frame (an eccentric rotor under a casing at rest, gravity on a turning casing)
    has per_rev = -1. It changes only the gap: the speed of the offset is small against R Omega.

    >>> Whirl(amplitude=1e-4, per_rev=-1.0).hz
    0.0
    """

    amplitude: Annotated[float, Key("radius of the circle on which the centre moves [m]", "not negative", "clearance")]
    per_rev: Annotated[
        float, Key("rate of the motion, in revolutions per revolution of the casing [-]", least=-1000.0, most=1000.0)
    ] = 0.0
    hz: float = 0.0
    phase_deg: Annotated[float, Key("angle of the centre at t = 0 [degrees]", "turn")] = 0.0

    def __post_init__(self) -> None:
        require_not_negative(amplitude=self.amplitude)
        require_finite(per_rev=self.per_rev, hz=self.hz, phase_deg=self.phase_deg)


@lru_cache(maxsize=8)  # evaluated at every angle
def _hermite_table(profile: RimProfile) -> Array:
    if profile.theta is None or profile.depth is None:
        return np.zeros((0, 3))
    turn = 2.0 * math.pi
    x, y = np.append(profile.theta, profile.theta[0] + turn), np.append(profile.depth, profile.depth[0])
    return np.ascontiguousarray(np.stack([x, y, _slopes(x, y)], axis=1))


@dataclass(frozen=True, eq=False, slots=True)
class RimProfile:
    """Out-of-roundness d(theta) in the casing's frame [m], positive where the radius is larger.

    `terms` {p, cos, sin} are summed; the table (`theta` [rad], `depth` [m]) is interpolated by a periodic piecewise
    cubic with continuous slope, which does not overshoot (Fritsch & Butland, SIAM J. Sci. Stat. Comput. 5, 1984, 300).

    >>> round(RimProfile(theta=[0.0, 2.0, 4.0], depth=[0.0, 1e-4, 0.0])(2.0), 12)
    0.0001
    """

    terms: tuple[tuple[int, float, float], ...] = ()
    theta: Array | None = None
    depth: Array | None = None

    __repr__ = brief

    def __post_init__(self) -> None:
        if (self.theta is None) != (self.depth is None):
            raise InputError("profile: found one of theta and depth, expected both or none")
        if self.theta is None or self.depth is None:
            return
        keep_readonly(self, "theta", "depth")
        require_table("profile", self.theta, self.depth)
        span = float(self.theta[-1] - self.theta[0])
        if len(self.theta) < 3 or span >= 2.0 * math.pi:
            expected = "three or more within less than 2 pi rad"
            raise InputError(f"profile: found {len(self.theta)} angles over {span:g} rad, expected {expected}")

    @staticmethod
    def fourier(terms: Sequence[Mapping[str, float]]) -> RimProfile:
        """Profile of Fourier terms, as in `RotatingRim.out_of_roundness`."""
        from contact.model.gaps.gap import require_term

        for term in terms:
            require_term(term)
        return RimProfile(tuple((int(t["p"]), float(t.get("cos", 0.0)), float(t.get("sin", 0.0))) for t in terms))

    @property
    def table(self) -> Array:
        """Hermite table, rows (theta, depth, slope) with the first point repeated a turn later; empty without one."""
        return _hermite_table(self)

    def __call__(self, phi: float) -> float:
        """Depth at one angle [m]."""
        return self.smooth(phi) + hermite(self.table, phi)

    def smooth(self, phi: float) -> float:
        """Contribution of the Fourier terms to the depth at one angle [m]."""
        return sum(a * math.cos(p * phi) + b * math.sin(p * phi) for p, a, b in self.terms)

    @property
    def repeats(self) -> int:
        """How many times the depth repeats around: the common divisor of its terms, 1 with a table, 0 if it is round.

        >>> RimProfile(((4, 1e-5, 0.0), (6, 0.0, 2e-5))).repeats, RimProfile().repeats
        (2, 0)
        """
        if self.theta is not None:
            return 1
        return math.gcd(*(p for p, a, b in self.terms if a or b))

    @property
    def farthest(self) -> float:
        """Upper bound of |d| [m]."""
        table = self.table
        base = float(np.abs(table[:, 1]).max()) if len(table) else 0.0
        return base + sum(math.hypot(a, b) for _, a, b in self.terms)

    @property
    def lowest(self) -> float:
        """A lower bound [m]: the table's lowest point minus the amplitudes of the terms."""
        table = self.table
        base = float(table[:, 1].min()) if len(table) else 0.0
        return base + sum(a if p == 0 else -math.hypot(a, b) for p, a, b in self.terms)


def _slopes(x: Array, y: Array) -> Array:
    """Slopes of a periodic monotone cubic: weighted harmonic means, zero at extremes."""
    h, rise = np.diff(x), np.diff(y) / np.diff(x)
    h0, d0 = np.roll(h, 1), np.roll(rise, 1)
    w0, w1 = 2.0 * h + h0, h + 2.0 * h0
    same = d0 * rise > 0.0
    inverse = w0 / np.where(same, d0, 1.0) + w1 / np.where(same, rise, 1.0)
    slope = np.where(same, (w0 + w1) / inverse, 0.0)
    return np.append(slope, slope[0])


def hermite(table: Array, phi: float) -> float:
    """Value of a periodic Hermite table at one angle; zero for an empty one."""
    if not len(table):
        return 0.0
    at = table[0, 0] + (phi - table[0, 0]) % (2.0 * math.pi)
    i = min(max(int(np.searchsorted(table[:, 0], at, side="right")) - 1, 0), len(table) - 2)
    h = table[i + 1, 0] - table[i, 0]
    s = (at - table[i, 0]) / h
    left = (1.0 + 2.0 * s) * (1.0 - s) ** 2 * table[i, 1] + s * (1.0 - s) ** 2 * h * table[i, 2]
    right = s * s * (3.0 - 2.0 * s) * table[i + 1, 1] - s * s * (1.0 - s) * h * table[i + 1, 2]
    return float(left + right)
