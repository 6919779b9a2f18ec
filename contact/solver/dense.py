"""Small dense systems inside compiled loops: no allocation, rows in the order they lie in memory.

Up to some thirty unknowns, as contacts of one step have, LAPACK called from a loop takes longer.
"""

from __future__ import annotations

from contact.compiled import jit
from contact.model.arrays import Array


@jit
def assign(out: Array, x: Array) -> None:
    """Fill out = x; an assignment to a slice brings the words of its refusal, which take seconds to compile."""
    for i in range(out.size):
        out[i] = x[i]


@jit
def affine(A: Array, x: Array, b: Array, out: Array) -> None:
    """Fill out = A x + b."""
    for i in range(out.size):
        total = 0.0
        for k in range(x.size):
            total += A[i, k] * x[k]
        out[i] = total + b[i]


@jit
def solve_in_place(A: Array, x: Array) -> bool:
    """Replace x by A^-1 x and A by its factors, rows exchanged for the largest pivot; False where a pivot is zero."""
    n = x.size
    for p in range(n):
        top, largest = p, abs(A[p, p])
        for i in range(p + 1, n):
            if abs(A[i, p]) > largest:
                top, largest = i, abs(A[i, p])
        if not largest > 0.0:
            return False
        if top != p:
            x[p], x[top] = x[top], x[p]
            for k in range(p, n):
                A[p, k], A[top, k] = A[top, k], A[p, k]
        for i in range(p + 1, n):
            ratio = A[i, p] / A[p, p]
            if ratio != 0.0:
                for k in range(p + 1, n):
                    A[i, k] -= ratio * A[p, k]
                x[i] -= ratio * x[p]
    for i in range(n - 1, -1, -1):
        total = x[i]
        for k in range(i + 1, n):
            total -= A[i, k] * x[k]
        x[i] = total / A[i, i]
    return True
