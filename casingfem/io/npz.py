"""Files of plain arrays (npz): without pickle, written whole or not at all, read with all that is wanted or refused."""

import os
import zlib
from collections.abc import Collection, Mapping
from pathlib import Path
from zipfile import BadZipFile

import numpy as np
from numpy.typing import ArrayLike

from casingfem.errors import InputError
from casingfem.io.arrays import Array
from casingfem.io.outfiles import write_atomic


def write_npz(path: str | os.PathLike[str], arrays: Mapping[str, ArrayLike], *, compressed: bool = False) -> Path:
    """Write arrays by name; returns the path."""

    def store(part: Path) -> None:
        with part.open("wb") as stream:
            (np.savez_compressed if compressed else np.savez)(stream, allow_pickle=False, **arrays)

    return write_atomic(Path(path), store)


def read_npz(path: str | os.PathLike[str], wanted: Collection[str] = (), expected: str = "") -> dict[str, Array]:
    """All arrays of a file by name.

    Raises
    ------
    InputError
        No file, another kind of file, or one without an array that is wanted; `expected` says what it should be.
    """
    try:
        with Path(path).open("rb") as stream, np.load(stream, allow_pickle=False) as archive:
            stored = {name: archive[name] for name in archive.files}
    except (OSError, ValueError, EOFError, AttributeError, BadZipFile, zlib.error) as error:
        expected = expected or "a file of arrays"
        raise InputError(str(path), found=f"no readable npz file ({error})", expected=expected) from error
    if missing := set(wanted) - stored.keys():
        found = f"an npz without {', '.join(sorted(missing))}"
        raise InputError(str(path), found=found, expected=expected or ", ".join(sorted(wanted)))
    return stored
