"""Matrices and values in a few numbers that any of their entries changes."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass

import numpy as np

NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e[-+]?\d+)?")


def probed(matrix) -> np.ndarray:
    """Products with three fixed vectors from both sides, (3, 3): W^T A W, columns of W over their length."""
    rows, columns = (np.cos(np.outer(np.arange(size) ** 2 % 977, [0.7, 1.3, 2.1]) + 0.3) for size in matrix.shape)
    return np.asarray(rows.T @ (matrix @ columns))


def numbers_in(value) -> Iterator[float]:
    """Numbers of a tree of dataclasses, mappings and tuples, in its order.

    Of an array its size, how many entries are finite, their norm and, if they are real in one row, a weighted sum.
    Two dimensions are those of mode shapes, whose signs may differ between processors.
    """
    if isinstance(value, bool | int | float | np.number):
        yield float(np.real(value))
    elif isinstance(value, np.ndarray) and value.dtype.kind in "biufc" and value.size:
        there = np.isfinite(value)
        known = np.where(there, value, 0)
        yield from (value.size, int(there.sum()), float(np.linalg.norm(known)))
        if value.ndim == 1 and value.dtype.kind != "c":
            yield float(known @ np.cos(np.arange(value.size) ** 2 % 977 + 0.3))
    elif is_dataclass(value):
        yield from (x for field in fields(value) for x in numbers_in(getattr(value, field.name)))
    elif isinstance(value, Mapping | tuple | list):
        entries = value.values() if isinstance(value, Mapping) else value
        yield from (x for entry in entries for x in numbers_in(entry))


def numbers_of_notes(*texts):
    """How many texts there are, and the numbers in them."""
    return [len(texts), *(float(text) for text in NUMBER.findall(" ".join(texts)))]


LONG, MOST = 40, 300
SPENT = re.compile(r",? (in )?[\d.]+ s$")  # times of computation
TIMES = ("seconds", "versions", "machine", "wall")


def numbers_of_document(value):
    """The finite numbers of a JSON document, without times of computation; of long rows those of an array."""

    def timeless(part):
        if isinstance(part, Mapping):
            return {key: timeless(entry) for key, entry in part.items() if not any(name in key for name in TIMES)}
        if isinstance(part, list | tuple):
            own = [timeless(entry) for entry in part]
            numbers = all(x is None or isinstance(x, int | float) for x in own)
            return np.array(own, dtype=float) if numbers and len(own) > LONG else own
        return part

    found = [x for x in numbers_in(timeless(value)) if np.isfinite(x)]
    if len(found) <= MOST:
        return found
    return [x for part in np.array_split(np.array(found), MOST // 10) for x in numbers_in(part)]


def numbers_of_result(found, name=""):
    """Columns for `held`: the numbers of a result's JSON or rows, without times of computation, and those it prints."""
    plain = found.to_json() if hasattr(found, "to_json") else [dict(row) for row in found.records()]
    told = numbers_of_document(plain)
    printed = [SPENT.sub("", line) for line in repr(found).splitlines()]
    return {f"{name}json": told, f"{name}printed": numbers_of_notes(*printed)}


def finite(value):
    """The finite numbers of a value, and those in its text `words` where it has one."""
    words = getattr(value, "words", "")
    return [x for x in numbers_in(value) if np.isfinite(x)] + (numbers_of_notes(words) if words else [])
