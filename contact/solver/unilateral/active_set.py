"""Contact problem of one step for many frictionless contacts: a dual active set on the motion, not on the forces.

    force >= 0,  gap = A A^T force + b >= 0,  force . gap = 0      (A: contacts x coordinates)

is the projection min |y|^2/2 subject to A y + b >= 0, y = A^T force. The method of Goldfarb & Idnani (Math. Programming
27, 1983, 1) starts from y = 0 and takes in the most violated contact, dropping those whose force would turn negative;
the QR factors of the active rows are updated by rotations. There may be many more contacts than coordinates; redundant
rows are recognised by their linear dependence.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from contact.base.arrays import Array, Indices
from contact.base.errors import InputError, NumericsError
from contact.jit.compiled import jit
from contact.solver.dense import dot

DEPENDENT = 1e-11  # of a row's length: its part outside the active rows, below which it depends on them
VIOLATED = 4e-15  # of the terms of a gap: less is round-off
UNOPENED = 1e-10  # the same where no motion is left: at a corner fixed by ill-conditioned rows round-off is larger
SOLVED, NO_MOTION, TOO_LONG = 0, 1, 2


class Contacts(NamedTuple):
    """`force`, `gap` (contacts,), motion `y` (coordinates,), and the number of changes of the active set.

    >>> found = unilateral(np.array([[1.0]]), np.array([-2.0]))
    >>> found.force.tolist(), found.gap.tolist(), found.iterations
    ([2.0], [0.0], 1)
    """

    force: Array
    gap: Array
    y: Array
    iterations: int


def unilateral(A: Array, b: Array) -> Contacts:
    """Forces of frictionless contacts in one step (Signorini's problem).

    force >= 0, gap = A (A^T force) + b >= 0, force . gap = 0: the projection min |y|^2/2 subject to A y + b >= 0, y =
    A^T force, by a dual active set (Goldfarb & Idnani, Math. Programming 27, 1983, 1).

    Parameters
    ----------
    A
        Gap rows times the square root of the step's compliance, (contacts, coordinates). With masses M and a step h,
        forces that act for one step move the gaps by A A^T = h^2 Q M^-1 Q^T.
    b
        Gaps of the free step, without these forces [m], (contacts,).

    Returns
    -------
    Contacts
        `force` [N] and `gap` [m], (contacts,) each, and the motion `y`.

    Raises
    ------
    InputError
        Shapes that do not fit, or values that are not finite.
    NumericsError
        If no motion opens all gaps at once (bodies wedged between rigid walls).

    Examples
    --------
    >>> found = unilateral(np.array([[1.0], [1.0], [2.0]]), np.array([-1.0, -1.0, 3.0]))
    >>> found.y.tolist(), float(found.force.sum()), found.gap.tolist()
    ([1.0], 1.0, [0.0, 0.0, 5.0])
    """
    A, b = np.ascontiguousarray(A, dtype=float), np.ascontiguousarray(b, dtype=float)
    if A.ndim != 2 or b.shape != A.shape[:1]:
        raise InputError(f"A, b: found shapes {A.shape} and {b.shape}, expected (contacts, coordinates), (contacts,)")
    if not (np.isfinite(A).all() and np.isfinite(b).all()):
        raise InputError("A, b: found values that are not finite, expected numbers")
    force, space = np.zeros(len(b)), active_space(len(b), A.shape[1])
    status, iterations = project(A, b, len(b), A.shape[1], force, space)
    y = space.y
    if status == NO_MOTION:
        raise NumericsError(
            "no motion opens all gaps at once: contacts press against each other; give them a compliance"
        )
    if status == TOO_LONG:
        raise NumericsError(
            f"the active set did not converge in {iterations} changes: scale the rows of A to similar size"
        )
    return Contacts(force=force, gap=A @ y + b, y=y, iterations=int(iterations))


def delassus_rows(W: Array) -> Array:
    """Rows A with A A^T = W for a symmetric positive semidefinite Delassus matrix, of full column rank.

    >>> A = delassus_rows(np.ones((3, 3)))
    >>> A.shape, bool(np.allclose(A @ A.T, 1.0))
    ((3, 1), True)
    """
    values, vectors = np.linalg.eigh(0.5 * (W + W.T))
    kept = values > len(values) * np.finfo(float).eps * values[-1]
    return np.asarray(vectors[:, kept] * np.sqrt(values[kept]))


class ActiveSpace(NamedTuple):
    """Work arrays for up to n contacts in m coordinates; `y` is the motion that `project` finds."""

    J: Array  # (m, m), rows orthonormal; active rows^T = J^T R
    R: Array  # (m, m)
    active: Indices  # (m,)
    lam: Array  # (m,), forces of the active contacts
    d: Array  # (m,)
    r: Array  # (m,)
    y: Array  # (m,)
    lengths: Array  # (n,)
    settled: Indices  # (n,), 1 for active contacts and for those that the active rows fix


def active_space(contacts: int, size: int) -> ActiveSpace:
    """Work arrays for problems of up to this size."""
    return ActiveSpace(
        J=np.zeros((size, size)), R=np.zeros((size, size)), active=np.zeros(size, dtype=np.int64), lam=np.zeros(size),
        d=np.zeros(size), r=np.zeros(size), y=np.zeros(size), lengths=np.zeros(contacts),
        settled=np.zeros(contacts, dtype=np.int64),
    )  # fmt: skip


@jit
def project(A: Array, b: Array, contacts: int, size: int, force: Array, w: ActiveSpace) -> tuple[int, int]:
    """Fill `force` and the motion `w.y`; returns (SOLVED | NO_MOTION | TOO_LONG, changes).

    Rows and columns of A and entries of b and `force` beyond `contacts` and `size` do not change.
    """
    J, R, active, lam, d, r, y = w.J, w.R, w.active, w.lam, w.d, w.r, w.y
    begin(A, contacts, size, force, w)
    count, limit = 0, 50 * (size + 10)
    for change in range(limit):
        p = most_violated(A, b, contacts, size, w)
        if p < 0:
            polish(A, b, count, size, w)
            for k in range(count):
                force[active[k]] += lam[k]
            return SOLVED, change
        pushed, row, length = 0.0, A[p], w.lengths[p]
        while True:  # take p in; contacts whose force reaches zero leave first
            for i in range(size):
                d[i] = dot(J[i], row, size)
            back_substitute(R, count, d, r)
            free = 0.0
            for i in range(count, size):
                free += d[i] * d[i]
            blocked, reach = -1, math.inf
            for k in range(count):
                if r[k] > 0.0 and lam[k] < reach * r[k]:
                    blocked, reach = k, lam[k] / r[k]
            independent = math.sqrt(free) > DEPENDENT * length
            gap = dot(row, y, size) + b[p]
            if not independent and blocked < 0:
                if pushed > 0.0 or gap < -UNOPENED * (length * math.sqrt(dot(y, y, size)) + abs(b[p])):
                    return NO_MOTION, change
                w.settled[p] = 1
                break
            full = -gap / free if independent else math.inf
            step = min(full, reach)
            if independent:
                for i in range(count, size):
                    for j in range(size):
                        y[j] += step * d[i] * J[i, j]
            for k in range(count):
                lam[k] -= step * r[k]
            pushed += step
            if full <= reach:
                enter(J, R, count, size, d)
                active[count], lam[count] = p, pushed
                w.settled[p] = 1  # its gap is zero; the computed value is round-off
                count += 1
                break
            leave(J, R, count, blocked, size)
            w.settled[active[blocked]] = 0
            for k in range(blocked, count - 1):
                active[k], lam[k] = active[k + 1], lam[k + 1]
            count -= 1
    return TOO_LONG, limit


@jit
def begin(A: Array, contacts: int, size: int, force: Array, w: ActiveSpace) -> None:
    """Start without active contacts and without motion."""
    for i in range(size):
        w.y[i] = 0.0
        for j in range(size):
            w.J[i, j] = 1.0 if i == j else 0.0
            w.R[i, j] = 0.0
    for i in range(contacts):
        w.lengths[i] = math.sqrt(dot(A[i], A[i], size))
        w.settled[i] = 0
        force[i] = 0.0


@jit
def most_violated(A: Array, b: Array, contacts: int, size: int, w: ActiveSpace) -> int:
    """The unsettled contact with the most negative gap relative to its row, beyond round-off; -1 if there is none."""
    moved = math.sqrt(dot(w.y, w.y, size))
    worst, found = 0.0, -1
    for i in range(contacts):
        gap, length = dot(A[i], w.y, size) + b[i], w.lengths[i]
        if w.settled[i] == 0 and gap < -VIOLATED * (length * moved + abs(b[i])) and gap < worst * length:
            worst, found = gap / length if length > 0.0 else -math.inf, i
    return found


@jit
def back_substitute(R: Array, count: int, d: Array, r: Array) -> None:
    """Solve R r = d for the first `count` entries."""
    for k in range(count - 1, -1, -1):
        total = d[k]
        for j in range(k + 1, count):
            total -= R[k, j] * r[j]
        r[k] = total / R[k, k]


@jit
def rotate(J: Array, i: int, k: int, c: float, s: float, size: int) -> None:
    """Rows i, k of J <- (c i + s k, c k - s i)."""
    for j in range(size):
        a, b = J[i, j], J[k, j]
        J[i, j], J[k, j] = c * a + s * b, c * b - s * a


@jit
def enter(J: Array, R: Array, count: int, size: int, d: Array) -> None:
    """Add a row with components d = J row to the factors: rotations reduce d[count:] to one number."""
    for i in range(size - 1, count, -1):
        length = math.hypot(d[i - 1], d[i])
        if d[i] == 0.0:
            continue
        rotate(J, i - 1, i, d[i - 1] / length, d[i] / length, size)
        d[i - 1] = length
    for i in range(count + 1):
        R[i, count] = d[i]


@jit
def leave(J: Array, R: Array, count: int, gone: int, size: int) -> None:
    """Take column `gone` out of R and make it triangular again."""
    for k in range(gone, count - 1):
        for i in range(k + 2):
            R[i, k] = R[i, k + 1]
    for k in range(gone, count - 1):
        length = math.hypot(R[k, k], R[k + 1, k])
        c, s = R[k, k] / length, R[k + 1, k] / length
        for j in range(k, count - 1):
            a, b = R[k, j], R[k + 1, j]
            R[k, j], R[k + 1, j] = c * a + s * b, c * b - s * a
        rotate(J, k, k + 1, c, s, size)


@jit
def polish(A: Array, b: Array, count: int, size: int, w: ActiveSpace) -> None:
    """Correct y and the forces once: active gaps back to zero, then forces from y."""
    J, R, active, lam, right, y = w.J, w.R, w.active, w.lam, w.d, w.y
    for k in range(count):  # R^T right = -gaps: the correction in the span of the active rows
        total = -(dot(A[active[k]], y, size) + b[active[k]])
        for j in range(k):
            total -= R[j, k] * right[j]
        right[k] = total / R[k, k]
    for k in range(count):
        for j in range(size):
            y[j] += right[k] * J[k, j]
    for i in range(count):
        right[i] = dot(J[i], y, size)
    back_substitute(R, count, right, lam)
    for j in range(size):
        y[j] = 0.0
    for k in range(count):
        lam[k] = max(lam[k], 0.0)
        for j in range(size):
            y[j] += lam[k] * A[active[k], j]
