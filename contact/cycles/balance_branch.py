"""Branches by harmonic balance.

Such a branch may turn back where that of the orbits does not, because a short series is another system. These turning
points are no folds: folds are those of `follow`, where a Floquet multiplier passes +1.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from contact.base.arrays import Array, require_count, require_finite, require_positive
from contact.base.errors import InputError, NumericsError
from contact.cycles.balance import (
    CLOSE,
    HALVINGS,
    HARMONICS,
    NEWTON,
    Balanced,
    balance,
    balanced,
    jacobian,
    linear,
    scales,
)
from contact.cycles.driven import Family
from contact.cycles.harmonics import complexes, reals, response
from contact.io.threads import with_one_thread

DIFFERENCE = 1e-6  # of the parameter, for the derivative by it
EASY = 4  # Newton steps
LEAST = 1e-4  # of the longest step


class Point(NamedTuple):
    """Real unknowns of a series, and the parameter; or a direction of both."""

    v: Array
    value: float

    def plus(self, other: Point, length: float = 1.0) -> Point:
        """Sum with a multiple of another one."""
        return Point(self.v + length * other.v, self.value + length * other.value)


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Equations:
    """Equations of harmonic balance over the parameter, and the metric of its branches."""

    family: Family
    harmonics: int
    periods: int
    span: float

    def product(self, a: Point, b: Point, at: Point) -> float:
        """Inner product of two directions at a point."""
        return float(a.v @ b.v) / max(float(at.v @ at.v), np.finfo(float).tiny) + a.value * b.value / self.span**2

    def unit(self, t: Point, at: Point) -> Point:
        """The direction scaled to unit length."""
        length = float(np.sqrt(self.product(t, t, at)))
        return Point(t.v / length, t.value / length)

    def corrected(self, guess: Point, along: Point) -> tuple[Point, Point, int] | None:
        """The solution on the plane through a guess normal to a direction, the tangent there, and the Newton steps."""
        at, border = guess, np.append(along.v / max(float(guess.v @ guess.v), 1e-300), along.value / self.span**2)
        last = np.zeros(at.v.size + 1)
        last[-1] = 1.0
        try:
            off, J = self.linear(at)
            for step in range(1, NEWTON + 1):
                ahead = border @ np.append(guess.v - at.v, guess.value - at.value)
                sides = np.column_stack([np.append(-off, ahead), last])
                change, tangent = np.linalg.solve(np.vstack([J, border]), sides).T
                if not np.all(np.isfinite(change)) or abs(at.value + change[-1] - guess.value) > self.span:
                    return None
                move, before = Point(change[:-1], float(change[-1])), float(np.linalg.norm(off))
                close = CLOSE * float(np.linalg.norm(at.v + move.v))
                if np.linalg.norm(move.v) <= close and abs(move.value) <= CLOSE * self.span:
                    at = at.plus(move)
                    return at, self.unit(Point(tangent[:-1], float(tangent[-1])), at), step
                for half in range(HALVINGS):
                    trial = at.plus(move, 0.5**half)
                    off, J = self.linear(trial)
                    if np.linalg.norm(off) <= (1.0 - 1e-4 * 0.5**half) * before:
                        break
                at = trial
        except (InputError, NumericsError, np.linalg.LinAlgError):
            return None
        return None

    def linear(self, at: Point) -> tuple[Array, Array]:
        """Weighted residual and its derivative by unknowns and parameter, (m,) and (m, m + 1)."""
        motion, _ = self.family.at(at.value)
        here = response(motion, self.harmonics, self.periods)
        delta = DIFFERENCE * max(abs(at.value), 1e-3 * self.span)
        near = response(self.family.at(at.value + delta)[0], self.harmonics, self.periods)
        y, weight = complexes(at.v, len(here.own)), scales(here)
        off, forces = linear(here, y)
        moved = np.einsum("hab,bh->ah", near.receptance - here.receptance, forces.lam)
        slope = -reals(near.still - here.still + moved) / delta
        return weight * off, weight[:, None] * np.column_stack([jacobian(here, forces), slope])

    def solution(self, at: Point, steps: int) -> Balanced:
        """The result at a point; raises as `balance`."""
        motion, _ = self.family.at(at.value)
        here = response(motion, self.harmonics, self.periods)
        y = complexes(at.v, len(here.own))
        return balanced(self.family, at.value, motion, self.periods, here, y, steps)


@with_one_thread
def balance_branch(
    family: Family, between: tuple[float, float], *, harmonics: int = HARMONICS, first: Balanced | None = None,
    longest: float = 0.02, most: int = 1000,
) -> tuple[Balanced, ...]:  # fmt: skip
    """Follow the motions of `balance` over a range of the parameter, by pseudo-arclength, until they leave it.

    It is a quick first pass for bodies of many modes, because modes are no unknowns. `first` is a motion at the first
    value, by default that of `balance`. `longest` is the longest step and `most` the largest number of motions, as in
    `follow`. The branch ends inside the range where Newton's method finds no further motion.

    Stability and folds are not computed. The parameter may turn back where the orbits of `follow` have no fold; only
    `follow` finds folds. Raises as `balance`.

    >>> import contact as ct
    >>> mass = ct.ModalBody(omega=[1.0], zeta=[0.025], channels=("x", "stop"), rows=[[1.0], [-1.0]], S=np.zeros((2, 2)))
    >>> patch = ct.Patch(body=mass, normal=("stop",), clearance=0.1)
    >>> driven = ct.cycles.DrivenBody(patch=patch, channel="x", amplitude=0.02, stiffness=100.0, shown=("x",))
    >>> motions = ct.cycles.balance_branch(driven.over("freq_hz", freq_hz=0.1), (0.1, 0.14), longest=0.5)
    >>> [round(motions[k].amplitude["x"], 4) for k in (0, -1)]
    [0.033, 0.0868]
    """
    require_finite(start=between[0], end=between[1])
    require_positive(longest=longest)
    require_count(2, most=most)
    if between[0] == between[1]:
        raise InputError(f"{family.name}: found {between[0]:g} to {between[1]:g}, expected two different ends")
    begin = first or balance(family, between[0], harmonics=harmonics)
    equations = Equations(
        family=family, harmonics=begin.harmonics, periods=begin.periods, span=abs(between[1] - between[0])
    )
    at, found, length = Point(reals(begin.y), begin.value), [begin], 0.3 * longest
    along = Point(np.zeros_like(at.v), between[1] - between[0])
    start = equations.corrected(at, along)
    along = equations.unit(along, at) if start is None else start[1]
    while len(found) < most and length >= LEAST * longest:
        new = equations.corrected(at.plus(along, length), along)
        if new is None:
            length *= 0.5
            continue
        if not min(between) <= new[0].value <= max(between):
            edge = min(max(new[0].value, min(between)), max(between))
            with suppress(NumericsError):  # else the branch ends before the edge
                found.append(balance(family, edge, harmonics=begin.harmonics, guess=found[-1]))
            break
        at, along, steps = new
        found.append(equations.solution(at, steps))
        length = min(1.5 * length, longest) if steps <= EASY else length
    return tuple(found)
