"""Free motion of coupled modes over many steps: one complex number for each pole, and the works over a skip.

Without force x = (q, D) -> M x, M = [1 - beta, alpha; -beta, alpha] (`coupled`). With M = V Lambda V^-1 each conjugate
pair of eigenvalues has one coordinate z, and z -> lambda^k z over k steps. Pair k moves wave n of the gap by at most
|z_k| (|a + i b| + |a - i b|)/2 at any angle, a and b the complex amplitudes of cos n phi and sin n phi for z = 1: the
major axis of an ellipse. The sum over all waves and pairs bounds the gap, since |lambda| <= 1.

The discrete energy E changes in a step by the work of damping and by that of the scheme, -s^T P_0 D_n/2 = x^T B x. The
latter is the change of x^T F x with M^T F M - F = B (Stein), so that E - F is the change due to damping.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from contact.base.arrays import Array, aligned, readonly
from contact.scheme.modal.blocks import BLOCK, matrix_blocks, row_blocks, whole
from contact.scheme.modal.propagator import Propagator

if TYPE_CHECKING:
    from contact.loop.modal.rows import RowBlocks
    from contact.loop.rub.free_flight import Pairs

WELL = 1e6  # condition of the eigenvectors, in the Frobenius norm, up to which a skip is exact to round-off
CLOSE = 1e-12  # of 1: product of two eigenvalues whose quadratic form does not change
BITS = 24  # a skip is shorter than 2^BITS steps
Complex = NDArray[np.complex128]


def no_pairs() -> Pairs:
    """Pairs of a run without coupled modes, or without skips."""
    from contact.loop.modal.rows import RowBlocks
    from contact.loop.rub.free_flight import Pairs

    none = RowBlocks(*row_blocks(np.zeros((0, BLOCK, BLOCK))))
    return Pairs(none, none, np.zeros(0), none, none, np.zeros((0, 0)))


def pairs_of(parts: Propagator, cos: Array, sin: Array) -> tuple[Array, Pairs]:
    """Powers of the free motion for `FreeFlight`, and its coordinates.

    `cos` and `sin` (m, waves) are the rows of the modes at the gap. Both are empty if a pole is real or grows, if the
    stiffness has a skew part, or if the eigenvectors are nearly dependent.
    """
    from contact.loop.rub.free_flight import Pairs

    m, part = parts.al.size, parts.coupled
    assert part is not None
    own = np.ix_(part.modes, part.modes)
    alpha, beta, false = np.diag(parts.al), np.diag(parts.be), np.zeros((m, m))
    inertia, stiff = np.diag(np.divide(1.0, parts.c, out=np.zeros(m), where=parts.c > 0.0)), np.diag(parts.omega**2)
    alpha[own], beta[own], false[own], inertia[own], stiff[own] = (
        part.alpha, part.beta, part.false, part.inertia, part.stiff
    )  # fmt: skip
    M = np.block([[np.eye(m) - beta, alpha], [-beta, alpha]])
    values, vectors = np.linalg.eig(M)
    turning, growing = values.imag != 0.0, np.abs(values) > 1.0 + CLOSE
    if part.odd.any() or growing.any() or not turning.all() or np.linalg.cond(vectors, "fro") > WELL:
        return readonly(np.zeros((0, 4, m))), no_pairs()
    upper = values.imag > 0.0
    V = vectors[:, upper]
    back = np.hstack([V.real, -V.imag])
    a, b = cos.T @ V[:m], sin.T @ V[:m]
    energy, made = np.zeros((2, 2 * m, 2 * m))
    energy[m:, m:], energy[:m, :m], energy[m:, :m] = 0.5 * inertia, 0.5 * stiff, -0.5 * stiff
    if false.any():
        total = np.hstack([-beta, np.eye(m) + alpha])  # D_n + D_(n+1)
        work = np.hstack([np.zeros((2 * m, m)), -0.5 * total.T @ false])
        made = _stein(values, vectors, 0.5 * (work + work.T))
    return _powers(values[upper]), Pairs(
        into=_blocks(np.linalg.inv(back)), back=_blocks(back),
        most=readonly(0.5 * (np.abs(a + 1j * b) + np.abs(a - 1j * b)).sum(axis=0)),
        damping=_triangle(energy - made), false=_triangle(made), room=aligned(3, 2 * whole(m)),
    )  # fmt: skip


def _blocks(square: Array) -> RowBlocks:
    """A matrix on (q, D) or (x, y) as rows by blocks of eight."""
    from contact.loop.modal.rows import RowBlocks

    m = len(square) // 2
    w = whole(m)
    own = np.concatenate([np.arange(m), w + np.arange(m)])
    padded = np.zeros((2 * w, 2 * w))
    padded[np.ix_(own, own)] = square
    found = RowBlocks(*matrix_blocks(padded[None])[0])
    for array in found:
        array.setflags(write=False)
    return found


def _triangle(form: Array) -> RowBlocks:
    """Upper triangle with the same quadratic form."""
    return _blocks(np.triu(form) + np.tril(form, -1).T)


def _stein(values: Complex, vectors: Complex, B: Array) -> Array:
    """F with M^T F M - F = B of a matrix with these eigenvalues and eigenvectors."""
    inner = vectors.T @ B @ vectors
    change = np.multiply.outer(values, values) - 1.0
    still = np.abs(change) < CLOSE
    inner = np.where(still, 0.0, inner / np.where(still, 1.0, change))
    inverse = np.linalg.inv(vectors)
    return np.asarray((inverse.T @ inner @ inverse).real)


def _powers(rate: Complex) -> Array:
    """Rotations and decays over 1, 2, 4, ... steps, (BITS, 4, m)."""
    found = np.empty((BITS, 4, rate.size))
    z = rate.astype(np.clongdouble)
    for j in range(BITS):
        found[j] = z.real, -z.imag, z.imag, z.real
        z = z * z
    return readonly(found)
