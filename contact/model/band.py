"""Symmetric banded matrices as plain arrays: what the compiled loops multiply and solve with.

A is kept by row sums and off-diagonals, (A u)_i = ground_i u_i + sum_j A_ij (u_j - u_i): a rigid translation
then strains nothing, whatever its size. Factors are L D L^T (banded Cholesky); a lumped matrix has no band.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from contact.errors import InputError
from contact.model.arrays import Array, Indices

ROUND_OFF = 8.0 * np.finfo(float).eps  # of a row's absolute sum: a smaller row sum is zero


class Band(NamedTuple):
    """Row sums (N,) and off[d - 1, i] = A[i, i + d], d = 1 .. b, shape (b, N); `grounded`: some row sum is not 0."""

    ground: Array
    off: Array
    grounded: bool = True


class Factor(NamedTuple):
    """A = L D L^T: 1/D (N,) and low[i, d - 1] = L[i + d, i], shape (N, b)."""

    inverse: Array
    low: Array


def band(A: Any, order: Indices) -> Band:
    """Pack a symmetric sparse or dense matrix, rows and columns taken in `order`.

    >>> band(np.array([[2.0, -1.0], [-1.0, 1.0]]), np.arange(2)).ground.tolist()
    [1.0, 0.0]
    """
    n = order.size
    place = np.empty(n, dtype=np.int64)
    place[order] = np.arange(n)
    rows, columns, values = _entries(A)
    rows, columns = place[rows], place[columns]
    width = int(np.max(np.abs(rows - columns), initial=0))
    off = np.zeros((width, n))
    upper = columns > rows
    np.add.at(off, (columns[upper] - rows[upper] - 1, rows[upper]), values[upper])
    ground, size = np.zeros(n), np.zeros(n)
    np.add.at(ground, rows, values)
    np.add.at(size, rows, np.abs(values))
    ground[np.abs(ground) <= ROUND_OFF * size] = 0.0
    return Band(ground, off, bool(ground.any()))


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
    off = np.zeros((max(part.off.shape[0] for _, part in terms), n))
    ground = np.zeros(n)
    for scale, part in terms:
        if scale:
            ground += scale * part.ground
            off[: part.off.shape[0]] += scale * part.off
    return Band(ground, off[: _width(off)], bool(ground.any()))


def _width(off: Array) -> int:
    used = np.nonzero(off.any(axis=1))[0]
    return int(used[-1]) + 1 if used.size else 0


def diagonal(A: Band) -> Array:
    """Diagonal entries, ground - sum of the off-diagonals of the row."""
    total = A.ground.copy()
    n = total.size
    for d in range(1, A.off.shape[0] + 1):
        total[: n - d] -= A.off[d - 1, : n - d]
        total[d:] -= A.off[d - 1, : n - d]
    return total


def lower_form(A: Band) -> Array:
    """SciPy's lower banded storage, (b + 1, N)."""
    return np.concatenate([diagonal(A)[None], A.off])


def factor(A: Band, name: str) -> Factor:
    """L D L^T of a positive definite band; raises InputError when it is not one.

    >>> factor(Band(np.array([2.0, 4.0]), np.zeros((0, 2))), "M").inverse.tolist()
    [0.5, 0.25]
    """
    if not np.all(diagonal(A) > 0.0):
        raise InputError(f"{name}: found a diagonal entry <= 0 in row {int(np.argmin(diagonal(A))) + 1}, expected > 0")
    if A.off.shape[0] == 0:
        return Factor(1.0 / A.ground, np.zeros((A.ground.size, 0)))
    from scipy.linalg import LinAlgError, cholesky_banded

    try:
        root = cholesky_banded(lower_form(A), lower=True)
    except LinAlgError as error:
        raise InputError(f"{name}: found a matrix that is not positive definite ({error})") from error
    return Factor(1.0 / root[0] ** 2, np.ascontiguousarray((root[1:] / root[0]).T))


def solve(A: Factor, right: Array) -> Array:
    """A^-1 right for columns (N, k): set-up only, the loops have their own compiled solve."""
    from scipy.linalg import solve_banded

    n, width = A.low.shape
    unit = np.concatenate([np.ones((1, n)), A.low.T])
    half = solve_banded((width, 0), unit, right)
    transposed = np.zeros((width + 1, n))
    for d in range(width + 1):
        transposed[width - d, d:] = unit[d, : n - d]
    return np.asarray(solve_banded((0, width), transposed, half * A.inverse[:, None]))
