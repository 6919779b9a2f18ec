"""Files of plain arrays (npz): without pickle, written whole or not at all."""

from __future__ import annotations

import os
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact.io.outfiles import settle, write_atomic


def write_npz(path: str | os.PathLike[str], arrays: Mapping[str, ArrayLike], *, compressed: bool = False) -> Path:
    """Write arrays by name; returns the path."""

    def store(part: Path) -> None:
        with part.open("wb") as stream:
            (np.savez_compressed if compressed else np.savez)(stream, allow_pickle=False, **arrays)

    return write_atomic(Path(path), store)


def load_npz(path: str | os.PathLike[str]) -> dict[str, NDArray[Any]]:
    """All arrays of a file by name.

    Raises
    ------
    ValueError
        No file, another kind of file, or one with pickled objects.
    """
    try:
        settle(Path(path).parent)
        with Path(path).open("rb") as stream, np.load(stream, allow_pickle=False) as archive:
            return {name: archive[name] for name in archive.files}
    except (OSError, ValueError, EOFError, AttributeError, BadZipFile, zlib.error) as error:
        raise ValueError(str(error)) from error
