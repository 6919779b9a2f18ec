"""Numbers in the fixed columns of universal files, all lines of a block at once.

Columns are fixed (Fortran formats), so an extra or missing character shifts the following ones. Two rules detect this:
integers end in the last column of their field; reals do too, or all end one column earlier with equally many digits.
"""

import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from casingfem.experiment.uff.split import RawSet
from casingfem.io.arrays import Array, FloatArray, IntArray

INTEGER = re.compile(r" *[+-]?[0-9]+")
REAL = re.compile(r" *([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+))(?:[EeDd]?([+-][0-9]+)|[EeDd]([0-9]+))? *")
_BLANK = ord(" ")
_OF_INTEGERS = np.frombuffer(b" 0123456789+-", np.uint8)
_OF_REALS = np.frombuffer(b" 0123456789+-.EeDd", np.uint8)
_EXPONENTS = np.frombuffer(b"EeDd", np.uint8)


class Columns(NamedTuple):
    """Position of equal fields on a line: first column (from 0), width of a field, number of fields."""

    start: int
    width: int
    fields: int

    @property
    def end(self) -> int:
        """The column after the last."""
        return self.start + self.width * self.fields


def integers(raw: RawSet, rows: Sequence[int], columns: Columns, *, last: bool = True) -> IntArray:
    """Integers of some lines of a set, (lines, fields), right-aligned in their fields.

    `last`: only blanks may follow them on the line.
    """
    block = _characters(raw, rows, columns, last=last)
    flush = np.all((block[..., -1] >= ord("0")) & (block[..., -1] <= ord("9")))
    if flush and np.isin(block, _OF_INTEGERS).all():
        try:
            return np.asarray(_texts(block).astype(np.int64))
        except (ValueError, OverflowError):
            pass
    raise _first_bad(raw, rows, columns, INTEGER, f"a whole number, right-aligned in {columns.width} columns")


def reals(raw: RawSet, rows: Sequence[int], columns: Columns, *, last: bool = True) -> FloatArray:
    """Finite reals of some lines of a set, (lines, fields); E, D or no letter before the exponent."""
    block = _characters(raw, rows, columns, last=last)
    values = _converted(block)
    if values is None:
        expected = f"a number such as 1.23450E+02 in {columns.width} columns"
        if all(REAL.fullmatch(cell) for row in rows for cell in cells(raw.lines[row], columns)):
            values = np.array([[_real(cell) for cell in cells(raw.lines[row], columns)] for row in rows])
        else:
            raise _first_bad(raw, rows, columns, REAL, expected)
    if not np.isfinite(values).all():
        row, field = np.argwhere(~np.isfinite(values))[0]
        found = repr(cells(raw.lines[rows[row]], columns)[field].strip())
        raise raw.error(rows[row], found, "a finite number")
    _check_columns(raw, rows, columns, block)
    return values


def cells(line: str, columns: Columns) -> list[str]:
    """The texts of several fields."""
    starts = range(columns.start, columns.end, columns.width)
    return [line[start : start + columns.width] for start in starts]


def series(raw: RawSet, start: int, count: int, columns: Columns, kind: Callable[..., Array], meaning: str) -> Array:
    """`count` numbers from a line on, `columns.fields` per line, by `integers` or `reals`.

    The last line may be shorter.

    A short last line is completed from the first, so that its columns are compared with those of the others.
    """
    check_lines(raw, start, -(-count // columns.fields), meaning)
    rows = range(start, start - (-count // columns.fields))
    rest = count - (len(rows) - 1) * columns.fields
    if rest < columns.fields and len(rows) > 1:
        end = columns.start + columns.width * rest
        text = raw.lines[rows[-1]]
        if len(text.rstrip()) > end:
            raise raw.error(rows[-1], repr(text[end:].strip()), f"only {rest} numbers on the last line of {meaning}")
        whole = text[:end].ljust(end) + raw.lines[start].ljust(columns.end)[end : columns.end]
        raw = replace(raw, lines=(*raw.lines[: rows[-1]], whole, *raw.lines[rows[-1] + 1 :]))
    elif rest < columns.fields:
        columns = columns._replace(fields=rest)
    return np.asarray(kind(raw, rows, columns)).reshape(-1)[:count]


def check_lines(raw: RawSet, start: int, lines: int, meaning: str) -> None:
    """Refuse a set with too few lines."""
    if start + lines > len(raw.lines):
        raise raw.error(len(raw.lines), f"{len(raw.lines) - start} lines of {meaning}", f"{lines} lines")


def check_end(raw: RawSet, index: int, meaning: str) -> None:
    """Refuse anything but blank lines from a line on."""
    for later in range(index, len(raw.lines)):
        if raw.lines[later].strip():
            raise raw.error(later, repr(raw.lines[later].strip()[:40]), f"the end of the set after {meaning}")


def _characters(raw: RawSet, rows: Sequence[int], columns: Columns, *, last: bool) -> Array:
    """Characters of the fields, (lines, fields, width); a line that is too long is refused."""
    texts = []
    for row in rows:
        text = raw.lines[row]
        if last and len(text.rstrip()) > columns.end:
            raise raw.error(row, repr(text[columns.end :].strip()), f"no text beyond column {columns.end}")
        texts.append(text[columns.start : columns.end].ljust(columns.end - columns.start))
    data = "".join(texts).encode("ascii", "replace")
    return np.frombuffer(data, np.uint8).reshape(len(rows), columns.fields, columns.width)


def _texts(block: Array) -> Array:
    """Fields as byte strings, (lines, fields)."""
    return np.ascontiguousarray(block).view(f"S{block.shape[-1]}")[..., 0]


def _converted(block: Array) -> FloatArray | None:
    """All fields as reals, if they can be converted at once."""
    if not np.isin(block, _OF_REALS).all():
        return None
    block = block.copy()
    block[(block == ord("D")) | (block == ord("d"))] = ord("E")
    try:
        return np.asarray(_texts(block).astype(np.float64))
    except ValueError:
        return None


def _real(cell: str) -> float:
    """One real, also in the Fortran form of large exponents: 1.0-100."""
    match = REAL.fullmatch(cell)
    assert match is not None
    return float(f"{match[1]}e{match[2] or match[3] or 0}")


def _check_columns(raw: RawSet, rows: Sequence[int], columns: Columns, block: Array) -> None:
    """Refuse reals that end in different columns, or one column early with fewer digits: characters are missing."""
    ends = columns.width - np.argmax(block[..., ::-1] != _BLANK, axis=-1)
    odd = ends != np.bincount(ends.ravel()).argmax()
    if not odd.any() and np.any(ends < columns.width):
        letters = np.isin(block, _EXPONENTS)
        mantissa_end = np.where(letters.any(axis=-1), letters.argmax(axis=-1), ends)
        points = block == ord(".")
        decimals = np.where(points.any(axis=-1), mantissa_end - points.argmax(axis=-1) - 1, 0)
        short = letters.any(axis=-1) & (ends - mantissa_end < 4)  # a letter, a sign, two digits
        before = np.roll(block, 1, axis=-1) >= ord("0")
        led = np.any(points & before, axis=-1)  # a digit is before the point
        odd = (decimals != np.bincount(decimals.ravel()).argmax()) | short | (led != led.flat[-1])
    if odd.any():
        row, field = np.argwhere(odd)[0]
        found = repr(cells(raw.lines[rows[row]], columns)[field])
        raise raw.error(
            rows[row], found, "numbers that end in the same column of their fields, with equal numbers of digits"
        )


def _first_bad(
    raw: RawSet, rows: Sequence[int], columns: Columns, pattern: re.Pattern[str], expected: str
) -> ValueError:
    for row in rows:
        for field, cell in enumerate(cells(raw.lines[row], columns)):
            padded = cell.ljust(columns.width)
            if not pattern.fullmatch(padded) or len(padded.strip()) > 25:
                low = columns.start + field * columns.width + 1
                found = repr(cell.strip()) if cell.strip() else "nothing"
                return raw.error(row, f"{found} in columns {low} to {low + columns.width - 1}", expected)
    return raw.error(rows[0], "a number that is too large", expected)
