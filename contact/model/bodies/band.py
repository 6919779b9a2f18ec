"""Symmetric matrices as plain arrays for the products and solves of compiled loops.

A is stored by row sums and off-diagonals, (A u)_i = ground_i u_i + sum_j A_ij (u_j - u_i), so that a rigid translation
causes no strain, whatever its size. A narrow band is stored by diagonals, a wide one by lists of entries (`Entries`).
Factors are L D L^T, by banded Cholesky or by SuperLU in the given order with pivots on the diagonal; a lumped matrix
has neither.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from contact.base.arrays import Array, Indices
from contact.base.errors import InputError

ROUND_OFF = 8.0 * np.finfo(float).eps  # of a row's absolute sum: a smaller row sum is zero


class Entries(NamedTuple):
    """Entries right of the diagonal: columns and values of row i are start[i] .. start[i + 1] - 1; an empty `start`.

    None.
    """

    start: Indices
    column: Indices
    value: Array


NO_ENTRIES = Entries(np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64), np.zeros(0))


class Band(NamedTuple):
    """Row sums (N,) and off[d - 1, i] = A[i, i + d], d = 1 .. b, shape (b, N); `grounded`: some row sum is not 0."""

    ground: Array
    off: Array
    grounded: bool = True
    sparse: Entries = NO_ENTRIES

    @property
    def lumped(self) -> bool:
        """Whether all off-diagonal entries are zero."""
        return self.off.shape[0] == 0 and self.sparse.value.size == 0


class Factor(NamedTuple):
    """A = L D L^T: 1/D (N,) and low[i, d - 1] = L[i + d, i], shape (N, b), or the entries of L^T."""

    inverse: Array
    low: Array
    sparse: Entries = NO_ENTRIES


def band(A: Any, order: Indices, *, wide: bool = False) -> Band:
    """Pack a symmetric sparse or dense matrix, with rows and columns in `order`; `wide`: by entries.

    >>> band(np.array([[2.0, -1.0], [-1.0, 1.0]]), np.arange(2)).ground.tolist()
    [1.0, 0.0]
    """
    n, place = order.size, np.argsort(order)
    rows, columns, values = _entries(A)
    rows, columns = place[rows], place[columns]
    upper = columns > rows
    off, sparse = _stored(n, rows[upper], columns[upper], values[upper], wide)
    ground, size = np.zeros(n), np.zeros(n)
    np.add.at(ground, rows, values)
    np.add.at(size, rows, np.abs(values))
    ground[np.abs(ground) <= ROUND_OFF * size] = 0.0
    return Band(ground, off, bool(ground.any()), sparse)


def lumped(entries: Array) -> Band:
    """A diagonal matrix.

    >>> lumped(np.array([2.0])).lumped
    True
    """
    return Band(entries, np.zeros((0, entries.size)), bool(entries.any()))


def _stored(n: int, rows: Indices, columns: Indices, values: Array, wide: bool) -> tuple[Array, Entries]:
    """The entries right of the diagonal as diagonals, or as lists."""
    if wide:
        from scipy.sparse import coo_array

        packed = coo_array((values, (rows, columns)), shape=(n, n)).tocsr()
        packed.eliminate_zeros()
        start, column = packed.indptr.astype(np.int64), packed.indices.astype(np.int64)
        return np.zeros((0, n)), Entries(start, column, packed.data) if packed.nnz else NO_ENTRIES
    off = np.zeros((int(np.max(columns - rows, initial=0)), n))
    np.add.at(off, (columns - rows - 1, rows), values)
    return off, NO_ENTRIES


def pairs(A: Band) -> tuple[Indices, Indices, Array]:
    """Row, column > row and value of every entry right of the diagonal.

    >>> [x.tolist() for x in pairs(band(np.array([[2.0, -1.0], [-1.0, 1.0]]), np.arange(2)))]
    [[0], [1], [-1.0]]
    """
    if A.sparse.start.size:
        rows = np.repeat(np.arange(A.ground.size), np.diff(A.sparse.start))
        return rows, A.sparse.column, A.sparse.value
    diagonals, rows = np.nonzero(A.off)
    return rows, rows + diagonals + 1, A.off[diagonals, rows]


def _entries(A: Any) -> tuple[Indices, Indices, Array]:
    if hasattr(A, "tocoo"):
        entries = A.tocoo()
        return entries.row.astype(np.int64), entries.col.astype(np.int64), entries.data
    rows, columns = np.nonzero(A)
    return rows, columns, A[rows, columns]


def combine(*terms: tuple[float, Band]) -> Band:
    """Sum of scaled bands.

    >>> unit = Band(np.ones(2), np.zeros((0, 2)))
    >>> combine((2.0, unit), (1.0, unit)).ground.tolist()
    [3.0, 3.0]
    """
    n = terms[0][1].ground.size
    ground = np.zeros(n)
    for scale, part in terms:
        ground += scale * part.ground
    if any(part.sparse.start.size for _, part in terms):
        lists = [(*pairs(part)[:2], scale * pairs(part)[2]) for scale, part in terms if scale]
        rows, columns, values = (np.concatenate(parts) for parts in zip(*lists, strict=True))
        off, sparse = _stored(n, rows, columns, values, wide=True)
        return Band(ground, off, bool(ground.any()), sparse)
    off = np.zeros((max(part.off.shape[0] for _, part in terms), n))
    for scale, part in terms:
        if scale:
            off[: part.off.shape[0]] += scale * part.off
    return Band(ground, off[: _width(off)], bool(ground.any()))


def _width(off: Array) -> int:
    used = np.nonzero(off.any(axis=1))[0]
    return int(used[-1]) + 1 if used.size else 0


def diagonal(A: Band) -> Array:
    """Diagonal entries, ground - sum of the off-diagonals of the row."""
    total = A.ground.copy()
    rows, columns, values = pairs(A)
    np.subtract.at(total, rows, values)
    np.subtract.at(total, columns, values)
    return total


def sparse_form(A: Band) -> Any:
    """SciPy sparse array of the whole matrix."""
    from scipy.sparse import coo_array, diags_array

    n = A.ground.size
    rows, columns, values = pairs(A)
    upper = coo_array((values, (rows, columns)), shape=(n, n))
    return (upper + upper.T + diags_array(diagonal(A))).tocsc()


def lower_form(A: Band) -> Array:
    """SciPy's lower banded storage, (b + 1, N)."""
    return np.concatenate([diagonal(A)[None], A.off])


def factor(A: Band, name: str) -> Factor:
    """L D L^T factors of a positive definite band; raises InputError if it is not positive definite.

    >>> factor(Band(np.array([2.0, 4.0]), np.zeros((0, 2))), "M").inverse.tolist()
    [0.5, 0.25]
    """
    if not np.all(diagonal(A) > 0.0):
        raise InputError(f"{name}: found {diagonal(A).min():g} on the diagonal, expected entries > 0")
    if A.lumped:
        return Factor(1.0 / A.ground, np.zeros((A.ground.size, 0)))
    if A.sparse.start.size:
        return _sparse_factor(A, name)
    from scipy.linalg import LinAlgError, cholesky_banded

    try:
        root = cholesky_banded(lower_form(A), lower=True)
    except LinAlgError as error:
        raise InputError(f"{name}: found a matrix that is not positive definite ({error})") from error
    return Factor(1.0 / root[0] ** 2, np.ascontiguousarray((root[1:] / root[0]).T))


def _sparse_factor(A: Band, name: str) -> Factor:
    """L D L^T in the order of A, which `fill_order` has chosen for a sparse factor."""
    from scipy.sparse import tril
    from scipy.sparse.linalg import splu

    n = A.ground.size
    try:
        lu = splu(sparse_form(A), permc_spec="NATURAL", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except RuntimeError as error:  # SuperLU's, of a pivot that is zero
        raise InputError(f"{name}: found a matrix that is not positive definite ({error})") from error
    if not (np.array_equal(lu.perm_r, np.arange(n)) and np.array_equal(lu.perm_c, np.arange(n))):
        raise InputError(f"{name}: found pivots away from the diagonal, expected a positive definite matrix")
    pivots = lu.U.diagonal()
    if not np.all(pivots > 0.0):
        raise InputError(f"{name}: found a matrix that is not positive definite, pivot {pivots.min():g}")
    below = tril(lu.L, k=-1, format="csc")  # its columns are the rows of L^T
    entries = Entries(below.indptr.astype(np.int64), below.indices.astype(np.int64), below.data)
    return Factor(1.0 / pivots, np.zeros((n, 0)), entries)


def fill_order(A: Any) -> Indices:
    """Order of rows and columns with a sparse factor of this pattern: minimum degree, postordered."""
    from scipy.sparse import csc_array, eye_array
    from scipy.sparse.linalg import splu

    pattern = csc_array(A)
    pattern.data = np.ones_like(pattern.data)
    heavy = csc_array(pattern + 2.0 * pattern.shape[0] * eye_array(pattern.shape[0]))
    lu = splu(heavy, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    return np.argsort(lu.perm_c).astype(np.int64)


def solve(A: Factor, right: Array) -> Array:
    """A^-1 right for columns (N, k); only for set-up, since loops have their own compiled solve."""
    from scipy.linalg import solve_banded

    if A.sparse.start.size:
        from scipy.sparse import csr_array, eye_array
        from scipy.sparse.linalg import spsolve_triangular

        size = A.inverse.size
        column, start = A.sparse.column.astype(np.intc), A.sparse.start.astype(np.intc)  # what scipy 1.14 solves with
        half = csr_array((A.sparse.value, column, start), shape=(size, size)) + eye_array(size)
        below = spsolve_triangular(csr_array(half.T), right, lower=True, unit_diagonal=True)
        return np.asarray(spsolve_triangular(half.tocsr(), below * A.inverse[:, None], lower=False, unit_diagonal=True))
    n, width = A.low.shape
    if n == 1 or not width:  # scipy 1.14 has no banded solution of one unknown
        return np.asarray(right * A.inverse[:, None])
    unit = np.concatenate([np.ones((1, n)), A.low.T])
    half = solve_banded((width, 0), unit, right)
    transposed = np.zeros((width + 1, n))
    for d in range(width + 1):
        transposed[width - d, d:] = unit[d, : n - d]
    return np.asarray(solve_banded((0, width), transposed, half * A.inverse[:, None]))
