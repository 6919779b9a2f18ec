"""L D L^H of a symmetric or Hermitian sparse matrix by dense fronts: LAPACK and BLAS on blocks, inertia included.

A = P L D L^H P^T front by front of a nested dissection (`fronts`). A front with positive definite pivots, as most are
even if A is not, is factored by Cholesky; the others by Bunch-Kaufman, with pivots of order one or two within the
front. The inertia of A is the sum of theirs (Haynsworth, Linear Algebra Appl. 1, 1968, 73).
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from casingfem.errors import NumericsError
from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.linalg.element_sum import ElementSum
from casingfem.linalg.entries import Places, Symmetric
from casingfem.linalg.fronts import Front, Fronts, Runs
from casingfem.linalg.substitution import Block, Indefinite, OneFront, Stack, Step, kernels
from contact.io.threads import with_one_thread

SINGULAR = "the matrix is singular: the structure is not supported, or the shift is an eigenvalue"
FEWEST = 2  # fronts of one shape that are worth stacking


@dataclass(frozen=True, slots=True, eq=False)
class MultifrontalFactor:
    """The steps of L and D, children before parents; none are stored if only the inertia was requested."""

    fronts: Fronts
    steps: tuple[Step, ...]
    negatives: int
    dtype: np.dtype[Any]

    def negative(self) -> int:
        """Number of negative eigenvalues of A."""
        return self.negatives

    @with_one_thread
    def solve(self, rhs: Array) -> Array:
        """A^-1 rhs, for one vector (n,) or several columns (n, k)."""
        order = self.fronts.order
        if np.iscomplexobj(rhs) and self.dtype.kind != "c":
            return np.asarray(self.solve(rhs.real) + 1j * self.solve(rhs.imag))
        x = np.ascontiguousarray(rhs.reshape(len(rhs), -1)[order], dtype=self.dtype)
        for step in self.steps:
            step.forward(x)
        for step in reversed(self.steps):
            step.back(x)
        solution = np.empty(x.shape, dtype=x.dtype, order="F")  # by columns, as bases are kept
        solution[order] = x
        return solution.reshape(rhs.shape)


@with_one_thread
def factored(A: Symmetric, fronts: Fronts, keep: bool = True) -> MultifrontalFactor:
    """Factor a symmetric or Hermitian matrix of the fronts' pattern; without `keep` only count negative eigenvalues.

    Raises
    ------
    NumericsError
        If the matrix is singular, or not finite.
    """
    if not (A.finite if isinstance(A, ElementSum) else np.all(np.isfinite(A.data))):
        raise NumericsError("the matrix contains values that are not finite")
    kept = Kept(fronts, A.dtype)
    passed: dict[int, Array] = {}
    negatives = 0
    for number, front in enumerate(fronts.fronts):
        K_pp, K_rp, K_rr = assembled(A, front, fronts, passed)
        block, count = eliminated(K_pp, K_rp, K_rr) if front.pivots else (Block(K_pp, K_rp, None), 0)
        negatives += count
        if keep:
            kept.take(number, front, block)
        passed[number] = K_rr
    return MultifrontalFactor(fronts=fronts, steps=kept.steps(), negatives=negatives, dtype=A.dtype)


class Kept:
    """The steps of a factorisation so far; fronts of one shape and height are stacked."""

    def __init__(self, fronts: Fronts, dtype: np.dtype[Any]) -> None:
        self.fronts, self.dtype = fronts, dtype
        self.stacks: dict[int, Stack] = {}
        self.single: dict[int, OneFront] = {}

    def take(self, number: int, front: Front, block: Block) -> None:
        """Store a front that was just eliminated, alone or in the stack of its group."""
        group = int(self.fronts.groups.of[number])
        count = int(self.fronts.groups.counts[group])
        if count < FEWEST or not front.pivots or block.D is not None:
            self.single[number] = OneFront(slice(front.start, front.start + front.pivots), front.rows, block)
            return
        if group not in self.stacks:
            self.stacks[group] = Stack(count, front.size, self.dtype)
        self.stacks[group].add(front.start, front.rows, block)

    def steps(self) -> tuple[Step, ...]:
        """Steps, the lowest fronts first."""
        groups = self.fronts.groups
        found: list[tuple[int, Step]] = [(int(groups.heights[g]), stack.step()) for g, stack in self.stacks.items()]
        found += [(int(groups.heights[groups.of[number]]), one) for number, one in self.single.items()]
        return tuple(step for _, step in sorted(found, key=lambda item: item[0]))


def assembled(A: Symmetric, front: Front, fronts: Fronts, passed: dict[int, Array]) -> tuple[Array, Array, Array]:
    """The parts of a front in its lower triangle, from A and from its children's updates, which are then released."""
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
    """K[rows, columns] += update, only the lower triangle if columns are also rows; both stored by columns."""
    for there, here in rows:
        last = there.stop if below else update.shape[1]
        some = slice(columns.start, columns.start + last) if isinstance(columns, slice) else columns[:last]
        K.T[some, here] += update.T[:last, there]


def eliminated(K_pp: Array, K_rp: Array, K_rr: Array) -> tuple[Block, int]:
    """Columns of L, and number of negative pivots; K_rr becomes the Schur complement, lower triangle, in place."""
    use = kernels(K_pp)
    L, failed = use.potrf(K_pp, lower=1, clean=0)
    if failed:
        return pivoted(K_pp, K_rp, K_rr)
    if len(K_rp):
        K_rp = use.trsm(1.0, L, K_rp, side=1, lower=1, trans_a=use.adjoint, overwrite_b=1)
        use.syrk(-1.0, K_rp, beta=1.0, c=K_rr, lower=1, overwrite_c=1)
    return Block(L, K_rp, None), 0


def pivoted(K_pp: Array, K_rp: Array, K_rr: Array) -> tuple[Block, int]:
    """`eliminated` for pivots that are not positive definite, by Bunch-Kaufman."""
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
    """D^-1 and the pivot order from LAPACK's sytrf or hetrf, and the number of negative eigenvalues of D.

    A pair of negative numbers in `swaps` is a pivot of order two, with one negative and one positive eigenvalue.
    """
    order = list(range(len(swaps)))
    first = np.flatnonzero(swaps < 0)[::2]
    second = set((first + 1).tolist())
    for i, swap in enumerate(swaps.tolist()):
        if swap > 0 or i in second:
            order[i], order[abs(swap) - 1] = order[abs(swap) - 1], order[i]
    single = swaps > 0
    inverse, coupling = np.empty_like(diagonal), np.zeros_like(beside)
    inverse[single] = 1.0 / diagonal[single]
    one, other, between = diagonal[first], diagonal[first + 1], beside[first]
    det = one * other - np.abs(between) ** 2
    inverse[first], inverse[first + 1], coupling[first] = other / det, one / det, -between / det
    return Indefinite(np.array(order), inverse, coupling), int(np.count_nonzero(diagonal[single] < 0.0)) + len(first)
