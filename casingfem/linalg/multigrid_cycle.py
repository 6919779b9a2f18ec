"""One multigrid cycle on many vectors at once, smoothed by Chebyshev polynomials.

Smoothed aggregation builds the levels (pyamg); the cycle is written here, since every product with a block of vectors
passes over the matrix once, where Gauss-Seidel passes once a vector. The polynomial damps the upper part of D^-1 A's
spectrum (Adams, Brezina, Hu & Tuminaro, J. Comput. Phys. 188, 2003, 593); the same before and after the coarse
correction, it leaves the cycle symmetric and positive definite, as conjugate gradients need it.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.sparse import bsr_matrix, csr_array, csr_matrix
from scipy.sparse.linalg import LinearOperator, eigsh

from casingfem.io.arrays import FloatArray

DEGREE = 3  # of the polynomial
DAMPED = 15.0  # the spectrum's upper end over the lower end of what is damped
SAFETY = 1.1  # on the upper end, which is estimated from below
COARSEST = 500  # nodes or aggregates solved directly
START_SEED = 9176  # of the estimate: same input, same bits


@dataclass(frozen=True, slots=True, eq=False)
class Level:
    """A symmetric matrix (n, n), the inverse of its diagonal (n, 1), rho(D^-1 A), and what prolongs to it (n, m)."""

    A: csr_array
    inverse: FloatArray
    radius: float
    P: csr_array

    def smoothed(self, b: FloatArray, x: FloatArray | None = None) -> FloatArray:
        """Chebyshev iteration for A x = b from x, or from zero."""
        high, low = SAFETY * self.radius, SAFETY * self.radius / DAMPED
        middle, half = 0.5 * (high + low), 0.5 * (high - low)
        residual = b - self.A @ x if x is not None else b
        step = self.inverse * residual / middle
        found = step if x is None else x + step
        rate = half / middle
        for _ in range(DEGREE - 1):
            residual = residual - self.A @ step
            faster = 1.0 / (2.0 * middle / half - rate)
            step = faster * rate * step + (2.0 * faster / half) * (self.inverse * residual)
            found = found + step
            rate = faster
        return np.asarray(found)


@dataclass(frozen=True, slots=True, eq=False)
class Hierarchy:
    """Levels from fine to coarse, and the factor of the coarsest matrix."""

    levels: tuple[Level, ...]
    coarsest: tuple[FloatArray, bool]

    @property
    def bytes(self) -> int:
        """Memory of the levels and the coarsest factor."""
        arrays = [self.coarsest[0]]
        for level in self.levels:
            arrays += [part for A in (level.A, level.P) for part in (A.data, A.indices, A.indptr)] + [level.inverse]
        return sum(array.nbytes for array in arrays)

    def cycle(self, b: FloatArray, depth: int = 0) -> FloatArray:
        """Approximately A^-1 b for a block of vectors (n, k): one V-cycle from a level down."""
        if depth == len(self.levels):
            return np.asarray(cho_solve(self.coarsest, b))
        level = self.levels[depth]
        x = level.smoothed(b)
        coarse = self.cycle(level.P.T @ (b - level.A @ x), depth + 1)
        return level.smoothed(b, x + level.P @ coarse)

    @property
    def operator(self) -> LinearOperator:
        """The cycle as a preconditioner."""

        def product(b: FloatArray) -> FloatArray:
            return self.cycle(b.reshape(len(b), -1)).reshape(b.shape)

        size = self.levels[0].A.shape[0] if self.levels else len(self.coarsest[0])
        return LinearOperator((size, size), matvec=product, matmat=product, dtype=np.float64)


def make_hierarchy(A: csr_array, near_null: FloatArray) -> Hierarchy:
    """Levels of smoothed aggregation for A, symmetric positive definite, with near_null (n, k) in its coarse spaces."""
    from pyamg import smoothed_aggregation_solver

    nodal = A.shape[0] % 3 == 0
    matrix = bsr_matrix(A, blocksize=(3, 3)) if nodal else csr_matrix(A)
    matrix.indices, matrix.indptr = matrix.indices.astype(np.int32), matrix.indptr.astype(np.int32)
    solver = smoothed_aggregation_solver(
        matrix,
        B=near_null,
        symmetry="symmetric",
        strength=("symmetric", {"theta": 0.0}),
        smooth="energy" if nodal else "jacobi",
        max_coarse=COARSEST,
    )
    *fine, last = solver.levels
    return Hierarchy(
        tuple(make_level(csr_array(level.A), csr_array(level.P)) for level in fine), cho_factor(last.A.toarray())
    )


def make_level(A: csr_array, P: csr_array) -> Level:
    """A level with the spectral radius of D^-1 A, by a few Lanczos steps from a fixed start."""
    root = 1.0 / np.sqrt(A.diagonal())
    start = np.random.default_rng(START_SEED).standard_normal(A.shape[0])
    scaled = LinearOperator(A.shape, matvec=lambda x: root * (A @ (root * x.ravel())), dtype=np.float64)
    radius = eigsh(scaled, 1, v0=start, tol=1e-2, return_eigenvectors=False)[0]
    return Level(A=A, inverse=root[:, None] ** 2, radius=float(radius), P=P)
