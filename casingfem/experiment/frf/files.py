"""Frequency responses from a file of any kind that is read, and the angles of their points."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from casingfem.errors import InputError
from casingfem.experiment.frf.frf_set import FrfSet
from casingfem.experiment.frf.hdf5 import read_hdf5
from casingfem.experiment.uff.read import read_uff
from casingfem.io.arrays import FloatArray
from casingfem.io.strict_csv import read

UNIVERSAL = (".uff", ".unv", ".uf", ".ufb")
HDF5 = (".h5", ".hdf5")
COHERENCE = 6, 26  # of functions of universal files: ordinary, multiple
KINDS = ", ".join((*UNIVERSAL, ".npz", *HDF5, ".csv"))


def read_frfs(path: str | os.PathLike[str]) -> FrfSet:
    """Frequency responses of a universal file, an npz of `FrfSet.save`, HDF5 or a csv table, by the file's ending.

    Raises
    ------
    InputError, InputError
        An unknown ending; what the readers refuse.
    """
    ending = Path(path).suffix.lower()
    if ending in UNIVERSAL:
        return FrfSet.from_uff(path)
    if ending == ".npz":
        return FrfSet.load(path)
    if ending in HDF5:
        return read_hdf5(path)
    if ending == ".csv":
        return FrfSet.from_csv(path)
    raise InputError(str(path), found=f"ending {ending!r}", expected=f"one of {KINDS}")


def read_coherence(path: str | os.PathLike[str]) -> FrfSet | None:
    """Coherence, ordinary or multiple, of a universal file or an npz of `FrfSet.save`; None where there is none.

    Raises
    ------
    InputError
        An unknown ending; what the readers refuse.
    """
    ending = Path(path).suffix.lower()
    if ending == ".npz":
        return FrfSet.load(path)
    if ending not in UNIVERSAL:
        raise InputError(str(path), found=f"ending {ending!r}", expected=f"one of {', '.join((*UNIVERSAL, '.npz'))}")
    functions = [function for function in read_uff(path).functions if function.kind in COHERENCE]
    return FrfSet.from_functions(functions, "spectrum", str(path)) if functions else None


def file_coherence(path: str | os.PathLike[str]) -> FrfSet | None:
    """Coherence that stands beside the responses of a universal file; None in other files, or where there is none."""
    return read_coherence(path) if Path(path).suffix.lower() in UNIVERSAL else None


def file_places(path: str | os.PathLike[str]) -> dict[int, FloatArray] | None:
    """Positions [m] of the nodes of a universal file, by label; None without geometry off the axis."""
    if Path(path).suffix.lower() not in UNIVERSAL:
        return None
    nodes = read_uff(path).nodes
    if nodes is None or not np.any(np.hypot(nodes.points[:, 0], nodes.points[:, 1]) > 0.0):
        return None
    return dict(zip(nodes.labels.tolist(), nodes.points, strict=True))


def read_places(path: str | os.PathLike[str]) -> tuple[dict[int, float], dict[int, FloatArray] | None]:
    """Angles [deg] and positions [m] by point, from a csv: point, angle_deg and, for positions, radius_m and z_m.

    Raises
    ------
    InputError
        Other columns, a point twice, a radius below zero, cells that are no numbers.
    """
    csv = read(path)
    if set(csv.header) not in ({"point", "angle_deg"}, {"point", "angle_deg", "radius_m", "z_m"}):
        expected = "point,angle_deg, or point,angle_deg,radius_m,z_m"
        raise InputError(csv.path, line=csv.header_line, found=",".join(csv.header), expected=expected)
    points, angles = csv.integers("point").tolist(), csv.numbers("angle_deg")
    for row, point in enumerate(points):
        if point in points[:row]:
            raise csv.refuse(row=row, column="point", found=f"{point} again", expected="each point once")
    by_point = dict(zip(points, angles.tolist(), strict=True))
    if "z_m" not in csv.header:
        return by_point, None
    radius, theta = csv.numbers("radius_m"), np.radians(angles)
    for row in np.flatnonzero(radius < 0.0)[:1].tolist():
        raise csv.refuse(row=row, column="radius_m", found=f"{radius[row]:g}", expected="0 or more")
    places = np.column_stack([radius * np.cos(theta), radius * np.sin(theta), csv.numbers("z_m")])
    return by_point, dict(zip(points, places, strict=True))


def read_picks(path: str | os.PathLike[str]) -> FloatArray:
    """Frequencies [Hz] picked by hand: the column freq_hz of a csv; other columns are of no matter.

    Raises
    ------
    InputError
        No such column, cells that are no numbers.
    """
    csv = read(path)
    if "freq_hz" not in csv.header:
        raise InputError(csv.path, line=csv.header_line, found=",".join(csv.header), expected="a column freq_hz")
    return csv.numbers("freq_hz")
