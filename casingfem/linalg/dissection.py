"""Nested dissection of a symmetric sparse pattern: an elimination tree of separators, from the graph alone.

Unknowns whose columns have the same pattern (those of a node, or of an element's interior) form one vertex. The
vertices get coordinates from their distances to a few far vertices (Harel & Koren, J. Graph Algorithms Appl. 8, 2004,
195), which unroll a closed or open shell like its geometry. Then every part is cut in two along one coordinate, all
parts of a depth at once (George, SIAM J. Numer. Anal. 10, 1973, 345). Among the cuts along all coordinates the one with
the smallest separator is used, so that cuts follow element lines.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.sparse import coo_array, csc_array, csr_array
from scipy.sparse.csgraph import breadth_first_order, connected_components

from casingfem.io.arrays import Array, FloatArray, IntArray

LANDMARKS, AXES, SMOOTHINGS = 12, 6, 8
LEAF = 150  # unknowns that are not cut further: a dense matrix of them costs less than its parts
UNEVEN = 0.75  # the largest share of a part on one side of a cut
SKEW = 4.0  # weight of the unevenness of a cut against its separator
CHUNK = 4_000_000  # entries of the pattern examined together
SEED = 4519  # of the hash: same input, same order


@dataclass(frozen=True, slots=True, eq=False)
class Graph:
    """Vertices with the number of unknowns in each, and edges in both directions, sorted by tail."""

    weight: IntArray
    tail: IntArray
    head: IntArray

    @property
    def size(self) -> int:
        """Number of vertices."""
        return len(self.weight)

    @property
    def first(self) -> IntArray:
        """Start of the edges of each vertex, and the end of all, (vertices + 1,)."""
        return np.asarray(np.searchsorted(self.tail, np.arange(self.size + 1)))


def spans(starts: IntArray, counts: IntArray) -> IntArray:
    """Numbers starts[i] to starts[i] + counts[i], one range after the other.

    >>> spans(np.array([5, 0]), np.array([2, 3])).tolist()
    [5, 6, 0, 1, 2]
    """
    ends = np.cumsum(counts)
    return np.repeat(starts - (ends - counts), counts) + np.arange(ends[-1] if len(ends) else 0)


def quotient(A: csc_array) -> tuple[IntArray, Graph]:
    """The vertex of each unknown, and the graph of a symmetric pattern.

    >>> A = csc_array(np.kron(np.diag(np.ones(100)), np.ones((2, 2))))
    >>> vertex, graph = quotient(A)
    >>> bool(np.all(vertex[::2] == vertex[1::2])), graph.size, set(graph.weight.tolist()), len(graph.tail)
    (True, 100, {2}, 0)
    """
    n, degree = A.shape[0], np.diff(A.indptr)
    key = np.random.default_rng(SEED).integers(2**62, size=n)
    sums = np.zeros(n, dtype=np.int64)  # of the keys in each column: equal patterns, equal sums
    ends = [*np.searchsorted(A.indptr, np.arange(0, A.indptr[-1], CHUNK)).tolist(), n]
    for low, high in pairwise(ends):
        filled = low + np.flatnonzero(degree[low:high])
        entries = key[A.indices[A.indptr[low] : A.indptr[high]]]
        sums[filled] = np.add.reduceat(entries, A.indptr[filled] - A.indptr[low])
    _, sample, vertex = np.unique(sums, return_index=True, return_inverse=True)
    size = len(sample)
    tail = np.repeat(np.arange(size), degree[sample])
    head = vertex[A.indices[spans(A.indptr[sample].astype(np.int64), degree[sample])]]
    apart = tail != head
    one_way = coo_array((np.ones(np.count_nonzero(apart)), (tail[apart], head[apart])), shape=(size, size)).tocsr()
    edges = csr_array(one_way + one_way.T)
    tail = np.repeat(np.arange(size), np.diff(edges.indptr))
    return vertex, Graph(np.bincount(vertex, minlength=size), tail, edges.indices.astype(np.int64))


def distances(graph: Graph, sources: IntArray) -> IntArray:
    """Number of edges from the nearest source to each vertex, (vertices,)."""
    n, root = graph.size, graph.size
    pointers = np.append(graph.first, len(graph.head) + len(sources))
    heads = np.append(graph.head, sources)
    joined = csr_array((np.ones(len(heads)), heads, pointers), shape=(n + 1, n + 1))
    _, before = breadth_first_order(joined, root)
    before[root] = root
    away = (before != root).astype(np.int64)
    while np.any(before != root):  # as many doublings as the number of steps has digits
        away += away[before]
        before = before[before]
    return np.asarray(away[:n])


def coordinates(graph: Graph) -> FloatArray:
    """Coordinates of the vertices, (axes, vertices): principal axes of distances to far vertices, and the component."""
    if graph.size == 1:
        return np.zeros((1, 1))
    links = csr_array((np.ones(len(graph.head)), graph.head, graph.first), shape=(graph.size, graph.size))
    pieces, piece = connected_components(links, directed=False)
    ends = np.cumsum(np.bincount(piece, minlength=pieces)) - 1

    def farthest(away: IntArray) -> IntArray:
        return np.lexsort((away, piece))[ends]

    near = distances(graph, farthest(np.zeros(graph.size, dtype=np.int64)))
    found = []
    nearest = np.full(graph.size, np.iinfo(np.int64).max)
    source = farthest(near)
    for _ in range(LANDMARKS):
        found.append(distances(graph, source))
        nearest = np.minimum(nearest, found[-1])
        source = farthest(nearest)
    X = np.array(found, dtype=float).T
    count = np.maximum(np.diff(graph.first), 1)[:, None]
    for _ in range(SMOOTHINGS):
        X = 0.5 * (X + (links @ X) / count)
    X -= X.mean(axis=0)
    _, turn = np.linalg.eigh(X.T @ X)
    axes = (X @ turn[:, ::-1][:, :AXES]).T
    return axes if pieces == 1 else np.vstack([piece, axes])


@dataclass(frozen=True, slots=True, eq=False)
class Cuts:
    """The best cut of each part along one coordinate: its cost, the rank up to which vertices are below, and the side.

    `above`: the separator is on the upper side; `rank` orders the vertices.
    """

    cost: FloatArray
    last: IntArray
    above: Array
    rank: IntArray


def best_cuts(x: FloatArray, part: IntArray, weight: IntArray, tail: IntArray, head: IntArray, parts: int) -> Cuts:
    """The cut with the smallest separator of each part along x; edges join vertices of one part.

    A vertex separates the cuts between itself and its farthest neighbour above (or below): sums over those intervals
    give the separators of all cuts at once.
    """
    order = np.lexsort((x, part))
    new = np.ones(len(x), dtype=bool)
    new[1:] = (np.diff(x[order]) > 0.0) | (np.diff(part[order]) > 0)
    rank = np.empty(len(x), dtype=np.int64)
    rank[order] = np.cumsum(new) - 1
    of = part[order][new]
    high, low = rank.copy(), rank.copy()
    starts = np.flatnonzero(np.diff(tail, prepend=-1))
    with_edges = tail[starts]
    high[with_edges] = np.maximum(rank[with_edges], np.maximum.reduceat(rank[head], starts))
    low[with_edges] = np.minimum(rank[with_edges], np.minimum.reduceat(rank[head], starts))
    total = np.bincount(part, weight, parts)
    cuts = len(of)
    below = np.cumsum(np.bincount(rank, weight, cuts)) - (np.cumsum(total) - total)[of]
    sides = []
    for start, stop, taken in ((rank, high, np.array([1.0, 0.0])), (low, rank, np.array([0.0, 1.0]))):
        separator = np.cumsum(np.bincount(start, weight, cuts) - np.bincount(stop, weight, cuts))
        left, right = below - taken[0] * separator, total[of] - below - taken[1] * separator
        share = np.maximum(left, right) / total[of]
        fair = (np.minimum(left, right) > 0.0) & (share < UNEVEN)
        sides.append(np.where(fair, separator * (1.0 + SKEW * np.maximum(share - 0.5, 0.0)), np.inf))
    cost = np.minimum(*sides)
    least = np.minimum.reduceat(cost, np.flatnonzero(np.diff(of, prepend=-1)))
    where = np.flatnonzero(cost == least[of])
    last = where[np.flatnonzero(np.diff(of[where], prepend=-1))]
    return Cuts(cost=least, last=last, above=sides[1][last] < sides[0][last], rank=rank)


def dissect(graph: Graph, axes: FloatArray, leaf: int = LEAF) -> tuple[IntArray, IntArray]:
    """The tree's node of each vertex, and the parent of each node; node 0 is the root, its parent -1."""
    node = np.zeros(graph.size, dtype=np.int64)
    parents = [np.array([-1])]
    vertex, part, places = np.arange(graph.size), np.zeros(graph.size, dtype=np.int64), np.zeros(1, dtype=np.int64)
    tail, head, nodes = graph.tail, graph.head, 1
    while len(vertex):  # vertex, part, tail and head are those not yet given to a node; `places` are the parts' nodes
        weight, parts = graph.weight[vertex], len(places)
        along = [best_cuts(x, part, weight, tail, head, parts) for x in axes[:, vertex]]
        best = np.argmin([cuts.cost for cuts in along], axis=0)
        each = ([getattr(cuts, name) for cuts in along] for name in ("cost", "last", "above"))
        cost, last, above = (np.choose(best, values) for values in each)
        total = np.bincount(part, weight, parts)
        split = (total > leaf) & (cost < 0.5 * total)
        upper = np.choose(best[part], [cuts.rank for cuts in along]) > last[part]
        touching = np.zeros(len(vertex), dtype=bool)
        touching[tail[upper[tail] != upper[head]]] = True
        stays = ~split[part] | (touching & (upper == above[part]))
        node[vertex[stays]] = places[part[stays]]
        going = np.flatnonzero(~stays)
        halves, fresh = np.unique(2 * part[going] + upper[going], return_inverse=True)
        number = np.full(len(vertex), -1)
        number[going] = np.arange(len(going))
        inside = np.flatnonzero((number[tail] >= 0) & (number[head] >= 0) & (upper[tail] == upper[head]))
        tail, head = number[tail[inside]], number[head[inside]]
        parents.append(places[halves // 2])
        vertex, part, places = vertex[going], fresh, nodes + np.arange(len(halves))
        nodes += len(halves)
    return node, np.concatenate(parents)
