"""Lowest modes of K phi = omega^2 M phi: shift-invert Lanczos, certified by a Sturm count."""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array
from scipy.sparse.linalg import ArpackError, LinearOperator, eigsh

from casingfem.arrays import FloatArray
from casingfem.modal.pencil import Mass, make_pencil
from casingfem.structure.factor import EigenError, factorise

__all__ = ["CountError", "EigenError", "EigenResult", "factorise", "gap_after", "solve_modes", "sturm_count"]

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


def sturm_count(K: csc_array, mass: Mass, sigma: float) -> int:
    """Number of eigenvalues of K - omega^2 M below sigma [rad^2/s^2], by one factorisation and its inertia.

    >>> sturm_count(csc_array(np.diag([1.0, 2.0, 3.0])), np.ones(3), 2.5)
    2
    """
    return make_pencil(K, mass).count_below(sigma)


def gap_after(eigenvalues: FloatArray, count: int) -> tuple[int, float]:
    """The first clear gap at or after `count` eigenvalues: how many lie below it, and a shift inside it."""
    steps = np.diff(eigenvalues) / np.maximum(np.abs(eigenvalues[1:]), np.finfo(float).tiny)
    clear = np.flatnonzero(steps[count - 1 :] > 1e-7)
    if not len(clear):
        raise EigenError(f"no gap among eigenvalues {count} to {len(eigenvalues)}: ask for more modes")
    below = count + int(clear[0])
    return below, float(0.5 * (eigenvalues[below - 1] + eigenvalues[below]))


def solve_modes(K: csc_array, mass: Mass, count: int, shift: float, extra: int = 4) -> EigenResult:
    """Lowest `count` modes of K - omega^2 M, complete by a Sturm count.

    Parameters
    ----------
    K, mass
        Stiffness (free, free); the diagonal of M (free,), or M itself, sparse and positive definite.
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
    pencil = make_pencil(K, mass)
    factor = factorise(pencil.shifted(shift))
    inverse = LinearOperator(K.shape, matvec=factor.solve, dtype=float)
    start = np.random.default_rng(START_SEED).standard_normal(size)
    wanted = count + extra
    for _ in range(3):  # a missed double mode shows in the count: look for more
        try:
            values, vectors = eigsh(pencil.A, min(wanted, size - 1), M=pencil.B, sigma=shift, OPinv=inverse, v0=start)
        except ArpackError as error:
            raise EigenError(f"ARPACK did not converge on {wanted} modes: {error}") from error
        order = np.argsort(values)
        values, vectors = values[order], vectors[:, order]
        below, sigma = gap_after(values, count)
        certified = pencil.count_below(sigma)
        if certified == below:
            break
        wanted += 2 * max(certified - below, 1) + extra
    else:
        raise EigenError(f"{certified} modes lie below {np.sqrt(sigma) / 2 / np.pi:.6g} Hz, {below} were found")
    vectors, values = vectors[:, :below], values[:below]
    return EigenResult(
        eigenvalues=values,
        vectors=vectors * pencil.scale[:, None],
        sturm_count=certified,
        residuals=pencil.residuals(values, vectors, abs(shift)),
    )
