"""Plan of a multifrontal factorisation: unknowns that each front eliminates and updates, and the cost.

Fronts are the nodes of a nested dissection, in postorder. A front contains its pivots, and the later unknowns with
which they are coupled, directly or through eliminated ones (Duff & Reid, ACM Trans. Math. Softw. 9, 1983, 302; Liu,
SIAM Review 34, 1992, 82).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple, TypeAlias
from weakref import ReferenceType, ref

import numpy as np

from casingfem.io.arrays import FloatArray, IntArray
from casingfem.linalg.dissection import coordinates, dissect, quotient, spans
from casingfem.linalg.element_sum import ElementSum
from casingfem.linalg.entries import Entries, Places, Symmetric, compact, element_entries, element_graph, sparse_entries

Runs: TypeAlias = tuple[tuple[slice, slice], ...]

SMALL = 15_000_000  # entries of a pattern whose plan is kept, some 150 MB of it


@dataclass(frozen=True, slots=True, eq=False)
class Front:
    """One dense matrix on `pivots` unknowns from number `start` on, and on later ones at `rows`, ascending.

    `own` is its part of A. In its parent's front, its first `split` rows are the pivots `head`, the others the rows
    `tail`.
    """

    start: int
    pivots: int
    rows: IntArray
    own: Entries
    children: tuple[int, ...]
    split: int
    head: Places
    tail: Places
    head_runs: Runs
    tail_runs: Runs

    @property
    def size(self) -> tuple[int, int]:
        """Number of pivots and rows."""
        return self.pivots, len(self.rows)


class Groups(NamedTuple):
    """The group of each front, (fronts,); for each group the height above the leaves, and its number of fronts."""

    of: IntArray
    heights: IntArray
    counts: IntArray


@dataclass(frozen=True, eq=False)
class Fronts:
    """Fronts in the order of elimination, for matrices of one pattern.

    Attributes
    ----------
    pattern
        Pointers and row numbers of a matrix in columns, or the unknowns of elements.
    order
        Unknowns in the order of elimination, (n,).
    fronts
        Children before parents.
    """

    pattern: tuple[IntArray, ...]
    order: IntArray
    fronts: tuple[Front, ...]

    @property
    def operations(self) -> float:
        """Multiplications and additions of a factorisation."""
        k, m = np.array([front.size for front in self.fronts], dtype=float).T
        return float(np.sum(k**3 / 3.0 + k**2 * m + k * m**2))

    @property
    def entries(self) -> int:
        """Number of entries of a factor."""
        return sum(k * (k + m) for k, m in (front.size for front in self.fronts))

    @cached_property
    def groups(self) -> "Groups":
        """Fronts by height and shape; those of one group are independent."""
        heights = np.zeros(len(self.fronts), dtype=np.int64)
        for f, front in enumerate(self.fronts):
            heights[f] = max((heights[child] + 1 for child in front.children), default=0)
        keys = np.column_stack([heights, [front.size for front in self.fronts]])
        shapes, of, counts = np.unique(keys, axis=0, return_inverse=True, return_counts=True)
        return Groups(of.ravel(), shapes[:, 0], counts)

    def working(self) -> int:
        """Largest number of values in memory besides the factor: a front, and updates of fronts not yet used."""
        most = held = 0
        for front in self.fronts:
            k, m = front.size
            most = max(most, held + (k + m) ** 2 + k * (k + m))
            held += m * m - sum(len(self.fronts[child].rows) ** 2 for child in front.children)
        return most

    def bytes(self, keep: bool, number: int = 8) -> float:
        """Largest memory of a factorisation, with and without its factor, for numbers of a given size in bytes."""
        return float(number) * (self.working() + keep * self.entries)

    def fits(self, A: Symmetric) -> bool:
        """Whether a matrix has this pattern."""
        other = pattern_of(A)
        same = len(self.order) == A.shape[0] and len(other) == len(self.pattern)
        return same and all(np.array_equal(a, b) for a, b in zip(self.pattern, other, strict=True))


def pattern_of(A: Symmetric) -> tuple[IntArray, ...]:
    """The data of a matrix that determine its plan."""
    return A.pattern if isinstance(A, ElementSum) else (A.indptr, A.indices)


def postorder(parent: IntArray) -> IntArray:
    """Order of the nodes: children before their parents and next to them."""
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


def runs(places: IntArray) -> Runs:
    """Ascending indices cut into consecutive pieces: their positions and values.

    >>> runs(np.array([3, 4, 9]))
    ((slice(0, 2, None), slice(3, 5, None)), (slice(2, 3, None), slice(9, 10, None)))
    """
    cuts = [0, *(np.flatnonzero(np.diff(places) > 1) + 1).tolist(), len(places)]
    pieces = pairwise(cuts) if len(places) else ()
    return tuple((slice(a, b), slice(int(places[a]), int(places[b - 1]) + 1)) for a, b in pieces)


class Recent:
    """The last plan, kept while it is in use or small, since shifted and similar matrices share their pattern."""

    last: ReferenceType[Fronts] | None = None
    small: Fronts | None = None


def planned(A: Symmetric) -> Fronts:
    """The plan for a matrix: the last one if the pattern is the same, else a new one."""
    last = Recent.last() if Recent.last is not None else None
    if last is not None and last.fits(A):
        return last
    fronts = plan(A)
    Recent.last, Recent.small = ref(fronts), fronts if sum(map(len, fronts.pattern)) <= SMALL else None
    return fronts


def plan(A: Symmetric) -> Fronts:
    """Plan the factorisation of matrices with the pattern of A, symmetric, with sorted indices.

    >>> from scipy.sparse import csc_array
    >>> fronts = plan(csc_array(np.eye(3)))
    >>> len(fronts.fronts), fronts.entries
    (1, 9)
    """
    vertex, graph = element_graph(A) if isinstance(A, ElementSum) else quotient(A)
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
    return Fronts(pattern_of(A), order, make_fronts(A, order, weight, starts, ends, rows, above, children))


def longest(axes: FloatArray, of: IntArray, fronts: int) -> FloatArray:
    """For each vertex the coordinate along which its front is longest, so that shared vertices stay together."""
    count = np.maximum(np.bincount(of, minlength=fronts), 1)
    mean = np.array([np.bincount(of, x, fronts) / count for x in axes])
    spread = np.array([np.bincount(of, x * x, fronts) / count for x in axes]) - mean**2
    return np.asarray(np.choose(spread.argmax(axis=0)[of], axes))


def later_neighbours(tail: IntArray, head: IntArray, place: IntArray, ends: IntArray) -> list[IntArray]:
    """For each front, the indices of later vertices with which its vertices are coupled."""
    here, there = place[tail], place[head]
    front = np.searchsorted(ends, here, side="right") - 1
    later = np.flatnonzero(there >= ends[front + 1])
    later = later[np.argsort(front[later], kind="stable")]
    cuts = np.searchsorted(front[later], np.arange(1, len(ends) - 1))
    return [np.unique(part) for part in np.split(there[later], cuts)]


def make_fronts(
    A: Symmetric,
    order: IntArray,
    weight: IntArray,
    starts: IntArray,
    ends: IntArray,
    rows: list[IntArray],
    above: IntArray,
    children: list[list[int]],
) -> tuple[Front, ...]:
    """Fronts with their positions in A and in each other.

    Vertices have `weight` unknowns from `starts`, fronts end at `ends`.
    """
    position = np.empty(len(order), dtype=np.int32)
    position[order] = np.arange(len(order), dtype=np.int32)
    firsts = starts[ends]
    if isinstance(A, ElementSum):
        entries: Sequence[Entries] = element_entries(A, position, firsts, rows)
    else:
        entries = sparse_entries(A, order, position, weight, starts, ends, rows)
    fronts = []
    for f, p in enumerate(above.tolist()):  # the last has no rows, and is its own parent here
        split = int(np.searchsorted(rows[f], firsts[p + 1]))
        head = rows[f][:split] - firsts[p]
        tail = np.searchsorted(rows[p], rows[f][split:])
        own = int(firsts[f]), int(firsts[f + 1] - firsts[f]), rows[f], entries[f], tuple(children[f])
        fronts.append(Front(*own, split, compact(head), compact(tail), runs(head), runs(tail)))
    return tuple(fronts)
