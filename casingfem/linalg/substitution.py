"""Substitution through the fronts of L D L^H: a single front, or many of one shape at once.

With few right-hand sides the cost is not in multiplications: triangular solvers copy L, and each front takes several
calls from Python. Fronts of one shape and height above the leaves are independent, and a mesh of equal elements has
dozens of them, so they are treated as products of stacked matrices. For that, diagonal blocks of L with a few dozen
rows are inverted.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from scipy.linalg import blas, lapack
from scipy.sparse import csc_array

from casingfem.io.arrays import Array, FloatArray, IntArray

INVERTED = 64  # rows of a block on the diagonal at most


class Kernels(NamedTuple):
    """BLAS and LAPACK routines for one type of numbers; `adjoint` is the option for L^H in their triangular solvers."""

    potrf: Callable[..., Any]
    trtri: Callable[..., Any]
    sytrf: Callable[..., Any]
    sytrf_lwork: Callable[..., Any]
    syconv: Callable[..., Any]
    syrk: Callable[..., Any]
    gemm: Callable[..., Any]
    trsm: Callable[..., Any]
    adjoint: int


REAL = Kernels(
    lapack.dpotrf, lapack.dtrtri, lapack.dsytrf, lapack.dsytrf_lwork, lapack.dsyconv,
    blas.dsyrk, blas.dgemm, blas.dtrsm, 1,
)  # fmt: skip
COMPLEX = Kernels(
    lapack.zpotrf, lapack.ztrtri, lapack.zhetrf, lapack.zhetrf_lwork, lapack.zsyconv,
    blas.zherk, blas.zgemm, blas.ztrsm, 2,
)  # fmt: skip


def kernels(A: Any) -> Kernels:
    """The routines for the type of an array."""
    return COMPLEX if np.iscomplexobj(A) else REAL


@dataclass(frozen=True, slots=True, eq=False)
class Indefinite:
    """D^-1 of Bunch-Kaufman, tridiagonal, lower entries `beside`; order of its pivots; L is unit triangular."""

    order: IntArray
    diagonal: FloatArray
    beside: Array

    def divided(self, x: Array) -> Array:
        """D^-1 x for columns x (k, columns)."""
        y = self.diagonal[:, None] * x
        y[:-1] += self.beside.conj()[:, None] * x[1:]
        y[1:] += self.beside[:, None] * x[:-1]
        return np.asarray(y)


class Block(NamedTuple):
    """Columns of L for one front: on its pivots (k, k), lower, and on its rows (m, k)."""

    L: Array
    below: Array
    D: Indefinite | None


@dataclass(frozen=True, slots=True, eq=False)
class OneFront:
    """A single front: its pivots are consecutive, `rows` are later ones."""

    pivots: slice
    rows: IntArray
    block: Block

    def forward(self, x: Array) -> None:
        """Forward substitution: eliminate the pivots."""
        (L, below, D), own = self.block, x[self.pivots]
        if D is not None:
            own[:] = own[D.order]
        kernels(x).trsm(1.0, L, own.T, side=1, lower=1, trans_a=1, diag=D is not None, overwrite_b=1)
        if len(self.rows):
            x[self.rows] -= below @ own

    def back(self, x: Array) -> None:
        """Back substitution: compute the pivots from the rows."""
        (L, below, D), own = self.block, x[self.pivots]
        if D is not None:
            own[:] = D.divided(own)
        beside, hermitian = x[self.rows], np.iscomplexobj(x)
        if hermitian:  # L^-H y is the conjugate of L^-T conj(y)
            np.conj(own, out=own)
            np.conj(beside, out=beside)
        own -= below.T @ beside
        kernels(x).trsm(1.0, L, own.T, side=1, lower=1, diag=D is not None, overwrite_b=1)
        if hermitian:
            np.conj(own, out=own)
        if D is not None:
            own[D.order] = own.copy()


@dataclass(frozen=True, eq=False)
class AlikeFronts:
    """Independent fronts of one shape: their pivots (fronts, k) and rows (fronts, m).

    `L` (fronts, k, k) contains columns of L on the pivots, with inverted blocks on the diagonal between `cuts`; entries
    above them are not used. `below` (fronts, m, k) is L on the rows.
    """

    pivots: IntArray
    rows: IntArray
    cuts: tuple[slice, ...]
    L: Array
    below: Array

    @cached_property
    def sums(self) -> tuple[IntArray, csc_array]:
        """The rows of all fronts together, and the operator that sums the contributions of all fronts."""
        touched, place = np.unique(self.rows, return_inverse=True)
        columns = np.arange(self.rows.size + 1)
        return touched, csc_array((np.ones(self.rows.size), place.ravel(), columns), (len(touched), self.rows.size))

    def forward(self, x: Array) -> None:
        """Forward substitution: eliminate the pivots."""
        own = x[self.pivots]
        for cut in self.cuts:
            own[:, cut] = np.matmul(self.L[:, cut, cut], own[:, cut])
            if cut.stop < own.shape[1]:
                own[:, cut.stop :] -= np.matmul(self.L[:, cut.stop :, cut], own[:, cut])
        x[self.pivots] = own
        if self.rows.size:
            touched, sums = self.sums
            x[touched] -= sums @ np.matmul(self.below, own).reshape(self.rows.size, -1)

    def back(self, x: Array) -> None:
        """Back substitution: compute the pivots from the rows."""
        own = x[self.pivots].conj()  # L^H y is the conjugate of L^T conj(y)
        if self.rows.size:
            own -= np.matmul(self.below.swapaxes(1, 2), x[self.rows].conj())
        for cut in reversed(self.cuts):
            if cut.stop < own.shape[1]:
                own[:, cut] -= np.matmul(self.L[:, cut.stop :, cut].swapaxes(1, 2), own[:, cut.stop :])
            own[:, cut] = np.matmul(self.L[:, cut, cut].swapaxes(1, 2), own[:, cut])
        x[self.pivots] = own.conj()


Step: TypeAlias = OneFront | AlikeFronts  # their ways through right-hand sides x (n, columns) are in place


class Stack:
    """Storage for the fronts of one shape, filled one by one with those whose pivots are positive definite."""

    def __init__(self, count: int, size: tuple[int, int], dtype: Any) -> None:
        k, m = size
        self.L, self.below = np.empty((count, k, k), dtype=dtype), np.empty((count, k, m), dtype=dtype)  # by columns
        self.pivots, self.rows = np.empty((count, k), dtype=np.int64), np.empty((count, m), dtype=np.int64)
        ends = np.linspace(0, k, -(-k // INVERTED) + 1).astype(int).tolist()
        self.cuts = tuple(slice(low, high) for low, high in pairwise(ends))
        self.count = 0

    def add(self, start: int, rows: IntArray, block: Block) -> None:
        """Add a front that Cholesky has factored."""
        i, k = self.count, self.L.shape[1]
        self.L[i], self.below[i] = block.L.T, block.below.T
        trtri = kernels(block.L).trtri
        for cut in self.cuts:
            self.L[i, cut, cut] = np.tril(trtri(block.L[cut, cut], lower=1)[0]).T
        self.pivots[i], self.rows[i] = np.arange(start, start + k), rows
        self.count += 1

    def step(self) -> AlikeFronts:
        """The fronts collected so far, as arrays."""
        pivots, rows, L, below = (part[: self.count] for part in (self.pivots, self.rows, self.L, self.below))
        return AlikeFronts(pivots, rows, self.cuts, L.swapaxes(1, 2), below.swapaxes(1, 2))
