"""L D L^T of a symmetric sparse matrix by dense fronts: LAPACK and BLAS on blocks, inertia included.

A = P L D L^T P^T front by front of a nested dissection (`fronts`). A front whose pivots are positive definite, as most
are even where A is not, is factored by Cholesky; the others by Bunch-Kaufman, with pivots of one or two among the
front's own. The inertia of A is the sum of theirs (Haynsworth, Linear Algebra Appl. 1, 1968, 73).
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg.blas import dgemm, dsyrk, dtrsm
from scipy.linalg.lapack import dpotrf, dsyconv, dsytrf, dsytrf_lwork
from scipy.sparse import csc_array

from casingfem.errors import NumericsError
from casingfem.io.arrays import FloatArray, IntArray
from casingfem.linalg.fronts import Front, Fronts, Places, Runs

SINGULAR = "the matrix is singular: the structure is not supported, or the shift is an eigenvalue"


@dataclass(frozen=True, slots=True, eq=False)
class Indefinite:
    """D^-1 of Bunch-Kaufman, tridiagonal, and the order of its pivots; L is unit triangular."""

    order: IntArray
    diagonal: FloatArray
    beside: FloatArray

    def divided(self, x: FloatArray) -> FloatArray:
        """D^-1 x for columns x (k, columns)."""
        y = self.diagonal[:, None] * x
        y[:-1] += self.beside[:, None] * x[1:]
        y[1:] += self.beside[:, None] * x[:-1]
        return np.asarray(y)


@dataclass(frozen=True, slots=True, eq=False)
class Block:
    """Columns of L of one front: on its pivots (k, k), lower, and on its rows (m, k)."""

    L: FloatArray
    below: FloatArray
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

    def solve(self, rhs: FloatArray) -> FloatArray:
        """A^-1 rhs, for one vector (n,) or several columns (n, k)."""
        order = self.fronts.order
        x = np.ascontiguousarray(rhs.reshape(len(rhs), -1)[order], dtype=float)
        both = list(zip(self.fronts.fronts, self.blocks, strict=True))
        for front, block in both:
            own = x[front.start : front.start + front.pivots]
            if block.D is not None:
                own[:] = own[block.D.order]
            dtrsm(1.0, block.L, own.T, side=1, lower=1, trans_a=1, diag=block.D is not None, overwrite_b=1)
            x[front.rows] -= block.below @ own
        for front, block in reversed(both):
            own = x[front.start : front.start + front.pivots]
            if block.D is not None:
                own[:] = block.D.divided(own)
            own -= block.below.T @ x[front.rows]
            dtrsm(1.0, block.L, own.T, side=1, lower=1, diag=block.D is not None, overwrite_b=1)
            if block.D is not None:
                own[block.D.order] = own.copy()
        solution = np.empty_like(x)
        solution[order] = x
        return solution.reshape(rhs.shape)


def factored(A: csc_array, fronts: Fronts, keep: bool = True) -> MultifrontalFactor:
    """Factor a symmetric matrix of the fronts' pattern; without `keep` count its negative eigenvalues alone.

    Raises
    ------
    NumericsError
        If the matrix is singular, or not finite.
    """
    if not np.all(np.isfinite(A.data)):
        raise NumericsError("the matrix holds values that are not finite")
    blocks: list[Block] = []
    passed: dict[int, FloatArray] = {}
    negatives = 0
    for number, front in enumerate(fronts.fronts):
        K_pp, K_rp, K_rr = assembled(A, front, fronts, passed)
        block, count = eliminated(K_pp, K_rp, K_rr) if front.pivots else (Block(K_pp, K_rp, None), 0)
        negatives += count
        if keep:
            blocks.append(block)
        passed[number] = K_rr
    return MultifrontalFactor(fronts=fronts, blocks=tuple(blocks), negatives=negatives)


def assembled(
    A: csc_array, front: Front, fronts: Fronts, passed: dict[int, FloatArray]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """The parts of a front in its lower triangle, from A and from its children, whose updates are used up."""
    k, m = front.size
    columns = np.zeros(k * (k + m))
    columns[front.place] = A.data[front.source]
    K_pp, K_rp = columns[: k * k].reshape((k, k), order="F"), columns[k * k :].reshape((m, k), order="F")
    K_rr = np.zeros((m, m), order="F")
    for number in front.children:
        child, update = fronts.fronts[number], passed.pop(number)
        s = child.split
        add(K_pp, child.head_runs, child.head, update[:s, :s])
        add(K_rp, child.tail_runs, child.head, update[s:, :s], below=False)
        add(K_rr, child.tail_runs, child.tail, update[s:, s:])
    return K_pp, K_rp, K_rr


def add(K: FloatArray, rows: Runs, columns: Places, update: FloatArray, below: bool = True) -> None:
    """K[rows, columns] += update, of its lower triangle only where columns are rows too; both by columns in memory."""
    for there, here in rows:
        last = there.stop if below else update.shape[1]
        some = slice(columns.start, columns.start + last) if isinstance(columns, slice) else columns[:last]
        K.T[some, here] += update.T[:last, there]


def eliminated(K_pp: FloatArray, K_rp: FloatArray, K_rr: FloatArray) -> tuple[Block, int]:
    """Columns of L, and negative pivots; K_rr becomes the Schur complement, in its lower triangle, in place."""
    L, failed = dpotrf(K_pp, lower=1, clean=0)
    if failed:
        return pivoted(K_pp, K_rp, K_rr)
    if len(K_rp):
        K_rp = dtrsm(1.0, L, K_rp, side=1, lower=1, trans_a=1, overwrite_b=1)
        dsyrk(-1.0, K_rp, beta=1.0, c=K_rr, lower=1, overwrite_c=1)
    return Block(L, K_rp, None), 0


def pivoted(K_pp: FloatArray, K_rp: FloatArray, K_rr: FloatArray) -> tuple[Block, int]:
    """The same for pivots that are not positive definite, by Bunch-Kaufman."""
    work, _ = dsytrf_lwork(len(K_pp), lower=1)
    L, swaps, failed = dsytrf(K_pp, lower=1, lwork=int(work), overwrite_a=1)
    diagonal = L.diagonal().copy()
    if failed or not np.all(np.isfinite(diagonal)):
        raise NumericsError(SINGULAR)
    L, beside, _ = dsyconv(L, swaps, lower=1, overwrite_a=1)
    D, count = pivots(diagonal, beside[:-1], swaps)
    if len(K_rp):
        image = dtrsm(1.0, L, np.asfortranarray(K_rp[:, D.order]), side=1, lower=1, trans_a=1, diag=1, overwrite_b=1)
        K_rp = np.asfortranarray(D.divided(image.T).T)
        dgemm(-1.0, K_rp, image, beta=1.0, c=K_rr, trans_b=1, overwrite_c=1)
    return Block(L, K_rp, D), count


def pivots(diagonal: FloatArray, beside: FloatArray, swaps: IntArray) -> tuple[Indefinite, int]:
    """D^-1 and the order of pivots from what LAPACK's sytrf leaves, and how many eigenvalues of D are negative.

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
    det = one * other - between**2
    inverse[first], inverse[first + 1], coupling[first] = other / det, one / det, -between / det
    return Indefinite(order, inverse, coupling), int(np.count_nonzero(diagonal[single] < 0.0)) + len(first)
