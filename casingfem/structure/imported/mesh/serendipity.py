"""Quadratic wedges of 15 and pyramids of 13 nodes: shape functions and quadrature, which scikit-fem does not have.

Wedge: with L the three area coordinates and t in [-1, 1] along it,

    corners  L_i ((2 L_i - 1)(1 -+ t) - (1 - t^2))/2,   edges across  2 L_i L_j (1 -+ t),   edges along  L_i (1 - t^2)

Pyramid (Bedrosian, Int. J. Numer. Meth. Eng. 35, 1992, 95): rational functions, quadratic on each edge and face. Nodes
are in VTK's order; the reference wedge is on (0, 0), (1, 0), (0, 1) from z = 0 to 1, the pyramid on the unit square
with its apex above the first corner.
"""

from abc import ABC, abstractmethod
from typing import Any

import numpy as np
from skfem import MeshTri
from skfem.quadrature import get_quadrature

from casingfem.io.arrays import FloatArray

GAUSS, HEIGHT = 3, 4  # Gauss points along edges, and from base to apex
STEP = 1e-30  # of the complex step: derivatives to round-off


class Serendipity(ABC):
    """A kind of cell whose shape functions are one function of position.

    Their derivatives are computed by complex steps.
    """

    corners: tuple[tuple[int, int, int], ...]
    edges: tuple[tuple[int, int], ...]

    @property
    def doflocs(self) -> FloatArray:
        """Places of the nodes in the reference cell, (nodes, 3)."""
        corners = np.array(self.corners, dtype=float)
        return np.vstack([corners, *(corners[list(edge)].mean(axis=0)[None] for edge in self.edges)])

    @abstractmethod
    def values(self, x: Any, y: Any, z: Any) -> Any:
        """Shape functions (nodes, points)."""

    @staticmethod
    @abstractmethod
    def quadrature() -> tuple[FloatArray, FloatArray]:
        """Points (3, q) and weights (q,)."""

    def lbasis(self, X: FloatArray, i: int) -> tuple[FloatArray, FloatArray]:
        """Value (points,) and slopes (3, points) of a shape function."""
        steps = [self.values(*(X + 1j * STEP * np.eye(3)[:, [k]]))[i].imag / STEP for k in range(3)]
        return self.values(*X)[i], np.array(steps)


class Wedge15(Serendipity):
    """The wedge.

    >>> wedge = Wedge15()
    >>> bool(np.allclose(wedge.values(*wedge.doflocs.T), np.eye(15)))
    True
    """

    corners = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1))
    edges = ((0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5))

    def values(self, x: Any, y: Any, z: Any) -> Any:
        """Shape functions (15, points)."""
        L, t = (1.0 - x - y, x, y), 2.0 * z - 1.0
        low, high, bow = 1.0 - t, 1.0 + t, 1.0 - t**2
        across = [L[i] * L[(i + 1) % 3] for i in range(3)]
        corners = [0.5 * a * ((2.0 * a - 1.0) * side - bow) for side in (low, high) for a in L]
        return np.array(corners + [2.0 * ab * side for side in (low, high) for ab in across] + [a * bow for a in L])

    @staticmethod
    def quadrature() -> tuple[FloatArray, FloatArray]:
        """Points (3, q) and weights (q,)."""
        flat, weight = get_quadrature(MeshTri.elem.refdom, 5)
        t, along = gauss(GAUSS)
        points = np.vstack([np.repeat(flat, GAUSS, axis=1), np.tile(t, flat.shape[1])])
        return points, np.repeat(weight, GAUSS) * np.tile(along, flat.shape[1])


class Pyramid13(Serendipity):
    """The pyramid.

    >>> pyramid = Pyramid13()
    >>> places = pyramid.doflocs * (1.0 - 1e-14)
    >>> bool(np.allclose(pyramid.values(*places.T), np.eye(13), atol=1e-12))
    True
    """

    corners = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1))
    edges = ((0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 4), (2, 4), (3, 4))

    def values(self, x: Any, y: Any, z: Any) -> Any:
        """Shape functions (13, points), in a = +-1 across the base at z = 0, shrinking to the apex."""
        a, b = 2.0 * x + z - 1.0, 2.0 * y + z - 1.0  # -(1 - z) .. 1 - z
        high = 1.0 - z
        left, right, front, back = 0.5 * (high - a), 0.5 * (high + a), 0.5 * (high - b), 0.5 * (high + b)
        near = np.where(np.abs(high) > 0.0, high, 1.0)
        base = [left * front, right * front, right * back, left * back]  # over high: bilinear
        out = [-a - b, a - b, a + b, b - a]
        corners = [part / near * (way - 1.0) for part, way in zip(base, out, strict=True)]
        middles = [left * right * front, right * front * back, left * right * back, left * front * back]
        top, sides = z * (2.0 * z - 1.0), [4.0 * z * part / near for part in base]
        return np.array([*corners, top, *(4.0 * part / near for part in middles), *sides])

    @staticmethod
    def quadrature() -> tuple[FloatArray, FloatArray]:
        """Points (3, q) and weights (q,): the rule of a cube, mapped to the pyramid."""
        t, along = gauss(GAUSS)
        z, up = gauss(HEIGHT)
        r, s, h = (v.ravel() for v in np.meshgrid(t, t, z, indexing="ij"))
        weight = np.einsum("i,j,k->ijk", along, along, up).ravel()
        return np.stack([r * (1.0 - h), s * (1.0 - h), h]), weight * (1.0 - h) ** 2


def gauss(count: int) -> tuple[FloatArray, FloatArray]:
    """Gauss' points and weights on [0, 1]."""
    x, w = np.polynomial.legendre.leggauss(count)
    return 0.5 + 0.5 * x, 0.5 * w
