"""Entries of the matrix for a front: from a sparse matrix, or from dense element matrices.

The whole matrix of an element belongs to the front that eliminates the first of its unknowns; the others are coupled
with that one, so they are pivots or rows of the same front. If an element has a front to itself, its matrix is that
front.
"""

from collections.abc import Sequence
from typing import NamedTuple, TypeAlias

import numpy as np
from scipy.sparse import coo_array, csc_array, csr_array

from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.linalg.dissection import SEED, Graph, spans
from casingfem.linalg.element_sum import ElementSum

Symmetric: TypeAlias = csc_array | ElementSum
Places: TypeAlias = slice | IntArray
Parts: TypeAlias = tuple[Array, Array, Array]


class SparseEntries(NamedTuple):
    """Part of sparse matrices for a front: entries `source` of A's data go to entries `place` of the front's columns.

    Those of the pivots (k, k) come first, one column after the other, then those of the rows (m, k).
    """

    source: IntArray
    place: IntArray

    def parts(self, A: Symmetric, pivots: IntArray, rows: IntArray) -> Parts:
        """The front of a matrix on unknowns `pivots` (k,) and `rows` (m,): (k, k), (m, k), (m, m), by columns.

        At least the lower triangle of the first and last is filled.
        """
        assert not isinstance(A, ElementSum)
        k, m = len(pivots), len(rows)
        columns = np.zeros(k * (k + m), dtype=A.data.dtype)
        columns[self.place] = A.data[self.source]
        K_rr = np.zeros((m, m), dtype=A.data.dtype, order="F")
        return columns[: k * k].reshape((k, k), order="F"), columns[k * k :].reshape((m, k), order="F"), K_rr


class Piece(NamedTuple):
    """An element: its group and index, its unknowns that are pivots and rows of the front, and their places there."""

    group: int
    number: int
    pivots: Places
    rows: Places
    to_pivots: Places
    to_rows: Places


class ElementEntries(NamedTuple):
    """Part of sums of elements for a front: the elements that belong to it."""

    pieces: tuple[Piece, ...]

    def parts(self, A: Symmetric, pivots: IntArray, rows: IntArray) -> Parts:
        """The front of a sum of elements, in parts as in `SparseEntries`."""
        assert isinstance(A, ElementSum)
        k, m = len(pivots), len(rows)
        K_pp, K_pr, K_rr = np.zeros((k, k)), np.zeros((k, m)), np.zeros((m, m))
        on, beside = A.scale[pivots], A.scale[rows]
        for number, p in enumerate(self.pieces):
            B = A.groups[p.group].matrices[p.number]
            of_pivots, of_rows = B[p.pivots], B[p.rows]
            accumulate(K_pp, p.to_pivots, p.to_pivots, of_pivots[:, p.pivots], on, on, number == 0)
            accumulate(K_pr, p.to_pivots, p.to_rows, of_pivots[:, p.rows], on, beside, number == 0)
            accumulate(K_rr, p.to_rows, p.to_rows, of_rows[:, p.rows], beside, beside, number == 0)
        K_pp[np.arange(k), np.arange(k)] += A.diagonal[pivots]
        return K_pp.T, K_pr.T, K_rr.T


Entries: TypeAlias = SparseEntries | ElementEntries


def accumulate(
    K: FloatArray, rows: Places, columns: Places, part: FloatArray, left: FloatArray, right: FloatArray, empty: bool
) -> None:
    """K[rows, columns] += part, with scaled rows and columns; `empty`: K is still zero."""
    if empty and isinstance(rows, slice) and isinstance(columns, slice):
        there = K[rows, columns]
        np.multiply(part, right[columns], out=there)
        there *= left[rows, None]
        return
    scaled = left[rows, None] * part * right[columns]
    if isinstance(rows, slice) or isinstance(columns, slice):
        K[rows, columns] += scaled
    else:
        K[np.ix_(rows, columns)] += scaled


def element_graph(A: ElementSum) -> tuple[IntArray, Graph]:
    """The vertex of each unknown, and the graph of a sum of elements; unknowns of one vertex share their elements."""
    rng = np.random.default_rng(SEED)
    sums = np.zeros(A.size + 1, dtype=np.int64)
    for dofs in A.pattern:
        np.add.at(sums, dofs, rng.integers(2**62, size=(len(dofs), 1)))
    _, vertex = np.unique(sums[:-1], return_inverse=True)
    weight = np.bincount(vertex)
    size = len(weight)
    edges = csr_array((size, size))
    for dofs in A.pattern:
        element, column = np.nonzero(dofs < A.size)
        touched = vertex[dofs[element, column]]
        within = csr_array(coo_array((np.ones(len(touched)), (element, touched)), shape=(len(dofs), size)))
        edges = edges + within.T @ within
    found = csr_array(edges).tocoo()
    apart = found.row != found.col
    order = np.lexsort((found.col[apart], found.row[apart]))
    return vertex, Graph(weight, found.row[apart][order].astype(np.int64), found.col[apart][order].astype(np.int64))


def element_entries(A: ElementSum, position: Array, firsts: IntArray, rows: Sequence[IntArray]) -> list[ElementEntries]:
    """The elements of each front; unknowns have a `position` in the elimination, fronts start at `firsts`."""
    found: list[list[Piece]] = [[] for _ in rows]
    known = np.append(position, -1)
    for g, dofs in enumerate(A.pattern):
        places = known[dofs]
        order = np.argsort(places, axis=1, kind="stable")
        held = np.count_nonzero(places < 0, axis=1)
        for e in np.flatnonzero(held < dofs.shape[1]).tolist():
            inside = order[e, held[e] :]
            at = places[e, inside]
            f = int(np.searchsorted(firsts, at[0], side="right")) - 1
            split = int(np.searchsorted(at, firsts[f + 1]))
            own = (inside[:split], inside[split:], at[:split] - firsts[f], np.searchsorted(rows[f], at[split:]))
            found[f].append(Piece(g, e, *(compact(part) for part in own)))
    return [ElementEntries(tuple(pieces)) for pieces in found]


def compact(places: IntArray) -> Places:
    """Indices as a slice, if they are consecutive."""
    if len(places) and places[-1] - places[0] == len(places) - 1 and np.all(np.diff(places) == 1):
        return slice(int(places[0]), int(places[-1]) + 1)
    return places


def sparse_entries(
    A: csc_array,
    order: IntArray,
    position: Array,
    weight: IntArray,
    starts: IntArray,
    ends: IntArray,
    rows: Sequence[IntArray],
) -> list[SparseEntries]:
    """The entries of each front; vertices have `weight` unknowns from `starts`, the fronts' vertices end at `ends`."""
    local = np.zeros(len(order), dtype=np.int32)  # places of unknowns in the front at hand
    degree = np.diff(A.indptr)
    found = []
    for f, below in enumerate(rows):  # found for the first unknown of each vertex, the others follow
        own = slice(ends[f], ends[f + 1])
        start, end = int(starts[ends[f]]), int(starts[ends[f + 1]])
        k, m, unknowns = end - start, len(below), order[start:end]
        local[start:end], local[below] = np.arange(k), k + np.arange(m)
        first = unknowns[starts[own] - start] if k else unknowns
        entries = degree[first]
        inside = spans(np.zeros_like(entries), entries)
        row = position[A.indices[inside + np.repeat(A.indptr[first], entries)]]
        kept = row >= np.repeat(starts[own], entries)  # the lower triangle, and vertices' own blocks
        inside, row = inside[kept], local[row[kept]]
        last = np.append(0, np.cumsum(kept))[np.cumsum(entries)]
        here = row < k
        place, step = np.where(here, row, k * k + row - k), np.where(here, k, m)
        number = np.int32 if max(len(A.indices), k * (k + m)) < 2**31 else np.int64
        each = np.repeat(np.diff(last, prepend=0), weight[own])  # entries of each unknown
        of = spans(np.repeat(np.append(0, last)[:-1], weight[own]), each)
        column, begin = (np.repeat(x.astype(number), each) for x in (np.arange(k), A.indptr[unknowns]))
        at, on, stride = (x.astype(number)[of] for x in (inside, place, step))
        found.append(SparseEntries(at + begin, on + stride * column))
    return found
