"""Matrices as named arrays: npz, MATLAB's .mat (old ones by scipy, version 7.3 by h5py), HDF5.

K, M and maybe C, dense, or sparse as MATLAB keeps it, or in an npz as NAME_data, NAME_indices, NAME_indptr of
compressed columns; `dofs` (n, 2) and `nodes` (k, 4: number, x, y, z) if they are there.
"""

from pathlib import Path
from typing import Any

import numpy as np
from scipy.io import loadmat
from scipy.sparse import csc_array, issparse

from casingfem.errors import ModelError
from casingfem.extras import remedy
from casingfem.io.arrays import IntArray
from casingfem.io.npz import read_npz
from casingfem.io.probe import fault_of
from casingfem.structure.imported.matrix.matrix_set import MatrixSet, roles_of

TABLES = ("dofs", "nodes")


def read_arrays(path: Path, dofs: IntArray | None) -> MatrixSet:
    """K, M and C of a file of arrays, told apart by their names.

    Raises
    ------
    ModelError
        `matrix-file` for a file that cannot be read, `matrix-dofs` without dofs, `matrix-names` without K or M.
    """
    read = {".npz": read_from_npz, ".mat": read_from_mat}.get(path.suffix.lower(), read_from_hdf5)
    found = read(path)
    tables = {name: np.asarray(found.pop(name)) for name in TABLES if name in found}
    square = {name: A for name, A in found.items() if getattr(A, "ndim", 0) == 2 and A.shape[0] == A.shape[1]}
    roles = roles_of(list(square), path.name)
    if dofs is None:
        if "dofs" not in tables:
            raise ModelError("matrix-dofs", f"{path.name}: found no array dofs")
        dofs = tables["dofs"].astype(np.int64)
    if dofs.ndim != 2 or dofs.shape[1] != 2:
        raise ModelError("matrix-dofs", f"{path.name}: dofs have shape {dofs.shape}, expected (n, 2)")
    nodes = tables.get("nodes", np.zeros((0, 4)))
    if nodes.ndim != 2 or nodes.shape[1] != 4:
        raise ModelError("matrix-file", f"{path.name}: nodes have shape {nodes.shape}, expected (k, 4)")
    matrices = {role: csc_array(square[name], dtype=float) for role, name in roles.items()}
    points = {int(row[0]): row[1:] for row in nodes}
    return MatrixSet(K=matrices["K"], M=matrices["M"], C=matrices.get("C"), dofs=dofs, points=points, source=path.name)


def read_from_npz(path: Path) -> dict[str, Any]:
    """Dense arrays as they are; parts of compressed columns put together."""
    stored: dict[str, Any] = dict(read_npz(path))
    for name in [key.removesuffix("_indptr") for key in stored if key.endswith("_indptr")]:
        parts = [stored.pop(f"{name}_{part}", None) for part in ("data", "indices", "indptr")]
        if any(part is None for part in parts):
            raise ModelError("matrix-file", f"{path.name}: {name}: expected {name}_data, {name}_indices, {name}_indptr")
        size = len(parts[2]) - 1
        stored[name] = csc_array(tuple(parts), shape=(size, size))
    return stored


def read_from_mat(path: Path) -> dict[str, Any]:
    """MATLAB's variables; a process of its own reads them first, as scipy's reader ends with some damaged files."""
    if path.is_file() and (fault := fault_of(path, "scipy.io", "loadmat")):
        raise ModelError("matrix-file", f"{path.name}: no readable .mat file: {fault}")
    try:
        stored = loadmat(path)
    except NotImplementedError:  # version 7.3 is HDF5
        return read_from_hdf5(path)
    except FileNotFoundError:
        raise
    except Exception as error:  # whatever it trips over is a malformed file
        raise ModelError("matrix-file", f"{path.name}: no readable .mat file ({error})") from None
    return {name: value for name, value in stored.items() if not name.startswith("__")}


def read_from_hdf5(path: Path) -> dict[str, Any]:
    """Data sets of an HDF5 file, and groups that MATLAB keeps sparse matrices in (data, ir, jc)."""
    try:
        import h5py
    except ImportError:
        raise ModelError("matrix-file", f"{path.name}: HDF5 needs h5py: {remedy('test-data')}") from None
    found: dict[str, Any] = {}
    try:
        with h5py.File(path, "r") as file:
            for name, item in file.items():
                if isinstance(item, h5py.Dataset):
                    value = np.asarray(item)
                    found[name] = value.T if value.ndim == 2 and "MATLAB_class" in item.attrs else value
                elif {"data", "ir", "jc"} <= set(item):
                    parts = tuple(np.asarray(item[part]) for part in ("data", "ir", "jc"))
                    size = len(parts[2]) - 1
                    found[name] = csc_array(parts, shape=(int(item.attrs.get("MATLAB_sparse", size)), size))
    except OSError as error:
        if isinstance(error, FileNotFoundError):
            raise
        raise ModelError("matrix-file", f"{path.name}: no readable HDF5 file ({error})") from None
    return found


def to_columns(name: str, A: Any) -> dict[str, Any]:
    """A sparse matrix as the arrays of an npz."""
    sparse = csc_array(A) if not issparse(A) else A
    return {f"{name}_data": sparse.data, f"{name}_indices": sparse.indices, f"{name}_indptr": sparse.indptr}
