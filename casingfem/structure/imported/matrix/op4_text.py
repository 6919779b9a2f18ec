"""OP4 files as text: lines of integers, and values whose width the header states.

The header may end with the format of the values; the default is 5E16.9. It ends with `I16` if columns and rows take
sixteen characters each.
"""

import re
from itertools import takewhile

import numpy as np
from scipy.sparse import csc_array

from casingfem.io.arrays import FloatArray
from casingfem.structure.imported.matrix.matrix_set import fault
from casingfem.structure.imported.matrix.op4_entries import Entries, begun, keep, split_word

FORMAT = re.compile(r"[ED](\d+)\.", re.IGNORECASE)
PLAIN_WIDTH = 16  # of values in a file that gives no format
NUMBERS = re.compile(r"\s*[-+]?\d*\.\d")  # how a line of values begins, and no other
SHORT_EXPONENT = re.compile(r"(?<=\d)([-+]\d{3})$")  # Fortran leaves out the E of a three-digit exponent


def read_text(lines: list[str], source: str) -> dict[str, csc_array]:
    """The matrices of a text file."""
    found: dict[str, csc_array] = {}
    at = 0
    while at < len(lines):
        if not lines[at].strip():
            at += 1
            continue
        entries, width = header(lines[at], at, source)
        at = text_columns(lines, at + 1, width, entries, source)
        keep(found, entries, source)
    return found


def header(line: str, at: int, source: str) -> tuple[Entries, int]:
    """A matrix from its header line, and the width of its values."""
    wide = 48 if line.rstrip().upper().endswith("|I16") else 32  # of these numbers, columns and rows in 16 each
    numbers, name, form = line[:wide], line[wide : wide + 8], line[wide + 8 :]
    width = FORMAT.search(form)
    if len(numbers.split()) != 4 or (width is None and form.strip()):
        raise fault(
            source,
            f"line {at + 1}: found {line[:48]!r}, expected the header of a matrix: columns, rows, form, type, name",
        )
    columns, rows, _, kind = integers(numbers, at, source)
    return begun(source, name.strip(), columns, rows, kind), PLAIN_WIDTH if width is None else int(width[1])


def text_columns(lines: list[str], at: int, width: int, entries: Entries, source: str) -> int:
    """Read columns until the one after the last; returns the line after it."""
    column = row = wanted = 0

    def values() -> FloatArray:
        nonlocal at
        numbers: list[float] = []
        while at < len(lines) and NUMBERS.match(lines[at]):
            line = lines[at].rstrip().upper().replace("D", "E")
            try:
                numbers += [real(line[k : k + width]) for k in range(0, len(line), width)]
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


def real(text: str) -> float:
    """A real number; ValueError if the text is not a number.

    >>> real(" 1.2500000000000000E+00"), real("-2.5000000000000000-103")
    (1.25, -2.5e-103)
    """
    return float(SHORT_EXPONENT.sub(r"E\1", text))


def integers(line: str, at: int, source: str) -> list[int]:
    """Integers of a line."""
    try:
        return [int(word) for word in line.split()]
    except ValueError:
        raise fault(source, f"line {at + 1}: found {line!r}, expected whole numbers") from None


def check_column(source: str, at: int, entries: Entries, column: int, wanted: int) -> None:
    """Refuse a column with fewer or more values than announced; programs count the announced words differently."""
    strings = [len(values) for _, _, values in takewhile(lambda part: part[0] == column, reversed(entries.parts))]
    found = sum(strings)
    if column and not found <= wanted <= entries.words * found + 4 * len(strings):
        message = f"{entries.name}: found {found} values in column {column}, expected {wanted} words as announced"
        raise fault(source, f"line {at}: {message}{': cut short?' if found < wanted else ''}")
