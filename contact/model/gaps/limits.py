"""Limits on the motion of a rim and its tips; beyond them a linear model is invalid, and usually the run diverges."""

from __future__ import annotations

import math

import numpy as np

from contact.base.arrays import Array
from contact.base.errors import InputError
from contact.io.trust import Flag

FAR = 0.1  # of the radius: a larger clearance or interference is a mistyped unit, a larger motion is not linear
WALL = 0.5  # of the wall's thickness: the linear model is valid up to this deflection of a rim
RIM, TIP, REACHED = 0, 1, 2  # entries of `limits`: allowed values, and from REACHED on the values reached
WATCHED, LARGEST = 4, 5  # entries: a smaller deflection is not computed; the largest, also of states that are stored
LOOK = 64  # steps between two computations of a rim's deflection


def motion_limits(radius: float, thickness: float) -> Array:
    """Limits of the rim's deflection and of a tip's motion against it [m]; the values reached.

    Two thresholds of the deflection.

    Deflections below WATCHED are not computed; the value reached is then 0. The deflection of every LOOK-th step
    decides whether a run ends, independently of the stored states. LARGEST includes these and all stored states. If
    `thickness` is 0 or infinite (unknown), both limits are a tenth of the radius.

    >>> motion_limits(0.5, 3e-3).tolist(), motion_limits(0.5, 0.0).tolist()
    ([0.0015, 0.05, 0.0, 0.0, 0.0015, 0.0], [0.05, 0.05, 0.0, 0.0, 0.05, 0.0])
    """
    far = FAR * radius if radius > 0.0 else math.inf
    rim = min(WALL * thickness, far) if thickness > 0.0 else far
    return np.array([rim, far, 0.0, 0.0, rim, 0.0])


def rotor_limits(limit: float) -> Array:
    """Limits of a rotor without a casing: the largest distance of a node from its straight position [m].

    >>> rotor_limits(0.05).tolist()
    [inf, 0.05, 0.0, 0.0, inf, 0.0]
    """
    return np.array([math.inf, limit, 0.0, 0.0, math.inf, 0.0])


def passed(limits: Array | None) -> tuple[str, float, float] | None:
    """Name of the limit that a run passed, the value reached and the value allowed [m]; None within all limits.

    >>> passed(np.array([1e-3, 0.05, 2e-3, 0.01])), passed(np.array([1e-3, 0.05, 5e-4, 0.01]))
    (('wall', 0.002, 0.001), None)
    """
    if limits is None:
        return None
    for kind in (TIP, RIM):
        if not limits[REACHED + kind] <= limits[kind]:
            wall = kind == RIM and limits[RIM] < limits[TIP]
            name = "gap" if math.isinf(limits[RIM]) else "wall" if wall else "radius"
            return name, float(limits[REACHED + kind]), float(limits[kind])
    return None


def wall_flags(deflection: float, thickness: float) -> tuple[Flag, ...]:
    """Flag for a rim's largest deflection [m] if it exceeds half of the wall; none below."""
    if not (math.isfinite(thickness) and thickness > 0.0 and deflection > WALL * thickness):
        return ()
    part = f"{deflection / thickness:.2g} of its wall thickness"
    words = f"the rim deflected by {deflection:.3g} m, {part}; linear theory is valid to {WALL:g} of it"
    return (Flag(words, "wall-deflection"),)


def require_near(radius: float, **lengths: float) -> None:
    """Raise InputError for the first length [m] beyond a tenth of the radius, which suggests a mistyped unit."""
    for name, value in lengths.items():
        if not abs(value) <= FAR * radius:
            expected = f"at most a tenth of it: {value:g} mm are {1e-3 * value:g} m"
            raise InputError(f"{name}: found {value:g} m on a radius of {radius:g} m, expected {expected}")
