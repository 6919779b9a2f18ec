"""K - omega^2 M, scaled by the diagonal of M so that numbers of unlike dofs compare.

Unknowns without mass, such as nodes between two springs, are scaled by the diagonal of K: they follow the others
statically, A is definite on them, and neither counts nor modes see more of them.
"""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from scipy.sparse import csc_array, diags_array

from casingfem.errors import NumericsError
from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.linalg.element_sum import ElementSum
from casingfem.linalg.entries import Symmetric
from casingfem.linalg.factor import Direct, canonical, factorise
from casingfem.linalg.memory import MemoryNeedError

Mass: TypeAlias = FloatArray | csc_array  # the diagonal of M, or M itself


@dataclass(frozen=True, slots=True, eq=False)
class Pencil:
    """A x = lambda B x with A = R K R, B = R M R, R = diag(M)^-1/2; B has a unit diagonal, 0 where M has none.

    A and B are symmetric, or Hermitian; A may be a sum of elements. `B` is None where M is diagonal; `scale` is the
    diagonal of R, (free,). phi = R x. A's pattern holds that of B, the entries of which stand at `places` in A's data.
    `massless` counts unknowns without mass.
    """

    A: Symmetric
    B: csc_array | None
    scale: FloatArray
    places: IntArray
    massless: int = 0

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return len(self.scale)

    @property
    def modes(self) -> int:
        """Most modes that it can have: its unknowns with mass."""
        return self.size - self.massless

    def shifted(self, sigma: float) -> Symmetric:
        """A - sigma B, of A's pattern."""
        if isinstance(self.A, ElementSum):
            return self.A.plus(-sigma)
        data = self.A.data.copy()
        data[self.places] -= sigma if self.B is None else sigma * self.B.data
        return csc_array((data, self.A.indices, self.A.indptr), shape=self.A.shape)

    def weigh(self, vectors: Array) -> Array:
        """B x."""
        return vectors if self.B is None else np.asarray(self.B @ vectors)

    def norm(self, vectors: Array) -> float:
        """The largest length of some vectors, |x|^2 = x^H B x."""
        return float(np.sqrt(np.einsum("ij,ij->j", vectors.conj(), self.weigh(vectors)).real.max()))

    def count_below(self, sigma: float, direct: Direct = "multifrontal") -> int:
        """Number of eigenvalues below sigma, by the inertia of A - sigma B.

        Raises
        ------
        NumericsError
            If sigma is an eigenvalue, or memory is too small.
        """
        try:
            return factorise(self.shifted(sigma), direct, keep=False).negative()
        except MemoryNeedError:
            raise
        except NumericsError as error:
            raise NumericsError(f"no Sturm count at shift {sigma:.6g}: {error}") from error

    def residuals(self, values: FloatArray, vectors: Array, floor: float) -> FloatArray:
        """|A x - lambda B x| / max(|lambda|, floor), (modes,)."""
        norms = np.linalg.norm(self.A @ vectors - self.weigh(vectors) * values, axis=0)
        return np.asarray(norms / np.maximum(np.abs(values), floor))


def places_in(K: csc_array, M: csc_array | None) -> IntArray:
    """Numbers of M's entries, the diagonal's if it is None, in the data of K; without those that K does not have."""
    if M is None:
        return np.flatnonzero(K.indices == np.repeat(np.arange(K.shape[0], dtype=K.indices.dtype), np.diff(K.indptr)))
    numbers = csc_array((np.arange(1, len(K.data) + 1), K.indices, K.indptr), shape=K.shape)
    pattern = csc_array((np.ones(len(M.data), dtype=int), M.indices, M.indptr), shape=K.shape)
    return np.asarray(numbers.multiply(pattern).tocsc().data - 1)


def widened(K: csc_array, M: csc_array) -> csc_array:
    """K with zeros where M alone has entries.

    >>> widened(csc_array(np.diag([1j, 2.0])), csc_array(np.eye(2)[::-1])).data.tolist()
    [1j, 0j, 0j, (2+0j)]
    """
    one, other = (csc_array((np.ones(len(A.data)), A.indices, A.indptr), shape=K.shape) for A in (K, M))
    both = csc_array(one + other)
    data = np.zeros(len(both.data), dtype=K.dtype)
    data[places_in(both, K)] = K.data
    return csc_array((data, both.indices, both.indptr), shape=K.shape)


def scaled(K: csc_array, root: FloatArray) -> csc_array:
    """R K R for a diagonal R given by its entries; the pattern stays."""
    data = root[K.indices] * K.data * np.repeat(root, np.diff(K.indptr))
    return csc_array((data, K.indices, K.indptr), shape=K.shape)


def make_pencil(K: Symmetric, mass: Mass) -> Pencil:
    """The scaled pencil of K (free, free) and M, given by its diagonal (free,) or as a sparse matrix.

    A sum of elements takes a diagonal.

    Raises
    ------
    NumericsError
        If the sizes do not fit, or the diagonal of M is not positive: of a sparse M it may be 0 where K's is not.

    >>> make_pencil(csc_array(np.diag([8.0, 2.0])), np.array([2.0, 1.0])).count_below(3.0)
    1
    >>> make_pencil(csc_array(np.diag([8.0, 2.0])), csc_array(np.array([[2.0, 0.5], [0.5, 1.0]]))).count_below(3.0)
    1
    """
    diagonal = mass if isinstance(mass, np.ndarray) else np.real(mass.diagonal())
    if diagonal.shape != (K.shape[0],):
        raise NumericsError(f"the mass is of {diagonal.shape[0]} unknowns, the stiffness of {K.shape[0]}")
    bare = np.zeros(len(diagonal), dtype=bool)
    if not isinstance(mass, np.ndarray) and not isinstance(K, ElementSum):
        bare = (diagonal == 0.0) & (np.real(K.diagonal()) > 0.0)
    if not np.all((diagonal > 0.0) | bare):
        raise NumericsError(
            "the mass has a diagonal that is not positive: a density, a thickness or an element is wrong"
        )
    M = None if isinstance(mass, np.ndarray) else mass
    if isinstance(K, ElementSum):
        assert M is None
        scale = 1.0 / np.sqrt(diagonal)
        return Pencil(A=K.scaled(scale), B=None, scale=scale, places=np.zeros(0, dtype=np.int64))
    K, M = canonical(K), None if M is None else canonical(M)  # places are those of entries in order
    places = places_in(K, M)
    if len(places) != (K.shape[0] if M is None else len(M.data)):
        K = widened(K, csc_array(diags_array(diagonal)) if M is None else M)
        places = places_in(K, M)
    if bare.any():  # as stiff as the others, scaled
        stiff = np.real(K.diagonal())
        diagonal = np.where(bare, stiff / np.median(stiff[~bare] / diagonal[~bare]), diagonal)
    scale, massless = 1.0 / np.sqrt(diagonal), int(np.count_nonzero(bare))
    B = None if M is None else scaled(M, scale)
    return Pencil(A=scaled(K, scale), B=B, scale=scale, places=places, massless=massless)
