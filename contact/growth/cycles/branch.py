"""Branches of periodic orbits by pseudo-arclength, around folds, with what happens on the way.

Unknown are the state and the parameter; the tangent is the null vector of [M - I, d Phi/d value] (Keller, 1977). The
arclength counts the state relative to its size and the parameter relative to its range.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from contact.base.arrays import Array, require_count, require_finite, require_positive
from contact.base.errors import InputError, NumericsError
from contact.growth.cycles.driven import Family
from contact.growth.cycles.result import Branch, Cycles, Special
from contact.growth.cycles.shooting import CLOSE, Orbit, made, map_of, orbit

DIFFERENCE = 1e-7  # of the parameter, for the derivative of the map by it
FIRST, LEAST = 0.3, 1e-4  # of the longest step
NEWTON, EASY = 8, 4
STRAIGHT = 0.9  # least cosine between tangents of neighbours
BISECTIONS = 16
FLIP = "flip"
Progress = Callable[[float], None]


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

    def slope(self, at: Orbit) -> Array:
        """How the state after a period changes with the parameter (n,)."""
        sense = 1.0 if at.value < self.low + 0.5 * self.span else -1.0  # into the range
        change = sense * DIFFERENCE * max(abs(at.value), 1e-3 * self.span)
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
        """The orbit on the plane across `along` at a distance; raises NumericsError."""
        n = at.x.size
        weight = 1.0 / max(float(at.x @ at.x), self.size**2)
        x, value = at.x + length * along.x, at.value + length * along.value
        J = np.zeros((n + 1, n + 1))
        J[n, :n], J[n, n] = weight * along.x, along.value / self.span**2
        for k in range(NEWTON):
            map_ = map_of(self.family, value, at.start, at.periods)
            found = map_(x)
            delta = DIFFERENCE * max(abs(value), 1e-3 * self.span)
            moved = map_of(self.family, value + delta, at.start, at.periods)(x, tangent=False)
            assert found.M is not None
            J[:n, :n], J[:n, n] = found.M - np.eye(n), (moved.x - found.x) / delta
            off = weight * float(along.x @ (x - at.x)) + along.value * (value - at.value) / self.span**2 - length
            change = np.linalg.solve(J, np.concatenate([x - found.x, [-off]]))
            x, value = x + change[:n], value + float(change[n])
            if not np.all(np.isfinite(x)):
                break
            if np.linalg.norm(change[:n]) <= CLOSE * np.linalg.norm(x) and abs(change[n]) <= CLOSE * self.span:
                return made(self.family, value, map_, at.periods, at.start, x, found, k + 1)
        raise NumericsError(f"no orbit after {NEWTON} Newton steps near {self.family.name} = {value:.8g}")


def branch(
    family: Family, between: tuple[float, float], *, first: Orbit | None = None, longest: float = 0.02,
    most: int = 1000, progress: Progress | None = None,
) -> Cycles:  # fmt: skip
    """Follow the orbits of a family from one value of its parameter to the other, and past folds until it leaves both.

    `first` is an orbit at the first value, by default the one a run from rest settles on; `longest` the longest step,
    1 being a change of the state by its own size, or the range; `most` the number of points. Raises NumericsError where
    not even a first orbit is found; a branch that ends before says where and why.
    """
    require_finite(start=between[0], end=between[1])
    require_positive(longest=longest)
    require_count(2, most=most)
    if between[0] == between[1]:
        raise InputError(f"{family.name}: found {between[0]:g} to {between[1]:g}, expected a range")
    begin = first or orbit(family, between[0])
    low, high = min(between), max(between)
    course = Course(family=family, low=low, high=high, size=1e-3 * float(np.linalg.norm(begin.x)) or 1.0)
    ahead = Tangent(np.zeros_like(begin.x), float(np.sign(between[1] - between[0])))
    found = followed(course, begin, ahead, longest=longest, most=most, progress=progress)
    return Cycles(name=family.name, branches=(found,))


def followed(
    course: Course, begin: Orbit, ahead: Tangent, *, longest: float, most: int, progress: Progress | None = None
) -> Branch:
    """Orbits from the first on, the way `ahead` goes."""
    points, specials, end = [begin], [], ""
    along = course.tangent(begin, ahead)
    length = FIRST * longest
    while len(points) < most:
        at = points[-1]
        try:
            new = course.next(at, along, length)
            after = course.tangent(new, along)
            bent = course.product(after, along, new.x) < STRAIGHT
        except (NumericsError, np.linalg.LinAlgError) as error:
            bent, end = True, str(error)
        if bent:
            length *= 0.5
            if length < LEAST * longest:
                end = end or "the branch turns at once: a corner"
                break
            continue
        end = ""
        if not course.low <= new.value <= course.high:
            last = _at_edge(course, at, along, new, length)
            if last is not None:
                specials += _passed(course, at, last[0], along, last[1])
                points.append(last[0])
            break
        specials += _passed(course, at, new, along, length, after)
        points.append(new)
        if progress is not None:
            progress((new.value - course.low) / course.span)
        along = after
        if new.iterations <= EASY:
            length = min(1.5 * length, longest)
    return Branch(points=tuple(points), specials=tuple(specials), end=end)


def _at_edge(course: Course, at: Orbit, along: Tangent, new: Orbit, length: float) -> tuple[Orbit, float] | None:
    """The orbit where the branch leaves the range, and its distance from the last one; None where that is the last."""
    edge = course.low if new.value < course.low else course.high
    if abs(at.value - edge) <= 1e-12 * course.span:
        return None
    part = (edge - at.value) / (new.value - at.value)
    guess = at.x + part * (new.x - at.x)
    last = orbit(course.family, edge, guess=guess, start=at.start, periods=at.periods)
    return last, part * length


def _passed(
    course: Course, at: Orbit, new: Orbit, along: Tangent, length: float, after: Tangent | None = None
) -> list[Special]:
    """What lies between two neighbours, located by bisection along the tangent."""
    left = _signs(at, along)
    right = _signs(new, after or course.tangent(new, along))
    if left == right:
        return []
    low, high, reached = 0.0, length, new
    before = at
    try:
        for _ in range(BISECTIONS):
            middle = 0.5 * (low + high)
            trial = course.next(at, along, middle)
            if _signs(trial, course.tangent(trial, along)) == left:
                low, before = middle, trial
            else:
                high, reached = middle, trial
    except (NumericsError, np.linalg.LinAlgError):
        pass  # as near as it is
    found = _signs(reached, course.tangent(reached, along))
    specials = [Special(kind=kind, orbit=reached, before=before) for kind in _kinds(left, found)]
    if high < length and found != right and reached is not new:
        rest = course.tangent(reached, along)
        specials += [Special(kind=kind, orbit=new, before=reached) for kind in _kinds(_signs(reached, rest), right)]
    return specials


class Signs(NamedTuple):
    """What changes at special points: the way of the parameter, how many multipliers are beyond 1, -1, in pairs."""

    forward: bool
    real: int
    flipped: int
    pairs: int
    closings: tuple[int, ...]


def _signs(at: Orbit, along: Tangent) -> Signs:
    mu = at.multipliers
    real = mu.imag == 0.0
    return Signs(
        along.value > 0.0, int(np.sum(real & (mu.real > 1.0))), int(np.sum(real & (mu.real < -1.0))),
        int(np.sum(~real & (np.abs(mu) > 1.0))), at.closings,
    )  # fmt: skip


def _kinds(left: Signs, right: Signs) -> list[str]:
    kinds = []
    if left.forward != right.forward:
        kinds.append("fold")
    elif left.real != right.real and left.pairs == right.pairs:
        kinds.append("branch point")
    if left.flipped != right.flipped and left.pairs == right.pairs:
        kinds.append(FLIP)
    if left.pairs != right.pairs and left.real + left.flipped == right.real + right.flipped:
        kinds.append("Neimark-Sacker")
    if left.closings != right.closings:
        kinds.append("grazing")
    return kinds
