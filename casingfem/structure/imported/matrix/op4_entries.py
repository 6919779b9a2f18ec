"""A matrix of an OP4 file during reading: its header, and its entries column by column."""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array, csc_array

from casingfem.io.arrays import FloatArray, IntArray
from casingfem.structure.imported.matrix.matrix_set import fault, is_part, role_of

WORDS = {1: 1, 2: 2}  # of a number, by type of real matrices
OF_COMPLEX = {3: 1, 4: 2}  # of complex ones, whose values are two numbers each
ROW_BITS = 65536  # also the first number of rows that needs long row numbers
MOST = 2**31 - 1  # rows or columns: the largest number in a binary file


@dataclass(slots=True)
class Entries:
    """A matrix during reading."""

    name: str
    rows: int
    columns: int
    long: bool
    words: int
    parts: list[tuple[int, int, FloatArray]]  # column, first row, values
    real: bool = True

    def matrix(self, source: str) -> csc_array:
        """The finished matrix; entries outside its size are refused."""
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
        """Refuse entries that are given twice; their positions are counted column by column."""
        ordered = np.sort(places)
        for again in ordered[1:][ordered[1:] == ordered[:-1]][:1].tolist():
            column, row = divmod(again, self.rows)
            raise fault(source, f"{self.name}: found row {row + 1} of column {column + 1} again, expected it once")


def begun(source: str, name: str, columns: int, rows: int, kind: int) -> Entries:
    """Start a matrix from its header. Complex matrices are skipped; complex K, M, C or K4 are refused."""
    left_out = kind in OF_COMPLEX and not is_part(name)
    if kind not in WORDS and not left_out:
        found = f"type {kind}, {rows} rows, {columns} columns"
        also = "; 3 and 4 are complex" if kind in OF_COMPLEX else ""
        raise fault(source, f"{name}: found {found}, expected a real matrix (type 1 or 2{also})")
    if not (0 < columns <= MOST and 0 < abs(rows) <= MOST):
        raise fault(source, f"{name}: found {abs(rows)} rows, {columns} columns, expected 1 to {MOST} of each")
    long = rows < 0 or rows >= ROW_BITS
    return Entries(name, abs(rows), columns, long, (WORDS | OF_COMPLEX)[kind], [], not left_out)


def keep(found: dict[str, csc_array], entries: Entries, source: str) -> None:
    """Add a matrix to those read before. Complex ones are skipped; a second K, M or C of the same name is refused."""
    if not entries.real:
        return
    if entries.name in found and role_of(entries.name):
        raise fault(source, f"found the matrix {entries.name} again, expected it once")
    found[entries.name] = entries.matrix(source)


def split_word(word: int) -> tuple[int, int]:
    """Length in words and first row of a string, from the single word row + 65536 (length + 1)."""
    length = word // ROW_BITS - 1
    return length, word - ROW_BITS * (length + 1)
