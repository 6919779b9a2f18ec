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
    value : (products, sums), in the precision of x
    """

    factor: IntArray
    value: FloatArray

    def sums(self, x: Array) -> Array:
        """The sums of each case, (sums, cases), for coefficients x (X, cases), in the precision of x."""
        product = x[self.factor[:, 0]]
        for place in self.factor.T[1:]:
            product *= x[place]
        parts = self.value.T @ product.view(self.value.dtype)  # real and imaginary parts side by side
        return np.asarray(parts.view(x.dtype))


def collected(
    factor: IntArray, value: FloatArray, size: FloatArray, scale: FloatArray, square: FloatArray
) -> Monomials:
    """Sums for K, then for M if given; each product once.

    The smallest products are left out, which are together below `LEFT` of `scale`.

    Parameters
    ----------
    factor
        Products, (products, degree).
    value
        Their K and M, or K alone, in each number, (products, 2 or 1, numbers).
    size
        Root mean square of each coefficient, (X,).
    scale
        Size of the numbers to which the sums are added, (numbers,).
    square
        omega^2 that relates M to K, (numbers,).
    """
    factor = np.sort(factor, axis=1)
    key = factor @ size.size ** np.arange(factor.shape[1])  # one number a product
    order = np.argsort(key, kind="stable")
    first = np.flatnonzero(np.diff(key[order], prepend=-1))
    factor, summed = factor[order[first]], np.add.reduceat(value[order], first, axis=0) if len(order) else value
    weight = weights(factor, summed, size, square)
    weight = np.divide(weight, scale, out=np.zeros_like(weight), where=scale > 0.0).max(axis=1, initial=0.0)
    order = np.argsort(weight)
    kept: IntArray = np.sort(order[np.cumsum(weight[order]) > LEFT])
    sums = value.shape[1] * len(scale)
    return Monomials(np.asarray(factor[kept], dtype=np.int64), summed[kept].reshape(len(kept), sums))


def weights(factor: IntArray, value: FloatArray, size: FloatArray, square: FloatArray) -> FloatArray:
    """Usual size of each product in K, with that in M times omega^2, (products, numbers)."""
    both = np.abs(value[:, 0]) + square * np.abs(value[:, 1:]).sum(axis=1)
    return np.asarray(both * np.prod(size[factor], axis=1)[:, None])
