"""The one-step problem of many frictionless contacts: a dual active set on the motion, not on the forces.

    force >= 0,  gap = A A^T force + b >= 0,  force . gap = 0      (A: contacts x coordinates)

is the projection min |y|^2/2 subject to A y + b >= 0, y = A^T force. The method of Goldfarb & Idnani (Math.
Programming 27, 1983, 1) starts from y = 0 and takes in the most violated contact, dropping those whose force
would turn negative; the QR factors of the active rows are updated by rotations. Contacts may outnumber
coordinates many times: redundant rows are recognised by their dependence, cost nothing and break nothing.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from contact.compiled import jit_allocating, jit_entry_allocating
from contact.errors import InputError, NumericsError
from contact.model.arrays import Array, Indices

DEPENDENT = 1e-11  # of a row's length: what is left of it beside the active rows
VIOLATED = 4e-15  # of the terms of a gap: less is round-off
UNOPENED = 1e-10  # the same where no motion is left: at a corner fixed by ill-conditioned rows round-off is larger
SOLVED, NO_MOTION, TOO_LONG = 0, 1, 2


class Contacts(NamedTuple):
    """`force`, `gap` (contacts,), the motion `y` (coordinates,), and how often a contact was taken in or out."""

    force: Array
    gap: Array
    y: Array
    iterations: int


def unilateral(A: Array, b: Array) -> Contacts:
    """Forces of frictionless contacts: force >= 0, gap = A (A^T force) + b >= 0, force . gap = 0.

    Parameters
    ----------
    A : (contacts, coordinates), gap rows times the square root of the step's compliance
    b : (contacts,), gaps of the free step

    Raises
    ------
    InputError
        Shapes that do not fit, or values that are not finite.
    NumericsError
        When no motion opens all gaps at once (bodies wedged between rigid walls).

    >>> found = unilateral(np.array([[1.0], [1.0], [2.0]]), np.array([-1.0, -1.0, 3.0]))
    >>> found.y.tolist(), float(found.force.sum()), found.gap.tolist()
    ([1.0], 1.0, [0.0, 0.0, 5.0])
    """
    A, b = np.ascontiguousarray(A, dtype=float), np.ascontiguousarray(b, dtype=float)
    if A.ndim != 2 or b.shape != A.shape[:1]:
        raise InputError(f"A, b: found shapes {A.shape} and {b.shape}, expected (contacts, coordinates), (contacts,)")
    if not (np.isfinite(A).all() and np.isfinite(b).all()):
        raise InputError("A, b: found values that are not finite, expected numbers")
    force, y = np.zeros(len(b)), np.zeros(A.shape[1])
    status, iterations = project(A, b, force, y)
    if status == NO_MOTION:
        raise NumericsError("no motion opens all gaps at once: contacts press against each other without compliance")
    if status == TOO_LONG:
        raise NumericsError(f"the active set did not settle in {iterations} changes; largest row over smallest too big")
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


@jit_entry_allocating
def project(A: Array, b: Array, force: Array, y: Array) -> tuple[int, int]:
    """Fill `force` and `y` (both zero on entry); returns (SOLVED | NO_MOTION | TOO_LONG, changes)."""
    contacts, size = A.shape
    J, R = np.eye(size), np.zeros((size, size))  # rows of J: orthonormal; active rows^T = J^T R
    active, lam = np.zeros(size, dtype=np.int64), np.zeros(size)
    d, r, lengths = np.zeros(size), np.zeros(size), np.zeros(contacts)
    settled = np.zeros(contacts, dtype=np.int64)
    for i in range(contacts):
        lengths[i] = np.sqrt(np.dot(A[i], A[i]))
    count, limit = 0, 50 * (size + 10)
    for change in range(limit):
        p = most_violated(A, b, y, lengths, settled)
        if p < 0:
            polish(A, b, active, count, J, R, lam, y)
            for k in range(count):
                force[active[k]] += lam[k]
            return SOLVED, change
        pushed = 0.0
        while True:  # take p in; contacts whose force reaches zero leave first
            row = A[p]
            for i in range(size):
                d[i] = np.dot(J[i], row)
            back_substitute(R, count, d, r)
            free = 0.0
            for i in range(count, size):
                free += d[i] * d[i]
            blocked, reach = -1, np.inf
            for k in range(count):
                if r[k] > 0.0 and lam[k] < reach * r[k]:
                    blocked, reach = k, lam[k] / r[k]
            independent = np.sqrt(free) > DEPENDENT * lengths[p]
            gap = np.dot(row, y) + b[p]
            if not independent and blocked < 0:
                if pushed > 0.0 or gap < -UNOPENED * (lengths[p] * np.sqrt(np.dot(y, y)) + abs(b[p])):
                    return NO_MOTION, change
                settled[p] = 1
                break
            full = -gap / free if independent else np.inf
            step = min(full, reach)
            if independent:
                for i in range(count, size):
                    for j in range(size):
                        y[j] += step * d[i] * J[i, j]
            for k in range(count):
                lam[k] -= step * r[k]
            pushed += step
            if full <= reach:
                enter(J, R, count, d)
                active[count], lam[count] = p, pushed
                count += 1
                break
            leave(J, R, count, blocked)
            for k in range(blocked, count - 1):
                active[k], lam[k] = active[k + 1], lam[k + 1]
            count -= 1
    return TOO_LONG, limit


@jit_allocating
def most_violated(A: Array, b: Array, y: Array, lengths: Array, settled: Indices) -> int:
    """The contact, not settled, with the most negative gap beyond round-off per length of its row; -1 if none."""
    size = np.sqrt(np.dot(y, y))
    worst, found = 0.0, -1
    gaps = np.dot(A, y)
    for i in range(b.size):
        gap = gaps[i] + b[i]
        if settled[i] == 0 and gap < -VIOLATED * (lengths[i] * size + abs(b[i])) and gap < worst * lengths[i]:
            worst, found = gap / lengths[i] if lengths[i] > 0.0 else -np.inf, i
    return found


@jit_allocating
def back_substitute(R: Array, count: int, d: Array, r: Array) -> None:
    """R r = d for the first `count` entries."""
    for k in range(count - 1, -1, -1):
        total = d[k]
        for j in range(k + 1, count):
            total -= R[k, j] * r[j]
        r[k] = total / R[k, k]


@jit_allocating
def rotate(J: Array, i: int, k: int, c: float, s: float) -> None:
    """Rows i, k of J <- (c i + s k, c k - s i)."""
    for j in range(J.shape[1]):
        a, b = J[i, j], J[k, j]
        J[i, j], J[k, j] = c * a + s * b, c * b - s * a


@jit_allocating
def enter(J: Array, R: Array, count: int, d: Array) -> None:
    """Take a row with components d = J row into the factors: turn d[count:] into one number."""
    for i in range(d.size - 1, count, -1):
        length = np.hypot(d[i - 1], d[i])
        if d[i] == 0.0:
            continue
        rotate(J, i - 1, i, d[i - 1] / length, d[i] / length)
        d[i - 1] = length
    for i in range(count + 1):
        R[i, count] = d[i]


@jit_allocating
def leave(J: Array, R: Array, count: int, gone: int) -> None:
    """Take column `gone` out of R and make it triangular again."""
    for k in range(gone, count - 1):
        for i in range(k + 2):
            R[i, k] = R[i, k + 1]
    for k in range(gone, count - 1):
        length = np.hypot(R[k, k], R[k + 1, k])
        c, s = R[k, k] / length, R[k + 1, k] / length
        for j in range(k, count - 1):
            a, b = R[k, j], R[k + 1, j]
            R[k, j], R[k + 1, j] = c * a + s * b, c * b - s * a
        rotate(J, k, k + 1, c, s)


@jit_allocating
def polish(A: Array, b: Array, active: Indices, count: int, J: Array, R: Array, lam: Array, y: Array) -> None:
    """One correction of y and the forces: the active gaps back to zero, then forces from y anew."""
    size = y.size
    w = np.zeros(size)
    for k in range(count):  # R^T w = -gaps: the correction in the span of the active rows
        total = -(np.dot(A[active[k]], y) + b[active[k]])
        for j in range(k):
            total -= R[j, k] * w[j]
        w[k] = total / R[k, k]
    for k in range(count):
        for j in range(size):
            y[j] += w[k] * J[k, j]
    for i in range(count):
        w[i] = np.dot(J[i], y)
    back_substitute(R, count, w, lam)
    y[:] = 0.0
    for k in range(count):
        lam[k] = max(lam[k], 0.0)
        for j in range(size):
            y[j] += lam[k] * A[active[k], j]
