"""Lowest modes of large thick solids without shift-invert factors: LOBPCG with algebraic multigrid.

Block preconditioned conjugate gradients (Knyazev, SIAM J. Sci. Comput. 23, 2001, 517), preconditioned by one cycle of
smoothed aggregation whose coarse spaces contain the six rigid motions (Vanek, Mandel & Brezina, Computing 56, 1996,
179; pyamg). For thin walls it fails, since the cycle misses bending and the iteration stalls. Modes that did not
converge, or that a Sturm count shows to be incomplete, are never returned: the solution falls back to shift-invert with
a warning. The count needs one factor. If that does not fit into memory, a second iteration from another random block,
orthogonal to the modes found, searches for missing ones. It would find them, but proves nothing. `python -m
reports.benchmarks.solid_solvers` measures where the method is faster.

pyamg builds the levels. The cycle is written here, since a product with a block of vectors reads the matrix once, while
Gauss-Seidel reads it once for each vector. Chebyshev polynomials smooth: they damp the upper part of D^-1 A's spectrum
(Adams, Brezina, Hu & Tuminaro, J. Comput. Phys. 188, 2003, 593); used equally before and after the coarse correction,
they keep the cycle symmetric and positive definite, as conjugate gradients require.
"""

import warnings
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.sparse import bsr_matrix, csc_array, csr_array, csr_matrix
from scipy.sparse.linalg import LinearOperator, eigsh, lobpcg

from casingfem.errors import NumericsError, warn
from casingfem.io.arrays import FloatArray
from casingfem.linalg.eigen import EigenResult, gap_after, result, solve_modes
from casingfem.linalg.krylov import START_SEED, ConvergenceError
from casingfem.linalg.memory import MemoryNeedError
from casingfem.linalg.pencil import Mass, Pencil, make_pencil

ITERATIONS = 200
TOLERANCE = 1e-4  # of the residual, relative to the negative shift: some 1e-6 of the first elastic eigenvalue
BALANCED = 1e-10  # of a load: largest residual of static solutions
SEARCHED, SEARCH_STEPS = 6, 60  # vectors and iterations of the search for what was missed; the lowest must converge
ACCEPTED = 1e-5  # residual over eigenvalue, of rigid motions over ten shifts; its square is the error
DEGREE = 3  # of the polynomial
DAMPED = 15.0  # the spectrum's upper end over the lower end of what is damped
SAFETY = 1.1  # on the upper end, which is estimated from below
COARSEST = 500  # nodes or aggregates solved directly
RADIUS_SEED = 9176  # of the estimate of the spectrum's end: same input, same bits


@dataclass(frozen=True, slots=True, eq=False)
class Level:
    """A symmetric matrix (n, n), the inverse of its diagonal (n, 1), rho(D^-1 A), and the prolongation to it (n, m)."""

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
        """Approximation of A^-1 b for a block of vectors (n, k): one V-cycle from a level down."""
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
    """Levels of smoothed aggregation for A with near_null (n, k) in its coarse spaces.

    Raises
    ------
    ConvergenceError
        If A is not positive definite.
    """
    from pyamg import smoothed_aggregation_solver

    nodal = A.shape[0] % 3 == 0
    matrix = bsr_matrix(A, blocksize=(3, 3)) if nodal else csr_matrix(A)
    matrix.indices, matrix.indptr = matrix.indices.astype(np.int32), matrix.indptr.astype(np.int32)
    strength, smooth = ("symmetric", {"theta": 0.0}), "energy" if nodal else "jacobi"
    try:
        solver = smoothed_aggregation_solver(
            matrix, B=near_null, symmetry="symmetric", strength=strength, smooth=smooth, max_coarse=COARSEST
        )
        *fine, last = solver.levels
        levels = tuple(make_level(csr_array(level.A), csr_array(level.P)) for level in fine)
        return Hierarchy(levels, cho_factor(last.A.toarray()))
    except np.linalg.LinAlgError as error:
        raise ConvergenceError(f"the coarsest matrix is not positive definite: {error}") from error


def make_level(A: csr_array, P: csr_array) -> Level:
    """A level with the spectral radius of D^-1 A, by a few Lanczos steps from a fixed start."""
    root = 1.0 / np.sqrt(A.diagonal())
    start = np.random.default_rng(RADIUS_SEED).standard_normal(A.shape[0])
    scaled = LinearOperator(A.shape, matvec=lambda x: root * (A @ (root * x.ravel())), dtype=np.float64)
    radius = eigsh(scaled, 1, v0=start, tol=1e-2, return_eigenvectors=False)[0]
    return Level(A=A, inverse=root[:, None] ** 2, radius=float(radius), P=P)


def multigrid_modes(
    K: csc_array, mass: Mass, near_null: FloatArray, count: int, shift: float, extra: int = 4, *, counted: bool = True
) -> EigenResult:
    """Lowest `count` modes by LOBPCG and multigrid, complete by a Sturm count or a search; else by `solve_modes`.

    Parameters
    ----------
    K, mass, count, shift, extra
        As in `solve_modes`.
    near_null
        The rigid motions on the free dofs, (free, 6).
    counted
        Whether a Sturm count verifies them, in the time of one factor; otherwise, or if that does not fit into memory,
        `sturm_count` is None.

    Raises
    ------
    NumericsError
        If `solve_modes` fails too.
    """
    pencil = make_pencil(K, mass)
    try:
        levels = make_levels(pencil, near_null, shift)
        values, vectors, products = iterate(pencil, levels, count + extra, shift)
        below, sigma = gap_after(values, count, abs(shift))
        certified = count_that_fits(pencil, sigma) if counted else None
        if certified is None:
            products += search(pencil, levels, vectors[:, :below], sigma, shift)
        elif certified != below:
            raise ConvergenceError(f"{below} of {certified} modes found")
    except NumericsError as error:
        warn("modes-lobpcg", f"LOBPCG with multigrid: {error}")
        return solve_modes(K, mass, count, shift, extra)
    return result(pencil, values[:below], vectors[:, :below], certified, products, None)


def static_by_cycles(K: csc_array, near_null: FloatArray, loads: FloatArray) -> FloatArray:
    """K^-1 loads (free, k) of a supported thick solid: conjugate gradients for each column, preconditioned by cycles.

    Raises
    ------
    ConvergenceError
        If a residual stays above `BALANCED` of its load.
    """
    A = csr_array(K)
    levels = make_hierarchy(A, near_null)
    allowed = BALANCED * np.linalg.norm(loads, axis=0)
    found, residual = np.zeros_like(loads), loads.copy()
    way = levels.cycle(residual)
    slope = np.einsum("ij,ij->j", residual, way)
    for _ in range(ITERATIONS):
        stress = A @ way
        energy = np.einsum("ij,ij->j", way, stress)
        length = np.divide(slope, energy, out=np.zeros_like(slope), where=energy > 0.0)
        found += length * way
        residual -= length * stress
        if np.all(np.linalg.norm(residual, axis=0) <= allowed):
            return found
        down = levels.cycle(residual)
        before, slope = slope, np.einsum("ij,ij->j", residual, down)
        way = down + np.divide(slope, before, out=np.zeros_like(slope), where=before > 0.0) * way
    left = float(BALANCED * (np.linalg.norm(residual, axis=0)[allowed > 0.0] / allowed[allowed > 0.0]).max())
    raise ConvergenceError(f"{left:.1e} of a load remains unbalanced after {ITERATIONS} cycles")


def count_that_fits(pencil: Pencil, sigma: float) -> int | None:
    """The Sturm count, None if memory is too small for it."""
    try:
        return pencil.count_below(sigma)
    except MemoryNeedError:
        return None


def search(pencil: Pencil, levels: Hierarchy, found: FloatArray, sigma: float, shift: float) -> int:
    """Search for modes below sigma other than those found (free, k); returns the number of vectors used.

    Raises
    ------
    ConvergenceError
        If there is one, or the search does not converge.
    """
    values, _, products = iterate(pencil, levels, SEARCHED, shift, SEARCH_STEPS, found, needed=1)
    missed = int(np.count_nonzero(values < sigma))
    if missed:
        raise ConvergenceError(f"{missed} modes missed at first")
    return products


def make_levels(pencil: Pencil, near_null: FloatArray, shift: float) -> Hierarchy:
    """The multigrid levels of the shifted pencil, whose unknowns are scaled by the mass."""
    return make_hierarchy(csr_array(pencil.shifted(shift)), near_null / pencil.scale[:, None])


def iterate(
    pencil: Pencil,
    levels: Hierarchy,
    wanted: int,
    shift: float,
    iterations: int = ITERATIONS,
    beside: FloatArray | None = None,
    needed: int | None = None,
) -> tuple[FloatArray, FloatArray, int]:
    """Lowest eigenvalues ascending, B-orthonormal vectors, and preconditioned vectors; the first `needed` converged.

    All are needed by default. With B-orthonormal `beside` (free, k), the modes B-orthogonal to it.

    Raises
    ------
    ConvergenceError
        If a residual stays above `ACCEPTED` times its eigenvalue.
    """
    A = csr_array(pencil.shifted(shift))
    rng = np.random.default_rng([START_SEED, 0 if beside is None else beside.shape[1]])
    start = rng.standard_normal((pencil.size, wanted))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # residuals are judged below
        try:
            values, vectors, history = lobpcg(
                A, levels.cycle(start), B=pencil.B, M=levels.operator, Y=beside, largest=False,
                tol=TOLERANCE * abs(shift), maxiter=iterations, retResidualNormsHistory=True,
            )  # fmt: skip
        except (ValueError, np.linalg.LinAlgError) as error:
            raise ConvergenceError(f"the iteration broke down: {error}") from error
    order = np.argsort(values)
    values, vectors = values[order] + shift, vectors[:, order]
    residuals = pencil.residuals(values, vectors, TOLERANCE / ACCEPTED * abs(shift))[:needed]
    if not np.all(residuals <= ACCEPTED):
        done = int(np.count_nonzero(residuals <= ACCEPTED))
        found = f"{done} of {len(residuals)} modes converged, the largest residual is {residuals.max():.1e}"
        raise ConvergenceError(found)
    return values, vectors, wanted * len(history)
