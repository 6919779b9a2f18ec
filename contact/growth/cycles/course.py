"""One step along a branch of periodic orbits by pseudo-arclength, around folds.

Unknown are the state and the parameter; the tangent is the null vector of [M - I, d Phi/d value] (Keller, 1977). The
arclength counts the state relative to its size and the parameter relative to its range.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from contact.base.arrays import Array
from contact.base.errors import NumericsError
from contact.growth.cycles.driven import Family
from contact.growth.cycles.shooting import CLOSE, Orbit, made, map_of

DIFFERENCE = 1e-7  # of the parameter, for the derivative of the map by it
NEWTON = 8


class Tangent(NamedTuple):
    """Direction of a branch, of unit length in the metric of its orbit."""

    x: Array
    value: float


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Course:
    """What a branch is continued with: `span` is the range of the parameter, `size` the least size of a state."""

    family: Family
    low: float
    high: float
    size: float

    @property
    def span(self) -> float:
        """Length of the range."""
        return self.high - self.low

    def product(self, a: Tangent, b: Tangent, x: Array) -> float:
        """Inner product at a state."""
        return float(a.x @ b.x) / max(float(x @ x), self.size**2) + a.value * b.value / self.span**2

    def unit(self, t: Tangent, x: Array) -> Tangent:
        """The direction with length one."""
        length = np.sqrt(self.product(t, t, x))
        return Tangent(t.x / length, t.value / length)

    def difference(self, value: float) -> float:
        """A small change of the parameter, into the range."""
        sense = 1.0 if value < self.low + 0.5 * self.span else -1.0
        return sense * DIFFERENCE * max(abs(value), 1e-3 * self.span)

    def slope(self, at: Orbit) -> Array:
        """How the state after a period changes with the parameter (n,)."""
        change = self.difference(at.value)
        moved = map_of(self.family, at.value + change, at.start, at.periods)(at.x, tangent=False)
        return (moved.x - at.x) / change

    def tangent(self, at: Orbit, along: Tangent) -> Tangent:
        """Direction of the branch at an orbit, the way `along` goes."""
        n = at.x.size
        J = np.zeros((n + 1, n + 1))
        J[:n, :n], J[:n, n] = at.M - np.eye(n), self.slope(at)
        J[n, :n], J[n, n] = along.x / max(float(at.x @ at.x), self.size**2), along.value / self.span**2
        found = np.linalg.solve(J, np.concatenate([np.zeros(n), [1.0]]))
        return self.unit(Tangent(found[:n], float(found[n])), at.x)

    def next(self, at: Orbit, along: Tangent, length: float) -> Orbit:
        """The orbit on the plane across `along` at a distance.

        Raises NumericsError where none is found, and InputError on the way to a value that the family has not.
        """
        n = at.x.size
        weight = 1.0 / max(float(at.x @ at.x), self.size**2)
        x, value = at.x + length * along.x, float(at.value + length * along.value)
        J = np.zeros((n + 1, n + 1))
        J[n, :n], J[n, n] = weight * along.x, along.value / self.span**2
        for k in range(NEWTON):
            map_ = map_of(self.family, value, at.start, at.periods)
            found = map_(x)
            delta = self.difference(value)
            moved = map_of(self.family, value + delta, at.start, at.periods)(x, tangent=False)
            assert found.M is not None
            J[:n, :n], J[:n, n] = found.M - np.eye(n), (moved.x - found.x) / delta
            off = weight * float(along.x @ (x - at.x)) + along.value * (value - at.value) / self.span**2 - length
            change = np.linalg.solve(J, np.concatenate([x - found.x, [-off]]))
            x, value = x + change[:n], value + float(change[n])
            if not np.all(np.isfinite(x)) or not self.low - self.span < value < self.high + self.span:
                break
            if np.linalg.norm(change[:n]) <= CLOSE * np.linalg.norm(x) and abs(change[n]) <= CLOSE * self.span:
                return made(self.family, value, map_, at.periods, at.start, x, found, k + 1)
        raise NumericsError(f"no orbit after {NEWTON} Newton steps near {self.family.name} = {value:.8g}")
