"""Polynomials in the coefficients of random fields: few products, found once, summed for many casings at once."""

from typing import NamedTuple

import numpy as np

from casingfem.io.arrays import Array, FloatArray, IntArray

LEFT = 2e-5  # of the largest entry's size: what all terms left out may add up to


class Monomials(NamedTuple):
    """Sums of products of coefficients x (X, cases): sum_t value[t, s] x[factor[t, 0]] x[factor[t, 1]] ...

    Attributes
    ----------
    factor : places in x, one row a product, ascending, (products, degree)
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


def collected(factor: IntArray, value: FloatArray, size: FloatArray, scale: float) -> Monomials:
    """Products that are the same are one; the smallest, which together are `LEFT` of `scale`, are left out.

    Parameters
    ----------
    factor, value
        (products, degree) and (products, sums).
    size
        Root mean square of each coefficient, (X,).
    scale
        Size of what the first of the sums is added to.
    """
    factor = np.sort(factor, axis=1)
    key = factor @ size.size ** np.arange(factor.shape[1])  # one number a product
    _, first, of = np.unique(key, return_index=True, return_inverse=True)
    factor = factor[first]
    sums = [np.bincount(of.ravel(), weights=column, minlength=len(factor)).astype(float) for column in value.T]
    summed: FloatArray = np.stack(sums, axis=1)
    weight = np.abs(summed[:, 0]) * np.prod(size[factor], axis=1)
    order = np.argsort(weight)
    kept: IntArray = np.sort(order[np.cumsum(weight[order]) > LEFT * scale])
    return Monomials(np.asarray(factor[kept], dtype=np.int64), summed[kept])
