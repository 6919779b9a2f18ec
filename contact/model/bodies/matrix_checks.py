"""Checks of a given matrix: finite, right size, symmetric or skew, and its precision."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np

from contact.base.arrays import Array
from contact.base.errors import InputError

DIRECTIONS = ("q", "x", "y", "z", "rx", "ry", "rz")  # q: a scalar, such as the amplitude of a mode
NUMBERED: dict[str | int, str] = dict(enumerate(DIRECTIONS))
EYE = np.eye(3)
OPTIONAL = ("C", "K4", "G")
SQUARE = 1e-3  # of axes: three digits
MINOR = 1e-6  # of minors and diagonals: matrices of single precision have seven digits
DOUBLE, SINGLE = 2.0**-53, 2.0**-24  # largest relative error of a rounded number
DIGITS = range(7, 11)  # significant decimal digits of a text file by which its numbers may be rounded
WHOLE = 1e-4  # of the last digit: what a decimal number in double precision is off a whole number
SKEW = 1e-4  # asymmetry of a matrix, of the entries in its rows, beyond which it is refused

Dof: TypeAlias = tuple[int, str | int]


def checked_axes(node: int, own: Any) -> Array:
    """Check the axes of a node, which must be at right angles."""
    axes = np.asarray(own, dtype=float)
    if axes.shape != (3, 3) or not np.abs(axes @ axes.T - EYE).max() <= SQUARE or np.linalg.det(axes) < 0.0:
        raise InputError(f"axes: found {axes.tolist()} at node {node}, expected three unit vectors at right angles")
    return axes


def check_minors(M: Any, dofs: Sequence[tuple[int, str]]) -> None:
    """Refuse an impossible mass matrix: M_ii < 0, or |M_ij| above sqrt(M_ii M_jj), by a millionth of the mean."""
    from scipy.sparse import coo_array

    diagonal = M.diagonal()
    if not diagonal.any():
        return
    floor = MINOR * float(np.abs(diagonal).mean())
    expected = "expected a mass matrix without negative eigenvalues"
    worst = int(diagonal.argmin())
    if diagonal[worst] < -floor:
        node, direction = dofs[worst]
        raise InputError(f"M: found {diagonal[worst]:.3g} on the diagonal at {node}.{direction}, {expected}")
    entries = coo_array(M)
    rows, columns = entries.coords
    root = np.sqrt(np.maximum(diagonal, 0.0))
    beyond = np.abs(entries.data) - (1.0 + MINOR) * root[rows] * root[columns] - floor
    if beyond.size and beyond.max() > 0.0:
        k = int(beyond.argmax())
        (one, axis), (other, other_axis) = dofs[int(rows[k])], dofs[int(columns[k])]
        found = f"found {entries.data[k]:.3g} between {one}.{axis} and {other}.{other_axis}"
        raise InputError(f"M: {found}, more than the diagonal entries allow, {expected}")


def checked_dof(dof: Dof) -> tuple[int, str]:
    """A dof as (node, direction); directions by name or as 1 to 6, 0 for a scalar."""
    node, direction = dof
    name = NUMBERED.get(direction, str(direction))
    if name not in DIRECTIONS:
        raise InputError(f"dofs: found direction {direction!r} at node {node}, expected {', '.join(DIRECTIONS)}")
    return int(node), name


def checked(name: str, A: Any, size: int) -> Any:
    """Check a sparse matrix: finite numbers, a row for each dof; only an optional matrix may be zero."""
    from scipy.sparse import csc_array

    given = csc_array(A)
    if given.dtype.kind == "c":
        raise InputError(f"{name}: found complex numbers, expected real ones")
    sparse = csc_array(given, dtype=float)
    if sparse.shape != (size, size):
        raise InputError(f"{name}: found shape {sparse.shape}, expected ({size}, {size}), a row for each dof")
    if not np.isfinite(sparse.data).all():
        raise InputError(f"{name}: found entries that are NaN or infinite, expected finite numbers")
    if not sparse.count_nonzero() and name not in OPTIONAL:
        raise InputError(f"{name}: found only zeros, expected other entries")
    return sparse


def rounding_of(values: Any) -> float:
    """Largest relative error of numbers, by the precision of storage, which is detected from the numbers.

    2^-24 if all are exact in single precision, 0.5 10^(1 - d) if all have d significant digits, 2^-53 otherwise.

    >>> third = np.array([1.0, 2.0]) / 3.0
    >>> rounding_of(third) == 2.0**-53, rounding_of(third.astype(np.float32)) == 2.0**-24
    (True, True)
    >>> f"{rounding_of(np.array([3.3333333e9, -6.6666667e-3])):.0e}"
    '5e-08'
    """
    given = np.asarray(values)
    numbers = np.abs(given[given != 0.0].astype(float))
    with np.errstate(over="ignore", under="ignore"):
        if given.dtype == np.float32 or np.array_equal(numbers.astype(np.float32).astype(float), numbers):
            return SINGLE
    mantissas = numbers / 10.0 ** np.floor(np.log10(numbers))
    for digits in DIGITS:
        scaled = mantissas * 10.0 ** (digits - 1)
        if np.abs(scaled - np.rint(scaled)).max(initial=0.0) <= WHOLE:
            return float(0.5 * 10.0 ** (1 - digits))
    return DOUBLE


def symmetric_part(name: str, A: Any, size: int) -> tuple[Any, float]:
    """A sparse matrix made symmetric, and the removed asymmetry relative to the entries in the same rows."""
    from scipy.sparse import csc_array

    sparse = checked(name, A, size)
    skew = asymmetry(sparse)
    if skew > SKEW:
        advice = "write both triangles"
        if name in ("K", "C"):
            advice += "; for cross-coupled bearings pass nonsymmetric (--nonsymmetric)"
        found = f"asymmetry of {skew:.2e} of its entries"
        raise InputError(f"{name}: found {found}, expected a symmetric matrix: {advice}")
    return csc_array(0.5 * (sparse + sparse.T)), skew


def skew_part(G: Any, size: int) -> Any:
    """A sparse gyroscopic matrix made skew by removing its symmetric part, which must be round-off."""
    from scipy.sparse import coo_array, csc_array

    sparse = checked("G", G, size)
    even = coo_array(sparse + sparse.T)
    largest = float(np.abs(even.data).max(initial=0.0))
    if largest > SKEW * float(np.abs(sparse.data).max(initial=0.0)):
        k = int(np.abs(even.data).argmax())
        row, column = int(even.coords[0][k]), int(even.coords[1][k])
        found = f"{sparse[row, column]:.6g} at ({row}, {column}) and {sparse[column, row]:.6g} at ({column}, {row})"
        raise InputError(
            f"G: found {found}, expected a skew-symmetric matrix, G[i, j] = -G[j, i], per rad/s of the speed"
        )
    return csc_array(0.5 * (sparse - sparse.T))


def asymmetry(A: Any) -> float:
    """The largest |A_ij - A_ji| over the mean sqrt(a_i a_j) of the largest entries a of both rows.

    The largest entry of the whole matrix is no scale: beside a support's penalty of 1e20, a missing half would be
    negligible. Rows with round-off only, such as in the stiffness of a free Craig-Bampton set, are compared with the
    median of the rows.

    >>> asymmetry(np.array([[1e20, 0.0, 0.0], [0.0, 2.0, -1.0], [0.0, 0.0, 2.0]]))
    0.5
    """
    from scipy.sparse import coo_array

    entries, odd = coo_array(A), coo_array(A - A.T)
    largest = np.zeros(A.shape[0])
    for places in entries.coords:
        np.maximum.at(largest, places, np.abs(entries.data))
    if not largest.any():
        return 0.0
    largest = np.maximum(largest, np.median(largest[largest > 0.0]))
    rows, columns = odd.coords
    return float((np.abs(odd.data) / np.sqrt(largest[rows] * largest[columns])).max(initial=0.0))
