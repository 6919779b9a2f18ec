"""What a Sturm count is worth: nothing where round-off outweighs what parts the eigenvalues on both sides of it.

An inertia is exact for a matrix some units in the last place from K - sigma M. That moves an eigenvalue by up to
u |x|^T |K| |x|, whatever the order of the sums: on slender or thin structures, whose K holds stretching beside a
bending that is many orders softer, more than the lowest eigenvalues amount to. There the count changes with the
processor, and so do the modes; equal or not, they prove nothing.
"""

import numpy as np

from casingfem.errors import warn
from casingfem.io.arrays import Array, FloatArray
from casingfem.linalg.entries import Symmetric

UNIT = float(np.finfo(float).eps)


def round_off(K: Symmetric | FloatArray, vectors: Array) -> FloatArray:
    """How far round-off in the entries of K moves the eigenvalues of mass-normalised vectors (n, k): (k,).

    >>> float(round_off(np.array([[1.0, -1.0], [-1.0, 1.0]]), np.array([[0.5], [0.5]]))[0]) / UNIT
    1.0
    """
    size = np.abs(vectors)
    return np.asarray(UNIT * np.einsum("ij,ij->j", size, abs(K) @ size))


def most_round_off(K: Symmetric | FloatArray, vectors: FloatArray) -> FloatArray:
    """A bound on `round_off`, for the price of one product: 2 |x_i K_ij x_j| <= |K_ij| (x_i^2 + x_j^2).

    >>> K, x = np.array([[2.0, -1.0], [-1.0, 1.0]]), np.array([[0.8], [0.6]])
    >>> bool(round_off(K, x) <= most_round_off(K, x) < 1.1 * round_off(K, x))
    True
    """
    sums = abs(K) @ np.ones(len(vectors))
    return np.asarray(UNIT * (sums @ vectors**2))


def clear_of_eigenvalues(place: float, values: FloatArray, noise: FloatArray) -> bool:
    """Whether a place on the axis of eigenvalues is farther from each than round-off moves it."""
    return bool(np.all(np.abs(values - place) > noise))


def warn_of_count(place: float, values: FloatArray, noise: FloatArray) -> None:
    """Say that eigenvalues near a place [rad^2/s^2] cannot be counted, and how far round-off moves them."""
    nearest = int(np.argmin(np.abs(values - place)))
    base = max(place, 0.0)
    freq, moves = np.sqrt(base) / 2 / np.pi, (np.sqrt(base + noise[nearest]) - np.sqrt(base)) / 2 / np.pi
    found = f"those below {freq:.4g} Hz cannot be counted, round-off moves the next by {moves:.2g} Hz"
    warn("modes-round-off", f"modes: {found}", stacklevel=7)
