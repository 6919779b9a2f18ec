"""A symmetric matrix stored as the dense matrices of its elements; the sum is never assembled.

    A = R (sum over elements of P_e^T A_e P_e) R + diag(d),   P_e selects the element's unknowns, R is diagonal

Elements of high order have half of their unknowns inside: their dense matrices are smaller than the sum with its
indices, a dense front uses them directly (`fronts`), and products with several vectors run at the speed of dgemm.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from scipy.sparse import coo_array, csc_array, csr_array, diags_array

from casingfem.io.arrays import BoolArray, FloatArray, IntArray

CHUNK = 200_000  # entries of elements' matrices taken together: what stays in a core's cache


@dataclass(frozen=True, slots=True, eq=False)
class Elements:
    """Symmetric matrices (elements, m, m) of elements with m unknowns each, with indices `dofs` (elements, m).

    A fixed unknown has the index "number of unknowns".
    """

    dofs: IntArray
    matrices: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class ElementSum:
    """Groups of elements over `size` unknowns; `scale` is the diagonal of R, `diagonal` is d, both (size,)."""

    groups: tuple[Elements, ...]
    size: int
    scale: FloatArray
    diagonal: FloatArray

    @classmethod
    def of(cls, groups: Sequence[Elements], size: int) -> Self:
        """The plain sum of elements.

        >>> two = Elements(np.array([[0, 1], [1, 2]]), np.full((2, 2, 2), 3.0))
        >>> (ElementSum.of([two], 2) @ np.eye(2)).tolist()
        [[3.0, 3.0], [3.0, 6.0]]
        """
        return cls(tuple(groups), size, np.ones(size), np.zeros(size))

    @property
    def shape(self) -> tuple[int, int]:
        """Shape of the matrix."""
        return self.size, self.size

    @property
    def dtype(self) -> np.dtype[np.float64]:
        """Type of its numbers."""
        return self.scale.dtype

    @property
    def pattern(self) -> tuple[IntArray, ...]:
        """The data that determine the sparsity pattern."""
        return tuple(group.dofs for group in self.groups)

    @property
    def numbers(self) -> tuple[FloatArray, ...]:
        """The data that determine the entries: R, d and the matrices of the elements."""
        return self.scale, self.diagonal, *(group.matrices for group in self.groups)

    @property
    def finite(self) -> bool:
        """Whether all numbers are finite."""
        return all(bool(np.isfinite(part.sum()) or np.isfinite(part).all()) for part in self.numbers)  # without a copy

    def scaled(self, root: FloatArray) -> "ElementSum":
        """R A R for a diagonal R given by its entries; the elements' matrices are shared."""
        return replace(self, scale=root * self.scale, diagonal=root**2 * self.diagonal)

    def plus(self, diagonal: FloatArray | float) -> "ElementSum":
        """A + diag(d); the elements' matrices are shared."""
        return replace(self, diagonal=self.diagonal + diagonal)

    def changed(self, T: csc_array) -> "ElementSum":
        """T^T A T of a plain sum, with T (size, size) the identity except for small groups of unknowns.

        An element with some unknowns of a group gets all of them; the matrices of other elements are shared.

        >>> two = Elements(np.array([[0, 1], [1, 2]]), np.full((2, 2, 2), 3.0))
        >>> T = csc_array(np.array([[1.0, 0.0, 2.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
        >>> (ElementSum.of([two], 3).changed(T) @ np.eye(3))[2].tolist()
        [6.0, 9.0, 15.0]
        """
        rows = T.tocsr()
        other = csr_array(rows - diags_array(np.ones(self.size)))
        other.eliminate_zeros()
        moved = np.append(np.diff(other.indptr) > 0, False)
        groups = []
        for group in self.groups:
            touched = np.flatnonzero(moved[group.dofs].any(axis=1))
            if len(touched):
                dofs = group.dofs.copy()
                dofs[touched] = self.size
                groups.append(replace(group, dofs=dofs))
                groups.extend(within(group, touched, moved, rows))
            else:
                groups.append(group)
        return replace(self, groups=tuple(groups))

    def __matmul__(self, x: FloatArray) -> FloatArray:
        """A x, for one vector (size,) or several columns (size, k)."""
        return summed(self, x, np.matmul)

    def __abs__(self) -> "AbsoluteSum":
        """A bound on the absolute values of the entries: the sum of those of the elements and of the diagonal."""
        return AbsoluteSum(self)

    def tocsc(self) -> csc_array:
        """The assembled matrix in CSC form."""
        total = csc_array(diags_array(self.diagonal))
        for group in self.groups:
            free = group.dofs < self.size
            kept = free[:, :, None] & free[:, None, :]
            rows, columns = np.broadcast_arrays(group.dofs[:, :, None], group.dofs[:, None, :])
            at = rows[kept].astype(np.int32), columns[kept].astype(np.int32)
            entries = group.matrices[kept] * self.scale[at[0]] * self.scale[at[1]]
            total = total + coo_array((entries, at), shape=self.shape).tocsc()
        return csc_array(total)


@dataclass(frozen=True, slots=True, eq=False)
class AbsoluteSum:
    """Sum of the absolute values of a sum's parts, which is never stored, only multiplied."""

    of: ElementSum

    def __matmul__(self, x: FloatArray) -> FloatArray:
        """|A| x, for one vector (size,) or several columns (size, k)."""
        return summed(replace(self.of, scale=np.abs(self.of.scale), diagonal=np.abs(self.of.diagonal)), x, absolute)


def within(group: Elements, numbers: IntArray, moved: BoolArray, T: csr_array) -> list[Elements]:
    """T^T A T of some elements of a group, those of one size together.

    Only the rows `moved` of T differ from the identity.
    """
    found: dict[int, list[tuple[IntArray, FloatArray]]] = {}
    for e in numbers.tolist():
        dofs, A = group.dofs[e], group.matrices[e]
        at = np.flatnonzero(moved[dofs])
        part = T[dofs[at]]
        into = np.unique(part.indices)
        more = np.setdiff1d(into, dofs)
        whole = np.append(dofs, more)
        order = np.argsort(whole, kind="stable")
        to = order[np.searchsorted(whole, into, sorter=order)]
        change = part[:, into].toarray()
        B = np.zeros((len(whole), len(whole)))
        B[: len(dofs), : len(dofs)] = A
        B[at] = 0.0
        B[to] += change.T @ np.pad(A[at], ((0, 0), (0, len(more))))
        columns = B[:, at].copy()
        B[:, at] = 0.0
        B[:, to] += columns @ change
        found.setdefault(len(whole), []).append((whole, B))
    return [Elements(*(np.stack(part) for part in zip(*same, strict=True))) for same in found.values()]


def absolute(matrices: FloatArray, x: FloatArray) -> FloatArray:
    """|A| x of stacked matrices (elements, m, m) and columns (elements, m, k), some elements at a time."""
    found = np.empty((*matrices.shape[:2], x.shape[2]))
    step = max(1, CHUNK // max(1, matrices[:1].size))
    for low in range(0, len(matrices), step):
        own = slice(low, low + step)
        np.matmul(np.abs(matrices[own]), x[own], out=found[own])
    return found


def summed(A: ElementSum, x: FloatArray, product: Callable[[FloatArray, FloatArray], FloatArray]) -> FloatArray:
    """A x, with the element matrices multiplied by `product`."""
    columns = x.reshape(A.size, -1)
    padded = np.zeros((A.size + 1, columns.shape[1]))
    np.multiply(A.scale[:, None], columns, out=padded[:-1])
    sums = np.zeros_like(padded)
    for group in A.groups:
        count = group.dofs.size
        local = product(group.matrices, padded[group.dofs]).reshape(count, columns.shape[1])
        ones = np.ones(count), group.dofs.ravel(), np.arange(count + 1)  # one in each column: nothing to sort
        sums += csc_array(ones, (A.size + 1, count)) @ local
    return np.asarray((A.scale[:, None] * sums[:-1] + A.diagonal[:, None] * columns).reshape(x.shape))
