"""Frequency responses in files of plain arrays from other programs: MATLAB's .mat, .npz.

The layout: `freq_hz` (lines,), `frf` (channels, lines) or (channels, references, lines), complex; optional `coherence`
of the same shape, `form` or `unit`, `points` and `directions` (channels,), `references` (references,) or (references,
2), points and directions. The lines may also be the first axis, like MATLAB's columns. Without points, channels are
numbered from 1; without directions, these are 0.
"""

import os
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from casingfem.errors import InputError
from casingfem.experiment.frf.forms import FORMS
from casingfem.experiment.frf.frf_set import FrfSet
from casingfem.extras import remedy
from casingfem.io.arrays import Array, IntArray
from casingfem.io.probe import UnreadableError, arrays_of

NAMES = {
    "freq_hz": ("freq_hz", "freq", "freqs", "frequency", "frequencies", "f", "f_hz"),
    "omega": ("omega", "omega_rad_s"),
    "frf": ("frf", "frfs", "h", "responses", "frf_matrix"),
    "coherence": ("coherence", "coh"),
    "form": ("form",),
    "unit": ("unit", "units"),
    "points": ("points", "point", "nodes", "response_point"),
    "directions": ("directions", "direction", "response_direction"),
    "references": ("references", "reference", "reference_point"),
}
EXPECTED = "freq_hz (lines,) and frf (channels, lines) or (channels, references, lines)"


def from_loose(stored: Mapping[str, Array], path: str, *, coherence: bool = False) -> FrfSet | None:
    """The responses in named arrays, or their coherence; None if there is none.

    Raises
    ------
    InputError
        There are no frequencies or responses (the message lists the names found), two arrays have the same meaning, or
        shapes do not fit.
    """
    arrays = by_meaning(stored, NAMES, path)
    if coherence and "coherence" not in arrays:
        return None
    if "frf" not in arrays or not {"freq_hz", "omega"} & arrays.keys():
        found = "arrays " + (", ".join(sorted(stored)) or "none")
        raise InputError(path, found=found, expected=f"{EXPECTED}; state other names by --array MEANING=NAME")
    freq = arrays["freq_hz"] if "freq_hz" in arrays else _numbers(arrays["omega"], "omega", path) / (2.0 * np.pi)
    x = np.ravel(_numbers(freq, "freq_hz", path))
    values = _lines_last(_numbers(arrays["coherence" if coherence else "frf"], "frf", path), len(x), path)
    channels, references = values.shape[:2]
    points = _whole(arrays.get("points", np.arange(1, channels + 1)), (channels,), "points", path)
    directions = _whole(arrays.get("directions", np.zeros(channels)), (channels,), "directions", path)
    bases = np.atleast_1d(np.squeeze(arrays.get("references", np.arange(1, references + 1))))
    bases = bases.reshape(references, -1) if bases.size in (references, 2 * references) else bases
    bases = _whole(bases, (references, 1 if bases.ndim < 2 else bases.shape[1]), "references", path)
    form, unit = (str(np.ravel(arrays[name])[0]).strip() if name in arrays else "" for name in ("form", "unit"))
    if form not in ("", *FORMS):
        raise InputError(path, found=f"form {form!r}", expected=" or ".join(FORMS))
    return FrfSet.from_arrays(
        kind="spectrum" if coherence else "frf",
        x=x,
        responses=values.reshape(channels * references, len(x)),
        unit="" if coherence else unit,
        form="" if coherence else form,
        response_point=np.repeat(points, references),
        response_direction=np.repeat(directions, references),
        reference_point=np.tile(bases[:, 0], channels),
        reference_direction=np.tile(bases[:, 1] if bases.shape[1] > 1 else np.zeros(references, np.int64), channels),
        path=path,
    )


def renamed(stored: Mapping[str, Array], names: Mapping[str, str], path: str) -> dict[str, Array]:
    """Arrays with `names` (meaning: name in the file) under their meanings, without other arrays of these meanings.

    Raises
    ------
    InputError
        A meaning is unknown, or the file does not have a name.
    """
    unknown = [meaning for meaning in names if meaning not in NAMES]
    if unknown:
        raise InputError(f"array {unknown[0]!r}", found="no such meaning", expected=f"one of {', '.join(NAMES)}")
    missing = [name for name in names.values() if name not in stored]
    if missing:
        found = f"no array {missing[0]!r} among " + (", ".join(sorted(stored)) or "none")
        raise InputError(path, found=found, expected="the name of an array of the file")
    taken = {other for meaning in names for other in NAMES[meaning]}
    left = {name: array for name, array in stored.items() if name.rpartition(".")[2].lower() not in taken}
    return left | {meaning: stored[name] for meaning, name in names.items()}


def read_mat(path: str | os.PathLike[str]) -> dict[str, Array]:
    """Arrays of numbers and text in a MATLAB file, version 5 to 7.3, by name; fields of a struct as `struct.field`.

    Raises
    ------
    InputError
        The file is not a MATLAB file or is damaged, or it has version 7.3 and h5py is not installed.
    """
    try:
        return arrays_of(Path(path), __name__, "mat_contents")
    except (UnreadableError, OSError) as error:
        raise InputError(str(path), found=f"no readable MATLAB file ({error})", expected="a .mat file") from None


def mat_contents(path: Path) -> dict[str, Array]:
    """Contents of a MAT file for `read_mat`, read in a child process."""
    from scipy.io import loadmat

    try:
        tree: Any = loadmat(path, simplify_cells=True)
    except NotImplementedError:
        tree = _version_73(path)
    return _flat(tree)


def _flat(tree: Mapping[str, Any], above: str = "") -> dict[str, Array]:
    found = dict[str, Array]()
    for name, value in tree.items():
        if name.startswith(("__", "#")):
            continue
        if isinstance(value, Mapping):
            found |= _flat(value, f"{above}{name}.")
        elif np.asarray(value).dtype.kind in "biufcU":
            found[above + name] = np.asarray(value)
    return found


def _version_73(path: Path) -> dict[str, Any]:
    """Groups and data sets of an HDF5 file in MATLAB's layout: axes reversed, complex numbers in two fields."""
    try:
        import h5py
    except ImportError:
        raise ValueError(f"version 7.3 needs the package h5py: {remedy('test-data')}") from None

    def value(item: Any) -> Any:
        if isinstance(item, h5py.Group):
            return {name: value(part) for name, part in item.items()}
        array = np.asarray(item).T
        if array.dtype.names == ("real", "imag"):
            return array["real"] + 1j * array["imag"]
        if item.attrs.get("MATLAB_class") in (b"char", "char"):
            return "".join(chr(letter) for letter in np.ravel(array.T))
        return array

    with h5py.File(path, "r") as file:
        return {name: value(item) for name, item in file.items()}


def by_meaning(stored: Mapping[str, Array], names_of: Mapping[str, Collection[str]], path: str) -> dict[str, Array]:
    """Arrays by their meaning; a field of a struct is recognised by its own name."""
    arrays = dict[str, Array]()
    for meaning, names in names_of.items():
        found = [name for name in stored if name.rpartition(".")[2].lower() in names]
        if len(found) > 1:
            raise InputError(path, found=f"{' and '.join(sorted(found))} for {meaning}", expected="one of them")
        if found:
            arrays[meaning] = stored[found[0]]
    return arrays


def _numbers(array: Array, name: str, path: str) -> Array:
    if array.dtype.kind not in "biufc" or (name != "frf" and array.dtype.kind == "c"):
        expected = "numbers" if name == "frf" else "real numbers"
        raise InputError(path, found=f"{name} of type {array.dtype}", expected=expected)
    return array


def _lines_last(values: Array, lines: int, path: str) -> Array:
    """Values (channels, references, lines), from arrays with the lines at either end."""
    ends = [axis for axis in {0, values.ndim - 1} if values.ndim and values.shape[axis] == lines]
    if values.ndim not in (1, 2, 3) or len(ends) != 1:
        found = f"frf {values.shape} for {lines} frequencies"
        square = "; the number of lines equals another size: remove one line" if len(ends) > 1 else ""
        raise InputError(path, found=found, expected=f"{EXPECTED}{square}")
    moved = np.moveaxis(values, ends[0], -1)
    return moved.reshape(moved.shape[0] if moved.ndim > 1 else 1, moved.shape[1] if moved.ndim > 2 else 1, lines)


def _whole(values: Array, shape: tuple[int, ...], name: str, path: str) -> IntArray:
    given = np.asarray(values)
    if given.dtype.kind not in "iuf" or given.size != int(np.prod(shape)) or np.any(given % 1 != 0):
        raise InputError(path, found=f"{name} {given.shape} of {given.dtype}", expected=f"whole numbers {shape}")
    return given.reshape(shape).astype(np.int64)
