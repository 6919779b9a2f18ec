"""Lowest modes of K phi = omega^2 M phi: shift-invert Lanczos, certified by a Sturm count.

Because the factor's pivots stay on the diagonal, the signs of U's diagonal are the inertia of K - sigma M: the
number of eigenvalues below sigma (Sylvester).
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array, diags_array, eye_array
from scipy.sparse.linalg import ArpackError, LinearOperator, eigsh

from casingfem.arrays import FloatArray
from casingfem.structure.factor import EigenError, factorise

__all__ = ["CountError", "EigenError", "EigenResult", "factorise", "gap_after", "scaled", "solve_modes", "sturm_count"]

START_SEED = 7391  # ARPACK's start vector is fixed: same input, same bits


class CountError(EigenError, ValueError):
    """More modes were asked for than the model has."""


@dataclass(frozen=True, eq=False)
class EigenResult:
    """Eigenvalues [rad^2/s^2] ascending, mass-normalised vectors (free, modes), and the certificate.

    `sturm_count` is the number of eigenvalues below the last one returned (its double included), counted
    by the inertia of a factorisation; `residuals` are |A x - omega^2 x|/omega^2 of the mass-scaled problem.
    """

    eigenvalues: FloatArray
    vectors: FloatArray
    sturm_count: int
    residuals: FloatArray


def sturm_count(A: csc_array, sigma: float) -> int:
    """Number of eigenvalues of the symmetric matrix A below sigma.

    >>> sturm_count(csc_array(np.diag([1.0, 2.0, 3.0])), 2.5)
    2
    """
    factor = factorise(A - sigma * eye_array(A.shape[0], format="csc"))
    if not np.array_equal(factor.perm_r, factor.perm_c):
        raise EigenError(f"pivots left the diagonal at shift {sigma:.6g}: no Sturm count there")
    return int(np.count_nonzero(factor.U.diagonal() < 0.0))


def scaled(K: csc_array, mass: FloatArray) -> csc_array:
    """M^-1/2 K M^-1/2 for a diagonal M."""
    root = diags_array(1.0 / np.sqrt(mass))
    return csc_array(root @ K @ root)


def gap_after(eigenvalues: FloatArray, count: int) -> tuple[int, float]:
    """The first clear gap at or after `count` eigenvalues: how many lie below it, and a shift inside it."""
    steps = np.diff(eigenvalues) / np.maximum(np.abs(eigenvalues[1:]), np.finfo(float).tiny)
    clear = np.flatnonzero(steps[count - 1 :] > 1e-7)
    if not len(clear):
        raise EigenError(f"no gap among eigenvalues {count} to {len(eigenvalues)}: ask for more modes")
    below = count + int(clear[0])
    return below, float(0.5 * (eigenvalues[below - 1] + eigenvalues[below]))


def solve_modes(K: csc_array, mass: FloatArray, count: int, shift: float, extra: int = 4) -> EigenResult:
    """Lowest `count` modes of K - omega^2 diag(mass), complete by a Sturm count.

    Parameters
    ----------
    K, mass
        Stiffness (free, free) and the diagonal of M (free,).
    count
        Modes wanted.
    shift
        Negative shift [rad^2/s^2], small beside the first elastic eigenvalue; makes free bodies solvable.
    extra
        Modes computed beyond `count`, so that the count ends in a gap.

    Raises
    ------
    CountError
        If more modes are asked for than there are.
    EigenError
        If the solver fails, or the count cannot be certified.
    """
    size = K.shape[0]
    if count < 1 or count + extra >= size:
        raise CountError(f"count must lie between 1 and {max(size - extra - 1, 1)}, found {count}")
    A = scaled(K, mass)
    factor = factorise(A - shift * eye_array(size, format="csc"))
    inverse = LinearOperator(A.shape, matvec=factor.solve, dtype=float)
    start = np.random.default_rng(START_SEED).standard_normal(size)
    wanted = count + extra
    for _ in range(3):  # a missed double mode shows in the count: look for more
        try:
            values, vectors = eigsh(A, min(wanted, size - 1), sigma=shift, OPinv=inverse, v0=start)
        except ArpackError as error:
            raise EigenError(f"ARPACK did not converge on {wanted} modes: {error}") from error
        order = np.argsort(values)
        values, vectors = values[order], vectors[:, order]
        below, sigma = gap_after(values, count)
        certified = sturm_count(A, sigma)
        if certified == below:
            break
        wanted += 2 * max(certified - below, 1) + extra
    else:
        raise EigenError(f"{certified} modes lie below {np.sqrt(sigma) / 2 / np.pi:.6g} Hz, {below} were found")
    vectors, values = vectors[:, :below], values[:below]
    norms = np.linalg.norm(A @ vectors - vectors * values, axis=0)
    return EigenResult(
        eigenvalues=values,
        vectors=vectors / np.sqrt(mass)[:, None],
        sturm_count=certified,
        residuals=norms / np.maximum(np.abs(values), abs(shift)),
    )
