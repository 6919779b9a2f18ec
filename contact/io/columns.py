"""The columns of a result, each defined once: name, sentence, values, header, unit, format.

`records`, `print`, notebooks, pages, CSV, JSON and docs/columns.md read the same tuple of columns, so that a new column
is one entry of it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

WIDTH = 80  # characters of a printed line; a wider table goes on below
WIDE = 100  # the same of tables that are read in one piece
NONE = "-"  # an absent value in a printed table


@dataclass(frozen=True, slots=True, eq=False)
class Column:
    """One column of a result.

    Attributes
    ----------
    name
        Key in records, JSON and CSV. Its value is in SI units, and the name ends in the unit.
    text
        One sentence: the meaning of the value.
    values
        Function of the result that gives one value for each row; None or nan where a row has no value.
    head
        Header in tables; `name` if empty.
    unit
        Unit in tables.
    format
        Format specification in tables, or a function from the value to a word.
    scale
        Factor from the value to its unit in tables, such as 100 for per cent.
    where
        Tables that show it: all; those of pages and notebooks, which may be wide; or none, "files", so that records,
        JSON and CSV alone have it.

    Examples
    --------
    >>> split = Column("split_rel", "Split of a pair over its mean frequency.", lambda pairs: pairs,
    ...                head="split", unit="%", format=".4f", scale=100.0)
    >>> split.header, split.cell(0.00125), split.cell(None)
    ('split [%]', '0.1250', None)
    """

    name: str
    text: str
    values: Callable[[Any], Iterable[Any]]
    head: str = ""
    unit: str = ""
    format: str | Callable[[Any], str] = ""
    scale: float = 1.0
    where: Literal["everywhere", "pages", "files"] = "everywhere"

    @property
    def header(self) -> str:
        """Header with its unit."""
        head = self.head or self.name
        return f"{head} [{self.unit}]" if self.unit else head

    @property
    def words(self) -> bool:
        """Whether its cells are words, which align left."""
        return not isinstance(self.format, str)

    def cell(self, value: Any) -> str | None:
        """A value as tables show it; None where there is none."""
        if value is None or (isinstance(value, float | np.floating) and np.isnan(value)):
            return None
        if not isinstance(self.format, str):
            return self.format(value)
        return format(self.scale * value if self.scale != 1.0 else value, self.format)


Columns = Sequence[Column]
Rows = Iterable[Mapping[str, Any]]


def records_of(columns: Columns, source: Any) -> list[dict[str, Any]]:
    """One plain dictionary for each row of a result.

    >>> records_of([Column("n", "Nodal diameters.", lambda found: found)], np.array([4, 8]))
    [{'n': 4}, {'n': 8}]
    """
    names = [column.name for column in columns]
    parts = [plain(column.values(source)) for column in columns]
    return [dict(zip(names, row, strict=True)) for row in zip(*parts, strict=True)]


def plain(values: Iterable[Any]) -> Iterable[Any]:
    """Values as plain Python numbers."""
    return values.tolist() if isinstance(values, np.ndarray) else values


def present(values: Iterable[float]) -> list[float | None]:
    """Numbers, None in place of nan.

    >>> present(np.array([1.5, np.nan]))
    [1.5, None]
    """
    return [None if np.isnan(value) else float(value) for value in values]


def known(labels: Iterable[int]) -> list[int | None]:
    """Labels, None in place of negative ones.

    >>> known(np.array([8, -1]))
    [8, None]
    """
    return [int(label) if label >= 0 else None for label in labels]


def word(value: Any) -> str:
    """Format of a column of words: the word unchanged."""
    return str(value)


def mark(text: str) -> Callable[[Any], str]:
    """Format of a truth value: the word if true, else empty.

    >>> mark("rigid")(True), mark("rigid")(False)
    ('rigid', '')
    """
    return lambda value: text if value else ""


def cells_of(columns: Columns, rows: Rows, *, printed: bool = False) -> tuple[list[Column], list[list[str | None]]]:
    """The columns of a table on a page or in print, and their cells row by row; None where there is no value.

    Columns of words that are empty in all rows are left out.
    """
    found = list(rows)
    places = ("everywhere",) if printed else ("everywhere", "pages")
    chosen = [column for column in columns if column.where in places]
    texts = {column: [column.cell(row.get(column.name)) for row in found] for column in chosen}
    used = {column: cells for column, cells in texts.items() if not column.words or any(cells)}
    return list(used), [list(row) for row in zip(*used.values(), strict=True)]


def table_lines(columns: Columns, rows: Rows, *, width: int = WIDTH) -> list[str]:
    r"""Rows as lines of text of at most `width` under their headers; numbers align right, words left.

    >>> print("\n".join(table_lines([Column("n", "Nodal diameters.", iter, format="d"),
    ...                              Column("freq_hz", "Frequency.", iter, head="freq", unit="Hz", format=".1f")],
    ...                             [{"n": 4, "freq_hz": 371.25}, {"n": None, "freq_hz": 1207.46}])))
    n  freq [Hz]
    4      371.2
    -     1207.5
    """
    shown, cells = cells_of(columns, rows, printed=True)
    texts = [[NONE if cell is None else cell for cell in row] for row in cells]
    sides = ["<" if column.words else ">" for column in shown]
    return laid_out([column.header for column in shown], texts, sides, width)


def laid_out(
    heads: Sequence[str], rows: Sequence[Sequence[str]], sides: Sequence[str], width: int = WIDTH
) -> list[str]:  # fmt: skip
    """A table as lines of at most `width` characters.

    Further columns follow below, each block with the first column again.

    A single column may be wider.
    """
    wide = [max(map(len, column)) for column in zip(heads, *rows, strict=True)]
    return [
        "  ".join(f"{line[k]:{sides[k]}{wide[k]}}" for k in block).rstrip()
        for block in blocks_of(wide, width)
        for line in (heads, *rows)
    ]


def blocks_of(wide: Sequence[int], width: int = WIDTH) -> list[list[int]]:
    """Columns of each block of a table, by the widths of all columns.

    >>> blocks_of([4, 30, 40, 20])
    [[0, 1, 2], [0, 3]]
    """
    blocks = [[0]] if wide else []
    for k in range(1, len(wide)):
        together = [*blocks[-1], k]
        if len(blocks[-1]) > 1 and sum(wide[i] + 2 for i in together) - 2 > width:
            blocks.append([0, k])
        else:
            blocks[-1] = together
    return blocks
