"""Frequency responses in HDF5: the arrays of `FrfSet` as data sets, kind, unit and card as attributes of the file."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np

from casingfem.errors import InputError
from casingfem.experiment.frf.frf_set import PLACES, FrfSet
from casingfem.extras import remedy
from casingfem.io.probe import UnreadableError, arrays_of
from contact.io.npz import require_kinds
from contact.io.outfiles import write_atomic

ARRAYS = ("x", "responses", *PLACES)
SAID = ("kind", "unit", "card")


def read_hdf5(path: str | os.PathLike[str]) -> FrfSet:
    """Measured functions of an HDF5 file: x (lines,), responses (channels, lines), the four places (channels,).

    Places that are missing are 0 for every channel. The file's attributes `kind` ("frf" if missing), `unit` and
    `card` say what they are.

    Raises
    ------
    InputError
        h5py is not installed; a file that is no HDF5, lacks a data set or the unit; what `FrfSet` refuses.
    """
    _h5py(path)
    try:
        stored = arrays_of(Path(path), __name__, "_contents")
    except (UnreadableError, OSError) as error:
        raise InputError(str(path), found=f"no readable HDF5 file ({error})", expected="HDF5") from None
    arrays = {name: stored[name] for name in ARRAYS if name in stored}
    for name in ("x", "responses"):
        if name not in arrays:
            found = f"no data set {name!r}"
            raise InputError(str(path), found=found, expected=f"data sets {', '.join(ARRAYS)}")
    try:
        require_kinds(arrays, {"responses": "complex"})
    except ValueError as error:
        raise InputError(f"{path}: {error}") from error
    if "unit" not in stored:
        raise InputError(str(path), found="no attribute 'unit'", expected="the unit, such as '(m/s^2)/N'")
    card = tuple(str(line) for line in np.atleast_1d(stored.get("card", ())).tolist())
    kind: Any = str(stored.get("kind", "frf"))
    return FrfSet.from_arrays(kind=kind, unit=str(stored["unit"]), card=card, path=str(path), **arrays)


def _contents(path: Path) -> dict[str, Any]:
    """Data sets and attributes (in a child)."""
    h5py = _h5py(path)
    with h5py.File(path, "r") as file:
        arrays = {name: np.asarray(file[name]) for name in ARRAYS if isinstance(file.get(name), h5py.Dataset)}
        return arrays | {name: np.asarray(file.attrs[name]).astype(str) for name in SAID if name in file.attrs}


def write_hdf5(frfs: FrfSet, path: str | os.PathLike[str]) -> Path:
    """Write what `read_hdf5` reads, whole or not at all; numbers come back bit for bit."""
    h5py = _h5py(path)

    def store(part: Path) -> None:
        with h5py.File(part, "w") as file:
            for name in ARRAYS:
                file[name] = getattr(frfs, name)
            file.attrs["kind"], file.attrs["unit"] = frfs.kind, frfs.unit
            if frfs.card:
                file.attrs["card"] = list(frfs.card)

    return write_atomic(Path(path), store)


def _h5py(path: str | os.PathLike[str]) -> Any:
    """h5py, or what to install."""
    try:
        import h5py
    except ImportError as error:
        expected = f"the package h5py: {remedy('test-data')}"
        raise InputError(str(path), found="an HDF5 file", expected=expected) from error
    return h5py
