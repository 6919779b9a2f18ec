"""Motions as one file for ParaView: VTKHDF 2.0, an unstructured grid whose points move from step to step.

The file contains the cells once, and points and their data once for each step. ParaView 5.12 and newer animate it.
"""

import io
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from typing import Any

import numpy as np

from casingfem.errors import MissingExtraError
from casingfem.extras import remedy
from casingfem.io.arrays import Array, FloatArray, IntArray

ENDING = ".vtkhdf"
VERSION = (2, 0)


def require_series() -> None:
    """Raise MissingExtraError if h5py, which writes these files, is not installed."""
    if find_spec("h5py") is None:
        raise MissingExtraError("--vtu", found="no package h5py", expected=f"it: {remedy('test-data')}")


def series_file(
    time: Sequence[float] | FloatArray, points: Array, cells: IntArray, kind: int, at_points: Mapping[str, Array],
    of_whole: Mapping[str, float] | None = None, order: Sequence[int] | None = None,
) -> bytes:  # fmt: skip
    r"""One VTKHDF file of a motion.

    Parameters
    ----------
    time
        Times [s], (steps,).
    points
        Positions [m], (pictures, nodes, 3): one picture for each step, or those that `order` names.
    cells, kind
        Nodes of each cell, (cells, nodes of a cell), and their VTK cell type.
    at_points
        Values at the points by name, (pictures, nodes) or (pictures, nodes, components).
    of_whole
        Values for the whole motion by name.
    order
        Picture of each step, (steps,), if steps share pictures.

    Raises
    ------
    MissingExtraError
        h5py is not installed.

    Examples
    --------
    >>> moved = np.array([np.eye(3), np.eye(3) + 0.1])
    >>> series_file([0.0, 0.5], moved, np.array([[0, 1, 2]]), 5, {"size": np.ones((2, 3))})[:4]
    b'\x89HDF'
    """
    require_series()
    import h5py

    steps, (pictures, nodes) = len(time), points.shape[:2]
    count, corners = cells.shape
    zeros = np.zeros(steps, dtype="i8")
    places = nodes * np.asarray(range(steps) if order is None else order, dtype="i8")
    buffer = io.BytesIO()
    with h5py.File(buffer, "w") as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = np.array(VERSION, dtype="i8")
        root.attrs.create("Type", b"UnstructuredGrid", dtype=h5py.string_dtype("ascii", len("UnstructuredGrid")))
        sizes = {"NumberOfPoints": nodes, "NumberOfCells": count, "NumberOfConnectivityIds": cells.size}
        for name, size in sizes.items():
            root[name] = np.array([size], dtype="i8")
        root["Connectivity"] = cells.ravel().astype("i8")
        root["Offsets"] = corners * np.arange(count + 1, dtype="i8")
        root["Types"] = np.full(count, kind, dtype="u1")
        kept(root, "Points", points.reshape(-1, 3))
        played = root.create_group("Steps")
        played.attrs["NSteps"] = np.int64(steps)
        played["Values"] = np.asarray(time, dtype="f8")
        played["NumberOfParts"] = np.ones(steps, dtype="i8")
        played["PartOffsets"], played["PointOffsets"] = zeros, places
        for name in ("CellOffsets", "ConnectivityIdOffsets"):
            played[name] = zeros[:, None]
        data, offsets = root.create_group("PointData"), played.create_group("PointDataOffsets")
        for name, values in at_points.items():
            kept(data, name, values.reshape(pictures * nodes, *values.shape[2:]))
            offsets[name] = places
        for name, number in (of_whole or {}).items():
            root.require_group("FieldData")[name] = np.array([number])
            played.require_group("FieldDataOffsets")[name] = zeros
    return buffer.getvalue()


def kept(group: Any, name: str, values: Array) -> None:
    """A compressed data set in single precision, which is enough for pictures."""
    group.create_dataset(name, data=np.asarray(values, dtype="f4"), compression="gzip", shuffle=True)
