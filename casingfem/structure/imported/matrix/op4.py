"""Nastran's OP4 files: the real matrices by name, dense and sparse, as text or binary.

A matrix begins with columns, rows (negative: long row numbers), form, type (1 single, 2 double), name; then, column by
column, `column, row, words` and the values. Row 0 announces strings of values, each with its row and length: in one
word row + 65536 (length + 1), or in two where row numbers are long. A column after the last one ends the matrix.
Lengths count words of four bytes, of which a double has two.
"""

import re
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path
from typing import Any

import numpy as np
from scipy.sparse import coo_array, csc_array

from casingfem.errors import ModelError
from casingfem.io.arrays import FloatArray, IntArray
from casingfem.structure.imported.matrix.matrix_set import OF_A_SET, fault, role_of
from contact.io.infiles import read_bytes

FORMAT = re.compile(r"E(\d+)\.", re.IGNORECASE)
NUMBERS = re.compile(r"\s*[-+]?\d*\.\d")  # how a line of values begins, and no other
WORDS = {1: 1, 2: 2}  # of a number, by type of real matrices
OF_COMPLEX = {3: 1, 4: 2}  # of complex ones, whose values are two numbers each
ROW_BITS = 65536
MOST = 2**31 - 1  # rows or columns: what a binary file can say


@dataclass(slots=True)
class Entries:
    """A matrix as it is read."""

    name: str
    rows: int
    columns: int
    long: bool
    words: int
    parts: list[tuple[int, int, FloatArray]]  # column, first row, values
    real: bool = True

    def matrix(self, source: str) -> csc_array:
        """The matrix; entries outside it are refused."""
        for column, row, values in self.parts:
            if not (0 < column <= self.columns and 0 < row and row + len(values) - 1 <= self.rows):
                found = f"rows {row} to {row + len(values) - 1} of column {column}"
                raise fault(source, f"{self.name}: found {found} in a matrix of {self.rows} x {self.columns}")
        rows = [np.arange(row - 1, row - 1 + len(values)) for _, row, values in self.parts]
        columns = np.repeat([column - 1 for column, _, _ in self.parts], [len(own) for own in rows])
        none = np.zeros(0)
        values = np.concatenate([none, *(values for _, _, values in self.parts)])
        places = (np.concatenate([none, *rows]).astype(int), columns.astype(int))
        self.check_once(places[1] * self.rows + places[0], source)
        return csc_array(coo_array((values, places), shape=(self.rows, self.columns)))

    def check_once(self, places: IntArray, source: str) -> None:
        """Refuse entries given again, by their places counted column by column."""
        ordered = np.sort(places)
        for again in ordered[1:][ordered[1:] == ordered[:-1]][:1].tolist():
            column, row = divmod(again, self.rows)
            raise fault(source, f"{self.name}: found row {row + 1} of column {column + 1} again, expected it once")


def read_op4(path: Path) -> dict[str, csc_array]:
    """All matrices of a file by name.

    Raises
    ------
    ModelError
        `matrix-file` for a file that is cut short, complex, or no OP4.
    """
    content = read_bytes(path)
    if content[:4] in (b"\x18\0\0\0", b"\0\0\0\x18"):
        try:
            return read_binary(content, path.name)
        except ModelError:
            raise
        except ValueError as error:  # of strings, and numpy's of records that are no whole number of values
            raise fault(path.name, f"found a record that does not fit its matrix ({error})") from None
    return read_text(content.decode("latin-1").splitlines(), path.name)


def begun(source: str, name: str, columns: int, rows: int, kind: int) -> Entries:
    """A matrix by its header; complex ones are passed over, but KAA and its like."""
    passed = kind in OF_COMPLEX and not OF_A_SET.fullmatch(name.upper())
    if kind not in WORDS and not passed:
        found = f"type {kind}, {rows} rows, {columns} columns"
        raise fault(source, f"{name}: found {found}, expected a real matrix (type 1 or 2)")
    if not (0 < columns <= MOST and 0 < abs(rows) <= MOST):
        raise fault(source, f"{name}: found {abs(rows)} rows, {columns} columns, expected 1 to {MOST} of each")
    return Entries(name, abs(rows), columns, rows < 0, (WORDS | OF_COMPLEX)[kind], [], not passed)


def keep(found: dict[str, csc_array], entries: Entries, source: str) -> None:
    """Put a matrix beside those before it; complex ones are passed over, a second K, M or C of one name is refused."""
    if not entries.real:
        return
    if entries.name in found and role_of(entries.name):
        raise fault(source, f"found the matrix {entries.name} again, expected it once")
    found[entries.name] = entries.matrix(source)


def read_text(lines: list[str], source: str) -> dict[str, csc_array]:
    """The matrices of a text file."""
    found: dict[str, csc_array] = {}
    at = 0
    while at < len(lines):
        if not lines[at].strip():
            at += 1
            continue
        width = FORMAT.search(lines[at][40:])
        if len(lines[at][:32].split()) != 4 or width is None:
            raise fault(source, f"line {at + 1}: found {lines[at][:48]!r}, expected columns, rows, form, type, name")
        columns, rows, _, kind = integers(lines[at][:32], at, source)
        entries = begun(source, lines[at][32:40].strip(), columns, rows, kind)
        at = text_columns(lines, at + 1, int(width[1]), entries, source)
        keep(found, entries, source)
    return found


def text_columns(lines: list[str], at: int, width: int, entries: Entries, source: str) -> int:
    """Read columns until the one after the last; returns the line after it."""
    column = row = wanted = 0

    def values() -> FloatArray:
        nonlocal at
        numbers: list[float] = []
        while at < len(lines) and NUMBERS.match(lines[at]):
            line = lines[at].rstrip().replace("D", "E")
            try:
                numbers += [float(line[k : k + width]) for k in range(0, len(line), width)]
            except ValueError:
                raise fault(source, f"line {at + 1}: found {line!r}, expected numbers of {width} characters") from None
            at += 1
        return np.array(numbers)

    while True:
        if at >= len(lines):
            raise fault(source, f"{entries.name}: the file ends in column {column} of {entries.columns}: cut short?")
        head = integers(lines[at], at, source)
        begun_at, at = at, at + 1
        if len(head) == 3:
            check_column(source, begun_at, entries, column, wanted)
            column, row, wanted = head
            if column > entries.columns:
                values()
                return at
            if row > 0:
                entries.parts.append((column, row, values()))
        elif column and row == 0 and len(head) == (2 if entries.long else 1):
            first = head[1] if entries.long else split_word(head[0])[1]
            entries.parts.append((column, first, values()))
        else:
            raise fault(source, f"line {begun_at + 1}: found {lines[begun_at]!r}, expected column, row, words")


def integers(line: str, at: int, source: str) -> list[int]:
    """Whole numbers of a line."""
    try:
        return [int(word) for word in line.split()]
    except ValueError:
        raise fault(source, f"line {at + 1}: found {line!r}, expected whole numbers") from None


def check_column(source: str, at: int, entries: Entries, column: int, wanted: int) -> None:
    """Refuse a column with fewer or more values than announced; programs differ in what they count beside them."""
    strings = [len(values) for _, _, values in takewhile(lambda part: part[0] == column, reversed(entries.parts))]
    found = sum(strings)
    if column and not found <= wanted <= entries.words * found + 4 * len(strings):
        message = f"{entries.name}: found {found} values in column {column}, announced {wanted} words"
        raise fault(source, f"line {at}: {message}{': cut short?' if found < wanted else ''}")


def split_word(word: int) -> tuple[int, int]:
    """Length in words and first row of a string, from the one word row + 65536 (length + 1)."""
    length = word // ROW_BITS - 1
    return length, word - ROW_BITS * (length + 1)


def read_binary(content: bytes, source: str) -> dict[str, csc_array]:
    """The matrices of a binary file, in Fortran's records."""
    order = "<" if content[:4] == b"\x18\0\0\0" else ">"
    found: dict[str, csc_array] = {}
    start = at = 0  # of the last record, and of the next

    def record() -> bytes:
        nonlocal start, at
        length = int.from_bytes(content[at : at + 4], "little" if order == "<" else "big", signed=True)
        end = at + 8 + length
        if length < 0 or end > len(content) or content[at : at + 4] != content[end - 4 : end]:
            raise fault(source, f"byte {at}: found no whole record: cut short?")
        start, at = at, end
        return content[start + 4 : end - 4]

    while at < len(content):
        head = record()
        if len(head) != 24:
            raise fault(source, f"byte {start}: found a header of {len(head)} bytes, expected 24")
        columns, rows, _, kind = np.frombuffer(head, f"{order}i4", 4).tolist()
        entries = begun(source, head[16:].decode("latin-1").strip(), columns, rows, kind)
        while True:
            body = record()
            if len(body) < 12:
                raise fault(source, f"byte {start}: found a column of {len(body)} bytes, expected 12 or more")
            column, row, words = np.frombuffer(body, f"{order}i4", 3).tolist()
            if column > entries.columns:
                break
            if len(body) != 12 + 4 * words:
                raise fault(source, f"byte {start}: found {len(body) - 12} bytes of values, expected {4 * words}")
            entries.parts += binary_parts(body[12:], column, row, entries, order)
        keep(found, entries, source)
    return found


def binary_parts(data: bytes, column: int, row: int, entries: Entries, order: str) -> list[tuple[int, int, FloatArray]]:
    """Values of one column, a whole one or in strings."""
    kind: Any = f"{order}f{4 * entries.words}"
    if row > 0:
        return [(column, row, np.frombuffer(data, kind).astype(float))]
    parts, at = [], 0
    while at < len(data):
        if entries.long:
            length, first = np.frombuffer(data, f"{order}i4", 2, at).tolist()
            length -= 1
        else:
            length, first = split_word(int(np.frombuffer(data, f"{order}i4", 1, at)[0]))
        at += 8 if entries.long else 4
        left = (len(data) - at) // 4
        if not 0 < length <= left or length % entries.words:
            found = f"a string of {length} words in column {column}"
            raise ValueError(f"{found}, expected {entries.words} a value and {left} at most")
        parts.append((column, first, np.frombuffer(data[at : at + 4 * length], kind).astype(float)))
        at += 4 * length
    return parts
