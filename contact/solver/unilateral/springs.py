"""Contact problem of one step for many frictionless compliant contacts: Newton's method on the motion.

    force_i = <-(A_i y + b_i)>/S_i,  y = A^T force      (A: contacts x coordinates, S_i > 0)

is the minimum of |y|^2/2 + sum <-(A_i y + b_i)>^2/(2 S_i), which is strictly convex and piecewise quadratic. Newton's
method with an exact line search ends after finitely many steps (Sun, J. Optim. Theory Appl. 95, 1997, 1). One step
costs k m^2 operations for k contacts and m coordinates, while active sets of forces cost k^3 in all.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from contact.base.arrays import Array
from contact.jit.compiled import jit
from contact.solver.dense import dot

STIFFEST = 1e6  # of A_i.A_i/S_i: a force has the round-off of its gap times this, 2e-10 of a force
MOST = 200  # Newton steps; a handful is usual
FAINT = 1e-14  # of the terms of a gap: its sign is round-off
LINE = 100  # steps of a line search, which passes the opening or closing of at least one contact each


class SpringSpace(NamedTuple):
    """Work arrays for k contacts in m coordinates; `y` is kept from one step to the next."""

    y: Array  # (m,)
    p: Array  # (m,), direction
    H: Array  # (m, m)
    gap: Array  # (k,), A y + b
    slope: Array  # (k,), A p


def spring_space(contacts: int, size: int) -> SpringSpace:
    """Work arrays for problems of this size."""
    return SpringSpace(np.zeros(size), np.zeros(size), np.zeros((size, size)), np.zeros(contacts), np.zeros(contacts))


def springs_of(A: Array, S: Array) -> Array:
    """Compliances (k,) of contacts that this method solves; empty if another method does.

    It needs more contacts than coordinates, a diagonal S, and no contact stiffer than STIFFEST allows.
    """
    own = np.diag(S) if S.size else np.zeros(len(A))
    alone = S.size > 0 and not np.any(S - np.diag(own))
    soft = np.all(own * STIFFEST >= np.sum(A**2, axis=1)) and np.all(own > 0.0)
    return own.copy() if alone and soft and A.shape[0] > A.shape[1] else np.zeros(0)


@jit
def spring_forces(A: Array, S: Array, b: Array, force: Array, w: SpringSpace) -> tuple[bool, int]:
    """Fill `force` for the free gaps `b`; returns whether the method converged, and its steps.

    A full step that changes no contact ends at the minimum.
    """
    k, m = S.size, w.y.size
    for i in range(k):
        w.gap[i] = dot(A[i], w.y, m) + b[i]
    for step in range(MOST):
        direction(A, S, w)
        for i in range(k):
            w.slope[i] = dot(A[i], w.p, m)
        same = True
        for i in range(k):
            gap = w.gap[i] + w.slope[i]
            flips = (w.gap[i] < 0.0) != (gap < 0.0)
            same &= not flips or abs(gap) <= FAINT * (abs(gap) + abs(b[i]))
        length = 1.0 if same else along(S, w)
        for j in range(m):
            w.y[j] += length * w.p[j]
        for i in range(k):
            w.gap[i] = dot(A[i], w.y, m) + b[i]
        if same:
            for i in range(k):
                force[i] = max(-w.gap[i], 0.0) / S[i]
            return True, step + 1
        if not math.isfinite(length):
            return False, step + 1
    return False, MOST


@jit
def direction(A: Array, S: Array, w: SpringSpace) -> None:
    """Newton's direction p: (I + sum A_i^T A_i/S_i) p = -y - sum A_i gap_i/S_i over the closed contacts."""
    m, H, p = w.y.size, w.H, w.p
    for j in range(m):
        p[j] = -w.y[j]
        for i in range(m):
            H[i, j] = 1.0 if i == j else 0.0
    for k in range(S.size):
        if w.gap[k] < 0.0:
            for i in range(m):
                weight = A[k, i] / S[k]
                p[i] -= weight * w.gap[k]
                for j in range(i + 1):
                    H[i, j] += weight * A[k, j]
    for j in range(m):  # Cholesky factor in the lower triangle
        for i in range(j, m):
            for n in range(j):
                H[i, j] -= H[i, n] * H[j, n]
            H[i, j] /= math.sqrt(H[i, j]) if i == j else H[j, j]
        for n in range(j):
            p[j] -= H[j, n] * p[n]
        p[j] /= H[j, j]
    for j in range(m - 1, -1, -1):
        for n in range(j + 1, m):
            p[j] -= H[n, j] * p[n]
        p[j] /= H[j, j]


@jit
def along(S: Array, w: SpringSpace) -> float:
    """Step to the minimum along p: the root of an increasing piecewise linear slope, by Newton from the left."""
    m = w.y.size
    square, start = dot(w.p, w.p, m), dot(w.y, w.p, m)
    low, high, t = 0.0, math.inf, 1.0
    for _ in range(LINE):
        value, rise = start + t * square, square
        for i in range(S.size):
            gap = w.gap[i] + t * w.slope[i]
            if gap < 0.0:
                value += w.slope[i] * gap / S[i]
                rise += w.slope[i] * w.slope[i] / S[i]
        if value < 0.0:
            low = t
        else:
            high = t
        if rise <= 0.0:
            return t
        ahead = t - value / rise
        if abs(ahead - t) <= 1e-12 * t:
            return t
        t = ahead if low < ahead < high else 0.5 * (low + high)
    return t
