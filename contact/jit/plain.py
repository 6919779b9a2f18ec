"""Operations of `contact.jit.vector` in NumPy, for step loops that numba is asked not to compile (NUMBA_DISABLE_JIT).

Loops are thousands of times slower, but a debugger can step through them.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from contact.base.arrays import Array

WIDTH = 8


def load(array: Array, first: int) -> Array:
    """Eight entries from flat index `first` on."""
    found: Array = array.ravel()[first : first + WIDTH].copy()
    return found


def put(array: Array, first: int, vector: Array) -> None:
    """Write eight numbers from flat index `first` on."""
    flat = array.ravel()
    if not np.shares_memory(array, flat):
        raise TypeError("found strides, expected a contiguous array")
    flat[first : first + WIDTH] = vector


def same(number: float) -> Array:
    """The same number eight times."""
    return np.full(WIDTH, float(number))


def eight(*numbers: float) -> Array:
    """A vector of these eight numbers."""
    return np.array(numbers, dtype=float)


def total(vector: Array) -> float:
    """Sum of eight numbers, by halves as in the compiled version."""
    while vector.size > 1:
        half = vector.size // 2
        vector = vector[:half] + vector[half:]
    return float(vector[0])


def larger(first: Array, second: Array) -> Array:
    """The larger entries of two vectors; the second's entry where one is NaN."""
    return np.asarray(np.where(first > second, first, second))


def below_zero(vector: Array) -> bool:
    """Whether an entry is below zero, or NaN."""
    return not bool((vector >= 0.0).all())


def entry(array: Array, place: int) -> Any:
    """One entry by its flat index."""
    return array.ravel()[place]
