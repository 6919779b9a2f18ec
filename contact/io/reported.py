"""Outputs of every result of both packages: table, picture, notebook cell, file, copy."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields
from functools import cache
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np

from contact.io.columns import Columns, cells_of, laid_out, records_of, table_lines
from contact.io.stored import load_value, read_only, save_value

if TYPE_CHECKING:
    import pandas as pd

SHOWN = 40  # rows of a table that a notebook shows
PICTURES = "contact.pictures"  # entry points: functions (result, ax, **options) that give a figure, or None


@dataclass(frozen=True, eq=False, repr=False)
class Reported:
    """Base of frozen dataclasses that are results of computations; they define `COLUMNS`, `records` or `columns`.

    Arrays are read-only, also in copies and after unpickling.

    >>> from contact.io.columns import Column
    >>> @dataclass(frozen=True, eq=False, repr=False)
    ... class Speeds(Reported):
    ...     COLUMNS: ClassVar[Columns] = (Column("speed_hz", "Speed.", lambda one: one.hz, unit="Hz", format=".1f"),)
    ...     hz: np.ndarray
    >>> Speeds(np.array([5.0, 12.5]))
    Speeds, 2 rows
    speed_hz [Hz]
              5.0
             12.5
    """

    __slots__ = ()
    COLUMNS: ClassVar[Columns] = ()

    def __post_init__(self) -> None:
        for name in _names(self):
            value = getattr(self, name)
            if isinstance(value, np.ndarray) and value.flags.writeable:
                object.__setattr__(self, name, read_only(np.array(value)))

    def described(self) -> Columns:
        """The columns of this result: those of its kind, and those that depend on its values."""
        return self.COLUMNS

    def records(self) -> Iterable[Mapping[str, Any]]:
        """One plain dictionary for each row, keys with units, as `print` and notebooks show them."""
        if described := self.described():
            return records_of(described, self)
        columns = self.columns()
        return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]

    def columns(self) -> Mapping[str, Any]:
        """The columns of `to_dataframe`, by name: those of `records`, or longer ones."""
        rows = list(self.records())
        return {name: [row.get(name) for row in rows] for name in names_in(rows)}

    def to_dataframe(self) -> pd.DataFrame:
        """A pandas table of the result; `.to_csv`, `.to_parquet` (with pyarrow) write it."""
        import pandas as pd

        return pd.DataFrame({name: whole(values) for name, values in self.columns().items()})

    def plot(self, ax: Any = None, **options: Any) -> Any:
        """Draw the result as a matplotlib Figure, or into the Axes `ax` of an existing figure.

        Raises
        ------
        ValueError
            If no installed package draws it.
        """
        for draw in painters():
            if (figure := draw(self, ax, **options)) is not None:
                return figure
        raise ValueError(
            f"plot: found no figure for {type(self).__name__}, expected a result of a run and casingfem installed"
        )

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write an npz file of plain arrays, whole or not at all, without pickle; `load` reads it. Returns the path."""
        return save_value(path, self)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Read a file that `save` wrote; ValueError names the file if it is of another kind."""
        found: Self = load_value(path, cls)
        return found

    def __repr__(self) -> str:
        rows = list(self.records())
        more = [f"... {len(rows) - SHOWN} more"] if len(rows) > SHOWN else []
        described = self.described()
        lines = table_lines(described, rows[:SHOWN]) if described else lines_of(rows[:SHOWN])
        return "\n".join([f"{type(self).__name__}, {len(rows)} rows", *lines, *more])

    def _repr_html_(self) -> str:
        """A table for a notebook, followed by the lines that `print` shows."""
        rows = list(self.records())
        heads, cells = self._cells(rows[:SHOWN])
        body = "".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in line) + "</tr>" for line in cells)
        more = f"<p>{SHOWN} of {len(rows)} rows</p>" if len(rows) > SHOWN else ""
        return (
            f"<table><caption>{type(self).__name__}</caption><thead><tr>{''.join(heads)}</tr></thead><tbody>{body}"
            f"</tbody></table>{more}<details><summary>in words</summary><pre>{escape(repr(self))}</pre></details>"
        )

    def _cells(self, rows: list[Mapping[str, Any]]) -> tuple[list[str], list[list[str]]]:
        """Headers as HTML, each with the meaning of its column, and the cells of some rows."""
        if described := self.described():
            shown, found = cells_of(described, rows)
            heads = [f'<th title="{escape(column.text)}">{escape(column.header)}</th>' for column in shown]
            return heads, [[value or "" for value in line] for line in found]
        names = names_in(rows)
        return [f"<th>{escape(name)}</th>" for name in names], [[cell(row.get(name)) for name in names] for row in rows]

    def __reduce__(self) -> tuple[Any, ...]:
        values = {name: getattr(self, name) for name in _names(self)}
        return restored, (type(self), values)


def _names(value: Any) -> tuple[str, ...]:
    """Names of the fields of a dataclass's value."""
    kind: Any = type(value)
    return _names_of(kind)


@cache
def _names_of(kind: Any) -> tuple[str, ...]:
    """Names of a dataclass's fields, cached for each class, since a sweep makes thousands of results."""
    return tuple(field.name for field in fields(kind))


def restored(kind: type, values: Mapping[str, Any]) -> Any:
    """A copy of a frozen value that was checked when it was made, for pickle and `copy`."""
    found: Any = object.__new__(kind)
    for name, value in values.items():
        object.__setattr__(found, name, read_only(value))
    return found


@cache
def painters() -> tuple[Any, ...]:
    """Functions that draw results, from the entry points of installed packages."""
    from importlib.metadata import entry_points

    return tuple(entry.load() for entry in entry_points(group=PICTURES))


def whole(values: Any) -> Any:
    """Whole numbers with missing values as pandas' `Int64`, so that they stay whole; other values unchanged."""
    import pandas as pd

    kinds = {type(value) for value in values} if isinstance(values, list | tuple) else set()
    return pd.array(list(values), dtype="Int64") if kinds == {int, type(None)} else values


def names_in(rows: Iterable[Mapping[str, Any]]) -> list[str]:
    """Names of all entries, in the order in which they come."""
    return list(dict.fromkeys(name for row in rows for name in row))


def cell(value: Any) -> str:
    """A value as a table shows it.

    >>> cell(371.20004), cell(8), cell(True), cell(None), cell(float("nan")), cell((1, 2))
    ('371.2', '8', 'yes', '', '', '1, 2')
    """
    if isinstance(value, bool | np.bool_):
        return "yes" if value else "no"
    if isinstance(value, float | np.floating):
        return "" if np.isnan(value) else f"{value:.6g}"
    if isinstance(value, list | tuple | np.ndarray):
        return ", ".join(map(cell, value))
    return "" if value is None else str(value)


def lines_of(rows: Iterable[Mapping[str, Any]]) -> list[str]:
    r"""Rows as lines of text under their names, in columns; words to the left, numbers to the right.

    >>> rows = [{"mode": 1, "wave": "with", "freq_hz": 371.25}, {"mode": 10, "wave": "against", "freq_hz": 1207.5}]
    >>> print("\n".join(lines_of(rows)))
    mode  wave     freq_hz
       1  with      371.25
      10  against   1207.5
    """
    found = list(rows)
    names = names_in(found)
    sides = ["<" if any(isinstance(row.get(name), str) for row in found) else ">" for name in names]
    return laid_out(names, [[cell(row.get(name)) for name in names] for row in found], sides)
