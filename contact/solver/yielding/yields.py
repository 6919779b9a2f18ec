"""A contact with a force-depth law in one step: its depth, and the equivalent spring of the law there.

    depth + D force = -gap,   force = F(depth, rate),   rate = rate_0 + rate_1 depth,

D > 0 the compliance of the step and `gap` the gap without this force. A law whose force increases with depth has one
solution; for another law the first one found is used.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numba import config, types

from contact.base.arrays import Array
from contact.jit.compiled import VECTOR, ByAddress, jit

MOST = 100  # steps to the depth, each at least half of the last bracket
CLOSE = 4e-15  # of the free gap: largest error of the depth
NUDGE = 1e-6  # of a rate, for the derivative of the force


kinds: Any = types
configured: Any = config
PAIR: Any = kinds.UniTuple(kinds.float64, 2)
Function = Callable[[float, float, Array], tuple[float, float]]


class ByDepth(ByAddress):
    """A force-depth law as a function address for loops."""

    kind: Any = PAIR(types.float64, types.float64, VECTOR)

    def __init__(self, function: Function, *, used: bool = True) -> None:
        super().__init__(used=used)
        self.function = function

    def __call__(self, depth: float, rate: float, values: Array) -> tuple[float, float]:
        """Run it in Python if numba does not compile."""
        force, slope = self.function(depth, rate, values)
        return force, slope

    def compile(self) -> None:
        """Compile the law if numba compiles; raises numba's error."""
        if not configured.DISABLE_JIT:
            self.__wrapper_address__()


class Yielding(NamedTuple):
    """The law of K contacts, with the depths [m] of the last two steps and the terms of the rate of each.

    Rigid surfaces have none: K = 0.
    """

    law: ByDepth
    values: Array
    rate: Array  # (K, 2): rate = rate[k, 0] + rate[k, 1] depth [1/s]
    past: Array  # (K, 2) the last depth and that before, below 0 of open contacts
    depth: Array  # (K,) found in this step, for loops to keep
    steepest: Array  # (1,) largest slope so far [N/m]


def yielding(law: ByDepth, values: Array, now: Array, before: Array) -> Yielding:
    """Work arrays for contacts with these gaps at t_0 and a step before, (K,) each."""
    past = -np.stack([now, before], axis=1)
    return Yielding(
        law=law, values=values, rate=np.zeros((now.size, 2)), past=past, depth=np.zeros(now.size), steepest=np.zeros(1)
    )


def no_law() -> Yielding:
    """Rigid contacts."""
    none = np.zeros(0)
    return yielding(ByDepth(_rigid, used=False), none, none, none)


def _rigid(depth: float, rate: float, values: Array) -> tuple[float, float]:
    raise AssertionError("a rigid surface has no force-depth law")


@jit
def gives_way(y: Yielding) -> bool:
    """Whether the contacts have a law."""
    return bool(y.depth.size > 0)


@jit
def paced(y: Yielding, k: int, h: float) -> None:
    """Rate of the depth of contact k in this step, (3 depth - 4 depth_{n-1} + depth_{n-2})/(2 h) (Gear's, order 2)."""
    y.rate[k, 0] = (0.5 * y.past[k, 1] - 2.0 * y.past[k, 0]) / h
    y.rate[k, 1] = 1.5 / h


@jit
def passed(y: Yielding, k: int, depth: float) -> None:
    """Keep the depth of contact k after a step; negative if it is open."""
    y.past[k, 1] = y.past[k, 0]
    y.past[k, 0] = depth


@jit
def bears(y: Yielding, k: int, depth: float) -> tuple[float, float]:
    """Force of contact k at a depth, and its derivative with respect to the depth within this step."""
    by_depth = y.rate[k, 1]
    rate = y.rate[k, 0] + by_depth * depth
    force, slope = y.law(depth, rate, y.values)
    if by_depth != 0.0:
        nudge = NUDGE * (abs(rate) + by_depth * depth)
        faster, _ = y.law(depth, rate + nudge, y.values)
        slope += by_depth * (faster - force) / nudge
    return force, slope


@jit
def pressed(y: Yielding, k: int, D: float, gap: float) -> float:
    """Depth of contact k alone, whose free `gap` is negative; 0 if its rate alone already gives enough force."""
    at_once, _ = y.law(0.0, y.rate[k, 0], y.values)
    if D * at_once >= -gap:
        return 0.0
    low, high = 0.0, -gap
    depth = high
    for _ in range(MOST):
        force, slope = bears(y, k, depth)
        error = depth + D * force + gap
        if abs(error) <= -CLOSE * gap:
            break
        if error > 0.0:
            high = depth
        else:
            low = depth
        ahead = depth - error / (1.0 + D * slope)
        depth = ahead if low < ahead < high else 0.5 * (low + high)
        if not low < depth < high:
            break
    return depth


@jit
def press(y: Yielding, k: int, D: float, gap: float) -> tuple[float, float]:
    """Depth and force >= 0 of contact k alone, whose free `gap` is negative."""
    depth = pressed(y, k, D, gap)
    note_slope(y, k, depth)
    return depth, max(-(gap + depth) / D, 0.0)


@jit
def note_slope(y: Yielding, k: int, depth: float) -> None:
    """Record the largest slope of the law at a depth at rest."""
    if depth > 0.0:
        _, slope = y.law(depth, 0.0, y.values)
        y.steepest[0] = max(y.steepest[0], slope)
