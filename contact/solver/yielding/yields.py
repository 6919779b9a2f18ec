"""A contact with a force-depth law in one step: its depth, and the spring that the law is there.

    depth + D force = -gap,   force = F(depth, rate),   rate = rate_0 + rate_1 depth,

D > 0 the compliance of the step and `gap` the gap without this force. A law whose force rises with the depth has one
depth; of another law the first one found.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numba import config, types

from contact.base.arrays import Array
from contact.jit.compiled import VECTOR, ByAddress, jit

MOST = 100  # steps to the depth, each at least half of the last bracket
CLOSE = 4e-15  # of the free gap: what the depth may miss
NUDGE = 1e-6  # of a rate, to see how the force depends on it


kinds: Any = types
configured: Any = config
PAIR: Any = kinds.UniTuple(kinds.float64, 2)
Function = Callable[[float, float, Array], tuple[float, float]]


class ByDepth(ByAddress):
    """A force-depth law as loops call it."""

    kind: Any = PAIR(types.float64, types.float64, VECTOR)

    def __init__(self, function: Function) -> None:
        super().__init__(used=True)
        self.function = function

    def __call__(self, depth: float, rate: float, values: Array) -> tuple[float, float]:
        """Run it where numba does not compile."""
        force, slope = self.function(depth, rate, values)
        return force, slope

    def compile(self) -> None:
        """Compile it, where numba compiles; raises what numba raises."""
        if not configured.DISABLE_JIT:
            self.__wrapper_address__()


class Yielding(NamedTuple):
    """The law of K contacts, and for each what its rate is made of, and depth and slope found last."""

    law: ByDepth
    values: Array
    rate: Array  # (K, 2): rate = rate[k, 0] + rate[k, 1] depth [1/s]
    depth: Array  # (K,) [m], 0 of an open contact
    steepest: Array  # (1,) largest slope so far [N/m]


def yielding(law: ByDepth, values: Array, contacts: int) -> Yielding:
    """Work space for so many contacts."""
    return Yielding(
        law=law, values=values, rate=np.zeros((contacts, 2)), depth=np.zeros(contacts),
        steepest=np.zeros(1),
    )  # fmt: skip


@jit
def paced(y: Yielding, k: int, h: float, averaged: bool, scale: float, S: float, test: float, now: float, last: float,
          before: float) -> None:  # fmt: skip
    """How fast contact k gets deeper in this step, as a function of its depth.

    `scale` = D of the step, `S` its residual part; gaps of the modes alone: `test` of the step without force, `now` at
    t_n, `last` at t_{n-1}; `before` what S gave way in the last step. At the mean of three gaps the rate is
    -(g_{n+1} - g_{n-1})/(2 h), else -(g_{n+1} - g_n)/h, less what S gives way.
    """
    if averaged:
        y.rate[k, 0] = (now + last + before - S * test / scale) / h
        y.rate[k, 1] = (2.0 - S / scale) / h
    else:
        y.rate[k, 0] = (now + before) / h
        y.rate[k, 1] = 1.0 / h


@jit
def bears(y: Yielding, k: int, depth: float) -> tuple[float, float]:
    """Force of contact k at a depth, and how it changes with the depth within this step."""
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
    """Depth of contact k alone, whose free `gap` is negative; 0 where it opens at once by its rate."""
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
def press(y: Yielding, k: int, D: float, gap: float) -> float:
    """Force of contact k alone whose free `gap` is negative, >= 0; keeps its depth and the law's slope."""
    depth = pressed(y, k, D, gap)
    _, slope = bears(y, k, depth)
    y.depth[k] = depth
    y.steepest[0] = max(y.steepest[0], slope)
    return max(-(gap + depth) / D, 0.0)
