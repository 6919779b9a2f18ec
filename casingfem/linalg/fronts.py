"""The plan of a multifrontal factorisation: which unknowns each front eliminates, which it updates, what it will cost.

Fronts are the nodes of a nested dissection, in postorder. A front holds its own unknowns, its pivots, and those later
ones that they are coupled with, directly or through what was eliminated before (Duff & Reid, ACM Trans. Math. Softw. 9,
1983, 302; Liu, SIAM Review 34, 1992, 82).
"""

from dataclasses import dataclass
from itertools import pairwise
from typing import TypeAlias
from weakref import ReferenceType, ref

import numpy as np
from scipy.sparse import csc_array

from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.linalg.dissection import coordinates, dissect, quotient, spans

Places: TypeAlias = slice | IntArray
Runs: TypeAlias = tuple[tuple[slice, slice], ...]

SMALL = 15_000_000  # entries of a pattern whose plan is kept, some 150 MB of it


@dataclass(frozen=True, slots=True, eq=False)
class Front:
    """One dense matrix on `pivots` unknowns from number `start` on, and on those at `rows`, later ones, ascending.

    Its part of A: entries number `source` of A's data are entries number `place` of its columns, those of the pivots
    (pivots, pivots) one after the other and then those of the rows (rows, pivots). Of its parent's front, its first
    `split` rows are the pivots `head`, the others the rows `tail`.
    """

    start: int
    pivots: int
    rows: IntArray
    source: IntArray
    place: IntArray
    children: tuple[int, ...]
    split: int
    head: Places
    tail: Places
    head_runs: Runs
    tail_runs: Runs

    @property
    def size(self) -> tuple[int, int]:
        """Pivots and rows."""
        return self.pivots, len(self.rows)


@dataclass(frozen=True, eq=False)
class Fronts:
    """Fronts in the order of elimination, for matrices of one pattern.

    Attributes
    ----------
    indptr, indices
        The pattern, of a matrix in columns.
    order
        Unknowns in the order of elimination, (n,).
    fronts
        Children before parents.
    """

    indptr: IntArray
    indices: IntArray
    order: IntArray
    fronts: tuple[Front, ...]

    @property
    def operations(self) -> float:
        """Multiplications and additions of a factorisation."""
        k, m = np.array([front.size for front in self.fronts], dtype=float).T
        return float(np.sum(k**3 / 3.0 + k**2 * m + k * m**2))

    @property
    def entries(self) -> int:
        """Numbers that a factor keeps."""
        return sum(k * (k + m) for k, m in (front.size for front in self.fronts))

    def working(self) -> int:
        """Numbers held at most beside the factor: a front, and what its elder relatives have passed on so far."""
        most = held = 0
        for front in self.fronts:
            k, m = front.size
            most = max(most, held + (k + m) ** 2 + k * (k + m))
            held += m * m - sum(len(self.fronts[child].rows) ** 2 for child in front.children)
        return most

    def bytes(self, keep: bool, number: int = 8) -> float:
        """Memory that a factorisation takes at most, of its factor and without it, in numbers of so many bytes."""
        return float(number) * (self.working() + keep * self.entries)

    def fits(self, A: csc_array) -> bool:
        """Whether a matrix has this pattern."""
        same = len(A.indptr) == len(self.indptr) and len(A.indices) == len(self.indices)
        return same and np.array_equal(A.indptr, self.indptr) and np.array_equal(A.indices, self.indices)


def postorder(parent: IntArray) -> IntArray:
    """Number of each node, children before their parents and next to them."""
    children: list[list[int]] = [[] for _ in parent]
    for i, p in enumerate(parent[1:].tolist(), start=1):
        children[p].append(i)
    order, stack = [], [0]
    while stack:  # parents first, then reversed
        order.append(stack.pop())
        stack += children[order[-1]]
    number = np.empty(len(parent), dtype=np.int64)
    number[order[::-1]] = np.arange(len(parent))
    return number


def compact(places: IntArray) -> Places:
    """Ascending places as a slice, if they follow each other."""
    if len(places) and places[-1] - places[0] == len(places) - 1:
        return slice(int(places[0]), int(places[-1]) + 1)
    return places


def runs(places: IntArray) -> Runs:
    """Ascending places cut into pieces that follow each other: which of them, and where.

    >>> runs(np.array([3, 4, 9]))
    ((slice(0, 2, None), slice(3, 5, None)), (slice(2, 3, None), slice(9, 10, None)))
    """
    cuts = [0, *(np.flatnonzero(np.diff(places) > 1) + 1).tolist(), len(places)]
    pieces = pairwise(cuts) if len(places) else ()
    return tuple((slice(a, b), slice(int(places[a]), int(places[b - 1]) + 1)) for a, b in pieces)


class Recent:
    """The plan last made, as long as somebody holds it or it is small: shifts and neighbours share their pattern."""

    last: ReferenceType[Fronts] | None = None
    small: Fronts | None = None


def planned(A: csc_array) -> Fronts:
    """The plan for a matrix: that of the last one, if the pattern is the same, or a new one."""
    last = Recent.last() if Recent.last is not None else None
    if last is not None and last.fits(A):
        return last
    fronts = plan(A)
    Recent.last, Recent.small = ref(fronts), fronts if len(A.indices) <= SMALL else None
    return fronts


def plan(A: csc_array) -> Fronts:
    """Plan the factorisation of matrices with the pattern of A, symmetric, its indices sorted.

    >>> fronts = plan(csc_array(np.eye(3)))
    >>> len(fronts.fronts), fronts.entries
    (1, 9)
    """
    vertex, graph = quotient(A)
    axes = coordinates(graph)
    node, parent = dissect(graph, axes)
    number = postorder(parent)
    above = np.full(len(parent), -1)
    above[number[1:]] = number[parent[1:]]
    of = number[node]
    by_front = np.lexsort((longest(axes, of, len(parent)), of))
    place = np.empty(graph.size, dtype=np.int64)
    place[by_front] = np.arange(graph.size)
    ends = np.searchsorted(of[by_front], np.arange(len(parent) + 1))
    weight = graph.weight[by_front]
    starts = np.append(0, np.cumsum(weight))
    order = np.argsort(place[vertex], kind="stable")
    coupled = later_neighbours(graph.tail, graph.head, place, ends)
    children: list[list[int]] = [[] for _ in parent]
    structures: list[IntArray] = []
    for f, p in enumerate(above.tolist()):
        below = np.unique(np.concatenate([coupled[f], *(structures[child] for child in children[f])]))
        structures.append(below[below >= ends[f + 1]])
        if p >= 0:
            children[p].append(f)
    rows = [spans(starts[s], weight[s]) for s in structures]
    return Fronts(A.indptr, A.indices, order, make_fronts(A, order, weight, starts, ends, rows, above, children))


def longest(axes: FloatArray, of: IntArray, fronts: int) -> FloatArray:
    """Of each vertex the coordinate along which its front is longest: what neighbours share of it stays together."""
    count = np.maximum(np.bincount(of, minlength=fronts), 1)
    mean = np.array([np.bincount(of, x, fronts) / count for x in axes])
    spread = np.array([np.bincount(of, x * x, fronts) / count for x in axes]) - mean**2
    return np.asarray(np.choose(spread.argmax(axis=0)[of], axes))


def later_neighbours(tail: IntArray, head: IntArray, place: IntArray, ends: IntArray) -> list[IntArray]:
    """For each front, the places of vertices after its own that its vertices are coupled with."""
    here, there = place[tail], place[head]
    front = np.searchsorted(ends, here, side="right") - 1
    later = np.flatnonzero(there >= ends[front + 1])
    later = later[np.argsort(front[later], kind="stable")]
    cuts = np.searchsorted(front[later], np.arange(1, len(ends) - 1))
    return [np.unique(part) for part in np.split(there[later], cuts)]


def make_fronts(
    A: csc_array,
    order: IntArray,
    weight: IntArray,
    starts: IntArray,
    ends: IntArray,
    rows: list[IntArray],
    above: IntArray,
    children: list[list[int]],
) -> tuple[Front, ...]:
    """Fronts with their places in A and in each other; vertices have `weight` unknowns from `starts`, fronts `ends`."""
    position = np.empty(len(order), dtype=np.int32)
    position[order] = np.arange(len(order), dtype=np.int32)
    local = np.zeros(len(order), dtype=np.int32)  # places of unknowns in the front at hand
    firsts = starts[ends]
    degree = np.diff(A.indptr)
    fronts = []
    for f, p in enumerate(above.tolist()):
        start, end = int(firsts[f]), int(firsts[f + 1])
        local[start:end] = np.arange(end - start)
        local[rows[f]] = end - start + np.arange(len(rows[f]))
        own, size = slice(ends[f], ends[f + 1]), (end - start, len(rows[f]))
        source, place = entries_of(A, order[start:end], position, local, degree, weight[own], starts[own], size)
        split = int(np.searchsorted(rows[f], firsts[p + 1])) if p >= 0 else 0
        head = rows[f][:split] - firsts[p]
        tail = np.searchsorted(rows[p], rows[f][split:]) if p >= 0 else rows[f]
        fronts.append(
            Front(
                start=start,
                pivots=end - start,
                rows=rows[f],
                source=source,
                place=place,
                children=tuple(children[f]),
                split=split,
                head=compact(head),
                tail=compact(tail),
                head_runs=runs(head),
                tail_runs=runs(tail),
            )
        )
    return tuple(fronts)


def entries_of(
    A: csc_array,
    unknowns: IntArray,
    position: Array,
    local: Array,
    degree: IntArray,
    weight: IntArray,
    starts: IntArray,
    size: tuple[int, int],
) -> tuple[IntArray, IntArray]:
    """`source` and `place` of a front: found for the first unknown of each of its vertices, the others follow."""
    k, m = size
    first = unknowns[starts - starts[0]] if k else unknowns
    entries = degree[first]
    inside = spans(np.zeros_like(entries), entries)
    row = position[A.indices[inside + np.repeat(A.indptr[first], entries)]]
    kept = row >= np.repeat(starts, entries)  # the lower triangle, and vertices' own blocks
    inside, row = inside[kept], local[row[kept]]
    ends = np.append(0, np.cumsum(kept))[np.cumsum(entries)]
    here = row < k
    place, step = np.where(here, row, k * k + row - k), np.where(here, k, m)
    number = np.int32 if max(len(A.indices), k * (k + m)) < 2**31 else np.int64
    each = np.repeat(np.diff(ends, prepend=0), weight)  # entries of each unknown
    of = spans(np.repeat(np.append(0, ends)[:-1], weight), each)
    column, begin = (np.repeat(x.astype(number), each) for x in (np.arange(k), A.indptr[unknowns]))
    at, own, stride = (x.astype(number)[of] for x in (inside, place, step))
    return at + begin, own + stride * column
