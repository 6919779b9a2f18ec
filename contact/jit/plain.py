"""Operations of `contact.jit.vector` in NumPy, for step loops that numba is asked not to compile (NUMBA_DISABLE_JIT).

Loops run thousands of times slower so; a debugger can step through them.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from contact.base.arrays import Array

WIDTH = 8


def load(array: Array, first: int) -> Array:
    """Eight entries from `first` on, counted flat."""
    found: Array = array.ravel()[first : first + WIDTH].copy()
    return found


def put(array: Array, first: int, vector: Array) -> None:
    """Write eight numbers from entry `first` on, counted flat."""
    flat = array.ravel()
    if not np.shares_memory(array, flat):
        raise TypeError("found strides, expected a contiguous array")
    flat[first : first + WIDTH] = vector


def same(number: float) -> Array:
    """One number, eight times."""
    return np.full(WIDTH, float(number))


def eight(*numbers: float) -> Array:
    """These eight numbers."""
    return np.array(numbers, dtype=float)


def total(vector: Array) -> float:
    """Sum of eight numbers, by halves as the compiled one."""
    while vector.size > 1:
        half = vector.size // 2
        vector = vector[:half] + vector[half:]
    return float(vector[0])


def larger(first: Array, second: Array) -> Array:
    """The larger by entry; that of the second where one is NaN."""
    return np.asarray(np.where(first > second, first, second))


def below_zero(vector: Array) -> bool:
    """Whether some entry is below zero, or NaN."""
    return not bool((vector >= 0.0).all())


def entry(array: Array, place: int) -> Any:
    """One entry, counted flat."""
    return array.ravel()[place]
