"""Frequency responses from files of all supported kinds, and the angles of their points.

In HDF5 the arrays of `FrfSet` are data sets; kind, unit, form and card are attributes of the file.
"""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from casingfem.errors import InputError
from casingfem.experiment.frf.frf_set import PLACES, FrfSet
from casingfem.experiment.frf.loose_arrays import from_loose, read_mat, renamed
from casingfem.experiment.uff.read import read_uff
from casingfem.extras import remedy
from casingfem.io.arrays import Array, FloatArray
from casingfem.io.columns import FREQUENCY, PLACE, named
from casingfem.io.npz import read_npz
from casingfem.io.probe import UnreadableError, arrays_of
from casingfem.io.strict_csv import read
from casingfem.io.workbook import file_and_sheet
from contact.io.infiles import open_file, regular_file
from contact.io.npz import require_kinds
from contact.io.outfiles import write_atomic

UNIVERSAL = (".uff", ".unv", ".uf", ".ufb")
HDF5 = (".h5", ".hdf5")
LOOSE = (".mat", ".npz")
COHERENCE = 6, 26  # of functions of universal files: ordinary, multiple
TABLES = (".csv", ".xlsx")
KINDS = ", ".join((*UNIVERSAL, ".npz", ".mat", *HDF5, *TABLES))
ARRAYS = ("x", "responses", *PLACES)
SAID = ("kind", "unit", "form", "card")


def read_frfs(path: str | os.PathLike[str], *, arrays: Mapping[str, str] | None = None) -> FrfSet:
    """Frequency responses of a universal file, npz, MATLAB file, HDF5, a csv table or a workbook, by the file's ending.

    A workbook has the rows of a csv table, on its first sheet or on that of `file.xlsx#Sheet`. An npz is that of
    `FrfSet.save`, or has the layout of `loose_arrays`, like MATLAB files. `arrays` gives the file's own names, such as
    {"freq_hz": "Freq_domain", "frf": "Hf_chan_2"}.

    Raises
    ------
    InputError
        The ending is unknown, or the reader refuses the file.

    Examples
    --------
    >>> import tempfile
    >>> import casingfem as cf
    >>> one = cf.frf.FrfSet.from_arrays(kind="frf", x=[10.0, 20.0], responses=[1.0, 2.0j], unit="m/N")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     cf.frf.read_frfs(one.to_csv(f"{folder}/one.csv"))
    FrfSet(frf, 1 channel, 2 lines, 10 to 20 Hz, m/N)
    """
    ending = Path(file_and_sheet(os.fspath(path))[0]).suffix.lower()
    if arrays and ending not in LOOSE:
        raise InputError(str(path), found="names of arrays", expected=f"a file of arrays: {' or '.join(LOOSE)}")
    if ending in HDF5:
        return read_hdf5(path)
    if ending in LOOSE and (stored := _loose(path, arrays)) is not None:
        found = from_loose(stored, str(path))
        assert found is not None
        return found
    readers = {**dict.fromkeys(UNIVERSAL, FrfSet.from_uff), ".npz": FrfSet.load}
    readers |= dict.fromkeys(TABLES, FrfSet.from_csv)
    if ending not in readers:
        _require_file(path)
        raise InputError(str(path), found=f"ending {ending!r}", expected=f"one of {KINDS}")
    return readers[ending](path)


def _require_file(path: str | os.PathLike[str]) -> None:
    """Refuse a path that is not a file, whatever its ending."""
    try:
        if os.path.lexists(path):
            open_file(path).close()
    except OSError as error:
        raise InputError(f"{os.fspath(path)}: {error.strerror}") from error


def _loose(path: str | os.PathLike[str], arrays: Mapping[str, str] | None = None) -> dict[str, Array] | None:
    """Arrays of a MATLAB file or npz, under the stated names; None for an npz that `FrfSet.save` wrote."""
    stored = read_mat(path) if Path(path).suffix.lower() == ".mat" else read_npz(path)
    if arrays:
        return renamed(stored, arrays, str(path))
    return None if {"x", "responses"} <= stored.keys() else stored


def read_coherence(path: str | os.PathLike[str]) -> FrfSet | None:
    """Coherence, ordinary or multiple, from a universal file or an npz of `FrfSet.save`; None if there is none.

    Raises
    ------
    InputError
        The ending is unknown, or the reader refuses the file.

    Examples
    --------
    >>> import tempfile
    >>> import casingfem as cf
    >>> one = cf.frf.FrfSet.from_arrays(kind="spectrum", x=[10.0, 20.0], responses=[0.9, 1.0], unit="")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     cf.frf.read_coherence(one.save(f"{folder}/coherence.npz")).responses.real.tolist()
    [[0.9, 1.0]]
    """
    ending = Path(path).suffix.lower()
    if ending in LOOSE:
        stored = _loose(path)
        return FrfSet.load(path) if stored is None else from_loose(stored, str(path), coherence=True)
    if ending not in UNIVERSAL:
        raise InputError(str(path), found=f"ending {ending!r}", expected=f"one of {', '.join((*UNIVERSAL, *LOOSE))}")
    functions = [function for function in read_uff(path).functions if function.kind in COHERENCE]
    return FrfSet.from_functions(functions, "spectrum", str(path)) if functions else None


def file_coherence(path: str | os.PathLike[str], *, arrays: Mapping[str, str] | None = None) -> FrfSet | None:
    """Coherence in the same file as the responses, for several kinds of file; None if there is none."""
    ending = Path(path).suffix.lower()
    if ending in LOOSE:
        stored = _loose(path, arrays)
        return None if stored is None else from_loose(stored, str(path), coherence=True)
    return read_coherence(path) if ending in UNIVERSAL else None


def file_places(path: str | os.PathLike[str]) -> dict[int, FloatArray] | None:
    """Positions [m] of the nodes of a universal file, by label; None without geometry off the axis."""
    if Path(path).suffix.lower() not in UNIVERSAL:
        return None
    nodes = read_uff(path).nodes
    if nodes is None or not np.any(np.hypot(nodes.points[:, 0], nodes.points[:, 1]) > 0.0):
        return None
    return dict(zip(nodes.labels.tolist(), nodes.points, strict=True))


def read_places(path: str | os.PathLike[str]) -> tuple[dict[int, float], dict[int, FloatArray] | None]:
    r"""Angles [deg] and positions [m] by point, from a csv: point, angle_deg and, for positions, radius_m and z_m.

    Raises
    ------
    InputError
        There are other columns, a repeated point, a negative radius, or cells that are not numbers.

    Examples
    --------
    >>> import tempfile
    >>> import casingfem as cf
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     text = "point,angle_deg\n4,90\n7,30\n"
    ...     _ = Path(folder, "angles.csv").write_text(text)
    ...     cf.frf.read_places(f"{folder}/angles.csv")
    ({4: 90.0, 7: 30.0}, None)
    """
    csv = named(read(path), PLACE)
    if set(csv.header) not in ({"point", "angle_deg"}, {"point", "angle_deg", "radius_m", "z_m"}):
        expected = "point,angle_deg, or point,angle_deg,radius_m,z_m"
        raise csv.refuse_header(found=",".join(csv.header), expected=expected)
    points, angles = csv.integers("point").tolist(), csv.numbers("angle_deg")
    above = set[int]()
    for row, point in enumerate(points):
        if point in above:
            raise csv.refuse(row=row, column="point", found=f"{point} again", expected="each point once")
        above.add(point)
    by_point = dict(zip(points, angles.tolist(), strict=True))
    if "z_m" not in csv.header:
        return by_point, None
    radius, theta = csv.numbers("radius_m"), np.radians(angles)
    for row in np.flatnonzero(radius < 0.0)[:1].tolist():
        raise csv.refuse(row=row, column="radius_m", found=f"{radius[row]:g}", expected="0 or more")
    places = np.column_stack([radius * np.cos(theta), radius * np.sin(theta), csv.numbers("z_m")])
    return by_point, dict(zip(points, places, strict=True))


def read_picks(path: str | os.PathLike[str]) -> FloatArray:
    r"""Frequencies [Hz] picked by hand: the column freq_hz of a csv; other columns are ignored.

    Raises
    ------
    InputError
        There is no such column, or cells are not numbers.

    Examples
    --------
    >>> import tempfile
    >>> import casingfem as cf
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = Path(folder, "picks.csv").write_text("mode,freq_hz\n1,90.5\n2,91\n")
    ...     cf.frf.read_picks(f"{folder}/picks.csv").tolist()
    [90.5, 91.0]
    """
    csv = named(read(path), (FREQUENCY,))
    if "freq_hz" not in csv.header:
        raise csv.refuse_header(found=",".join(csv.header), expected="a column freq_hz")
    return csv.numbers("freq_hz")


def read_hdf5(path: str | os.PathLike[str]) -> FrfSet:
    """Measured functions of an HDF5 file: x (lines,), responses (channels, lines), four place arrays (channels,).

    Missing places are 0 for every channel. The file's attributes `kind` ("frf" if missing), `unit` and
    `card` state what they are.

    Raises
    ------
    InputError
        h5py is not installed. The file is not HDF5, or has no data set or no unit. `FrfSet` refuses the data.
    """
    _h5py(path)
    try:
        stored = arrays_of(regular_file(path), __name__, "_contents")
    except (UnreadableError, OSError) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(str(path), found=f"no readable HDF5 file ({reason})", expected="HDF5") from None
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
    unit, form = str(stored["unit"]), str(stored.get("form", ""))
    return FrfSet.from_arrays(kind=kind, unit=unit, form=form, card=card, path=str(path), **arrays)


def _contents(path: Path) -> dict[str, Any]:
    """Data sets and attributes, read in a child process."""
    h5py = _h5py(path)
    with h5py.File(path, "r") as file:
        arrays = {name: np.asarray(file[name]) for name in ARRAYS if isinstance(file.get(name), h5py.Dataset)}
        return arrays | {name: np.asarray(file.attrs[name]).astype(str) for name in SAID if name in file.attrs}


def write_hdf5(frfs: FrfSet, path: str | os.PathLike[str]) -> Path:
    """Write a file for `read_hdf5`, whole or not at all; numbers are stored bit for bit."""
    h5py = _h5py(path)

    def store(part: Path) -> None:
        with h5py.File(part, "w") as file:
            for name in ARRAYS:
                file[name] = getattr(frfs, name)
            file.attrs["kind"], file.attrs["unit"] = frfs.kind, frfs.unit
            if frfs.form:
                file.attrs["form"] = frfs.form
            if frfs.card:
                file.attrs["card"] = list(frfs.card)

    return write_atomic(Path(path), store)


def _h5py(path: str | os.PathLike[str]) -> Any:
    """The module h5py, or an error with the command that installs it."""
    try:
        import h5py
    except ImportError as error:
        expected = f"the package h5py: {remedy('test-data')}"
        raise InputError(str(path), found="an HDF5 file", expected=expected) from error
    return h5py
