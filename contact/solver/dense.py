"""Small dense systems inside compiled loops: the first n rows and columns of arrays that are large enough.

Functions take sizes instead of slices, since a slice makes another array in every call and takes longer to compile. Up
to about thirty unknowns, typical of contacts, LAPACK called from a loop takes longer.
"""

from __future__ import annotations

import math
from typing import Any

from numba import types

from contact.base.arrays import Array
from contact.jit.compiled import MATRIX, VECTOR, ByAddress, jit
from contact.jit.vector import WIDTH, entry, load, put, same, total

PANEL = 4  # columns that `solve_in_place` takes at a time
LARGE = 40  # unknowns from which on it does: fewer stay in the nearest cache


@jit
def assign(out: Array, x: Array, n: int) -> None:
    """Fill out = x."""
    for i in range(n):
        out[i] = x[i]


@jit
def dot(a: Array, b: Array, n: int) -> float:
    """Sum of products."""
    whole, result = n - n % WIDTH, 0.0
    if whole > 0:
        part = same(0.0)
        for i in range(0, whole, WIDTH):
            part = part + load(a, i) * load(b, i)
        result = total(part)
    for i in range(whole, n):
        result += a[i] * b[i]
    return result


@jit
def dot_from(a: Array, first: int, b: Array, n: int) -> float:
    """Sum of products of `b` with as many entries of `a`, flat, from `first`."""
    whole, result = n - n % WIDTH, 0.0
    if whole > 0:
        part = same(0.0)
        for i in range(0, whole, WIDTH):
            part = part + load(a, first + i) * load(b, i)
        result = total(part)
    for i in range(whole, n):
        result += entry(a, first + i) * b[i]
    return result


@jit
def add_from(out: Array, ratio: float, a: Array, first: int, n: int) -> None:
    """Add `ratio` times the entries of `a`, flat, from `first`."""
    whole, part = n - n % WIDTH, same(ratio)
    for i in range(0, whole, WIDTH):
        put(out, i, load(out, i) + part * load(a, first + i))
    for i in range(whole, n):
        out[i] += ratio * entry(a, first + i)


@jit
def subtract(a: Array, ratio: float, b: Array, first: int, n: int) -> None:
    """Subtract ratio b from a, from entry `first` on."""
    whole, part = n - (n - first) % WIDTH, same(ratio)
    for i in range(first, whole, WIDTH):
        put(a, i, load(a, i) - part * load(b, i))
    for i in range(whole, n):
        a[i] -= ratio * b[i]


@jit
def affine(A: Array, x: Array, b: Array, out: Array, n: int) -> None:
    """Fill out = A x + b."""
    for i in range(n):
        out[i] = dot(A[i], x, n) + b[i]


@jit
def solve_in_place(A: Array, x: Array, n: int, panels: Panels) -> bool:
    """Replace x by A^-1 x and A by its factors, with partial pivoting; returns False if a pivot is zero.

    Use `panels` if n may be LARGE.
    """
    if n >= LARGE:
        if not panels(A, x, n):
            return False
    elif not eliminate(A, x, n):
        return False
    for i in range(n - 1, -1, -1):
        left = x[i]
        for k in range(i + 1, n):
            left -= A[i, k] * x[k]
        x[i] = left / A[i, i]
    return True


@jit
def eliminate(A: Array, x: Array, n: int) -> bool:
    """Make A upper triangular; returns False if a pivot is zero."""
    for p in range(n):
        top, largest = p, abs(A[p, p])
        for i in range(p + 1, n):
            if abs(A[i, p]) > largest:
                top, largest = i, abs(A[i, p])
        if not largest > 0.0:
            return False
        if top != p:
            exchange(A, x, p, top, p, n)
        for i in range(p + 1, n):
            ratio = A[i, p] / A[p, p]
            if ratio != 0.0:
                subtract(A[i], ratio, A[p], p + 1, n)
                x[i] -= ratio * x[p]
    return True


@jit
def exchange(A: Array, x: Array, p: int, top: int, first: int, n: int) -> None:
    """Exchange rows p and `top`, from column `first` on."""
    x[p], x[top] = x[top], x[p]
    for k in range(first, n):
        A[p, k], A[top, k] = A[top, k], A[p, k]


@jit
def subtract_panel(A: Array, first: int, n: int) -> None:
    """Subtract rows `first` .. `first` + PANEL - 1, times the factors in these columns, from all rows below."""
    wide, begin = A.shape[1], first + PANEL
    p, whole = first * wide, n - (n - begin) % WIDTH
    for i in range(begin, n):
        row = i * wide
        a, b, c, d = same(A[i, first]), same(A[i, first + 1]), same(A[i, first + 2]), same(A[i, first + 3])
        for k in range(begin, whole, WIDTH):
            left = load(A, row + k) - a * load(A, p + k)
            left = left - b * load(A, p + wide + k)
            left = left - c * load(A, p + 2 * wide + k)
            put(A, row + k, left - d * load(A, p + 3 * wide + k))
        for other in range(first, begin):
            ratio = A[i, other]
            for k in range(whole, n):
                A[i, k] -= ratio * A[other, k]


def eliminate_panels(A: Array, x: Array, n: int) -> bool:
    """Make A upper triangular, `PANEL` columns at a time, so that the rest is read and written once for all of them.

    Every entry undergoes the operations of `eliminate` in the same order.
    """
    for first in range(0, n, PANEL):
        end, top, largest = min(first + PANEL, n), first, abs(A[first, first])
        for i in range(first + 1, n):
            if abs(A[i, first]) > largest:
                top, largest = i, abs(A[i, first])
        for p in range(first, end):
            if not largest > 0.0:
                return False
            if top != p:
                exchange(A, x, p, top, first, n)
            for i in range(p + 1, n):
                ratio = A[i, p] / A[p, p]
                A[i, p] = ratio
                for k in range(p + 1, end):
                    A[i, k] -= ratio * A[p, k]
                x[i] -= ratio * x[p]
                if p + 1 < end and (i == p + 1 or abs(A[i, p + 1]) > largest):
                    top, largest = i, abs(A[i, p + 1])
        for i in range(first + 1, end):
            for p in range(first, i):
                subtract(A[i], A[i, p], A[p], end, n)
        if end < n:
            subtract_panel(A, first, n)
    return True


class Panels(ByAddress):
    """`eliminate_panels` as a function address, so that loops with few contacts do not contain its code."""

    kind: Any = types.boolean(MATRIX, VECTOR, types.int64)
    function = staticmethod(eliminate_panels)


@jit
def cholesky(W: Array, A: Array, n: int) -> None:
    """Lower triangle A with A A^T = W, zeros above; NaN if W is not positive definite."""
    for i in range(n):
        for k in range(i + 1):
            left = W[i, k] - dot(A[i], A[k], k)
            A[i, k] = math.sqrt(left) if i == k else left / A[k, k]
        for k in range(i + 1, n):
            A[i, k] = 0.0
