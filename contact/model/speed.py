"""The speed of rotation over time, and tables by ascending places."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from contact.base.arrays import Array, readonly
from contact.base.errors import InputError
from contact.io.brief import brief


@dataclass(frozen=True, eq=False, slots=True)
class Speed:
    """Omega(t) [rad/s], linear between the points (time [s], hz), constant before the first and after the last.

    The angle is its exact integral, angle(0) = 0.

    >>> ramp = Speed(time=[0.0, 2.0], hz=[0.0, 1.0])
    >>> round(ramp.angle(2.0) / (2 * np.pi), 12), round(ramp.angle(3.0) / (2 * np.pi), 12)
    (1.0, 2.0)
    """

    time: Array
    hz: Array

    __repr__ = brief

    def __post_init__(self) -> None:
        for name in ("time", "hz"):
            object.__setattr__(self, name, readonly(np.atleast_1d(getattr(self, name))))
        require_table("speed", self.time, self.hz)

    @staticmethod
    def constant(hz: float) -> Speed:
        """One speed for the whole run [turns per second]."""
        return Speed(readonly([0.0]), readonly([hz]))

    @property
    def table(self) -> Array:
        """Rows (start [s], angle there [rad], Omega there, its slope), (segments, 4), the first from before t = 0."""
        t, w = self.time, 2.0 * math.pi * self.hz
        slope = np.concatenate(([0.0], np.diff(w) / np.diff(t), [0.0]))
        start, omega = np.concatenate(([min(t[0], 0.0) - 1.0], t)), np.concatenate(([w[0]], w))
        length = np.diff(start)
        angle = np.concatenate(([0.0], np.cumsum(omega[:-1] * length + 0.5 * slope[:-1] * length**2)))
        at_zero = _integral(np.stack([start, angle, omega, slope], axis=1), np.float64(0.0))[0]
        return np.ascontiguousarray(np.stack([start, angle - at_zero, omega, slope], axis=1))

    def angle(self, t: float) -> float:
        """Angle turned since t = 0 [rad]."""
        return float(_integral(self.table, np.float64(t))[0])

    def angles(self, t: Array) -> Array:
        """Angles turned since t = 0 at many times [rad]."""
        return np.asarray(_integral(self.table, t)[0])

    def omega(self, t: float) -> float:
        """Angular speed [rad/s]."""
        return float(_integral(self.table, np.float64(t))[1])

    @property
    def fastest(self) -> float:
        """Largest |Omega| [rad/s]."""
        return 2.0 * math.pi * float(np.abs(self.hz).max())


def _integral(table: Array, t: Array | np.float64) -> tuple[Array, Array]:
    start, angle, omega, slope = table[np.maximum(np.searchsorted(table[:, 0], t, side="right") - 1, 0)].T
    since = t - start
    return angle + omega * since + 0.5 * slope * since**2, omega + slope * since


def require_table(name: str, at: ArrayLike, values: ArrayLike) -> None:
    """Refuse a table whose places do not ascend, or that has not as many finite values as places."""
    x, y = np.asarray(at, dtype=float), np.asarray(values, dtype=float)
    if x.ndim != 1 or x.shape != y.shape or not x.size:
        raise InputError(f"{name}: found {x.shape} places and {y.shape} values, expected equal numbers")
    if not (np.isfinite(x).all() and np.isfinite(y).all()):
        raise InputError(f"{name}: found values that are NaN or infinite, expected finite numbers")
    if np.any(np.diff(x) <= 0.0):
        worst = int(np.argmin(np.diff(x)))
        raise InputError(f"{name}: found {x[worst + 1]:g} after {x[worst]:g}, expected ascending values")
