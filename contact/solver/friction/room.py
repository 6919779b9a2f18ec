"""Work space of the friction solvers, made once for a run: nothing is allocated inside a step."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numba
import numpy as np

from contact.base.arrays import Array, Indices
from contact.solver.dense import LARGE, Panels

protocol: Any = numba.types.WrapperAddressProtocol
Pivoted = Callable[[Array, Array, Array, int, Array], tuple[Array, float]]  # W, b, mu, dim, force: force, residual

# rows of `vectors`; methods that follow one another share them
U, MISS, STEP, TRIAL, TRIAL_MISS, BASE, RIGHT = 0, 1, 2, 3, 4, 5, 6  # Newton's method
# 1, 2, 4 to 8 and 12 to 14 are those of contacts that slide (`all_sliding`), which use U and TRIAL too
BEHIND, GUESS, MOTION = 9, 10, 11  # coatings, around both
JACOBIAN, INNER, SOFT = 0, 1, 2  # matrices: Newton's and the part of it that presses; W behind a coating
CLOSED, AT = 0, 1  # rows of `whole`


class Otherwise(protocol):  # type: ignore[misc]
    """What compiled loops call where Newton's method fails, through Python, because it hardly ever does.

    So many Gauss-Seidel sweeps, or pivoting where their number is 0. The problem stands in W, b, mu and force, which is
    improved; returns its residual, after sweeps 0. Compiled copies in every loop took half of the time to compile it.
    """

    kind = ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_int64, ctypes.c_int64, ctypes.c_int64)

    def __init__(self, W: Array, b: Array, mu: Array, force: Array, pivoted: Pivoted | None) -> None:
        def improve(count: int, dim: int, sweeps: int) -> float:
            from contact.solver.friction.sweeps import sweep

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
            except Exception:  # none can pass through compiled code: it would read 0, a problem solved
                return math.nan
            except BaseException as error:  # Ctrl-C, which `pass_on` raises
                self.interrupted.append(error)
                return math.nan
            force[:n] = found
            return residual

        self.interrupted: list[BaseException] = []
        self.call = self.kind(improve)

    def pass_on(self) -> None:
        """Raise what interrupted Python inside a loop, Ctrl-C above all, now that the loop has ended."""
        if self.interrupted:
            raise self.interrupted.pop()

    def __wrapper_address__(self) -> int | None:
        """Where the function is."""
        return ctypes.cast(self.call, ctypes.c_void_p).value

    def signature(self) -> Any:
        """Residual of (contacts, dimensions, sweeps)."""
        return numba.float64(numba.int64, numba.int64, numba.int64)


class Room(NamedTuple):
    """Arrays for problems of up to N unknowns in K contacts, and what to call where Newton's method fails."""

    vectors: Array  # (15, N)
    matrices: Array  # (3, N, N and some columns)
    pairs: Array  # (K, 2)
    whole: Indices  # (2, N)
    left: Array  # (1,) largest error of a solution as motion, over the free motion of its contact
    otherwise: Otherwise
    panels: Panels


def staggered(size: int) -> int:
    """So many columns, or some more, that entries of a column lie in different parts of the cache.

    >>> staggered(5), staggered(128), staggered(130)
    (5, 136, 136)
    """
    return size if size < LARGE else 8 * (-(-size // 8) // 2 * 2 + 1)


def friction_room(contacts: int, dim: int, pivoted: Pivoted | None = None) -> Room:
    """Room for problems of up to this many contacts in `dim` directions; without pivoting where it is not given."""
    size = contacts * dim
    vectors, matrices = np.zeros((15, size)), np.zeros((3, size, staggered(size)))
    return Room(
        vectors=vectors, matrices=matrices, pairs=np.zeros((contacts, 2)), whole=np.zeros((2, size), dtype=np.int64),
        left=np.zeros(1),
        otherwise=Otherwise(matrices[INNER], vectors[MISS], vectors[STEP], vectors[TRIAL], pivoted),
        panels=Panels(used=size >= LARGE),
    )  # fmt: skip
