"""A branch of periodic orbits: pseudo-arclength steps around folds up to the edges of the range, and special points.

The unknowns are the state and the parameter; the tangent is the null vector of [M - I, d Phi/d value] (Keller, 1977).
The arclength counts the state relative to its size and the parameter relative to its range. Steps are longer where the
correction converges fast and the branch is nearly straight.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from contact.base.arrays import Array
from contact.base.errors import InputError, NumericsError
from contact.cycles.driven import Family
from contact.cycles.result import Branch, Special
from contact.cycles.shooting import CLOSE, EVEN, Orbit, made, map_of, orbit

DIFFERENCE = 1e-7  # of the parameter, for the derivative of the map by it
NEWTON = 8
BISECTIONS = 16
MOST = 8  # changes between two neighbours
FIRST, LEAST = 0.3, 1e-4  # of the longest step
EASY = 4  # Newton steps
STRAIGHT = 0.9  # least cosine between tangents of neighbours
CORNER, JOINS = "the branch has a corner", "joins the branch of half its period"


class Tangent(NamedTuple):
    """Direction of a branch, of unit length in the metric of its orbit."""

    x: Array
    value: float


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Course:
    """Settings of a continuation: `span` is the range of the parameter, `size` the smallest scale of a state."""

    family: Family
    low: float
    high: float
    size: float

    @property
    def span(self) -> float:
        """Length of the range."""
        return self.high - self.low

    def product(self, a: Tangent, b: Tangent, x: Array) -> float:
        """Inner product of two directions at a state."""
        return float(a.x @ b.x) / max(float(x @ x), self.size**2) + a.value * b.value / self.span**2

    def unit(self, t: Tangent, x: Array) -> Tangent:
        """The direction scaled to unit length."""
        length = np.sqrt(self.product(t, t, x))
        return Tangent(t.x / length, t.value / length)

    def difference(self, value: float) -> float:
        """A small difference of the parameter that stays inside the range."""
        sense = 1.0 if value < self.low + 0.5 * self.span else -1.0
        return sense * DIFFERENCE * max(abs(value), 1e-3 * self.span)

    def slope(self, at: Orbit) -> Array:
        """Derivative of the state after one period with respect to the parameter (n,)."""
        if at.slope is not None:
            return at.slope
        change = self.difference(at.value)
        moved = map_of(self.family, at.value + change, at.start, at.periods)(at.x, tangent=False)
        return (moved.x - at.x) / change

    def tangent(self, at: Orbit, along: Tangent) -> Tangent:
        """Direction of the branch at an orbit, on the side of `along`."""
        n = at.x.size
        J = np.zeros((n + 1, n + 1))
        J[:n, :n], J[:n, n] = at.M - np.eye(n), self.slope(at)
        J[n, :n], J[n, n] = along.x / max(float(at.x @ at.x), self.size**2), along.value / self.span**2
        found = np.linalg.solve(J, np.concatenate([np.zeros(n), [1.0]]))
        return self.unit(Tangent(found[:n], float(found[n])), at.x)

    def next(self, at: Orbit, along: Tangent, length: float, bend: Tangent | None = None) -> Orbit:
        """The orbit on the plane normal to `along` at a given distance; `bend` is the change of the tangent there.

        Raises NumericsError where no orbit is found, and InputError for a value of the parameter outside the family.
        """
        n = at.x.size
        weight = 1.0 / max(float(at.x @ at.x), self.size**2)
        x, value = at.x + length * along.x, float(at.value + length * along.value)
        if bend is not None:
            x, value = x + 0.5 * length**2 * bend.x, value + 0.5 * length**2 * bend.value
        J, eye = np.zeros((n + 1, n + 1)), np.eye(n)
        J[n, :n], J[n, n] = weight * along.x, along.value / self.span**2
        for k in range(NEWTON):
            map_ = map_of(self.family, value, at.start, at.periods)
            found = map_(x)
            delta = self.difference(value)
            near = map_of(self.family, value + delta, at.start, at.periods)
            slope = (near.beside(x, found, map_.period) - found.x) / delta
            assert found.M is not None
            J[:n, :n], J[:n, n] = found.M - eye, slope
            off = weight * float(along.x @ (x - at.x)) + along.value * (value - at.value) / self.span**2 - length
            change = np.linalg.solve(J, np.concatenate([x - found.x, [-off]]))
            x, value = x + change[:n], value + float(change[n])
            size, moved = float(x @ x), float(change[:n] @ change[:n])
            if not math.isfinite(size) or not self.low - self.span < value < self.high + self.span:
                break
            if moved <= CLOSE**2 * size and abs(change[n]) <= CLOSE * self.span:
                return made(self.family, value, map_, at.periods, at.start, x, found, k + 1, slope)
        raise NumericsError(f"found no orbit near {self.family.name} = {value:.8g} after {NEWTON} Newton steps")


class Signs(NamedTuple):
    """Quantities whose change marks a special point.

    Sign of d(parameter), numbers of multipliers above 1, below -1, in pairs.

    Also how often each contact closes. A series of impacts that ends at rest counts once, since the number of its
    impacts has no meaning.
    """

    forward: bool
    real: int
    flipped: int
    pairs: int
    closings: tuple[int, ...]


def signs(at: Orbit, along: Tangent) -> Signs:
    """Signs of an orbit at which the branch has this tangent."""
    mu = at.multipliers.tolist()
    real = [value.real for value in mu if value.imag == 0.0]
    return Signs(
        along.value > 0.0, sum(value > 1.0 for value in real), sum(value < -1.0 - EVEN for value in real),
        sum(value.imag != 0.0 and abs(value) > 1.0 + EVEN for value in mu),
        tuple(-ends if ends else often for often, ends in zip(at.closings, at.rests, strict=True)),
    )  # fmt: skip


def kinds(left: Signs, right: Signs) -> list[str]:
    """Kinds of special points between two neighbours."""
    found = []
    if left.forward != right.forward:
        found.append("fold")
    elif left.real != right.real and left.pairs == right.pairs:
        found.append("branch point")
    if left.flipped != right.flipped and left.pairs == right.pairs:
        found.append("flip")
    if left.pairs != right.pairs and left.real + left.flipped == right.real + right.flipped:
        found.append("Neimark-Sacker")
    if left.closings != right.closings:
        found.append("grazing")
    return found


def bent(along: Tangent, after: Tangent, length: float) -> Tangent:
    """Change of the tangent along the branch, over the last step."""
    return Tangent((after.x - along.x) / length, (after.value - along.value) / length)


def passed(course: Course, at: Orbit, new: Orbit, along: Tangent, length: float, after: Tangent) -> list[Special]:
    """Special points between an orbit and the next one, `length` away, located by bisection along the tangent."""
    left, right = signs(at, along), signs(new, after)
    if left == right:
        return []
    bend = bent(along, after, length)
    low, found = 0.0, []
    for _ in range(MOST):
        if left == right:
            break
        high, before, reached, there = length, at, new, right
        try:
            for _ in range(BISECTIONS):
                middle = 0.5 * (low + high)
                trial = course.next(at, along, middle, bend)
                here = signs(trial, course.tangent(trial, along))
                if here == left:
                    low, before = middle, trial
                else:
                    high, reached, there = middle, trial, here
        except (NumericsError, InputError, np.linalg.LinAlgError):
            pass  # bisection cannot come nearer
        found += [Special(kind=kind, orbit=reached, before=before) for kind in kinds(left, there)]
        left, low = there, high
    return found


class Way(NamedTuple):
    """A branch during continuation: orbits and special points so far, last direction, length of the next step."""

    points: tuple[Orbit, ...]
    specials: tuple[Special, ...]
    along: Tangent
    length: float
    bend: Tangent | None = None


def begun(course: Course, begin: Orbit, ahead: Tangent, longest: float) -> Way:
    """A branch that starts at its first orbit."""
    return Way((begin,), (), course.tangent(begin, ahead), FIRST * longest)


def followed(
    course: Course, way: Way, *, longest: float, most: int, progress: Callable[[Way], None] | None = None
) -> Branch:
    """All orbits of a branch from the current one on; `progress` receives the distance after each."""
    points, specials, along, length, bend = list(way.points), list(way.specials), way.along, way.length, way.bend
    while len(points) < most:
        at = points[-1]
        try:
            new = course.next(at, along, length, bend)
            after = course.tangent(new, along)
            end = CORNER if course.product(after, along, new.x) < STRAIGHT else ""
            value, x = (at.value, at.x) if end else (new.value, new.x)
        except (NumericsError, np.linalg.LinAlgError) as error:
            end, value, x = str(error), at.value, at.x
        except InputError as error:  # beyond the range there may be no orbit: the step ends at its edge
            end, value, x = str(error), float(at.value + length * along.value), at.x + length * along.x
        outside = not course.low <= value <= course.high
        edge = _at_edge(course, at, value, x) if outside else None
        if end and edge is None:
            length, bend = 0.5 * length, None
            if length < LEAST * longest:
                return Branch(points=tuple(points), specials=tuple(specials), end=_why(course, at, along, end))
            continue
        if outside:
            if edge is not None:
                part = (edge.value - at.value) / (value - at.value)
                specials += passed(course, at, edge, along, part * length, course.tangent(edge, along))
                points.append(edge)
            break
        specials += passed(course, at, new, along, length, after)
        points.append(new)
        if merged(course, points[-2], new):
            return Branch(points=tuple(points), specials=tuple(specials), end=JOINS)
        along, bend = after, bent(along, after, length)
        if new.iterations <= EASY:
            length = min(1.5 * length, longest)
        if progress is not None:
            progress(Way(tuple(points), tuple(specials), along, length, bend))
    end = f"{most} orbits" if len(points) >= most else ""
    return Branch(points=tuple(points), specials=tuple(specials), end=end)


def merged(course: Course, last: Orbit, new: Orbit) -> bool:
    """Whether an orbit of even period has passed the orbit of half its period.

    Beyond that point the branch repeats itself.
    """
    if new.periods % 2:
        return False
    apart = []
    for at in (last, new):
        half = map_of(course.family, at.value, at.start, at.periods // 2)
        apart.append(half(at.x, tangent=False).x - at.x)
    return bool(apart[0] @ apart[1] < 0.0)


def _why(course: Course, at: Orbit, along: Tangent, error: str) -> str:
    """Reason why a branch stops: grazing within a step, where the map of a rigid contact is not differentiable."""
    for length in (0.01, -0.01):
        value = at.value + length * along.value
        try:
            ahead = map_of(course.family, value, at.start, at.periods)(at.x + length * along.x, tangent=False)
        except (NumericsError, InputError) as other:
            return str(other)
        if sum(event.closes for event in ahead.events) != sum(at.closings):
            return f"a contact grazes ({error})"
    return error


def _at_edge(course: Course, at: Orbit, value: float, x: Array) -> Orbit | None:
    """The orbit where a step crosses the edge of the range; None if the last orbit is on it, or none is found."""
    edge = course.low if value < course.low else course.high
    if abs(at.value - edge) <= 1e-12 * course.span:
        return None
    part = (edge - at.value) / (value - at.value)
    try:
        return orbit(course.family, edge, guess=at.x + part * (x - at.x), start=at.start, periods=at.periods)
    except NumericsError:
        return None
