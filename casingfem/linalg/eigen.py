"""Modes of K phi = omega^2 M phi, lowest or in a band: shift-invert block Lanczos, verified by Sturm counts."""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from casingfem.errors import NumericsError, sentence
from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.linalg.entries import Symmetric
from casingfem.linalg.factor import Direct, Factor, factorise
from casingfem.linalg.krylov import BLOCKS, ConvergenceError, nearest
from casingfem.linalg.memory import require_affordable
from casingfem.linalg.pencil import (
    Mass,
    Pencil,
    clear_of_eigenvalues,
    make_pencil,
    most_round_off,
    round_off,
    warn_of_count,
)
from casingfem.linalg.slicing import CLEAR, CLEARER, slices
from contact.io.threads import with_one_thread

Band: TypeAlias = tuple[float, float]


class CountError(NumericsError, ValueError):
    """More modes were requested than the model has."""


@dataclass(frozen=True, slots=True, eq=False)
class EigenResult:
    """Eigenvalues [rad^2/s^2] ascending, mass-normalised vectors (free, modes), and the verification.

    `sturm_count` is the number of eigenvalues below the last one returned (including its double), for a band the number
    inside it, counted by the inertia of factorisations. It is None if that was too large or round-off is too large for
    a count. `products` is the number of vectors that the factors solved for. `factor` is that of the scaled problem
    near 0, if a number of modes was requested.
    """

    eigenvalues: FloatArray
    vectors: Array
    sturm_count: int | None
    products: int
    factor: Factor | None = None

    @property
    def freq(self) -> FloatArray:
        """Frequencies [Hz]; values that round-off makes negative are zero."""
        return np.asarray(np.sqrt(np.maximum(self.eigenvalues, 0.0)) / (2.0 * np.pi))


def sturm_count(K: Symmetric, mass: Mass, sigma: float) -> int:
    """Number of eigenvalues of K - omega^2 M below sigma [rad^2/s^2], by one factorisation and its inertia.

    >>> from scipy.sparse import csc_array
    >>> sturm_count(csc_array(np.diag([1.0, 2.0, 3.0])), np.ones(3), 2.5)
    2
    """
    return make_pencil(K, mass).count_below(sigma)


def solve(K: Symmetric, mass: Mass, wanted: int | Band, shift: float, direct: Direct = "multifrontal") -> EigenResult:
    """A number of modes (`solve_modes`), or the modes of a band [Hz] (`solve_band`)."""
    if isinstance(wanted, int):
        return solve_modes(K, mass, wanted, shift=shift, direct=direct)
    low, high = ((2.0 * np.pi * end) ** 2 for end in wanted)
    return solve_band(K, mass, (low, high), shift=shift, direct=direct)


def gaps(eigenvalues: FloatArray, count: int, floor: float, clear: float) -> IntArray:
    """Eigenvalues from number `count` on that a clear gap follows, numbered from there.

    Eigenvalues below `floor` are zero up to round-off; their distances are compared with the floor.
    """
    return np.flatnonzero(np.diff(eigenvalues)[count - 1 :] > clear * np.maximum(eigenvalues[count:], floor))


def gap_after(
    eigenvalues: FloatArray, count: int, floor: float = 0.0, clear: float = CLEAR, noise: float = 0.0
) -> tuple[int, float]:
    """The first clear gap at or after `count` eigenvalues: the number below it, and a shift inside it.

    Gaps whose middle is farther than `noise` from both sides come before others.
    """
    found = gaps(eigenvalues, count, floor, clear)
    if not len(found):
        raise NumericsError(f"found no gap between eigenvalues {count} and {len(eigenvalues)}: ask for more modes")
    wide = found[np.diff(eigenvalues)[count - 1 :][found] > 2.0 * noise]
    found = wide if len(wide) else found
    below = count + int(found[0])
    return below, float(0.5 * (eigenvalues[below - 1] + eigenvalues[below]))


@with_one_thread
def solve_modes(
    K: Symmetric, mass: Mass, count: int, shift: float, extra: int = 4, direct: Direct = "multifrontal"
) -> EigenResult:
    """Lowest `count` modes of K - omega^2 M, complete by a Sturm count.

    Parameters
    ----------
    K, mass
        Stiffness (free, free), symmetric or Hermitian; the diagonal of M (free,), or M itself, positive definite except
        on unknowns without mass, on which K must be.
    count
        Number of modes.
    shift
        Negative shift [rad^2/s^2], small compared with the first elastic eigenvalue; makes free bodies solvable.
    extra
        Modes computed beyond `count`, so that the count ends in a gap.
    direct
        Kind of factorisation, as in `factorise`.

    Raises
    ------
    CountError
        If more modes are requested than exist.
    NumericsError
        If the solver fails, or the count shows that modes are missing.

    Warns
    -----
    ModelWarning
        `modes-round-off` if no count is possible.
    """
    pencil = make_pencil(K, mass)
    size = pencil.modes
    if not 1 <= count <= size:
        raise CountError(sentence("modes-count", f"count must lie between 1 and {size}, found {count}"))
    require_affordable(count, size)
    for step in (1.0, 1e2, 1e4):  # a shift too close to rigid motions drowns the elastic modes in their round-off
        try:
            return solve_from(pencil, count, step * shift, extra, direct)
        except ConvergenceError as error:
            failed = error
    raise failed


def solve_from(pencil: Pencil, count: int, shift: float, extra: int, direct: Direct) -> EigenResult:
    """`solve_modes` for a scaled pencil from one shift."""
    factor = factorise(pencil.shifted(shift), direct)
    wanted, products = count + extra, 0
    tries = list(zip(BLOCKS, CLEARER, strict=True))
    while tries:
        block, clear = tries[0]
        found = nearest(pencil, factor.solve, shift, min(wanted, pencil.modes), block, extra)
        products += found.products
        order = np.argsort(found.values)
        values, vectors = found.values[order], found.vectors[:, order]
        if len(values) == pencil.modes:  # orthonormal, so these are all
            return result(pencil, values, vectors, pencil.modes, products, factor)
        if not gaps(values, count, abs(shift), clear).size and wanted < pencil.modes:
            wanted += 2 * extra + 1  # a cluster goes on
            continue
        noise = most_round_off(pencil.A, vectors)
        noise[count - 1 :] = round_off(pencil.A, vectors[:, count - 1 :])
        below, sigma = gap_after(values, count, abs(shift), clear, noise[count - 1 :].max())
        near = np.abs(values - sigma) <= noise
        if np.any(near):
            noise[near] = round_off(pencil.A, vectors[:, near])
        certified = pencil.count_below(sigma, direct) if clear_of_eigenvalues(sigma, values, noise) else None
        if certified == below:
            return result(pencil, values[:below], vectors[:, :below], certified, products, factor)
        wanted += 2 * max((certified or 0) - below, 1) + extra
        tries.pop(0)  # a missed mode shows in the count: search again, with more vectors at once, in a wider gap
    if certified is None:
        warn_of_count(sigma, values, noise)
        return result(pencil, values[:below], vectors[:, :below], None, products, factor)
    raise NumericsError(f"{certified} modes lie below {np.sqrt(sigma) / 2 / np.pi:.6g} Hz, {below} were found")


@with_one_thread
def solve_band(K: Symmetric, mass: Mass, band: Band, shift: float, direct: Direct = "multifrontal") -> EigenResult:
    """Every mode with omega^2 in a band [rad^2/s^2], certified by Sturm counts at its ends.

    A mode on an end of the band, to a relative 1e-7, belongs to it, as does its double. A band with many modes is cut
    into slices with a shift each.

    Parameters
    ----------
    K, mass, direct
        As in `solve_modes`.
    band
        Lower and upper end; a lower end of 0 includes the rigid motions.
    shift
        Negative shift that replaces a lower end of 0.

    Raises
    ------
    NumericsError
        If the number of modes found in a slice differs from its count.

    Warns
    -----
    ModelWarning
        `modes-round-off` if no count is possible.
    """
    low, high = band
    if not 0.0 <= low < high < np.inf:
        raise NumericsError(f"band: found {low:.6g} to {high:.6g}, expected 0 <= from < to")
    pencil = make_pencil(K, mass)
    parts = list(slices(pencil, low, high, shift, direct))
    values = np.concatenate([part.values for part in parts])
    vectors = np.hstack([part.vectors for part in parts])
    products = sum(part.products for part in parts)
    counted = len(values) if all(part.counted for part in parts) else None
    return result(pencil, values, vectors, counted, products, None)


def result(
    pencil: Pencil, values: FloatArray, vectors: Array, certified: int | None, products: int, factor: Factor | None
) -> EigenResult:
    """Verified pairs of the scaled pencil as modes of K and M."""
    return EigenResult(values, vectors * pencil.scale[:, None], certified, products, factor)
