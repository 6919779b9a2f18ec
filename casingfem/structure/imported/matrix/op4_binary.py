"""Binary OP4 files, in Fortran's records: integers of 32 or 64 bits, of either byte order.

The first record is the header of a matrix; its length shows the size of the integers and the byte order. With 64-bit
integers every word has eight bytes, so a number of either precision is one word.
"""

from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import csc_array

from casingfem.io.arrays import FloatArray
from casingfem.structure.imported.matrix.matrix_set import fault
from casingfem.structure.imported.matrix.op4_entries import Entries, begun, keep, split_word

SHORT, LONG = 24, 48  # bytes of a header, of words of four or eight bytes
NAMES = {size: "64-bit" if size == LONG else "32-bit" for size in (SHORT, LONG)}


class Layout(NamedTuple):
    """Byte order, and bytes of a word."""

    order: str
    word: int

    def integers(self, data: bytes, count: int, at: int = 0) -> list[int]:
        """Integers from a position in the file."""
        numbers: list[int] = np.frombuffer(data, f"{self.order}i{self.word}", count, at).tolist()
        return numbers

    def real(self, words: int) -> Any:
        """Type of a real number of this many four-byte words."""
        return f"{self.order}f{max(4 * words, self.word)}"


def layout_of(content: bytes) -> Layout | None:
    """The layout of a binary file; None for a text file."""
    lengths = {order: np.frombuffer(content[:4], f"{order}i4").tolist() for order in "<>"}
    return next((Layout(o, n // 6) for o, own in lengths.items() for n in own if n in NAMES), None)


def is_binary(content: bytes) -> bool:
    """Whether a file begins with the header of a matrix as a record."""
    return len(content) >= 4 and layout_of(content) is not None


def read_binary(content: bytes, source: str) -> dict[str, csc_array]:
    """The matrices of a binary file."""
    layout = layout_of(content)
    assert layout is not None
    found: dict[str, csc_array] = {}
    start = at = 0  # of the last record, and of the next

    def record() -> bytes:
        nonlocal start, at
        length = int.from_bytes(content[at : at + 4], "little" if layout.order == "<" else "big", signed=True)
        end = at + 8 + length
        if length < 0 or end > len(content) or content[at : at + 4] != content[end - 4 : end]:
            raise fault(source, f"byte {at}: found an incomplete record: cut short?")
        start, at = at, end
        return content[start + 4 : end - 4]

    size = layout.word
    while at < len(content):
        head = record()
        if len(head) != 6 * size:
            raise fault(source, f"byte {start}: found {len(head)} bytes, expected the header of a matrix, {6 * size}")
        columns, rows, _, kind = layout.integers(head, 4)
        entries = begun(source, name_of(head[4 * size :], size), columns, rows, kind)
        while True:
            body = record()
            if len(body) < 3 * size:
                raise fault(source, f"byte {start}: found a column of {len(body)} bytes, expected {3 * size} or more")
            column, row, words = layout.integers(body, 3)
            if column > entries.columns:
                break
            if len(body) != size * (3 + words):
                found_bytes = f"{len(body) - 3 * size} bytes of values"
                raise fault(source, f"byte {start}: found {found_bytes}, expected {size * words}")
            entries.parts += binary_parts(body[3 * size :], column, row, entries, layout)
        keep(found, entries, source)
    return found


def name_of(field: bytes, size: int) -> str:
    """A matrix's name; in words of eight bytes each half of the name may have its own padding."""
    text = field.decode("latin-1").replace("\0", " ")
    return text.replace(" ", "") if size == 8 else text.strip()


def binary_parts(
    data: bytes, column: int, row: int, entries: Entries, layout: Layout
) -> list[tuple[int, int, FloatArray]]:
    """Values of one column, stored as a whole or in strings."""
    kind, size = layout.real(entries.words), layout.word
    each = entries.words if size == 4 else 1  # words of a number
    if row > 0:
        return [(column, row, np.frombuffer(data, kind).astype(float))]
    parts, at = [], 0
    while at < len(data):
        if entries.long:
            length, first = layout.integers(data, 2, at)
            length -= 1
        else:
            length, first = split_word(layout.integers(data, 1, at)[0])
        at += 2 * size if entries.long else size
        left = (len(data) - at) // size
        if not 0 < length <= left or length % each:
            found = f"a string of {length} words in column {column}"
            raise ValueError(f"{found}, expected a multiple of {each} and at most {left}")
        parts.append((column, first, np.frombuffer(data[at : at + size * length], kind).astype(float)))
        at += size * length
    return parts
