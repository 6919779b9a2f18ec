"""Nastran's OP4 files: real matrices by name, dense and sparse, as text (`op4_text.py`) or binary (`op4_binary.py`).

The header of a matrix gives columns, rows (negative: long row numbers), form, type (1 single, 2 double) and name. The
columns follow, each with `column, row, words` and its values. If the row is 0, the values come in strings, each with
its first row and its length. These are one word, row + 65536 (length + 1), or two words if row numbers are long. A
column number above the last one ends the matrix. Lengths count words of four bytes, so a double has two words. In files
of 64-bit integers a word has eight bytes.
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
        `matrix-file` for a truncated file, a complex matrix, or a file of another format.
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
