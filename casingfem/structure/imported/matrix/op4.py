"""Nastran's OP4 files: real matrices by name, dense and sparse, as text (`op4_text.py`) or binary (`op4_binary.py`).

A matrix begins with columns, rows (negative: long row numbers), form, type (1 single, 2 double), name; then, column by
column, `column, row, words` and the values. Row 0 announces strings of values, each with its row and length: in one
word row + 65536 (length + 1), or in two where row numbers are long. A column after the last one ends the matrix.
Lengths count words: four bytes, of which a double has two, or eight bytes in files of 64-bit integers.
"""

from pathlib import Path

from scipy.sparse import csc_array

from casingfem.errors import ModelError
from casingfem.structure.imported.matrix.matrix_set import fault
from casingfem.structure.imported.matrix.op4_binary import is_binary, read_binary
from casingfem.structure.imported.matrix.op4_text import read_text
from contact.io.infiles import read_bytes


def read_op4(path: Path) -> dict[str, csc_array]:
    """All matrices of a file by name.

    Raises
    ------
    ModelError
        `matrix-file` for a file that is cut short, complex, or no OP4.
    """
    content = read_bytes(path)
    if not is_binary(content):
        return read_text(content.decode("latin-1").rstrip("\r\n").replace("\r\n", "\n").split("\n"), path.name)
    try:
        return read_binary(content, path.name)
    except ModelError:
        raise
    except ValueError as error:  # of strings, and numpy's of records that are no whole number of values
        raise fault(path.name, f"found a record that does not fit its matrix ({error})") from None
