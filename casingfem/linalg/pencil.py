"""K - omega^2 M, scaled by the diagonal of M so that dofs are comparable, and the reliability of its Sturm count.

Unknowns without mass, such as nodes between two springs, are scaled by the diagonal of K: they follow the others
statically, A is definite on them, and they affect neither counts nor modes.

A count is unreliable if round-off exceeds the distance of the eigenvalues on both sides of it. An inertia is exact for
a matrix that differs from K - sigma M by some units in the last place, which moves an eigenvalue by up to u |x|^T |K|
|x|. In slender or thin structures stretching is many orders stiffer than bending, so this can exceed the lowest
eigenvalues. Then the count depends on the processor, and so do the modes; agreement proves nothing.
"""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from scipy.sparse import coo_array, csc_array, diags_array
from scipy.sparse.csgraph import connected_components

from casingfem.errors import NumericsError, warn
from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.linalg.element_sum import ElementSum
from casingfem.linalg.entries import Symmetric
from casingfem.linalg.factor import Direct, canonical, factorise
from casingfem.linalg.memory import MemoryNeedError

Mass: TypeAlias = FloatArray | csc_array  # the diagonal of M, or M itself
UNIT = float(np.finfo(float).eps)


@dataclass(frozen=True, slots=True, eq=False)
class Pencil:
    """A x = lambda B x with A = R K R, B = R M R, R = diag(M)^-1/2; B has a unit diagonal, 0 where M has none.

    A and B are symmetric, or Hermitian; A may be a sum of elements. `B` is None if M is diagonal; `scale` is the
    diagonal of R, (free,). phi = R x. A's pattern contains that of B, whose entries are at `places` in A's data.
    `massless` is the number of unknowns without mass.
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
        """Largest possible number of modes: its unknowns with mass."""
        return self.size - self.massless

    def shifted(self, sigma: float) -> Symmetric:
        """A - sigma B, with A's pattern."""
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
    """Indices into `K.data` of the entries of M (of the diagonal if M is None). Entries absent from K are skipped."""
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
    """R K R for a diagonal R given by its entries, with unchanged pattern."""
    data = root[K.indices] * K.data * np.repeat(root, np.diff(K.indptr))
    return csc_array((data, K.indices, K.indptr), shape=K.shape)


def make_pencil(K: Symmetric, mass: Mass) -> Pencil:
    """The scaled pencil of K (free, free) and M, given by its diagonal (free,) or as a sparse matrix.

    With a sum of elements, M must be diagonal.

    Raises
    ------
    NumericsError
        If the sizes do not fit, or the diagonal of M is not positive; with a sparse M it may be 0 where K's is
        positive.

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
        found = "the mass has a diagonal that is not positive: a density, a thickness or an element is wrong"
        raise NumericsError(found)
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


def diagonalised(M: csc_array) -> tuple[FloatArray, csc_array]:
    """Diagonal of T^T M T, and the change of dofs T (size, size), which is the identity where M couples nothing.

    Rings off their edge and masses between nodes couple some dofs in M. Each group of coupled dofs is replaced by
    combinations of them, x = T y with T = D^-1/2 S^-1/2 D^1/2, D the group's diagonal and S = D^-1/2 M D^-1/2 (Loewdin,
    J. Chem. Phys. 18, 1950, 365: the smallest of all such changes), so that T^T M T = D.

    Raises
    ------
    ValueError
        If M is not positive.

    >>> M = csc_array(np.array([[2.0, 0.5, 0.0], [0.5, 1.0, 0.0], [0.0, 0.0, 3.0]]))
    >>> mass, T = diagonalised(M)
    >>> bool(abs(T.T @ M @ T - diags_array(mass)).max() < 1e-14)
    True
    """
    mass = M.diagonal()
    if not np.all(mass > 0.0):
        raise ValueError("the mass matrix is not positive: a dof without mass")
    coupled = csc_array(M - diags_array(mass))
    coupled.eliminate_zeros()
    _, group = connected_components(coupled, directed=False)
    count = np.bincount(group)
    order = np.argsort(group, kind="stable")
    place = np.empty(len(mass), dtype=np.int64)  # of a dof in its group
    place[order] = np.arange(len(mass)) - np.repeat(np.cumsum(count) - count, count)
    entries = M.tocoo()
    alone = np.flatnonzero(count[group] == 1)
    rows, columns, values = [alone], [alone], [np.ones(len(alone))]
    for size in np.unique(count[count > 1]).tolist():  # groups of one size together
        parts = order[count[group[order]] == size].reshape(-1, size)
        number = np.full(len(count), -1)
        number[group[parts[:, 0]]] = np.arange(len(parts))
        own = number[group[entries.row]] >= 0
        i, j = entries.row[own], entries.col[own]
        root = np.sqrt(mass[parts])
        S = np.zeros((len(parts), size, size))
        S[number[group[i]], place[i], place[j]] = entries.data[own] / np.sqrt(mass[i] * mass[j])
        squares, turn = np.linalg.eigh(S)
        if squares.min() <= 0.0:
            raise ValueError("the mass matrix is not positive")
        T = (turn / np.sqrt(squares)[:, None]) @ turn.swapaxes(1, 2) / root[:, :, None] * root[:, None]
        i, j = np.broadcast_arrays(parts[:, :, None], parts[:, None, :])
        rows.append(i.ravel())
        columns.append(j.ravel())
        values.append(T.ravel())
    places = (np.concatenate(rows), np.concatenate(columns))
    return mass, coo_array((np.concatenate(values), places), shape=M.shape).tocsc()


def round_off(K: Symmetric | FloatArray, vectors: Array) -> FloatArray:
    """Change of the eigenvalues of mass-normalised vectors (n, k) by round-off in the entries of K: (k,).

    >>> float(round_off(np.array([[1.0, -1.0], [-1.0, 1.0]]), np.array([[0.5], [0.5]]))[0]) / UNIT
    1.0
    """
    size = np.abs(vectors)
    return np.asarray(UNIT * np.einsum("ij,ij->j", size, abs(K) @ size))


def most_round_off(K: Symmetric | FloatArray, vectors: FloatArray) -> FloatArray:
    """A bound on `round_off`, at the cost of one product: 2 |x_i K_ij x_j| <= |K_ij| (x_i^2 + x_j^2).

    >>> K, x = np.array([[2.0, -1.0], [-1.0, 1.0]]), np.array([[0.8], [0.6]])
    >>> bool(round_off(K, x) <= most_round_off(K, x) < 1.1 * round_off(K, x))
    True
    """
    sums = abs(K) @ np.ones(len(vectors))
    return np.asarray(UNIT * (sums @ vectors**2))


def clear_of_eigenvalues(place: float, values: FloatArray, noise: FloatArray) -> bool:
    """Whether a position on the axis of eigenvalues is farther from each than round-off moves it.

    >>> values, noise = np.array([1.0, 2.0]), np.array([1e-9, 1e-9])
    >>> clear_of_eigenvalues(2.0 + 1e-12, values, noise), clear_of_eigenvalues(2.0 + 1e-6, values, noise)
    (False, True)
    """
    return bool(np.all(np.abs(values - place) > noise))


def warn_of_count(place: float, values: FloatArray, noise: FloatArray) -> None:
    """Warn that eigenvalues near a position [rad^2/s^2] cannot be counted, and state how far round-off moves them."""
    nearest = int(np.argmin(np.abs(values - place)))
    base = max(place, 0.0)
    freq, moves = np.sqrt(base) / 2 / np.pi, (np.sqrt(base + noise[nearest]) - np.sqrt(base)) / 2 / np.pi
    found = f"those below {freq:.4g} Hz cannot be counted, round-off moves the next by {moves:.2g} Hz"
    warn("modes-round-off", f"modes: {found}", stacklevel=7)
