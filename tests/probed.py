"""Matrices and values in a few numbers that any of their entries changes."""

from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass

import numpy as np


def probed(matrix) -> np.ndarray:
    """Products with three fixed vectors from both sides, (3, 3): W^T A W, columns of W over their length."""
    rows, columns = (np.cos(np.outer(np.arange(size) ** 2 % 977, [0.7, 1.3, 2.1]) + 0.3) for size in matrix.shape)
    return np.asarray(rows.T @ (matrix @ columns))


def numbers_in(value) -> Iterator[float]:
    """Numbers of a tree of dataclasses, mappings and tuples, in its order; of an array its size and norm."""
    if isinstance(value, bool | int | float | np.number):
        yield float(np.real(value))
    elif isinstance(value, np.ndarray) and value.dtype.kind in "iufc" and value.size:
        yield from (value.size, float(np.linalg.norm(value)))
    elif is_dataclass(value):
        yield from (x for field in fields(value) for x in numbers_in(getattr(value, field.name)))
    elif isinstance(value, Mapping | tuple | list):
        entries = value.values() if isinstance(value, Mapping) else value
        yield from (x for entry in entries for x in numbers_in(entry))
