"""How alike mode shapes are: the modal assurance criterion, for vectors and for planes of doublets."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import qr

from casingfem.io.arrays import Array, FloatArray


def mac(A: ArrayLike, B: ArrayLike, M: Any = None) -> FloatArray:
    """Modal assurance criterion of every shape in A with every shape in B, in [0, 1].

    MAC_ij = |a_i^H M b_j|^2 / ((a_i^H M a_i) (b_j^H M b_j))   (Allemang and Brown, IMAC 1982)

    Parameters
    ----------
    A, B : (dofs, m1), (dofs, m2), or (dofs,) for one shape; may be complex
    M : (dofs, dofs) symmetric weight, dense or sparse; identity when None

    Returns
    -------
    (m1, m2)

    Raises
    ------
    ValueError
        Different numbers of dofs, values that are not finite, a shape that is zero.

    Examples
    --------
    >>> mac([[1.0, 0.0], [0.0, 1.0]], [1.0, 1.0]).round(3)
    array([[0.5],
           [0.5]])
    """
    a, b = _shapes(A, B)
    weighted = b if M is None else M @ b
    a_norm = np.einsum("di,di->i", a.conj(), a if M is None else M @ a).real
    b_norm = np.einsum("di,di->i", b.conj(), weighted).real
    if min(a_norm.min(initial=1.0), b_norm.min(initial=1.0)) <= 0.0:
        raise ValueError("mac: a shape has no norm; leave out modes that the sensors do not see")
    return np.asarray(np.minimum(np.abs(a.conj().T @ weighted) ** 2 / np.outer(a_norm, b_norm), 1.0))


def subspace_mac(A: ArrayLike, B: ArrayLike, M: Any = None) -> float:
    """Mean squared cosine between the spaces spanned by A and B: 1 when the smaller lies in the larger.

    trace(P_A P_B)/k, P the M-orthogonal projectors and k = min(m1, m2).  It does not change when the
    members of a doublet are rotated in their plane, where MAC may take any value; for one shape
    against a plane it is the largest MAC in that plane (S2MAC, D'Ambrogio and Fregolent, 2003).

    Raises
    ------
    ValueError
        As ``mac``; shapes that are linearly dependent.

    Examples
    --------
    >>> plane, turned = np.eye(3)[:, :2], np.array([[0.6, -0.8], [0.8, 0.6], [0.0, 0.0]])
    >>> round(subspace_mac(plane, turned), 12), mac(plane, turned).round(2).tolist()
    (1.0, [[0.36, 0.64], [0.64, 0.36]])
    """
    a, b = _shapes(A, B)
    P, Q = _orthonormal(a, M), _orthonormal(b, M)
    cross = P.conj().T @ (Q if M is None else M @ Q)
    return float(min(np.sum(np.abs(cross) ** 2) / min(a.shape[1], b.shape[1]), 1.0))


def _shapes(A: ArrayLike, B: ArrayLike) -> tuple[Array, Array]:
    """Return both as finite arrays (dofs, modes) of the same dofs."""
    arrays: list[Array] = []
    for values in (A, B):
        array = np.asarray(values)
        array = array[:, None] if array.ndim == 1 else array
        if array.ndim != 2 or not np.all(np.isfinite(array)):
            raise ValueError(f"shapes must be finite numbers (dofs, modes), not an array {array.shape}")
        arrays.append(array)
    if len(arrays[0]) != len(arrays[1]):
        raise ValueError(f"shapes to compare need the same dofs, not {len(arrays[0])} and {len(arrays[1])}")
    return arrays[0], arrays[1]


def _orthonormal(A: Array, M: Any) -> Array:
    """Return an M-orthonormal basis of the columns of A."""
    basis, triangle, _ = qr(A, mode="economic", pivoting=True)
    diagonal = np.abs(np.diag(triangle))
    if diagonal.size < A.shape[1] or diagonal[-1] <= 1e-12 * diagonal[0]:
        raise ValueError("subspace_mac: the shapes of a plane must be linearly independent")
    if M is None:
        return np.asarray(basis)
    factor = np.linalg.cholesky(basis.conj().T @ (M @ basis))
    return np.asarray(np.linalg.solve(factor, basis.conj().T).conj().T)
