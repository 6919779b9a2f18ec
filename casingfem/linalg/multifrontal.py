"""L D L^H of a symmetric or Hermitian sparse matrix by dense fronts: LAPACK and BLAS on blocks, inertia included.

A = P L D L^H P^T front by front of a nested dissection (`fronts`). A front whose pivots are positive definite, as most
are even where A is not, is factored by Cholesky; the others by Bunch-Kaufman, with pivots of one or two among the
front's own. The inertia of A is the sum of theirs (Haynsworth, Linear Algebra Appl. 1, 1968, 73).
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from scipy.linalg import blas, lapack

from casingfem.errors import NumericsError
from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.linalg.element_sum import ElementSum
from casingfem.linalg.entries import Places, Symmetric
from casingfem.linalg.fronts import Front, Fronts, Runs

SINGULAR = "the matrix is singular: the structure is not supported, or the shift is an eigenvalue"


class Kernels(NamedTuple):
    """BLAS and LAPACK for one kind of numbers; `adjoint` says how their triangular solvers call L^H."""

    potrf: Callable[..., Any]
    sytrf: Callable[..., Any]
    sytrf_lwork: Callable[..., Any]
    syconv: Callable[..., Any]
    syrk: Callable[..., Any]
    gemm: Callable[..., Any]
    trsm: Callable[..., Any]
    adjoint: int


REAL = Kernels(lapack.dpotrf, lapack.dsytrf, lapack.dsytrf_lwork, lapack.dsyconv, blas.dsyrk, blas.dgemm, blas.dtrsm, 1)
COMPLEX = Kernels(
    lapack.zpotrf, lapack.zhetrf, lapack.zhetrf_lwork, lapack.zsyconv, blas.zherk, blas.zgemm, blas.ztrsm, 2
)


def kernels(A: Any) -> Kernels:
    """Those for the numbers of an array."""
    return COMPLEX if np.iscomplexobj(A) else REAL


@dataclass(frozen=True, slots=True, eq=False)
class Indefinite:
    """D^-1 of Bunch-Kaufman, tridiagonal, `beside` its lower entries; the order of its pivots; L is unit triangular."""

    order: IntArray
    diagonal: FloatArray
    beside: Array

    def divided(self, x: Array) -> Array:
        """D^-1 x for columns x (k, columns)."""
        y = self.diagonal[:, None] * x
        y[:-1] += self.beside.conj()[:, None] * x[1:]
        y[1:] += self.beside[:, None] * x[:-1]
        return np.asarray(y)


@dataclass(frozen=True, slots=True, eq=False)
class Block:
    """Columns of L of one front: on its pivots (k, k), lower, and on its rows (m, k)."""

    L: Array
    below: Array
    D: Indefinite | None


@dataclass(frozen=True, slots=True, eq=False)
class MultifrontalFactor:
    """The blocks of L and D; none are kept where only the inertia was asked for."""

    fronts: Fronts
    blocks: tuple[Block, ...]
    negatives: int

    def negative(self) -> int:
        """Number of negative eigenvalues of A."""
        return self.negatives

    def solve(self, rhs: Array) -> Array:
        """A^-1 rhs, for one vector (n,) or several columns (n, k)."""
        order, L = self.fronts.order, self.blocks[0].L
        if np.iscomplexobj(rhs) and not np.iscomplexobj(L):
            return np.asarray(self.solve(rhs.real) + 1j * self.solve(rhs.imag))
        x = np.ascontiguousarray(rhs.reshape(len(rhs), -1)[order], dtype=L.dtype)
        trsm = kernels(x).trsm
        both = list(zip(self.fronts.fronts, self.blocks, strict=True))
        for front, block in both:
            own = x[front.start : front.start + front.pivots]
            if block.D is not None:
                own[:] = own[block.D.order]
            trsm(1.0, block.L, own.T, side=1, lower=1, trans_a=1, diag=block.D is not None, overwrite_b=1)
            if len(front.rows):
                x[front.rows] -= block.below @ own
        hermitian = np.iscomplexobj(x)
        for front, block in reversed(both):
            own = x[front.start : front.start + front.pivots]
            if block.D is not None:
                own[:] = block.D.divided(own)
            beside = x[front.rows]
            if hermitian:  # L^-H y is the conjugate of L^-T conj(y)
                np.conj(own, out=own)
                np.conj(beside, out=beside)
            own -= block.below.T @ beside
            trsm(1.0, block.L, own.T, side=1, lower=1, diag=block.D is not None, overwrite_b=1)
            if hermitian:
                np.conj(own, out=own)
            if block.D is not None:
                own[block.D.order] = own.copy()
        solution = np.empty_like(x)
        solution[order] = x
        return solution.reshape(rhs.shape)


def factored(A: Symmetric, fronts: Fronts, keep: bool = True) -> MultifrontalFactor:
    """Factor a symmetric or Hermitian matrix of the fronts' pattern; without `keep` count negative eigenvalues alone.

    Raises
    ------
    NumericsError
        If the matrix is singular, or not finite.
    """
    if not (A.finite if isinstance(A, ElementSum) else np.all(np.isfinite(A.data))):
        raise NumericsError("the matrix holds values that are not finite")
    blocks: list[Block] = []
    passed: dict[int, Array] = {}
    negatives = 0
    for number, front in enumerate(fronts.fronts):
        K_pp, K_rp, K_rr = assembled(A, front, fronts, passed)
        block, count = eliminated(K_pp, K_rp, K_rr) if front.pivots else (Block(K_pp, K_rp, None), 0)
        negatives += count
        if keep:
            blocks.append(block)
        passed[number] = K_rr
    return MultifrontalFactor(fronts=fronts, blocks=tuple(blocks), negatives=negatives)


def assembled(A: Symmetric, front: Front, fronts: Fronts, passed: dict[int, Array]) -> tuple[Array, Array, Array]:
    """The parts of a front in its lower triangle, from A and from its children, whose updates are used up."""
    unknowns = fronts.order[front.start : front.start + front.pivots]
    K_pp, K_rp, K_rr = front.own.parts(A, unknowns, fronts.order[front.rows])
    for number in front.children:
        child, update = fronts.fronts[number], passed.pop(number)
        s = child.split
        add(K_pp, child.head_runs, child.head, update[:s, :s])
        add(K_rp, child.tail_runs, child.head, update[s:, :s], below=False)
        add(K_rr, child.tail_runs, child.tail, update[s:, s:])
    return K_pp, K_rp, K_rr


def add(K: Array, rows: Runs, columns: Places, update: Array, below: bool = True) -> None:
    """K[rows, columns] += update, of its lower triangle only where columns are rows too; both by columns in memory."""
    for there, here in rows:
        last = there.stop if below else update.shape[1]
        some = slice(columns.start, columns.start + last) if isinstance(columns, slice) else columns[:last]
        K.T[some, here] += update.T[:last, there]


def eliminated(K_pp: Array, K_rp: Array, K_rr: Array) -> tuple[Block, int]:
    """Columns of L, and negative pivots; K_rr becomes the Schur complement, in its lower triangle, in place."""
    use = kernels(K_pp)
    L, failed = use.potrf(K_pp, lower=1, clean=0)
    if failed:
        return pivoted(K_pp, K_rp, K_rr)
    if len(K_rp):
        K_rp = use.trsm(1.0, L, K_rp, side=1, lower=1, trans_a=use.adjoint, overwrite_b=1)
        use.syrk(-1.0, K_rp, beta=1.0, c=K_rr, lower=1, overwrite_c=1)
    return Block(L, K_rp, None), 0


def pivoted(K_pp: Array, K_rp: Array, K_rr: Array) -> tuple[Block, int]:
    """The same for pivots that are not positive definite, by Bunch-Kaufman."""
    use = kernels(K_pp)
    work, _ = use.sytrf_lwork(len(K_pp), lower=1)
    L, swaps, failed = use.sytrf(K_pp, lower=1, lwork=int(np.real(work)), overwrite_a=1)
    diagonal = L.diagonal().real.copy()
    if failed or not np.all(np.isfinite(diagonal)):
        raise NumericsError(SINGULAR)
    L, beside, _ = use.syconv(L, swaps, lower=1, overwrite_a=1)
    D, count = pivots(diagonal, beside[:-1], swaps)
    if len(K_rp):
        K_rp = np.asfortranarray(K_rp[:, D.order])
        image = use.trsm(1.0, L, K_rp, side=1, lower=1, trans_a=use.adjoint, diag=1, overwrite_b=1)
        K_rp = np.asfortranarray(D.divided(image.conj().T).conj().T)
        use.gemm(-1.0, K_rp, image, beta=1.0, c=K_rr, trans_b=use.adjoint, overwrite_c=1)
    return Block(L, K_rp, D), count


def pivots(diagonal: FloatArray, beside: Array, swaps: IntArray) -> tuple[Indefinite, int]:
    """D^-1 and the order of pivots from what LAPACK's sytrf, hetrf leave, and how many eigenvalues of D are negative.

    A pair of negative numbers in `swaps` is a pivot of two, of which one eigenvalue is negative and one is not.
    """
    order = np.arange(len(swaps))
    first = np.flatnonzero(swaps < 0)[::2]
    second = set((first + 1).tolist())
    for i, swap in enumerate(swaps.tolist()):
        if swap > 0 or i in second:
            order[[i, abs(swap) - 1]] = order[[abs(swap) - 1, i]]
    single = swaps > 0
    inverse, coupling = np.empty_like(diagonal), np.zeros_like(beside)
    inverse[single] = 1.0 / diagonal[single]
    one, other, between = diagonal[first], diagonal[first + 1], beside[first]
    det = one * other - np.abs(between) ** 2
    inverse[first], inverse[first + 1], coupling[first] = other / det, one / det, -between / det
    return Indefinite(order, inverse, coupling), int(np.count_nonzero(diagonal[single] < 0.0)) + len(first)
