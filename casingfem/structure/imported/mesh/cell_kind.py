"""Kinds of cells of imported meshes: node order, facets, shape functions.

Node order is VTK's everywhere: corners, then the middles of edges, of facets, of the cell. The shape functions come
from scikit-fem; those of wedges and pyramids come from `serendipity.py`. Their order is determined from the positions
of the nodes, without tables of permutations.
"""

from dataclasses import dataclass
from functools import cache
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from skfem import element as fem
from skfem.quadrature import get_quadrature

from casingfem.io.arrays import Array, FloatArray, IntArray, frozen
from casingfem.structure.imported.mesh.serendipity import Pyramid13, Serendipity, Wedge15

Corners = tuple[tuple[int, ...], ...]
Pairs = tuple[tuple[int, int], ...]

LINE: Corners = ((0,), (1,))
TRIANGLE: Corners = ((0, 0), (1, 0), (0, 1))
SQUARE: Corners = ((0, 0), (1, 0), (1, 1), (0, 1))
TETRA: Corners = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
CUBE: Corners = tuple((x, y, z) for z in (0, 1) for x, y in SQUARE)
TRIANGLE_EDGES: Pairs = ((0, 1), (1, 2), (2, 0))
SQUARE_EDGES: Pairs = ((0, 1), (1, 2), (2, 3), (3, 0))
TETRA_EDGES: Pairs = (*TRIANGLE_EDGES, (0, 3), (1, 3), (2, 3))
CUBE_EDGES: Pairs = (*SQUARE_EDGES, *((4 + i, 4 + j) for i, j in SQUARE_EDGES), *((i, 4 + i) for i in range(4)))
TETRA_FACETS: Corners = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2))  # seen from outside, anticlockwise
CUBE_FACETS: Corners = ((0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 3, 2, 1), (4, 5, 6, 7))


class Outline(NamedTuple):
    """Outline of cells of one shape: corners in the reference cell, edges and facets by their corners."""

    corners: Corners
    edges: Pairs
    facets: Corners


@dataclass(frozen=True, slots=True, kw_only=True)
class CellKind:
    """One kind of cell, named as in meshio.

    `edges` and `facets` name corners; nodes are at the corners, then in the middles of edges, facets and cell as
    `middles` counts them. `facet` is the kind of the facets. `degree` is the degree of the quadrature, one with
    positive weights only.
    """

    name: str
    corners: Corners
    edges: Pairs
    facets: Corners
    element: Any
    middles: int = 0  # 0 none, 1 edges, 2 edges, facets and cell
    facet: str = ""
    degree: int = 2

    @property
    def dim(self) -> int:
        """Dimension: 3 for solids, 2 for shells and the facets of solids."""
        return len(self.corners[0])

    @property
    def supports_of_nodes(self) -> Corners:
        """For each node, the corners whose mean position it has."""
        nodes: Corners = tuple((i,) for i in range(len(self.corners)))
        if self.middles:
            nodes += self.edges
        if self.middles == 2:
            inner: Corners = (tuple(range(len(self.corners))),)
            nodes += (*self.facets, *inner) if self.dim == 3 else inner
        return nodes

    @property
    def places(self) -> FloatArray:
        """Places of the nodes in the reference cell, (nodes, dim)."""
        corners = np.array(self.corners, dtype=float)
        return np.array([corners[list(nodes)].mean(axis=0) for nodes in self.supports_of_nodes])

    @property
    def nodes(self) -> int:
        """Nodes of a cell."""
        return len(self.supports_of_nodes)

    @property
    def facet_nodes(self) -> IntArray:
        """Local nodes of each facet in the order of the facet's own kind, (facets, facet nodes)."""
        number = {frozenset(nodes): k for k, nodes in enumerate(self.supports_of_nodes)}
        inner = KINDS[self.facet].supports_of_nodes
        return np.array([[number[frozenset(facet[i] for i in nodes)] for nodes in inner] for facet in self.facets])


VTK = {
    "quad": 9, "quad8": 23, "quad9": 28, "tetra": 10, "tetra10": 24, "hexahedron": 12, "hexahedron20": 25,
    "hexahedron27": 29,
}  # VTK's numbers of the kinds of cells  # fmt: skip


def _kinds() -> dict[str, CellKind]:
    line = Outline(LINE, ((0, 1),), ())
    tri = Outline(TRIANGLE, TRIANGLE_EDGES, TRIANGLE_EDGES)
    quad = Outline(SQUARE, SQUARE_EDGES, SQUARE_EDGES)
    tetra = Outline(TETRA, TETRA_EDGES, TETRA_FACETS)
    cube = Outline(CUBE, CUBE_EDGES, CUBE_FACETS)
    rows: list[tuple[str, Outline, type, int, str, int]] = [
        ("line", line, fem.ElementLineP1, 0, "", 3),
        ("line3", line, fem.ElementLineP2, 1, "", 5),
        ("triangle", tri, fem.ElementTriP1, 0, "line", 2),
        ("triangle6", tri, fem.ElementTriP2, 1, "line3", 4),
        ("quad", quad, fem.ElementQuad1, 0, "line", 3),
        ("quad8", quad, fem.ElementQuadS2, 1, "line3", 5),
        ("quad9", quad, fem.ElementQuad2, 2, "line3", 5),
        ("tetra", tetra, fem.ElementTetP1, 0, "triangle", 2),
        ("tetra10", tetra, fem.ElementTetP2, 1, "triangle6", 5),
        ("hexahedron", cube, fem.ElementHex1, 0, "quad", 3),
        ("hexahedron20", cube, fem.ElementHexS2, 1, "quad8", 5),
        ("hexahedron27", cube, fem.ElementHex2, 2, "quad9", 5),
        ("wedge15", Outline(Wedge15.corners, Wedge15.edges, ()), Wedge15, 1, "", 5),
        ("pyramid13", Outline(Pyramid13.corners, Pyramid13.edges, ()), Pyramid13, 1, "", 5),
    ]
    return {
        name: CellKind(name=name, element=element, middles=middles, facet=facet, degree=degree, **shape._asdict())
        for name, shape, element, middles, facet, degree in rows
    }


KINDS = MappingProxyType(_kinds())
SOLIDS = tuple(name for name, kind in KINDS.items() if kind.dim == 3 and kind.facets)  # others are in bricks
SHELLS = ("quad", "quad8", "quad9")  # triangles are in squares


def shape_functions(name: str, points: Array) -> tuple[FloatArray, FloatArray]:
    """Shape functions of a kind at local points (dim, points): values (nodes, points), slopes (dim, nodes, points).

    >>> N, dN = shape_functions("tetra10", np.array([[0.2], [0.3], [0.1]]))
    >>> round(float(N.sum()), 12), N.shape, dN.shape
    (1.0, (10, 1), (3, 10, 1))
    """
    kind = KINDS[name]
    element = kind.element()
    distance = np.abs(kind.places[:, None, :] - np.array(element.doflocs)[None]).sum(axis=2)
    tables = [element.lbasis(points, int(i)) for i in distance.argmin(axis=1)]
    values = np.stack([value * np.ones(points.shape[1]) for value, _ in tables])
    return values, np.stack([slope * np.ones(points.shape[1]) for _, slope in tables], axis=1)


@cache
def rule(name: str, degree: int | None = None) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Quadrature of a kind: points (dim, q), weights (q,), and the shape functions there, values and slopes."""
    kind = KINDS[name]
    if issubclass(kind.element, Serendipity):
        points, weights = kind.element.quadrature()
    else:
        points, weights = get_quadrature(kind.element.refdom, kind.degree if degree is None else degree)
    values, slopes = shape_functions(name, points)
    return frozen(points), frozen(weights), frozen(values), frozen(slopes)
