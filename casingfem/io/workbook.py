"""Sheets of Excel workbooks as rows of text: numbers as stored; a cell's place is its sheet and row.

openpyxl, the extra `excel`, reads the cells. Before it opens a workbook, the size of the unpacked parts is bounded and
document types, which XML expands, are refused.
"""

from __future__ import annotations

import os
import re
import warnings
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import date, datetime, time
from io import BytesIO
from struct import error as StructError  # noqa: N812
from typing import Any
from zipfile import BadZipFile, ZipFile

from casingfem.errors import InputError, MissingExtraError
from casingfem.extras import remedy
from contact.io.infiles import MOST_TEXT

NAMED = re.compile(r"(.+\.xls[xm])(?:#(.+))?", re.IGNORECASE | re.DOTALL)
ZIP = b"PK"
OLD = b"\xd0\xcf\x11\xe0"  # of Excel 97 to 2003, and of workbooks with a password
FORMULA = re.compile(rb"<(?:\w+:)?f[\s/>]")
MOST_ROWS = 1 << 20  # of a sheet of Excel
EXPECTED = "a workbook .xlsx as Excel saves it, or a table saved as CSV"
DAMAGE = (
    ArithmeticError, AttributeError, LookupError, OSError, RuntimeError, SyntaxError, TypeError, ValueError, EOFError,
    AssertionError, MemoryError, BadZipFile, StructError, zlib.error,
)  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class Sheet:
    """Nonempty rows of a sheet, with their numbers; all are as wide as the widest."""

    name: str
    card: tuple[str, ...]
    rows: tuple[tuple[int, tuple[str, ...]], ...]


def file_and_sheet(path: str | os.PathLike[str]) -> tuple[str, str | None]:
    """File and sheet of a name like `file.xlsx#Sheet`; for other names the name and None.

    >>> file_and_sheet("modal.xlsx#run 2"), file_and_sheet("modal.csv")
    (('modal.xlsx', 'run 2'), ('modal.csv', None))
    """
    name = os.fspath(path)
    found = NAMED.fullmatch(name)
    return (found[1], found[2]) if found else (name, None)


def is_workbook(path: str) -> bool:
    """Whether a file has the ending of a workbook."""
    return NAMED.fullmatch(path) is not None


def read_sheet(data: bytes, path: str, name: str | None) -> Sheet:
    """Read a sheet of a workbook, the first visible one if `name` is None.

    Raises
    ------
    MissingExtraError
        openpyxl is not installed.
    InputError
        The workbook cannot be read or unpacks to too much data, the sheet does not exist, or a formula has no stored
        value.
    """
    try:
        from openpyxl import load_workbook
    except ImportError as error:
        expected = f"the package openpyxl ({remedy('excel')}), or a table saved as CSV"
        raise MissingExtraError(path, found="an Excel workbook", expected=expected) from error
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of styles and extensions of a workbook, none of its values
            formulas = _checked(data, path)
            book = load_workbook(BytesIO(data), read_only=True, data_only=True)
            sheet = _chosen(book, path, name)
            stated = load_workbook(BytesIO(data), read_only=True)[sheet.title] if formulas else None
            return _sheet(sheet, stated, path)
    except InputError:
        raise
    except DAMAGE as error:
        reason = str(error).strip("'\"") or type(error).__name__
        raise InputError(path, found=f"no readable workbook ({reason})", expected=EXPECTED) from None


def _checked(data: bytes, path: str) -> bool:
    """Refuse a workbook that unpacks to too much data; returns whether any part has a formula."""
    formulas = False
    with ZipFile(BytesIO(data)) as archive:
        unpacked = sum(info.file_size for info in archive.infolist())
        if unpacked > MOST_TEXT:
            found = f"a workbook that unpacks to {unpacked / 1e6:.6g} MB"
            raise InputError(path, found=found, expected=f"at most {MOST_TEXT / 1e6:g} MB")
        for info in archive.infolist():
            if info.filename.lower().endswith((".xml", ".rels")):
                part = archive.read(info)
                if b"<!DOCTYPE" in part or b"\0" in part:
                    found = f"a document type or UTF-16 in its part {info.filename!r}"
                    raise InputError(path, found=found, expected=EXPECTED)
                formulas = formulas or FORMULA.search(part) is not None
    return formulas


def _chosen(book: Any, path: str, name: str | None) -> Any:
    sheets = {sheet.title: sheet for sheet in book.worksheets}
    if name is None:
        shown = [sheet for sheet in sheets.values() if sheet.sheet_state == "visible"]
        if not shown:
            raise InputError(path, found="no visible sheet", expected="a sheet with a table")
        return shown[0]
    if name not in sheets:
        expected = f"one of {', '.join(map(repr, sheets))}"
        raise InputError(path, found=f"no sheet {name!r}", expected=expected)
    return sheets[name]


def _sheet(sheet: Any, stated: Any, path: str) -> Sheet:
    """Comments and rows of a sheet; `stated` is the same sheet with its formulas."""
    card, rows, wrong, percent = list[str](), list[tuple[int, tuple[str, ...]]](), list[str](), set[int]()
    written = width = 0
    for number, cells, formulas in _rows(sheet, stated):
        if number > MOST_ROWS:
            raise InputError(path, sheet=sheet.title, found=f"row {number}", expected=f"at most {MOST_ROWS} rows")
        texts = [_text(cell) for cell in cells]
        written += len(texts) + sum(map(len, texts))
        if written > MOST_TEXT:
            expected = f"at most {MOST_TEXT / 1e6:g} MB"
            raise InputError(path, sheet=sheet.title, found="more text in its cells", expected=expected)
        wrong += [cells_name(number, k) for k, cell in enumerate(cells) if _lost(cell, formulas, k)]
        first = next((k for k, text in enumerate(texts) if text), None)
        if first is None:
            continue
        if texts[first].startswith("#") and cells[first].data_type != "e":
            card.append(" ".join(filter(None, texts))[1:].strip())
            continue
        for k in percent & {k for k, cell in enumerate(cells) if _in_percent(cell)}:
            found = f"a number in Excel's per cent format, stored as {texts[k]}, below a name with %"
            expected = "a number of per cent without that format, or a name without %"
            column = rows[0][1][k]
            raise InputError(path, sheet=sheet.title, line=number, column=column, found=found, expected=expected)
        if not rows:
            percent = {k for k, text in enumerate(texts) if "%" in text}
        while not texts[-1]:
            texts.pop()
        width = max(width, len(texts))
        rows.append((number, tuple(texts)))
    if wrong:
        found = f"formulas without stored values in {', '.join(wrong[:20])}{', ...' if len(wrong) > 20 else ''}"
        expected = "numbers: open the workbook in Excel and save it, which stores them"
        raise InputError(path, sheet=sheet.title, found=found, expected=expected)
    padded = tuple((number, (*texts, *[""] * (width - len(texts)))) for number, texts in rows)
    return Sheet(name=sheet.title, card=tuple(card), rows=padded)


def _rows(sheet: Any, stated: Any) -> Iterator[tuple[int, Sequence[Any], Sequence[Any]]]:
    """Numbered rows of cells, with the cells of the same row that have formulas."""
    sheet.reset_dimensions()  # those that a workbook states may be wrong
    if stated is None:
        yield from ((number, cells, ()) for number, cells in enumerate(sheet.iter_rows(), start=1))
        return
    stated.reset_dimensions()
    for number, (cells, formulas) in enumerate(zip(sheet.iter_rows(), stated.iter_rows(), strict=True), start=1):
        yield number, cells, formulas


def _lost(cell: Any, formulas: Sequence[Any], k: int) -> bool:
    """Whether a formula has no stored value; an empty text is a value."""
    return cell.value is None and cell.data_type != "str" and k < len(formulas) and formulas[k].data_type == "f"


def _in_percent(cell: Any) -> bool:
    return isinstance(cell.value, int | float) and "%" in str(cell.number_format)


def _text(cell: Any) -> str:
    """A cell in the form of a text table; since Excel has no integers, 3.0 becomes 3."""
    value = cell.value
    if value is None:
        return ""
    if isinstance(value, bool):
        return str(value).upper()
    if isinstance(value, float):
        return str(int(value)) if value.is_integer() and abs(value) < 1e15 else repr(value)
    if isinstance(value, datetime) and value.time() == time():
        return value.date().isoformat()
    return value.isoformat() if isinstance(value, date) else str(value).strip()


def cells_name(row: int, column: int) -> str:
    """The name of a cell from its row (from 1) and its column (from 0).

    >>> cells_name(3, 1), cells_name(1, 27)
    ('B3', 'AB1')
    """
    letters, left = "", column + 1
    while left:
        left, last = divmod(left - 1, 26)
        letters = chr(ord("A") + last) + letters
    return f"{letters}{row}"
