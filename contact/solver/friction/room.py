"""Work arrays of the friction solvers, made once for a run; Gauss-Seidel sweeps for points where Newton's path ends."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numba
import numpy as np

from contact.base.arrays import Array, Indices
from contact.jit.compiled import jit, jit_entry
from contact.solver.dense import LARGE, Panels, dot

protocol: Any = numba.types.WrapperAddressProtocol
Pivoted = Callable[[Array, Array, Array, int, Array], tuple[Array, float]]  # W, b, mu, dim, force: force, residual

# rows of `vectors`; methods that follow one another share them
U, MISS, STEP, TRIAL, TRIAL_MISS, BASE, RIGHT = 0, 1, 2, 3, 4, 5, 6  # Newton's method
# 1, 2, 4 to 8 and 12 to 14 are those of contacts that slide (`all_sliding`), which use U and TRIAL too
BEHIND, GUESS, MOTION = 9, 10, 11  # coatings, around both
JACOBIAN, INNER, SOFT = 0, 1, 2  # matrices: Newton's and the part of it that presses; W behind a coating
CLOSED, AT = 0, 1  # rows of `whole`
ROUGHLY = 1e-3  # accuracy of each contact: only a starting point is needed


class Otherwise(protocol):  # type: ignore[misc]
    """Fallback of compiled loops if Newton's method fails; it runs through Python, because it is rarely needed.

    It makes the given number of Gauss-Seidel sweeps, or pivots if that is 0. The problem is in W, b, mu and force,
    which is improved; returns the residual, after sweeps 0. Compiled copies in every loop would double its compile
    time.
    """

    kind = ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_int64, ctypes.c_int64, ctypes.c_int64)

    def __init__(self, W: Array, b: Array, mu: Array, force: Array, pivoted: Pivoted | None) -> None:
        def improve(count: int, dim: int, sweeps: int) -> float:

            n = count * dim
            if self.interrupted:
                return math.nan
            try:
                if sweeps > 0:
                    sweep(W, b, mu, dim, count, force, sweeps)
                    return 0.0
                if pivoted is None:
                    return math.nan
                found, residual = pivoted(W[:n, :n].copy(), b[:n].copy(), mu[:count].copy(), dim, force[:n].copy())
            except Exception:  # no exception can pass through compiled code, which would read 0, a solved problem
                return math.nan
            except BaseException as error:  # Ctrl-C, which `pass_on` raises
                self.interrupted.append(error)
                return math.nan
            force[:n] = found
            return residual

        self.interrupted: list[BaseException] = []
        self.call = self.kind(improve)

    def __call__(self, count: int, dim: int, sweeps: int) -> float:
        """Run it in Python if numba does not compile."""
        residual: float = self.call(count, dim, sweeps)
        return residual

    def pass_on(self) -> None:
        """Raise a Python interruption from inside a loop, such as Ctrl-C, after the loop has ended."""
        if self.interrupted:
            raise self.interrupted.pop()

    def __wrapper_address__(self) -> int | None:
        """Address of the function."""
        return ctypes.cast(self.call, ctypes.c_void_p).value

    def signature(self) -> Any:
        """Signature: residual from (contacts, dimensions, sweeps)."""
        return numba.float64(numba.int64, numba.int64, numba.int64)


class Room(NamedTuple):
    """Arrays for problems of up to N unknowns in K contacts, and the fallback if Newton's method fails."""

    vectors: Array  # (15, N)
    matrices: Array  # (3, N, N and some columns)
    pairs: Array  # (K, 2)
    whole: Indices  # (2, N)
    left: Array  # (1,) largest error of a solution as motion, over the free motion of its contact
    otherwise: Otherwise
    panels: Panels


def staggered(size: int) -> int:
    """A number of columns, increased slightly so that entries of a column lie in different parts of the cache.

    >>> staggered(5), staggered(128), staggered(130)
    (5, 136, 136)
    """
    return size if size < LARGE else 8 * (-(-size // 8) // 2 * 2 + 1)


def friction_room(contacts: int, dim: int, pivoted: Pivoted | None = None) -> Room:
    """Work arrays for up to this many contacts with `dim` directions; without pivoting if it is not given."""
    size = contacts * dim
    vectors, matrices = np.zeros((15, size)), np.zeros((3, size, staggered(size)))
    return Room(
        vectors=vectors, matrices=matrices, pairs=np.zeros((contacts, 2)), whole=np.zeros((2, size), dtype=np.int64),
        left=np.zeros(1),
        otherwise=Otherwise(matrices[INNER], vectors[MISS], vectors[STEP], vectors[TRIAL], pivoted),
        panels=Panels(used=size >= LARGE),
    )  # fmt: skip


@jit_entry
def sweep(W: Array, b: Array, mu: Array, dim: int, count: int, force: Array, sweeps: int) -> None:
    """Nonlinear Gauss-Seidel sweeps: each contact is solved with fixed forces of the others."""
    size = count * dim
    for visit in range(sweeps * count):
        k = visit % count
        i = k * dim
        q0, q1, q2 = without(W, b, i, i, dim, force, size), 0.0, 0.0
        if dim > 1:
            q1 = without(W, b, i + 1, i, dim, force, size)
        if dim > 2:
            q2 = without(W, b, i + 2, i, dim, force, size)
        one_contact(W, i, dim, q0, q1, q2, mu[k], force)


@jit
def without(W: Array, b: Array, row: int, i: int, dim: int, force: Array, size: int) -> float:
    """Motion along one direction without the contact's own force, whose entries begin at i."""
    q = b[row] + dot(W[row], force, size)
    for m in range(i, i + dim):
        q -= W[row, m] * force[m]
    return float(q)


@jit
def one_contact(W: Array, i: int, dim: int, q0: float, q1: float, q2: float, mu: float, force: Array) -> None:
    """Force of one contact with free gap and slip q0, q1, q2: open, sticking, or slipping (to `ROUGHLY`).

    Slipping, force_T = -(W_TT + alpha)^-1 (q_T + W_TN force_N) with alpha >= 0 the ratio of slip to tangential force:
    force_N follows, and |force_T| - mu force_N changes sign between alpha = 0 (too much) and infinity (too little).
    """
    if q0 >= 0.0:
        for j in range(i, i + dim):
            force[j] = 0.0
        return
    if dim == 1:
        force[i] = -q0 / W[i, i]
        return
    low, high = 0.0, 1.0
    if slip_excess(W, i, dim, q0, q1, q2, mu, 0.0, force) <= 0.0:
        return
    base = W[i + 1, i + 1] + W[i + dim - 1, i + dim - 1]
    while slip_excess(W, i, dim, q0, q1, q2, mu, high * base, force) > 0.0 and high < 1e18:
        low, high = high, 16.0 * high
    if low == 0.0:
        low = high
        while slip_excess(W, i, dim, q0, q1, q2, mu, low * base, force) < 0.0 and low > 1e-18:
            high, low = low, low / 16.0
    for _ in range(60):
        middle = math.sqrt(low * high)
        if slip_excess(W, i, dim, q0, q1, q2, mu, middle * base, force) > 0.0:
            low = middle
        else:
            high = middle
        if high - low <= ROUGHLY * high:
            break


@jit
def slip_excess(W: Array, i: int, dim: int, q0: float, q1: float, q2: float, mu: float, alpha: float,
                force: Array) -> float:  # fmt: skip
    """Set the force of a slipping contact, alpha = slip over tangential force; returns |force_T| - mu force_N."""
    a, c, m = W[i + 1, i + 1] + alpha, 1.0, 0.0
    w2, v2, mt = 0.0, 0.0, 0.0
    if dim == 3:
        c, m, mt = W[i + 2, i + 2] + alpha, W[i + 1, i + 2], W[i + 2, i + 1]
        w2, v2 = W[i + 2, i], W[i, i + 2]
    w1, v1 = W[i + 1, i], W[i, i + 1]
    det = a * c - m * mt
    f1, f2 = (c * q1 - m * q2) / det, (a * q2 - mt * q1) / det  # (W_TT + alpha)^-1 q_T
    g1, g2 = (c * w1 - m * w2) / det, (a * w2 - mt * w1) / det
    normal = (-q0 + v1 * f1 + v2 * f2) / (W[i, i] - v1 * g1 - v2 * g2)
    t1, t2 = -f1 - g1 * normal, -f2 - g2 * normal
    force[i], force[i + 1] = normal, t1
    if dim == 3:
        force[i + 2] = t2
    return float(math.hypot(t1, t2) - mu * normal)
