"""Matrices as named arrays: npz, MATLAB's .mat (old ones by scipy, version 7.3 by h5py), HDF5.

K, M and maybe C and K4 (structural damping), dense, or sparse in MATLAB's form, or in an npz as NAME_data,
NAME_indices, NAME_indptr of compressed columns; `dofs` (n, 2), `nodes` (k, 4: number, x, y, z) and `axes` (k, 7:
number, directions of the node's own x and y) if present.
"""

import warnings
from pathlib import Path
from typing import Any

import numpy as np
from scipy.io import loadmat
from scipy.sparse import csc_array, issparse

from casingfem.errors import ModelError
from casingfem.extras import remedy
from casingfem.io.arrays import Array, IntArray
from casingfem.io.npz import read_npz
from casingfem.io.probe import UnreadableError, arrays_of
from casingfem.structure.imported.matrix.matrix_set import MatrixSet, roles_of, without_null
from casingfem.structure.imported.matrix.tables import own_axes
from contact.io.infiles import open_file, regular_file

TABLES = ("dofs", "nodes", "axes")
SIGNATURE = slice(512, 516)  # where a .mat file of version 7.3 begins to be HDF5
PARTS = {"data": "data", "indices": "ir", "indptr": "jc"}  # MATLAB's names of the parts of compressed columns


def read_arrays(path: Path, dofs: IntArray | None) -> MatrixSet:
    """K, M, C and K4 of a file of arrays, distinguished by their names.

    Raises
    ------
    ModelError
        `matrix-file` for a file that cannot be read, `matrix-dofs` without dofs, `matrix-names` without K or M.
    """
    read = {".npz": read_from_npz, ".mat": read_from_mat}.get(path.suffix.lower(), read_from_hdf5)
    found = read(path)
    tables = {name: np.asarray(found.pop(name)) for name in TABLES if name in found}
    numeric = {name: A for name, A in found.items() if A.ndim == 2 and A.dtype.kind in "iufc"}
    square = without_null(numeric)
    roles = roles_of(list(square), path.name)
    if dofs is None:
        if "dofs" not in tables:
            raise ModelError("matrix-dofs", f"{path.name}: found no array named dofs")
        dofs = whole_numbers(tables["dofs"], 2, "matrix-dofs", f"{path.name}: dofs").astype(np.int64)
    nodes = whole_numbers(tables.get("nodes", np.zeros((0, 4))), 4, "matrix-file", f"{path.name}: nodes", numbered=1)
    turned = whole_numbers(tables.get("axes", np.zeros((0, 7))), 7, "matrix-file", f"{path.name}: axes", numbered=1)
    matrices = {role: fitting(f"{path.name}: {name}", square[name]) for role, name in roles.items()}
    if odd := [name for role, name in roles.items() if matrices[role].dtype.kind == "c"]:
        text = f"found complex numbers in {odd[0]}, expected real K, M and C"
        raise ModelError("matrix-file", f"{path.name}: {text}")
    named = {role: A.astype(float) for role, A in matrices.items()}
    points = {int(row[0]): row[1:] for row in nodes}
    left_out = tuple(name for name in numeric if name not in roles.values())
    return MatrixSet(**named, dofs=dofs, points=points, axes=axes_of(turned, path), source=path.name, left_out=left_out)


def axes_of(table: Array, path: Path) -> dict[int, Array]:
    """Own axes of nodes from their table, (k, 7)."""
    axes = {}
    for row in table:
        try:
            axes[int(row[0])] = own_axes(row[1:].astype(float))
        except ValueError as error:
            found = f"found {error} at node {int(row[0])}, expected two unit vectors at right angles"
            raise ModelError("matrix-file", f"{path.name}: axes: {found}") from None
    return axes


def whole_numbers(table: Array, width: int, code: str, what: str, numbered: int = 2) -> Array:
    """A table of finite numbers, the first `numbered` columns being whole numbers."""
    if table.ndim != 2 or table.shape[1] != width:
        raise ModelError(code, f"{what}: found the shape {table.shape}, expected (n, {width})")
    if table.dtype.kind not in "iuf" or not np.isfinite(table).all() or np.any(table[:, :numbered] % 1):
        expected = f"expected finite numbers, and whole ones in the first {numbered} columns"
        raise ModelError(code, f"{what}: found other values (of type {table.dtype}), {expected}")
    return table


def fitting(what: str, given: Any, **options: Any) -> csc_array:
    """A compressed-column matrix, after a check of its row indices and column starts; scipy checks them later."""
    try:
        if isinstance(given, tuple) and any(part.dtype.kind not in "iu" for part in given[1:]):
            raise ValueError("found indices or indptr of real numbers, expected whole numbers")
        A = csc_array(given, **options)
        A.check_format(full_check=True)
        if np.any(A.indptr[1:] < A.indptr[:-1]):  # scipy asks their differences, which overflow
            raise ValueError("found an indptr that decreases, expected it to ascend")
    except (ValueError, TypeError) as error:
        raise ModelError("matrix-file", f"{what}: {error}") from None
    return A


def read_from_npz(path: Path) -> dict[str, Any]:
    """Arrays of an npz file: dense arrays unchanged, compressed columns assembled from their parts."""
    return put_together(path, dict(read_npz(path)))


def put_together(path: Path, stored: dict[str, Any]) -> dict[str, Any]:
    """Arrays with NAME_data, NAME_indices and NAME_indptr (and NAME_shape if not square) combined into one NAME."""
    for name in [key.removesuffix("_indptr") for key in stored if key.endswith("_indptr")]:
        parts = [stored.pop(f"{name}_{part}", None) for part in ("data", "indices", "indptr")]
        if any(part is None for part in parts):
            expected = f"expected {name}_data, {name}_indices and {name}_indptr"
            raise ModelError("matrix-file", f"{path.name}: {name}: found only a part of the arrays, {expected}")
        size = np.size(parts[2]) - 1
        shape = tuple(np.ravel(stored.pop(f"{name}_shape", (size, size))).tolist())
        stored[name] = fitting(f"{path.name}: {name}", tuple(parts), shape=shape)
    return stored


def read_from_mat(path: Path) -> dict[str, Any]:
    """MATLAB's variables, read in a child process, since scipy's reader crashes on some damaged files."""
    with open_file(regular_file(path)) as stream:
        head = stream.read(SIGNATURE.stop)
    return read_from_hdf5(path) if head[SIGNATURE] == b"\x89HDF" else of_child(path, ".mat", "mat_arrays")


def mat_arrays(path: Path) -> dict[str, Any]:
    """All variables by name, sparse ones in parts; for cells and structs, which contain no numbers, only the size."""
    found: dict[str, Any] = {}
    with warnings.catch_warnings():
        # scipy 1.18 warns where the kind of sparse array is not given, either does; 1.14 has no such argument
        warnings.filterwarnings("ignore", ".*spmatrix", DeprecationWarning)
        variables = loadmat(path)
    for name, value in variables.items():
        if issparse(value):
            found |= to_columns(name, value) | {f"{name}_shape": np.array(value.shape)}
        elif not name.startswith("__"):
            found[name] = np.zeros(value.shape, dtype="S1") if value.dtype.hasobject else value
    return found


def read_from_hdf5(path: Path) -> dict[str, Any]:
    """Data sets of an HDF5 file, and groups with MATLAB's sparse matrices, read in a child process."""
    try:
        import h5py  # noqa: F401
    except ImportError:
        raise ModelError("matrix-file", f"{path.name}: HDF5 needs h5py: {remedy('test-data')}") from None
    return of_child(regular_file(path), "HDF5", "hdf5_arrays")


def of_child(path: Path, form: str, reader: str) -> dict[str, Any]:
    """Arrays that a child process reads with one of these readers."""
    try:
        return put_together(path, dict(arrays_of(path, __name__, reader)))
    except UnreadableError as error:
        raise ModelError("matrix-file", f"{path.name}: found no readable {form} file ({error})") from None


def hdf5_arrays(path: Path) -> dict[str, Any]:
    """All arrays by name, sparse ones in parts."""
    import h5py

    found: dict[str, Any] = {}
    with h5py.File(path, "r") as file:
        for name, item in file.items():
            if isinstance(item, h5py.Dataset):
                value = np.asarray(item)
                value = np.zeros(value.shape, dtype="S1") if value.dtype.hasobject else value
                found[name] = value.T if value.ndim == 2 and "MATLAB_class" in item.attrs else value
            elif {"data", "ir", "jc"} <= set(item):
                found |= {f"{name}_{part}": np.asarray(item[key]) for part, key in PARTS.items()}
                size = found[f"{name}_indptr"].size - 1
                found[f"{name}_shape"] = np.array([int(item.attrs.get("MATLAB_sparse", size)), size])
    return found


def to_columns(name: str, A: Any) -> dict[str, Any]:
    """A matrix in compressed columns as the arrays of an npz."""
    return {f"{name}_data": A.data, f"{name}_indices": A.indices, f"{name}_indptr": A.indptr}
