"""A strict reader for small measured tables: every ambiguity is an error that names its line.

The format: UTF-8, '#' comment lines anywhere, one header row of distinct names, then rows with exactly one cell per
name, comma separated, numbers with a decimal point; or, as in many European spreadsheets, separated by semicolons or
tabs, where numbers may all have a decimal comma. General readers repair or drop data that do not fit. Here such data
are refused, so that the person who measured can correct them.
"""

from __future__ import annotations

import csv
import math
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple
from unicodedata import category

import numpy as np

from casingfem.errors import InputError
from casingfem.io.arrays import FloatArray, IntArray
from casingfem.io.together import together
from casingfem.io.workbook import OLD, ZIP, Sheet, file_and_sheet, is_workbook, read_sheet
from contact.io.infiles import MOST_TEXT, TextError, read_bytes, text_of

_NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?")
_WITH_COMMA = re.compile(r"[+-]?[0-9]*,[0-9]+([eE][+-]?[0-9]+)?")
_SEPARATORS = (";", "\t")  # of a header with fewer commas


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StrictCsv:
    r"""Cells of a well-formed table as text, with the line numbers of the file.

    `written` has the file's names of columns that `columns.named` renamed, `factors` their conversion factors. For a
    sheet of a workbook, `sheet` is its name, and lines are rows.

    Examples
    --------
    >>> table = parse("# rig, 2024\nz_m,theta_deg\n0.1,30\n", "survey.csv")
    >>> table.card, table.header, table.numbers("z_m")
    (('rig, 2024',), ('z_m', 'theta_deg'), array([0.1]))
    """

    path: str
    card: tuple[str, ...]
    header: tuple[str, ...]
    header_line: int
    cells: Mapping[str, tuple[str, ...]]
    lines: IntArray
    decimal: str = "."
    written: Mapping[str, str] = field(default_factory=dict)
    factors: Mapping[str, float] = field(default_factory=dict)
    sheet: str = ""

    def refuse(self, *, found: str, expected: str, row: int | None = None, column: str | None = None) -> InputError:
        """An error about a row (from 0) and column, ready to be raised."""
        line = None if row is None else int(self.lines[row])
        column = None if column is None else self.written.get(column, column)
        return InputError(self.path, sheet=self.sheet, found=found, expected=expected, line=line, column=column)

    def refuse_header(self, *, found: str, expected: str, column: str | None = None) -> InputError:
        """An error about the header, or a name in it, ready to be raised."""
        return InputError(
            self.path, sheet=self.sheet, found=found, expected=expected, line=self.header_line, column=column
        )

    def numbers(self, column: str, *, blank: float | None = None) -> FloatArray:
        """A column as finite numbers; ``blank`` replaces empty cells, which are refused if it is None."""
        values, wrong = np.empty(len(self.lines)), list[InputError]()
        for row, text in enumerate(self.cells[column]):
            try:
                values[row] = self._number(row, column, text, blank)
            except InputError as error:
                wrong.append(error)
        if wrong:
            raise together(wrong)
        return values * self.factors[column] if column in self.factors else values

    def _number(self, row: int, column: str, text: str, blank: float | None) -> float:
        if not text:
            if blank is not None:
                return blank
            raise self.refuse(row=row, column=column, found="an empty cell", expected="a number")
        point = text.replace(",", ".", 1) if self.decimal == "," else text
        value = float(point) if _NUMBER.fullmatch(point) else math.nan
        if not math.isfinite(value):
            expected = "a finite number such as 371.2 or 3.712e2" + _or_empty(blank)
            raise self.refuse(row=row, column=column, found=repr(text), expected=expected)
        return value

    def integers(self, column: str, *, blank: int | None = None) -> IntArray:
        """A column as whole numbers; ``blank`` replaces empty cells, which are refused if it is None."""
        values, wrong = np.empty(len(self.lines), np.int64), list[InputError]()
        for row, text in enumerate(self.cells[column]):
            if not text and blank is not None:
                values[row] = blank
            elif re.fullmatch(r"[+-]?[0-9]{1,15}", text):
                values[row] = int(text)
            else:
                found = repr(text) if text else "an empty cell"
                expected = "a whole number" + _or_empty(blank)
                wrong.append(self.refuse(row=row, column=column, found=found, expected=expected))
        if wrong:
            raise together(wrong)
        return values


def _or_empty(blank: float | None) -> str:
    """End of a message about empty cells, if they are allowed."""
    return "" if blank is None else ", or an empty cell where there is none"


def read(path: str | os.PathLike[str]) -> StrictCsv:
    """Read a table from a file; everything that does not fit is refused.

    Workbooks (.xlsx) are read with the extra `excel`: the first visible sheet, or that of `file.xlsx#Sheet`.

    Raises
    ------
    InputError
        The table is invalid; the message has the line, the finding and the expectation.
    OSError
        The file does not exist (FileNotFoundError) or cannot be read; `strerror` states the finding.
    """
    if "\0" in os.fspath(path):
        raise InputError(repr(os.fspath(path)), found="a name with a zero byte", expected="a file")
    file, sheet = file_and_sheet(path)
    data = read_bytes(file, most=MOST_TEXT)
    if data[:4] == OLD:
        found = "a workbook of Excel 97 to 2003, or one with a password"
        raise InputError(file, found=found, expected="a workbook .xlsx without a password, or a table saved as CSV")
    if data[:4] == b"PK\x03\x04":
        return _of_sheet(read_sheet(data, file, sheet), file)
    if is_workbook(file):
        found = f"no workbook: the file begins with {data[:4]!r}, not with {ZIP!r}"
        raise InputError(file, found=found, expected="a workbook .xlsx, or the ending .csv for a table of text")
    try:
        return parse(text_of(data, utf16=True), str(path))
    except TextError as error:
        raise InputError(str(path), line=error.line, found=error.found, expected=error.expected) from None


def parse(text: str, path: str) -> StrictCsv:
    """Parse a table from text; ``path`` is only used in messages."""
    card, body = list[str](), list[tuple[int, str]]()
    for number, line in _significant_lines(text, path):
        if line.lstrip().startswith("#"):
            card.append(line.strip()[1:].strip())
        else:
            body.append((number, line))
    if not body:
        raise InputError(path, found="no header row", expected="a header with the names of the columns")
    often = body[0][1].count
    separator = next((mark for mark in _SEPARATORS if often(mark) > often(",")), ",")
    _refuse_title(body, separator, path)
    header = _checked_header(StrictRow(path, body[0][0], _split(body[0][1], body[0][0], path, separator)))
    rows, lines, wrong = list[tuple[str, ...]](), list[int](), list[InputError]()
    for number, line in body[1:]:
        try:
            rows.append(_row(line, number, path, separator, header))
            lines.append(number)
        except InputError as error:
            wrong.append(error)
    if wrong:
        raise together(wrong)
    decimal = "." if separator == "," else _decimal(rows, lines, path)
    return _table(StrictRow(path, body[0][0], header), rows, lines, card, decimal)


def _of_sheet(sheet: Sheet, path: str) -> StrictCsv:
    """The table in a sheet."""
    if not sheet.rows:
        expected = "a header with the names of the columns"
        raise InputError(path, sheet=sheet.name, found="no header row", expected=expected)
    for number, cells in sheet.rows:
        _check_printable("".join(cells), StrictRow(path, number, cells, sheet.name))
    (number, names), *rows = sheet.rows
    first = StrictRow(path, number, names, sheet.name)
    if rows:
        _check_title(first, " ".join(filter(None, names)), list(filter(None, rows[0][1])))
    header = StrictRow(path, number, _checked_header(first), sheet.name)
    return _table(header, [cells for _, cells in rows], [number for number, _ in rows], sheet.card, ".")


class StrictRow(NamedTuple):
    """Cells of a row with its place in the file."""

    path: str
    number: int
    cells: tuple[str, ...]
    sheet: str = ""

    def refuse(self, found: str, expected: str, column: str | None = None) -> InputError:
        """An error about this row, ready to be raised."""
        return InputError(self.path, sheet=self.sheet, line=self.number, column=column, found=found, expected=expected)


def _table(
    header: StrictRow, rows: Sequence[tuple[str, ...]], lines: Sequence[int], card: Sequence[str], decimal: str
) -> StrictCsv:
    """The table of rows that have one cell for each name."""
    if not rows:
        raise header.refuse("no rows below the header", "at least one row")
    columns = dict(zip(header.cells, zip(*rows, strict=True), strict=True))
    for index, name in enumerate(header.cells):
        if name.startswith("\0") and any(columns.pop(name)):  # a spreadsheet's column beyond the last
            raise header.refuse(f"no name for column {index + 1}", "a name for every column")
    return StrictCsv(
        path=header.path, card=tuple(card), header=tuple(columns), header_line=header.number, cells=columns,
        lines=np.array(lines), decimal=decimal, sheet=header.sheet,
    )  # fmt: skip


def _row(line: str, number: int, path: str, separator: str, header: Sequence[str]) -> tuple[str, ...]:
    """The cells of a line, one for each column."""
    cells = _split(line, number, path, separator)
    if len(cells) == len(header):
        return cells
    found = f"{len(cells)} cells in {line.strip()!r}"
    expected = f"{len(header)}, one for each of {','.join(header)}"
    if len(cells) > len(header) and separator == ",":
        expected += " (numbers take a decimal point, not a comma)"
    raise InputError(path, line=number, found=found, expected=expected)


def _refuse_title(body: Sequence[tuple[int, str]], separator: str, path: str) -> None:
    """Refuse a first line with a single text cell above a line of several names."""
    (number, first), *rest = body
    if not rest:
        return
    cells = _split(first, number, path, separator)
    marks = [mark for mark in (*_SEPARATORS, ",") if mark in rest[0][1]]
    below = [] if not marks else [cell.strip(' "') for cell in rest[0][1].split(marks[0])]
    _check_title(StrictRow(path, number, cells), first.strip(separator + " "), below)


def _check_title(first: StrictRow, title: str, below: Sequence[str]) -> None:
    """Refuse a first row with one cell above a row of several names."""
    names = len(below) > 1 and not any(_NUMBER.fullmatch(cell) or _WITH_COMMA.fullmatch(cell) for cell in below)
    if names and sum(map(bool, first.cells)) <= 1:
        found = f"{title!r} above the names of the columns"
        raise first.refuse(found, "a header: put # before a title, or remove the line")


def _significant_lines(text: str, path: str) -> Iterator[tuple[int, str]]:
    """Yield numbered nonblank lines; a control character means that the file is not a text table."""
    for number, line in enumerate(text.replace("\r\n", "\n").replace("\r", "\n").split("\n"), start=1):
        _check_printable(line, StrictRow(path, number, ()))
        if line.strip():
            yield number, line


def _check_printable(text: str, row: StrictRow) -> None:
    """Refuse control characters."""
    if text.isprintable():
        return
    for c in text:
        if not (c.isprintable() or c == "\t" or category(c) == "Zs"):
            raise row.refuse(f"the character {c!r}", "printable text")


def _decimal(rows: Sequence[tuple[str, ...]], lines: Sequence[int], path: str) -> str:
    """Decimal mark of a table whose cells are not separated by commas; the whole table uses the same mark."""
    marks = ""
    for line, cells in zip(lines, rows, strict=True):
        for cell in cells:
            mark = "," if _WITH_COMMA.fullmatch(cell) else "." if "." in cell and _NUMBER.fullmatch(cell) else ""
            if mark and marks and mark != marks:
                found = f"{cell!r} below numbers with a decimal {'comma' if marks == ',' else 'point'}"
                raise InputError(path, line=line, found=found, expected="one decimal mark in all numbers")
            marks = marks or mark
    return marks or "."


def _split(line: str, number: int, path: str, separator: str) -> tuple[str, ...]:
    try:
        cells = next(csv.reader([line], strict=True, skipinitialspace=separator != "\t", delimiter=separator))
    except csv.Error:
        found = f"quotes that do not pair in {line.strip()!r}"
        raise InputError(path, line=number, found=found, expected="cells on one line, quoted or not") from None
    return tuple(cell.strip(" \t") for cell in cells)


def _checked_header(row: StrictRow) -> tuple[str, ...]:
    cells = row.cells
    if _NUMBER.fullmatch(cells[0]):
        found = f"numbers ({cells[0]}) in the first row"
        raise row.refuse(found, "a header with the names of the columns")
    above = set[str]()
    for cell in cells:
        if cell and cell in above:
            raise row.refuse("this column twice", "distinct columns", column=cell)
        above.add(cell)
    return tuple(cell or f"\0{index}" for index, cell in enumerate(cells))
