"""Lowest modes of large thick solids without the factors of shift-invert: LOBPCG with algebraic multigrid.

Block preconditioned conjugate gradients (Knyazev, SIAM J. Sci. Comput. 23, 2001, 517), preconditioned by one cycle of
smoothed aggregation whose coarse spaces hold the six rigid motions (Vanek, Mandel & Brezina, Computing 56, 1996, 179;
pyamg). Thin walls defeat it: there the cycle misses the bending, and the iteration stalls. What did not converge is
never returned: the solution falls back to shift-invert, and a warning says so. Nor is what a Sturm count shows to be
incomplete. The count needs one factor; where that does not fit, a second iteration from another random block, kept
orthogonal to what was found, looks for what was missed: it would find it, but does not prove that there is nothing.
`python -m reports.speed.solid_solvers` measures where it pays.
"""

import warnings

import numpy as np
from scipy.sparse import csc_array, csr_array
from scipy.sparse.linalg import lobpcg

from casingfem.errors import NumericsError, warn
from casingfem.io.arrays import FloatArray
from casingfem.linalg.eigen import EigenResult, gap_after, result, solve_modes
from casingfem.linalg.krylov import START_SEED, ConvergenceError
from casingfem.linalg.memory import MemoryNeedError
from casingfem.linalg.multigrid_cycle import Hierarchy, make_hierarchy
from casingfem.linalg.pencil import Mass, Pencil, make_pencil

ITERATIONS = 200
TOLERANCE = 1e-4  # of the residual, relative to the negative shift: some 1e-6 of the first elastic eigenvalue
BALANCED = 1e-10  # of a load: what static solutions may leave
SEARCHED, SEARCH_STEPS = 6, 60  # vectors and iterations of the search for what was missed; the lowest must converge
ACCEPTED = 1e-5  # residual over eigenvalue, of rigid motions over ten shifts; its square is the error


def multigrid_modes(
    K: csc_array, mass: Mass, near_null: FloatArray, count: int, shift: float, extra: int = 4, *, counted: bool = True
) -> EigenResult:
    """Lowest `count` modes by LOBPCG and multigrid, complete by a Sturm count or a search, or else by `solve_modes`.

    Parameters
    ----------
    K, mass, count, shift, extra
        As in `solve_modes`.
    near_null
        The rigid motions on the free dofs, (free, 6).
    counted
        Whether a Sturm count certifies them, for the time of one factor; without it, or where that does not fit into
        memory, `sturm_count` is None.

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
    """K^-1 loads (free, k) of a held thick solid: conjugate gradients, each column its own, preconditioned by cycles.

    Raises
    ------
    ConvergenceError
        If a residual stays above `BALANCED` of its load.
    """
    A = csr_array(K)
    try:
        levels = make_hierarchy(A, near_null)
    except np.linalg.LinAlgError as error:
        raise ConvergenceError(f"the coarsest matrix is not positive definite: {error}") from error
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
    raise ConvergenceError(f"{left:.1e} of a load is not balanced after {ITERATIONS} cycles")


def count_that_fits(pencil: Pencil, sigma: float) -> int | None:
    """The Sturm count, None where memory is too small for it."""
    try:
        return pencil.count_below(sigma)
    except MemoryNeedError:
        return None


def search(pencil: Pencil, levels: Hierarchy, found: FloatArray, sigma: float, shift: float) -> int:
    """Look for modes below sigma beside those found (free, k); returns how many vectors that took.

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
    try:
        return make_hierarchy(csr_array(pencil.shifted(shift)), near_null / pencil.scale[:, None])
    except np.linalg.LinAlgError as error:
        raise ConvergenceError(f"the coarsest matrix is not positive definite: {error}") from error


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

    All are needed if nothing is said. With `beside`, (free, k) B-orthonormal, those of what is B-orthogonal to it.

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
