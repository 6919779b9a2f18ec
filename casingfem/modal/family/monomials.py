"""Polynomials in the coefficients of random fields: their few products are found once and summed for many casings."""

from typing import NamedTuple

import numpy as np

from casingfem.io.arrays import Array, FloatArray, IntArray

LEFT = 2e-6  # of the largest entry's size: what all terms left out may add up to


class Monomials(NamedTuple):
    """Sums of products of coefficients x (X, cases): sum_t value[t, s] x[factor[t, 0]] x[factor[t, 1]] ...

    Attributes
    ----------
    factor : indices into x, one row for each product, ascending, (products, degree)
    value : (products, sums)
    """

    factor: IntArray
    value: FloatArray

    def sums(self, x: Array) -> Array:
        """The sums of each case, (sums, cases), for coefficients x (X, cases)."""
        product = x[self.factor[:, 0]]
        for place in self.factor.T[1:]:
            product *= x[place]
        parts = self.value.T @ product.view(float)  # real and imaginary parts side by side
        return np.asarray(parts.view(complex))


def collected(factor: IntArray, number: IntArray, value: FloatArray, size: FloatArray, scale: FloatArray) -> Monomials:
    """Sums for K, then for M; each product once, without the smallest ones, which are together below `LEFT` of `scale`.

    Parameters
    ----------
    factor, number, value
        Products (products, degree), the index of the number to which each belongs (products,), and its K and M
        (products, 2).
    size
        Root mean square of each coefficient, (X,).
    scale
        Size of the numbers to which the sums are added, (numbers,).
    """
    factor = np.sort(factor, axis=1)
    key = factor @ size.size ** np.arange(factor.shape[1])  # one number a product
    _, first, of = np.unique(key, return_index=True, return_inverse=True)
    factor = factor[first]
    summed = np.zeros((len(factor), 2, len(scale)))
    for kind in (0, 1):
        np.add.at(summed[:, kind], (of.ravel(), number), value[:, kind])
    weight = np.abs(summed[:, 0]) * np.prod(size[factor], axis=1)[:, None]
    weight = np.divide(weight, scale, out=np.zeros_like(weight), where=scale > 0.0).max(axis=1, initial=0.0)
    order = np.argsort(weight)
    kept: IntArray = np.sort(order[np.cumsum(weight[order]) > LEFT])
    return Monomials(np.asarray(factor[kept], dtype=np.int64), summed[kept].reshape(len(kept), 2 * len(scale)))
