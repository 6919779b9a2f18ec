"""Assurance criteria of mode shapes: for vectors, for planes of doublets, and channel by channel."""

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
        raise ValueError("mac: found a shape that is zero at all sensors, expected others: remove this mode")
    return np.asarray(np.minimum(np.abs(a.conj().T @ weighted) ** 2 / np.outer(a_norm, b_norm), 1.0))


def subspace_mac(A: ArrayLike, B: ArrayLike, M: Any = None) -> float:
    """Mean squared cosine between the spaces spanned by A and B: 1 if the smaller lies in the larger.

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
    """An M-orthonormal basis of the columns of A."""
    basis, triangle, _ = qr(A, mode="economic", pivoting=True)
    diagonal = np.abs(np.diag(triangle))
    if diagonal.size < A.shape[1] or diagonal[-1] <= 1e-12 * diagonal[0]:
        raise ValueError("subspace_mac: the shapes of a plane must be linearly independent")
    if M is None:
        return np.asarray(basis)
    factor = np.linalg.cholesky(basis.conj().T @ (M @ basis))
    return np.asarray(np.linalg.solve(factor, basis.conj().T).conj().T)


def nearest_in_plane(measured: ArrayLike, plane: ArrayLike) -> FloatArray:
    """Least-squares approximation of measured shapes (channels, m) by computed ones (channels, k).

    As the computed partner of a measured shape, it ignores a rotation within a doublet. For a single mode it is the
    scaled mode.

    >>> nearest_in_plane([[1.0], [1.0], [0.5]], [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]]).ravel().tolist()
    [1.0, 1.0, 0.0]
    """
    shapes, basis = np.asarray(measured, float), np.asarray(plane, float)
    return np.asarray(basis @ np.linalg.lstsq(basis, shapes, rcond=None)[0])


def comac(measured: ArrayLike, computed: ArrayLike) -> FloatArray:
    """Coordinate modal assurance criterion (COMAC): agreement of paired shapes at each channel.

    COMAC_c = (sum_k |a_ck b_ck|)^2/(sum_k a_ck^2 sum_k b_ck^2)   (Lieven and Ewins, IMAC 1988)

    Low values can mean a small amplitude as well as an error: compare them with `ecomac`.

    Parameters
    ----------
    measured, computed
        Real shapes in columns, (channels, shapes) each; column k of one is paired with column k of the other.

    Returns
    -------
    FloatArray
        Values from 0 to 1, (channels,); nan for a channel without motion on one side.

    Raises
    ------
    ValueError
        The arrays differ in size, or a shape is zero at every channel.

    Examples
    --------
    >>> comac([[1.0, 2.0], [1.0, -1.0]], [[1.0, 2.0], [1.0, 3.0]]).round(3).tolist()
    [1.0, 0.8]
    """
    a, b = paired(measured, computed)
    below = np.sum(a**2, axis=1) * np.sum(b**2, axis=1)
    return np.asarray(np.sum(np.abs(a * b), axis=1) ** 2 / np.where(below > 0.0, below, np.nan))


def ecomac(measured: ArrayLike, computed: ArrayLike) -> FloatArray:
    """Enhanced COMAC: mean difference of paired shapes at each channel, 0 if they agree.

    ECOMAC_c = sum_k |a_ck - b_ck|/(2 m)   (Hunt, IMAC 1992)

    The m pairs of shapes are first scaled to unit length and given matching signs. A sensor with the wrong sign shows
    here, but not in COMAC.

    Parameters
    ----------
    measured, computed
        Real shapes in columns, (channels, shapes) each; column k of one is paired with column k of the other.

    Returns
    -------
    FloatArray
        Values from 0 to 1, (channels,).

    Raises
    ------
    ValueError
        The arrays differ in size, or a shape is zero at every channel.

    Examples
    --------
    >>> ecomac([[1.0], [1.0]], [[1.0], [-1.0]]).round(3).tolist()
    [0.0, 0.707]
    """
    a, b = paired(measured, computed)
    a, b = (x / np.linalg.norm(x, axis=0) for x in (a, b))
    signs = np.where(np.sum(a * b, axis=0) < 0.0, -1.0, 1.0)
    return np.asarray(np.abs(a - signs * b).mean(axis=1) / 2.0)


def paired(measured: ArrayLike, computed: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Both as (channels, m) of equal size.

    Raises
    ------
    ValueError
        The shapes are not paired, or one is zero.
    """
    a, b = np.asarray(measured, float), np.asarray(computed, float)
    if a.ndim != 2 or a.shape != b.shape or not a.size:
        raise ValueError(f"paired shapes need equal sizes (channels, modes), not {a.shape} and {b.shape}")
    if not (np.all(np.any(a, axis=0)) and np.all(np.any(b, axis=0))):
        raise ValueError("paired shapes: one is zero at every channel")
    return a, b
