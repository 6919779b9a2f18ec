"""Compiled: cos phi and sin phi of eight angles at once, to the round-off of phi."""

from __future__ import annotations

import math

import numpy as np

from contact.jit.compiled import jit_inside
from contact.jit.vector import entry, same

WHOLE = 6755399441055744.0  # 1.5 2^52: added and taken away again, it rounds to a whole number
HIGH = math.floor(math.pi * 2.0**24) / 2.0**24  # n HIGH is exact for n < 2^27
LOW = math.pi - HIGH
REST = 1.2246467991473532e-16  # of pi, beyond double precision
COS = np.array([(-1.0) ** k / math.factorial(2 * k) for k in range(12)])  # of |x| <= pi/2: Taylor, to 1e-17
SIN = np.array([(-1.0) ** k / math.factorial(2 * k + 1) for k in range(12)])


@jit_inside
def half_turns(phi: float) -> float:
    """Nearest whole number of half turns."""
    turns: float = (phi * same(1.0 / math.pi) + same(WHOLE)) - same(WHOLE)
    return turns


@jit_inside
def within(phi: float, turns: float) -> float:
    """Angle less these half turns."""
    left: float = ((phi - turns * same(HIGH)) - turns * same(LOW)) - turns * same(REST)
    return left


@jit_inside
def sign_of(turns: float) -> float:
    """Sign by which sine and cosine differ after these half turns: 1 - 2 for odd ones."""
    half = turns * same(0.5)
    odd = half - ((half + same(WHOLE)) - same(WHOLE))  # 0 or +-1/2
    sign: float = same(1.0) - same(8.0) * odd * odd
    return sign


@jit_inside
def cosine(x: float) -> float:
    """Of |x| <= pi/2."""
    y, total = x * x, same(entry(COS, 11))
    for k in range(10, -1, -1):
        total = total * y + same(entry(COS, k))
    result: float = total
    return result


@jit_inside
def sine(x: float) -> float:
    """Of |x| <= pi/2."""
    y, total = x * x, same(entry(SIN, 11))
    for k in range(10, -1, -1):
        total = total * y + same(entry(SIN, k))
    result: float = total * x
    return result
