"""Spectral quadrilateral: nodal Lagrange element of order p on Gauss-Lobatto-Legendre points.

The nodes are also the points of a quadrature rule of degree 2p - 1, so the mass matrix is diagonal. Edges, supports and
probes select nodal dofs.
"""

from functools import cache

import numpy as np
from numpy.polynomial import legendre
from scipy.special import roots_jacobi
from skfem.element import ElementH1
from skfem.refdom import RefQuad

from casingfem.io.arrays import Array, FloatArray


@cache
def lobatto(order: int) -> tuple[FloatArray, FloatArray]:
    """Gauss-Lobatto-Legendre points and weights on [0, 1], order + 1 of each.

    Interior points are the roots of P_p'; weights 2 / (p (p + 1) P_p(x)^2) on [-1, 1].

    >>> points, weights = lobatto(2)
    >>> points.tolist(), (6 * weights).round(12).tolist()
    ([0.0, 0.5, 1.0], [1.0, 4.0, 1.0])
    """
    if order < 1:
        raise ValueError(f"the order must be at least 1, found {order}")
    coefficients = np.eye(order + 1)[order]
    inner = roots_jacobi(order - 1, 1.0, 1.0)[0] if order > 1 else np.array([])  # P_p' ~ P_(p-1)^(1,1)
    x = np.concatenate([[-1.0], inner, [1.0]])
    x = 0.5 * (x - x[::-1])  # exactly symmetric
    w = 2.0 / (order * (order + 1) * legendre.legval(x, coefficients) ** 2)
    return 0.5 * (x + 1.0), 0.5 * w


@cache
def gauss(count: int) -> tuple[FloatArray, FloatArray]:
    """Gauss-Legendre points and weights on [0, 1].

    >>> gauss(2)[0].round(6).tolist()
    [0.211325, 0.788675]
    """
    x, w = legendre.leggauss(count)
    return 0.5 * (x + 1.0), 0.5 * w


def lagrange(order: int, x: Array) -> tuple[Array, Array]:
    """Lagrange polynomials on the Lobatto points of [0, 1], and their derivatives, at x.

    Parameters
    ----------
    order
        Polynomial order p.
    x
        Points, any shape.

    Returns
    -------
    values, slopes
        Each (p + 1, *x.shape).

    >>> values, slopes = lagrange(3, np.array([[0.2, 0.7]]))
    >>> bool(np.allclose(values.sum(0), 1.0) and np.allclose(slopes.sum(0), 0.0))
    True
    """
    modal = legendre.legvander(2.0 * np.asarray(x) - 1.0, order)
    to_nodes, slopes_of = _from_legendre(order)
    values = np.moveaxis(modal @ to_nodes, -1, 0)
    return values, np.moveaxis(2.0 * (modal @ slopes_of) @ to_nodes, -1, 0)


@cache
def _from_legendre(order: int) -> tuple[FloatArray, FloatArray]:
    """Matrices from Legendre to Lagrange polynomials, and to their slopes, (order + 1, order + 1) each."""
    vandermonde = legendre.legvander(2.0 * lobatto(order)[0] - 1.0, order)
    slopes = [np.pad(legendre.legder(row), (0, 1)) for row in np.eye(order + 1)]
    return np.asarray(np.linalg.inv(vandermonde), np.float64), np.array(slopes, np.float64).T


class ElementQuadLobatto(ElementH1):  # type: ignore[misc]
    """Nodal quadrilateral of order p on Lobatto points, for tensor meshes of scikit-fem.

    Neighbours match because all elements of a tensor mesh have the same orientation.

    >>> len(ElementQuadLobatto(3).doflocs)
    16
    """

    refdom = RefQuad
    nodal_dofs = 1

    def __init__(self, order: int) -> None:
        self.order_p = order
        self.facet_dofs = order - 1
        self.interior_dofs = (order - 1) ** 2
        self.maxdeg = 2 * order
        inner = range(1, order)
        vertices = [(0, 0), (order, 0), (order, order), (0, order)]
        facets = [[(i, 0) for i in inner], [(order, i) for i in inner]]
        facets += [[(i, order) for i in inner], [(0, i) for i in inner]]
        interior = [(i, j) for i in inner for j in inner]
        self.pairs = np.array([*vertices, *(pair for facet in facets for pair in facet), *interior])
        self.dofnames = ["u"] * (1 + self.facet_dofs + self.interior_dofs)
        self.doflocs = lobatto(order)[0][self.pairs]

    def lbasis(self, X: Array, i: int) -> tuple[Array, Array]:
        """Value and local gradient of basis function i at local points X (2, ...)."""
        a, b = self.pairs[i]
        f, df = lagrange(self.order_p, X[0])
        g, dg = lagrange(self.order_p, X[1])
        return f[a] * g[b], np.stack([df[a] * g[b], f[a] * dg[b]])

    def tabulate(self, points: tuple[Array, Array]) -> FloatArray:
        """All basis functions and local derivatives on a tensor of points: (3, functions, points).

        The first axis is (value, d/dx, d/dy); points run with the second coordinate fastest.
        """
        (f, df), (g, dg) = (lagrange(self.order_p, np.asarray(p)) for p in points)
        a, b = self.pairs.T
        blocks = [(f, g), (df, g), (f, dg)]
        return np.stack([np.einsum("aq,ar->aqr", F[a], G[b]).reshape(len(a), -1) for F, G in blocks])
