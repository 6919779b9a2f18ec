"""Tensor meshes of spectral quadrilaterals over the parameter rectangle of a chart."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Annotated

import numpy as np
from skfem import Basis, MeshQuad

from casingfem.errors import ModelError
from casingfem.io.arrays import Array, FloatArray, IntArray, frozen
from casingfem.structure.geometry.chart import Chart, Surface
from casingfem.structure.mesh.element import ElementQuadLobatto, gauss, lagrange, lobatto
from contact.io.brief import brief
from contact.io.keys import Key

QUAD = 9  # VTK's number of a quadrilateral
LARGEST = 2_000_000  # unknowns: their factor needs some 20 GB


@dataclass(frozen=True, slots=True, kw_only=True)
class ShellMesh:
    """Mesh of a shell: polynomial order, rows along the first parameter, elements along the second.

    `rows` and `around` are numbers of equal elements, or break points from 0 to 1 (for example graded towards edges);
    around a casing they are equal. There use more elements than 4/p times the largest nodal diameter of interest. The
    number should be odd for a perfect casing, and a multiple of the bolt count for a bolted one.

    >>> ShellMesh()
    ShellMesh(order=8, rows=1, around=21)
    >>> ShellMesh(order=8, rows=2, around=21).breaks.tolist()
    [0.0, 0.5, 1.0]
    """

    order: Annotated[int, Key("polynomial order; alone it refines the default mesh (10)", least=2, most=20)] = 8
    rows: int | tuple[float, ...] = 1
    around: int | tuple[float, ...] = 21

    def __post_init__(self) -> None:
        if not (isinstance(self.order, int | np.integer) and 2 <= self.order <= 20):
            raise ModelError("mesh-order", f"mesh.order must be a whole number from 2 to 20, found {self.order!r}")
        for name, parts in (("rows", self.rows), ("around", self.around)):
            if isinstance(parts, int | np.integer):
                if parts < 1:
                    raise ModelError(f"mesh-{name}", f"mesh.{name} must be at least 1, found {parts}")
                continue
            if np.ndim(parts) != 1:
                expected = f"mesh.{name} must be a whole number of at least 1, or break points from 0 to 1"
                raise ModelError(f"mesh-{name}", f"{expected}, found {parts!r}")
            breaks = np.asarray(parts, dtype=float)
            if len(breaks) < 2 or breaks[0] != 0.0 or breaks[-1] != 1.0 or not np.all(np.diff(breaks) > 0.0):
                raise ModelError(f"mesh-{name}", f"mesh.{name} must increase from 0 to 1, found {parts}")
        if self.unknowns > LARGEST:
            raise ModelError("mesh-too-large", f"mesh: some {self.unknowns:.2g} unknowns")

    @property
    def unknowns(self) -> int:
        """About how many unknowns the mesh has."""
        return int(5 * self.order**2 * (len(self.breaks) - 1) * self.columns)

    @property
    def breaks(self) -> FloatArray:
        """Break points of the rows on [0, 1]."""
        return break_points(self.rows)

    @property
    def columns(self) -> int:
        """Number of elements along the second parameter."""
        return len(break_points(self.around)) - 1


def break_points(parts: int | tuple[float, ...]) -> FloatArray:
    """Break points on [0, 1] of a number of equal parts, or those given."""
    if isinstance(parts, int | np.integer):
        return np.linspace(0.0, 1.0, parts + 1)
    return np.asarray(parts, dtype=float)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Edge:
    """The nodes along one edge, with the parameters and quadrature weights of their Lobatto rule.

    A node shared by two elements appears once, with the sum of its weights. `weights` are in parameter units. For each
    element, `parts` are the positions of its nodes in `nodes`, and `shares` their weights, each (elements of the edge,
    order + 1).
    """

    nodes: IntArray
    weights: FloatArray
    parts: IntArray
    shares: FloatArray
    along: int  # the parameter that varies along the edge

    __repr__ = brief

    def arc(self, surface: Surface) -> Array:
        """Length of edge [m] that the quadrature rule assigns to each node, (nodes,), for the surface at the nodes."""
        tangent = surface.x2 if self.along == 1 else surface.x1
        return np.asarray(np.sqrt(np.einsum("i...,i...->...", tangent, tangent)) * self.weights)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Grid:
    """Nodes, elements and quadrature of a shell mesh; five dofs a node.

    Attributes
    ----------
    nodes
        Parameters of the nodes, (2, nodes).
    elements
        Node numbers, (elements, functions).
    corner, size
        Lower corner and extent of each element, (2, elements).
    table
        Basis values and local derivatives at the quadrature points, (3, functions, points).
    points, weights
        Quadrature on the unit square, (2, points) and (points,).
    """

    mesh: ShellMesh
    periodic: bool
    nodes: FloatArray
    elements: IntArray
    corner: FloatArray
    size: FloatArray
    table: FloatArray
    points: FloatArray
    weights: FloatArray
    edges: dict[str, Edge] = field(default_factory=dict)

    __repr__ = brief

    @property
    def parameters(self) -> tuple[FloatArray, FloatArray]:
        """Parameters of all quadrature points, each (elements, points)."""
        x = self.corner[:, :, None] + self.size[:, :, None] * self.points[:, None, :]
        return x[0], x[1]

    @property
    def middle(self) -> FloatArray:
        """The first parameter in the middle of each element, (elements, 1)."""
        return np.asarray(self.corner[0] + 0.5 * self.size[0])[:, None]

    @property
    def measure(self) -> FloatArray:
        """Quadrature weights in parameter space, (elements, points)."""
        return np.asarray(self.size[0] * self.size[1])[:, None] * self.weights


def tensor_rule(order: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Gauss points of one direction, and the points (2, n^2) and weights (n^2,) of the rule on the square."""
    x, w = gauss(order + 1)
    return x, np.stack([np.repeat(x, len(x)), np.tile(x, len(x))]), np.outer(w, w).ravel()


@cache
def unit_basis(order: int, rows: int, around: int) -> tuple[FloatArray, IntArray]:
    """Node positions in element units, (2, nodes), and element nodes, from scikit-fem's dof numbering."""
    u, v = np.meshgrid(np.arange(rows + 1.0), np.arange(around + 1.0), indexing="ij")
    number = np.arange(u.size).reshape(u.shape)
    corners = [number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]]
    mesh = MeshQuad(np.stack([u.ravel(), v.ravel()]), np.stack([c.ravel() for c in corners]))
    one = (np.array([[0.5], [0.5]]), np.array([1.0]))
    basis = Basis(mesh, ElementQuadLobatto(order), quadrature=one)
    return basis.doflocs, basis.element_dofs.T.astype(np.int64)


def merge_seam(places: FloatArray, elements: IntArray, around: int) -> tuple[FloatArray, IntArray]:
    """Identify the nodes on the last line of the second parameter with those on the first."""
    last = np.flatnonzero(np.isclose(places[1], around))
    first = np.flatnonzero(np.isclose(places[1], 0.0))
    target = np.arange(places.shape[1])
    target[last[np.argsort(places[0, last])]] = first[np.argsort(places[0, first])]
    kept, compact = np.unique(target, return_inverse=True)
    return places[:, kept], compact[elements]


def find_edge(places: FloatArray, held: int, value: float, spans: FloatArray, order: int, wrap: bool) -> Edge:
    """Nodes with one parameter constant at an end, ordered along the edge, with Lobatto weights."""
    along = 1 - held
    nodes = np.flatnonzero(np.isclose(places[held], value))
    nodes = nodes[np.argsort(places[along, nodes])]
    parts = np.arange(len(spans))[:, None] * order + np.arange(order + 1)
    if wrap:
        parts[-1, -1] = 0
    shares = spans[:, None] * lobatto(order)[1]
    weights = np.zeros(len(nodes), dtype=spans.dtype)
    np.add.at(weights, parts, shares)
    return Edge(nodes=frozen(nodes), weights=frozen(weights), parts=frozen(parts), shares=frozen(shares), along=along)


def make_grid(chart: Chart, mesh: ShellMesh, stations: Mapping[str, float] | None = None) -> Grid:
    """Make the grid of a mesh on a chart.

    `stations` are named lines between the edges, which `Grid.edges` contains too.
    """
    (a0, a1), (b0, b1) = chart.bounds
    lines = (a0 + (a1 - a0) * mesh.breaks, b0 + (b1 - b0) * break_points(mesh.around))
    rows, columns = len(lines[0]) - 1, len(lines[1]) - 1
    places, elements = unit_basis(mesh.order, rows, columns)
    if chart.periodic:
        places, elements = merge_seam(places, elements, columns)
    cell = np.minimum(places.astype(int), [[rows - 1], [columns - 1]])
    nodes = np.stack([lines[k][cell[k]] + np.diff(lines[k])[cell[k]] * (places[k] - cell[k]) for k in range(2)])
    i, j = (index.ravel() for index in np.indices((rows, columns)))
    x, points, weights = tensor_rule(mesh.order)
    ends = ((0.0, float(rows)), (0.0, float(columns)))
    edges = {}
    for name, (held, end) in chart.edges.items():
        wrap = chart.periodic and held == 0
        edges[name] = find_edge(places, held, ends[held][end], np.diff(lines[1 - held]), mesh.order, wrap)
    for name, at in (stations or {}).items():
        row = float(np.abs(np.real(lines[0]) - at).argmin())
        edges[name] = find_edge(places, 0, row, np.diff(lines[1]), mesh.order, chart.periodic)
    return Grid(
        mesh=mesh,
        periodic=chart.periodic,
        nodes=frozen(nodes),
        elements=frozen(elements),
        corner=frozen(np.stack([lines[0][i], lines[1][j]])),
        size=frozen(np.stack([np.diff(lines[0])[i], np.diff(lines[1])[j]])),
        table=frozen(ElementQuadLobatto(mesh.order).tabulate((x, x))),
        points=frozen(points),
        weights=frozen(weights),
        edges=edges,
    )


def quads(grid: Grid) -> IntArray:
    """Every element of order p as p x p four-noded quadrilaterals on the element's nodes, (elements p^2, 4)."""
    order = grid.mesh.order
    place = np.empty((order + 1, order + 1), dtype=np.int64)  # function number at each lattice point of an element
    place[tuple(ElementQuadLobatto(order).pairs.T)] = np.arange((order + 1) ** 2)
    corners = np.stack([place[:-1, :-1], place[1:, :-1], place[1:, 1:], place[:-1, 1:]], axis=-1).reshape(-1, 4)
    return np.asarray(grid.elements[:, corners].reshape(-1, 4))


def edge_breaks(grid: Grid, edge: str) -> Array:
    """Ends of the elements along an edge, in its parameter; a closed edge ends one turn after its start."""
    places: Array = grid.nodes[grid.edges[edge].along, grid.edges[edge].nodes]
    if grid.periodic:
        places = np.append(places, places[0] + 2.0 * np.pi)
    return places[:: grid.mesh.order]


def rim_values(grid: Grid, edge: str, along: Array) -> tuple[IntArray, Array]:
    """Interpolate nodal values along an edge: node numbers and weights, each (points, order + 1).

    Only nodes of the edge are used, with a Lagrange polynomial of order p on each element.
    """
    order = grid.mesh.order
    nodes = grid.edges[edge].nodes
    ring = np.append(nodes, nodes[0]) if grid.periodic else nodes
    breaks = edge_breaks(grid, edge)
    x, ends = np.asarray(along), np.real(breaks)
    if grid.periodic:
        x = x - 2.0 * np.pi * np.floor((np.real(x) - ends[0]) / (2.0 * np.pi))
    cell = np.clip(np.searchsorted(ends, np.real(x), side="right") - 1, 0, len(breaks) - 2)
    local = (x - breaks[cell]) / np.diff(breaks)[cell]
    return ring[cell[:, None] * order + np.arange(order + 1)], lagrange(order, local)[0].T
