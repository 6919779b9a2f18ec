"""Walls of a shell: which cells continue each other smoothly over an edge, and the nodes where walls meet at an angle.

Two cells on an edge belong to one wall if the surface turns by less than `SHARP` between them and no third cell
continues either of them as smoothly. All other edges with several cells are folds and branches. Up to the angle
`FOLDED` a coarse mesh of a smooth surface may be meant, so normals must agree as within a wall. A wall has one director
at a node, so each wall gets a node of its own where walls meet (`walls_apart`); `joints.py` joins them.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from casingfem.io.arrays import BoolArray, FloatArray, IntArray
from casingfem.structure.imported.mesh.cell_kind import KINDS, shape_functions
from casingfem.structure.imported.mesh.collapsed import distinct
from casingfem.structure.imported.mesh.mesh_data import MeshData, natives

SHARP = 25.0  # degrees between neighbours up to which they are one wall: one director mitres a kink
FOLDED = 61.0  # degrees between neighbours up to which their normals must agree
FLAT = 5.0  # degrees between cells or walls that lie over each other or side by side


class Neighbours(NamedTuple):
    """Pairs of shell cells with a common edge.

    `facets` (pairs, 2, 2): cell and local edge of both. `ahead` (pairs,): cosine of the angle by which the surface
    turns from one to the other, 1 straight on, -1 back over itself.
    """

    facets: IntArray
    ahead: FloatArray


class Apart(NamedTuple):
    """A shell's mesh with a node for each wall where walls meet.

    `mesh`: new nodes come after the others. `nodes`: for each node of `mesh`, its node in the whole mesh, (nodes of
    `mesh`,).
    """

    mesh: MeshData
    nodes: IntArray

    @property
    def whole(self) -> int:
        """Nodes of the whole mesh."""
        return int(self.nodes.max()) + 1

    @property
    def meeting(self) -> IntArray:
        """Nodes of the whole mesh where walls meet, ascending."""
        return np.unique(self.nodes[self.whole :])


def cell_normals(mesh: MeshData) -> FloatArray:
    """Unit normals of each cell at its nodes, (cells, nodes, 3); 0 at a repeated node of a six-noded triangle."""
    found = np.zeros((*mesh.cells.shape, 3))
    for kind, rows, slots in natives(mesh):
        _, slopes = shape_functions(kind, np.ascontiguousarray(KINDS[kind].places.T))
        tangents = np.einsum("dkq,ekc->deqc", slopes, mesh.points[mesh.cells[rows][:, slots]])
        normals = np.cross(tangents[0], tangents[1])
        size = np.linalg.norm(normals, axis=2, keepdims=True)
        if not size.all():  # squares collapsed to triangles, which have one normal
            normals = np.where(size > 0.0, normals, normals.sum(axis=1, keepdims=True))
            size = np.linalg.norm(normals, axis=2, keepdims=True)
        found[rows[:, None], slots] = unit(normals)
    return found


def unit(v: FloatArray) -> FloatArray:
    """Vectors (..., 3) scaled to length 1; zero vectors stay 0."""
    size = np.linalg.norm(v, axis=-1, keepdims=True)
    return np.asarray(v / np.maximum(size, np.finfo(float).tiny))


def neighbours(mesh: MeshData) -> Neighbours:
    """Every pair of cells with a common edge."""
    ends = distinct(mesh.facets)
    facets = np.argwhere(ends[:, :, 0] >= 0)
    edge = ends[facets[:, 0], facets[:, 1]] @ np.array([len(mesh.points), 1])
    order = np.argsort(edge, kind="stable")
    edge = edge[order]
    away = outward(mesh, facets)
    pairs: list[IntArray] = []
    for apart in range(1, len(facets)):
        first = np.flatnonzero(edge[apart:] == edge[:-apart])
        if not len(first):
            break
        pairs.append(np.stack([order[first], order[first + apart]], axis=1))
    both = np.concatenate([np.zeros((0, 2), dtype=np.int64), *pairs])
    return Neighbours(facets[both], -np.einsum("pc,pc->p", away[both[:, 0]], away[both[:, 1]]))


def outward(mesh: MeshData, facets: IntArray) -> FloatArray:
    """Unit vectors in the surface, perpendicular to edges and pointing away from their cells, (facets, 3)."""
    cells, slots = facets[:, 0], mesh.cell_kind.facet_nodes[facets[:, 1]]
    a, b = mesh.facets[cells, facets[:, 1]].T
    normals = cell_normals(mesh)[cells[:, None], slots].sum(axis=1)
    return unit(np.cross(mesh.points[b] - mesh.points[a], normals))


def one_wall(given: Neighbours, degrees: float) -> BoolArray:
    """Pairs that continue each other, (pairs,).

    Within an angle, and no other cell continues either of them as smoothly.
    """
    near = given.ahead > np.cos(np.radians(degrees))
    codes = given.facets[near] @ np.array([4, 1])  # a shell cell has at most four edges
    _, place, count = np.unique(codes, return_inverse=True, return_counts=True)
    found: BoolArray = near.copy()
    found[near] = (count[place.reshape(codes.shape)] == 1).all(axis=1)
    return found


def against(mesh: MeshData, pairs: IntArray) -> BoolArray:
    """Pairs (pairs, 2, 2) of cells that have the same direction along their common edge: their normals are opposite."""
    one, other = (mesh.facets[pairs[:, k, 0], pairs[:, k, 1]] for k in (0, 1))
    return np.asarray((one == other).all(axis=1))


def walls_apart(mesh: MeshData, sharp: float = SHARP) -> Apart:
    """A shell's mesh with a node for each wall where walls meet; the mesh itself where none do.

    Neighbours are one wall up to the angle `sharp` [degrees]. A mesh with directors of its own is not taken apart.

    Examples
    --------
    >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [1, 0, 1], [1, 1, 1]])
    >>> corner = MeshData(kind="quad", points=points, cells=np.array([[0, 1, 2, 3], [1, 4, 5, 2]]))
    >>> both = walls_apart(corner)
    >>> both.mesh.cells.tolist(), both.nodes.tolist()
    ([[0, 1, 2, 3], [6, 4, 5, 7]], [0, 1, 2, 3, 4, 5, 1, 2])
    """
    nodes = np.arange(len(mesh.points))
    if mesh.directors is not None:
        return Apart(mesh, nodes)
    code = np.arange(len(mesh.cells))[:, None] * len(nodes) + mesh.cells
    codes, place = np.unique(code, return_inverse=True)
    place = place.reshape(code.shape)
    wall = walls_at_nodes(mesh, codes, place, sharp)
    own = codes % len(nodes)
    _, first = np.unique(own, return_index=True)
    at = np.zeros(len(nodes), dtype=np.int64)
    at[own[first]] = wall[first]
    new = np.unique(wall[wall != at[own]], return_index=True)
    if not len(new[0]):
        return Apart(mesh, nodes)
    number = np.full(wall.max() + 1, -1)
    number[at[own]] = own
    number[new[0]] = len(nodes) + np.arange(len(new[0]))
    origin = np.concatenate([nodes, own[wall != at[own]][new[1]]])
    numbers = np.concatenate([mesh.node_numbers, np.zeros(len(new[0]), dtype=np.int64)])
    split = replace(mesh, points=mesh.points[origin], cells=number[wall[place]], node_numbers=numbers)
    return Apart(on_walls(split, origin) if mesh.attachments.glued else split, origin)


def on_walls(mesh: MeshData, origin: IntArray) -> MeshData:
    """A shell taken apart, with its ties.

    A tied node on walls that meet follows the node of the wall that continues its own.
    """
    directors = mean_normals(mesh)
    count = int(origin.max()) + 1
    glued = []
    for tie in mesh.attachments.glued:
        others = tie.others.copy()
        for i, k in np.argwhere(np.isin(others, origin[count:])):
            walls = np.flatnonzero(origin == others[i, k])
            others[i, k] = walls[np.abs(directors[walls] @ directors[tie.nodes[i]]).argmax()]
        glued.append(replace(tie, others=others))
    return replace(mesh, attachments=replace(mesh.attachments, glued=tuple(glued)))


def mean_normals(mesh: MeshData) -> FloatArray:
    """Mean unit normals of the cells at each node, (nodes, 3); 0 at nodes without cells."""
    total = np.zeros_like(mesh.points)
    np.add.at(total, mesh.cells, cell_normals(mesh))
    return unit(total)


def walls_at_nodes(mesh: MeshData, codes: IntArray, place: IntArray, sharp: float) -> IntArray:
    """The wall of each cell at each of its nodes, numbered over all nodes, (cells' nodes,).

    `codes` number the nodes of cells, ascending, cell * nodes + node; `place` (cells, nodes of a cell) among them.
    """
    given = neighbours(mesh)
    pairs = given.facets[one_wall(given, sharp)]
    shared = mesh.facet_nodes(pairs[:, 0])
    i, j = (np.searchsorted(codes, pairs[:, k, 0][:, None] * len(mesh.points) + shared).ravel() for k in (0, 1))
    normals = cell_normals(mesh)
    total = np.zeros((len(codes), 3))
    np.add.at(total, place, normals)
    total = unit(total)
    wall = connected(i, j, len(codes))
    cosine = np.einsum("ic,ic->i", unit(sums(wall, total))[wall], total)
    steep = np.zeros(wall.max() + 1, dtype=bool)
    steep[wall[cosine < np.cos(np.radians(0.5 * FOLDED))]] = True  # round a peak: each cell is a wall
    kept = ~steep[wall[i]]
    wall = connected(i[kept], j[kept], len(codes))
    return merged(wall, codes % len(mesh.points), unit(sums(wall, total)))


def merged(wall: IntArray, node: IntArray, directors: FloatArray) -> IntArray:
    """Walls of a node that lie side by side, within `FLAT` of each other, as one wall; others unchanged."""
    count = int(node.max()) + 1
    of = np.zeros(len(directors), dtype=np.int64)
    of[wall] = node
    outer = np.zeros((count, 3, 3))
    np.add.at(outer, of, directors[:, :, None] * directors[:, None, :])
    axis = np.linalg.eigh(outer)[1][:, :, -1]
    lean = np.abs(np.einsum("wc,wc->w", axis[of], directors))
    level = np.ones(count, dtype=bool)
    level[of[lean < np.cos(np.radians(0.5 * FLAT))]] = False
    return np.asarray(np.where(level[node], len(directors) + node, wall))


def connected(i: IntArray, j: IntArray, count: int) -> IntArray:
    """For each of `count` items the number of its connected part, with i and j connected."""
    graph = coo_array((np.ones(len(i)), (i, j)), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.int64)


def sums(part: IntArray, vectors: FloatArray) -> FloatArray:
    """Sums of vectors (m, 3) by part, (parts, 3)."""
    total = np.zeros((int(part.max()) + 1, 3))
    np.add.at(total, part, vectors)
    return total
