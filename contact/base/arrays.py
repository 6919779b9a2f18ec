"""Read-only float arrays, the checks every model value passes on entry, files of arrays of one format."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any, TypeGuard

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact.base.errors import InputError
from contact.io.npz import load_npz, require_kinds

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
HUGE = 1e60  # of numbers with units: squares and products of them stay finite
MANY = 10_000_000  # of whole numbers that count what is stored


def readonly(values: ArrayLike) -> Array:
    """Return a contiguous float copy that cannot be written."""
    array = np.array(values, dtype=np.float64, order="C")
    array.setflags(write=False)
    return array


def keep_readonly(value: object, *names: str) -> None:
    """From a frozen dataclass's `__post_init__`: make these fields read-only float arrays.

    Fields that are None stay None.
    """
    for name in names:
        if getattr(value, name) is not None:
            object.__setattr__(value, name, readonly(getattr(value, name)))


def aligned(*shape: int) -> Array:
    """Zeros in memory that begins on a cache line, as long as a vector of eight numbers.

    A load across two lines costs double.

    >>> aligned(3, 8).ctypes.data % 64
    0
    """
    size = math.prod(shape)
    room = np.zeros(size + 7)
    skip = -(room.__array_interface__["data"][0] // 8) % 8
    return room[skip : skip + size].reshape(shape)


def require_shape(name: str, array: Array, shape: Sequence[int]) -> None:
    """Raise InputError unless `array` has this shape and only finite entries."""
    if array.shape != tuple(shape):
        raise InputError(f"{name}: found shape {array.shape}, expected {tuple(shape)}")
    bad = int(np.count_nonzero(~np.isfinite(array)))
    if bad:
        raise InputError(f"{name}: found {bad} entries that are NaN or infinite, expected finite numbers")


def require_positive(**fields: float) -> None:
    """Raise InputError for the first field that is not finite and > 0, or is too large or small to multiply."""
    for name, value in fields.items():
        if not (math.isfinite(value) and value > 0.0):
            raise InputError(f"{name}: found {value!r}, expected a finite number > 0")
        if not 1.0 / HUGE <= value <= HUGE:
            raise InputError(f"{name}: found {value!r}, expected a number between {1.0 / HUGE:g} and {HUGE:g}")


def require_not_negative(**fields: float) -> None:
    """Raise InputError for the first field that is not a finite number >= 0."""
    for name, value in fields.items():
        if not (math.isfinite(value) and value >= 0.0):
            raise InputError(f"{name}: found {value!r}, expected a finite number >= 0")


def is_whole(value: object) -> TypeGuard[int]:
    """Whether a value is a whole number by its type, numpy's or Python's."""
    return isinstance(value, int | np.integer)


def require_count(least: int = 1, **fields: object) -> None:
    """Raise InputError for the first field that is not a whole number >= `least`, or more than fits into memory."""
    for name, value in fields.items():
        if not is_whole(value) or value < least:
            raise InputError(f"{name}: found {value!r}, expected a whole number >= {least}")
        if value > MANY:
            raise InputError(f"{name}: found {value if value < 1e18 else 'over 1e18'}, expected at most {MANY}")


def require_finite(**fields: float) -> None:
    """Raise InputError for the first field that is NaN or infinite."""
    for name, value in fields.items():
        if not math.isfinite(value):
            raise InputError(f"{name}: found {value!r}, expected a finite number")


def read_npz(
    path: Path, wanted: str, required: tuple[str, ...], texts: tuple[str, ...], made_by: str
) -> dict[str, Any]:
    """Read all arrays of an npz file of this format: numbers, except `texts`. Raises InputError with file and key.

    `made_by` states what writes such a file, for the message of a missing one.
    """
    if not os.path.exists(path):  # unlike Path.exists also answers for a name with a zero byte
        raise InputError(f"{path}: found no such file, expected an npz file ({made_by})")
    try:
        data = load_npz(path)
    except ValueError as error:
        raise InputError(f"{path}: not a readable npz file without pickled objects ({error})") from error
    found = str(data.get("format", "no key 'format'"))
    if found != wanted:
        raise InputError(f"{path}: key 'format': found {found!r}, expected {wanted!r}")
    missing = [name for name in required if name not in data]
    if missing:
        raise InputError(f"{path}: missing keys {', '.join(missing)}")
    try:
        require_kinds(data, dict.fromkeys(texts, "text"))
    except ValueError as error:
        raise InputError(f"{path}: {error}") from error
    return data
