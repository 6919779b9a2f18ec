"""Matrices of cells summed into a sparse one, and its rows and columns on the free dofs."""

import numpy as np
from scipy.sparse import coo_array, csc_array

from casingfem.io.arrays import Array, FloatArray, IntArray

CHUNK = 4_000_000  # entries of a strain table held at a time


def cell_dofs(cells: IntArray, dofs: int) -> IntArray:
    """Dofs of each cell, node by node, (cells, dofs * nodes)."""
    return np.asarray((cells[:, :, None] * dofs + np.arange(dofs)).reshape(len(cells), -1))


def scatter(matrices: Array, rows: IntArray, size: int) -> csc_array:
    """Sum cell matrices (cells, m, m) into a sparse one (size, size) at the dofs rows (cells, m), without zeros.

    So many cells at a time that their numbered entries fit into memory beside the sum; sums of like size are added.
    """
    small, m = rows.astype(np.int32), rows.shape[1]
    step = max(1, 2 * CHUNK // m**2)
    sums = [csc_array((size, size), dtype=matrices.dtype)]
    for start in range(0, len(rows), step):
        part = small[start : start + step]
        i, j = np.broadcast_arrays(part[:, :, None], part[:, None, :])
        entries = matrices[start : start + step].ravel()
        one = coo_array((entries, (i.ravel(), j.ravel())), shape=(size, size)).tocsc()
        one.eliminate_zeros()
        sums.append(one)
        while len(sums) > 1 and sums[-2].nnz < 2 * sums[-1].nnz:
            sums[-2:] = [csc_array(sums[-2] + sums[-1])]
    while len(sums) > 1:
        sums[-2:] = [csc_array(sums[-2] + sums[-1])]
    return sums[0]


def on_free(A: csc_array, free: IntArray) -> csc_array:
    """Rows and columns of the free dofs, without stored zeros, exactly symmetric."""
    return symmetric(csc_array(A[:, free][free]))


def symmetric(A: csc_array) -> csc_array:
    """The symmetric part of a matrix that is symmetric but for round-off, without stored zeros."""
    A = csc_array(0.5 * (A + A.T))
    A.eliminate_zeros()
    A.sort_indices()  # products of sparse matrices are not in order
    return A


def put(total: FloatArray, rows: IntArray, slots: IntArray, matrices: FloatArray, dofs: int) -> None:
    """Put matrices of cells that have some of the nodes, in their order, into those of all, (cells, m, m)."""
    if dofs * len(slots) == total.shape[1]:
        total[rows] = matrices
        return
    places = cell_dofs(slots[None], dofs)[0]
    total[rows[:, None, None], places[:, None], places] = matrices
