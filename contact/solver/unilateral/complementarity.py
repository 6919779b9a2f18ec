"""Contact problem of one step for several contacts: 0 <= W lam + g, lam >= 0, complementary.

Principal pivoting: the set of closed contacts is corrected as a whole at first, then one contact at a time by the least
index, which ends for every positive definite W (Murty, Opsearch 11, 1974, 123). Redundant rows (singular W) get force
zero. If one of them is closer and would be left open, W gets a slight compliance. A single contact needs only a
division.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from numba import types

from contact.base.arrays import Array
from contact.jit.compiled import MATRIX, VECTOR, ByAddress, jit

BLOCK = 8  # corrections of the whole set before the least-index rule
PIVOTS = 2000  # corrections before the step is given up
SMALL = 1e-12  # of the largest gap or force: below, a sign is round-off
SINGULAR = 1e-13  # of a diagonal entry: a smaller pivot is a repeated row
LEFT_OPEN = 1e-11  # of the largest gap: more penetration means that the wrong one of repeated rows was left out
HAIR = 1e-12  # of the largest diagonal entry, added to it where rows repeat


@jit
def closed_forces(W: Array, soft: float, g: Array, closed: Array, A: Array, lam: Array) -> None:
    """Solve (W + soft I) lam = -g on the closed contacts, zero on the others."""
    n = g.size
    for i in range(n):
        lam[i] = -g[i] if closed[i] > 0.0 else 0.0
        for j in range(n):
            A[i, j] = W[i, j] if closed[i] > 0.0 and closed[j] > 0.0 else 0.0
        A[i, i] = W[i, i] + soft if closed[i] > 0.0 else 1.0
    for p in range(n):
        if A[p, p] <= SINGULAR * (W[p, p] + soft):
            for j in range(n):
                A[p, j], A[j, p] = 0.0, 0.0
            A[p, p], lam[p] = 1.0, 0.0
        for i in range(p + 1, n):
            ratio = A[i, p] / A[p, p]
            if ratio != 0.0:
                for j in range(p, n):
                    A[i, j] -= ratio * A[p, j]
                lam[i] -= ratio * lam[p]
    for i in range(n - 1, -1, -1):
        for j in range(i + 1, n):
            lam[i] -= A[i, j] * lam[j]
        lam[i] /= A[i, i]


def unilateral_forces(W: Array, soft: float, g: Array, lam: Array, closed: Array, A: Array) -> bool:
    """Lam >= 0 with (W + soft I) lam + g >= 0, complementary; returns False if the set of contacts cycles."""
    n = g.size
    size, open_all = 0.0, True
    for i in range(n):
        if g[i] != g[i]:
            return False
        open_all = open_all and g[i] >= 0.0
        if g[i] < 1e300:  # contacts left out of this step have an infinite gap
            size = max(size, abs(g[i]))
        closed[i] = 1.0 if g[i] < 0.0 or (lam[i] > 0.0 and g[i] < 1e300) else 0.0
    if open_all:
        lam[:] = 0.0
        return True
    if settle(W, soft, g, lam, closed, A, size) and least_gap(W, soft, g, lam) >= -LEFT_OPEN * size:
        return True
    top = 0.0
    for i in range(n):
        top = max(top, W[i, i])
        closed[i] = 1.0 if g[i] < 0.0 else 0.0
    return settle(W, soft + HAIR * top, g, lam, closed, A, size)


@jit
def least_gap(W: Array, soft: float, g: Array, lam: Array) -> float:
    """The smallest entry of (W + soft I) lam + g."""
    least = math.inf
    for i in range(g.size):
        total = g[i] + soft * lam[i]
        for j in range(g.size):
            total += W[i, j] * lam[j]
        least = min(least, total)
    return least


@jit
def settle(W: Array, soft: float, g: Array, lam: Array, closed: Array, A: Array, size: float) -> bool:
    """Correct the set of closed contacts until no force and no open gap is negative; returns False if it cycles."""
    n = g.size
    for pivot in range(PIVOTS):
        closed_forces(W, soft, g, closed, A, lam)
        top = 0.0
        for i in range(n):
            top = max(top, abs(lam[i]))
        wrong = 0
        for i in range(n):
            total = g[i]  # of an open contact, which is not soft
            for j in range(n):
                total += W[i, j] * lam[j]
            if lam[i] < -SMALL * top or (closed[i] == 0.0 and total < -SMALL * size):
                wrong += 1
                closed[i] = 1.0 - closed[i]
                if pivot >= BLOCK:
                    break
        if wrong == 0:
            for i in range(n):
                lam[i] = max(lam[i], 0.0)
            return True
    return False


SEVERAL: Any = types.boolean(MATRIX, types.float64, VECTOR, VECTOR, VECTOR, MATRIX)


class Several(ByAddress):
    """`unilateral_forces` as a function address, so that the loops of runs with one contact do not contain its code."""

    kind = SEVERAL
    function = staticmethod(unilateral_forces)


class LawNumbers(NamedTuple):
    """Parameters of a law. Rigid: stiffness 0. Penalty: stiffness [N/m]. Augmented.

    Also updates > 0 and a tolerance [m].
    """

    stiffness: float
    updates: int
    tolerance: float
    several: Several


@jit
def forces(W: Array, law: LawNumbers, soft: float, g: Array, lam: Array, closed: Array, A: Array) -> bool:
    """Lam >= 0 with (W + soft I) lam + g >= 0, complementary; returns False without a solution."""
    if g.size > 1:
        return bool(law.several(W, soft, g, lam, closed, A))
    if g.size == 1:
        lam[0] = 0.0 if g[0] >= 0.0 else -g[0] / (W[0, 0] + soft)
    return g.size == 0 or bool(lam[0] >= 0.0)


@jit
def contact_forces(W: Array, law: LawNumbers, g: Array, lam: Array, closed: Array, A: Array, shifted: Array) -> bool:
    """Forces of the law for free gaps g; `lam` has the last forces on entry. Returns False without a solution.

    Augmented Lagrangian: lam <- <lam - r (g + W lam)> solved for the new lam, until no gap is below -tolerance.
    """
    soft, n = 0.0, g.size
    if law.stiffness > 0.0:
        soft = 1.0 / law.stiffness
    if law.updates == 0:
        return forces(W, law, soft, g, lam, closed, A)
    for _ in range(law.updates):
        for i in range(n):
            shifted[i] = g[i] - soft * lam[i]
        if not forces(W, law, soft, shifted, lam, closed, A):
            return False
        worst = 0.0
        for i in range(n):
            gap = g[i]
            for j in range(n):
                gap += W[i, j] * lam[j]
            worst = max(worst, abs(min(gap, soft * lam[i])))
        if worst <= law.tolerance:
            return True
    return True
