"""A symmetric matrix kept as the dense matrices of its elements: what assembly adds up is never added up.

    A = R (sum over elements of P_e^T A_e P_e) R + diag(d),   P_e picks the element's unknowns, R is diagonal

Elements of high order have half of their unknowns inside: their dense matrices are smaller than the sum with its
indices, a dense front takes them as they are (`fronts`), and products with several vectors run at the speed of dgemm.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from scipy.sparse import coo_array, csc_array, diags_array

from casingfem.io.arrays import FloatArray, IntArray

CHUNK = 200_000  # entries of elements' matrices taken together: what stays in a core's cache


@dataclass(frozen=True, slots=True, eq=False)
class Elements:
    """Symmetric matrices (elements, m, m) of elements with m unknowns each, whose numbers are `dofs` (elements, m).

    An unknown that is held has the number of all unknowns.
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
        """The plain sum.

        >>> two = Elements(np.array([[0, 1], [1, 2]]), np.full((2, 2, 2), 3.0))
        >>> (ElementSum.of([two], 2) @ np.eye(2)).tolist()
        [[3.0, 3.0], [3.0, 6.0]]
        """
        return cls(tuple(groups), size, np.ones(size), np.zeros(size))

    @property
    def shape(self) -> tuple[int, int]:
        """Of the matrix."""
        return self.size, self.size

    @property
    def dtype(self) -> np.dtype[np.float64]:
        """Of its numbers."""
        return self.scale.dtype

    @property
    def pattern(self) -> tuple[IntArray, ...]:
        """What its sparsity depends on."""
        return tuple(group.dofs for group in self.groups)

    @property
    def finite(self) -> bool:
        """Whether all numbers are."""
        parts = (self.scale, self.diagonal, *(group.matrices for group in self.groups))
        return all(bool(np.isfinite(part.sum()) or np.isfinite(part).all()) for part in parts)  # a sum takes no memory

    def scaled(self, root: FloatArray) -> "ElementSum":
        """R A R for a diagonal R given by its entries; the elements' matrices are shared."""
        return replace(self, scale=root * self.scale, diagonal=root**2 * self.diagonal)

    def plus(self, diagonal: FloatArray | float) -> "ElementSum":
        """A + diag(d); the elements' matrices are shared."""
        return replace(self, diagonal=self.diagonal + diagonal)

    def __matmul__(self, x: FloatArray) -> FloatArray:
        """A x, for one vector (size,) or several columns (size, k)."""
        return summed(self, x, np.matmul)

    def __abs__(self) -> "AbsoluteSum":
        """A bound on the absolute values of the entries: those of the elements' and the diagonal's, added up."""
        return AbsoluteSum(self)

    def tocsc(self) -> csc_array:
        """The matrix added up, in columns."""
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
    """The absolute values of a sum's parts, added up; they are never kept, only multiplied."""

    of: ElementSum

    def __matmul__(self, x: FloatArray) -> FloatArray:
        """|A| x, for one vector (size,) or several columns (size, k)."""
        return summed(replace(self.of, scale=np.abs(self.of.scale), diagonal=np.abs(self.of.diagonal)), x, absolute)


def absolute(matrices: FloatArray, x: FloatArray) -> FloatArray:
    """|A| x of stacked matrices (elements, m, m) and columns (elements, m, k), some elements at a time."""
    found = np.empty((*matrices.shape[:2], x.shape[2]))
    step = max(1, CHUNK // max(1, matrices[:1].size))
    for low in range(0, len(matrices), step):
        own = slice(low, low + step)
        np.matmul(np.abs(matrices[own]), x[own], out=found[own])
    return found


def summed(A: ElementSum, x: FloatArray, product: Callable[[FloatArray, FloatArray], FloatArray]) -> FloatArray:
    """A x, the elements' matrices multiplied by `product`."""
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
