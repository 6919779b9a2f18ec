"""Special points of a branch: folds, flips, Neimark-Sacker and branch points, grazing; found between neighbours."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from contact.base.errors import InputError, NumericsError
from contact.growth.cycles.course import Course, Tangent
from contact.growth.cycles.result import Special
from contact.growth.cycles.shooting import Orbit

BISECTIONS = 16
MOST = 8  # changes between two neighbours


class Signs(NamedTuple):
    """What changes at special points: the way of the parameter, how many multipliers are beyond 1, -1, in pairs.

    And how often each contact closes; where hits end at rest, how often they do: their number in a series says nothing.
    """

    forward: bool
    real: int
    flipped: int
    pairs: int
    closings: tuple[int, ...]


def signs(at: Orbit, along: Tangent) -> Signs:
    """Signs of an orbit whose branch goes along a tangent."""
    mu = at.multipliers
    real = mu.imag == 0.0
    return Signs(
        along.value > 0.0, int(np.sum(real & (mu.real > 1.0))), int(np.sum(real & (mu.real < -1.0))),
        int(np.sum(~real & (np.abs(mu) > 1.0))),
        tuple(-ends if ends else often for often, ends in zip(at.closings, at.rests, strict=True)),
    )  # fmt: skip


def kinds(left: Signs, right: Signs) -> list[str]:
    """What lies between two neighbours."""
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


def passed(course: Course, at: Orbit, new: Orbit, along: Tangent, length: float, after: Tangent) -> list[Special]:
    """Special points between an orbit and the next, `length` further, located by bisection along the tangent."""
    left, right = signs(at, along), signs(new, after)
    low, found = 0.0, []
    for _ in range(MOST):
        if left == right:
            break
        high, before, reached, there = length, at, new, right
        try:
            for _ in range(BISECTIONS):
                middle = 0.5 * (low + high)
                trial = course.next(at, along, middle)
                here = signs(trial, course.tangent(trial, along))
                if here == left:
                    low, before = middle, trial
                else:
                    high, reached, there = middle, trial, here
        except (NumericsError, InputError, np.linalg.LinAlgError):
            pass  # it is as near as one comes
        found += [Special(kind=kind, orbit=reached, before=before) for kind in kinds(left, there)]
        left, low = there, high
    return found
