"""K - omega^2 M, scaled by the diagonal of M so that numbers of unlike dofs compare."""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from scipy.sparse import csc_array

from casingfem.errors import NumericsError
from casingfem.io.arrays import Array, FloatArray
from casingfem.linalg.factor import Direct, factorise

Mass: TypeAlias = FloatArray | csc_array  # the diagonal of M, or M itself


@dataclass(frozen=True, slots=True, eq=False)
class Pencil:
    """A x = lambda B x with A = R K R, B = R M R, R = diag(M)^-1/2; B has a unit diagonal.

    A and B are symmetric, or Hermitian. `B` is None where M is diagonal; `scale` is the diagonal of R, (free,).
    phi = R x.
    """

    A: csc_array
    B: csc_array | None
    scale: FloatArray

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return len(self.scale)

    def shifted(self, sigma: float) -> csc_array:
        """A - sigma B."""
        if self.B is not None:
            return csc_array(self.A - sigma * self.B)
        shifted = self.A.copy()
        shifted.setdiag(self.A.diagonal() - sigma)
        return shifted

    def weigh(self, vectors: Array) -> Array:
        """B x."""
        return vectors if self.B is None else np.asarray(self.B @ vectors)

    def norm(self, vectors: Array) -> float:
        """The largest length of some vectors, |x|^2 = x^H B x."""
        return float(np.sqrt(np.einsum("ij,ij->j", vectors.conj(), self.weigh(vectors)).real.max()))

    def count_below(self, sigma: float, direct: Direct = "superlu") -> int:
        """Number of eigenvalues below sigma, by the inertia of A - sigma B.

        Raises
        ------
        NumericsError
            If sigma is an eigenvalue.
        """
        try:
            return factorise(self.shifted(sigma), direct).negative()
        except NumericsError as error:
            raise NumericsError(f"no Sturm count at shift {sigma:.6g}: {error}") from error

    def residuals(self, values: FloatArray, vectors: Array, floor: float) -> FloatArray:
        """|A x - lambda B x| / max(|lambda|, floor), (modes,)."""
        norms = np.linalg.norm(self.A @ vectors - self.weigh(vectors) * values, axis=0)
        return np.asarray(norms / np.maximum(np.abs(values), floor))


def scaled(K: csc_array, root: FloatArray) -> csc_array:
    """R K R for a diagonal R given by its entries; the pattern stays."""
    data = root[K.indices] * K.data * np.repeat(root, np.diff(K.indptr))
    return csc_array((data, K.indices, K.indptr), shape=K.shape)


def make_pencil(K: csc_array, mass: Mass) -> Pencil:
    """The scaled pencil of K (free, free) and M, given by its diagonal (free,) or as a sparse matrix.

    Raises
    ------
    NumericsError
        If the sizes do not fit, or the diagonal of M is not positive.

    >>> make_pencil(csc_array(np.diag([8.0, 2.0])), np.array([2.0, 1.0])).count_below(3.0)
    1
    >>> make_pencil(csc_array(np.diag([8.0, 2.0])), csc_array(np.array([[2.0, 0.5], [0.5, 1.0]]))).count_below(3.0)
    1
    """
    diagonal = mass if isinstance(mass, np.ndarray) else np.real(mass.diagonal())
    if diagonal.shape != (K.shape[0],):
        raise NumericsError(f"the mass is of {diagonal.shape[0]} unknowns, the stiffness of {K.shape[0]}")
    if not np.all(diagonal > 0.0):
        raise NumericsError(
            "the mass has a diagonal that is not positive: a density, a thickness or an element is wrong"
        )
    scale = 1.0 / np.sqrt(diagonal)
    return Pencil(A=scaled(K, scale), B=None if isinstance(mass, np.ndarray) else scaled(mass, scale), scale=scale)
