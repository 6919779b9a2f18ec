"""Element matrices and nodal blocks -> sparse matrices on the free dofs, in the nodal frames."""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from scipy.sparse import bsr_array, csc_array, csr_array

from casingfem.io.arrays import FloatArray, IntArray
from casingfem.structure.mesh.kinematics import DOFS
from casingfem.structure.mesh.shell_mesh import Grid

CHUNK = 4_000_000  # entries placed together
KEPT = 15_000_000  # entries whose places are kept, 60 MB


def rotate_elements(matrices: FloatArray, grid: Grid, frames: FloatArray) -> None:
    """Express the rows and columns of the element matrices in the nodal frames, in place."""
    turned = np.any(frames != np.eye(DOFS), axis=(1, 2))
    for e in np.flatnonzero(turned[grid.elements].any(axis=1)):  # only elements on edges with a frame
        R = frames[grid.elements[e]]
        K = matrices[e].reshape(len(R), DOFS, len(R), DOFS)
        K = np.einsum("nji,njmd,mdk->nimk", R, K, R, optimize=True)
        matrices[e] = K.reshape(matrices[e].shape)


@dataclass(frozen=True, slots=True, eq=False)
class Pattern:
    """Where entries of element matrices stand in a sparse matrix of columns on the free dofs.

    That is the pattern of the nodes: which are coupled is found once, and where a couple's entries stand follows.

    Attributes
    ----------
    elements, free
        What it was made for.
    starts, rows
        Pointers and row numbers of the sparse matrix.
    first, place, height
        Of each node where its columns start and how many entries each has; the place of each of its dofs among the free
        ones (nodes, 5), beyond all entries for those that are held.
    keys, above
        Couples of nodes as numbers, ascending, and the entries of a column that stand above a couple's.
    slots
        `places` of all elements, where these are few enough to be kept.
    """

    elements: IntArray
    free: IntArray
    starts: IntArray
    rows: IntArray
    first: IntArray
    place: IntArray
    height: IntArray
    keys: IntArray
    above: IntArray
    slots: list[IntArray] = field(default_factory=list)

    def fits(self, elements: IntArray, free: IntArray) -> bool:
        """Whether it was made for these."""
        return np.array_equal(elements, self.elements) and np.array_equal(free, self.free)

    def chunks(self) -> Iterator[tuple[slice, IntArray]]:
        """Elements, some at a time, and where the entries of their matrices stand; held ones are beyond the last."""
        step = max(1, CHUNK // (self.elements.shape[1] * DOFS) ** 2)
        parts = [slice(low, low + step) for low in range(0, len(self.elements), step)]
        if self.slots:
            yield from zip(parts, self.slots, strict=True)
            return
        keep = len(self.elements) * (self.elements.shape[1] * DOFS) ** 2 <= KEPT
        for part in parts:
            slots = self.places(self.elements[part])
            if keep:
                self.slots.append(slots)
            yield part, slots

    def places(self, own: IntArray) -> IntArray:
        """Where the entries of some elements' matrices stand, one after the other."""
        couple = np.searchsorted(self.keys, own[:, :, None] * len(self.first) + own[:, None, :])
        columns = self.first[own][:, :, None] + self.place[own] * self.height[own][:, :, None]
        places = columns[:, :, :, None, None] + self.above[couple][:, :, None, :, None]
        places = places + self.place[own][:, None, None, :, :]
        return np.asarray(np.minimum(places, self.starts[-1]).astype(self.rows.dtype).ravel())


class Recent:
    """The pattern last made: an update assembles one mesh again and again."""

    pattern: Pattern | None = None


def pattern_of(elements: IntArray, nodes: int, free: IntArray) -> Pattern:
    """The pattern of the free dofs, that of the last call if it was for the same."""
    if Recent.pattern is not None and Recent.pattern.fits(elements, free):
        return Recent.pattern
    number = np.full(nodes * DOFS, -1)
    number[free] = np.arange(len(free))
    held = number.reshape(nodes, DOFS) < 0
    width = DOFS - np.count_nonzero(held, axis=1)  # free dofs of a node
    couples = coupled_nodes(elements, nodes)
    per_node = np.diff(couples.indptr)
    above = np.append(0, np.cumsum(width[couples.indices]))
    height = np.diff(above[couples.indptr])  # entries of each column of a node
    starts = np.append(0, np.cumsum(np.repeat(height, width)))
    index = np.int32 if starts[-1] < 2**31 - 1 else np.int64  # what sparse factors take without a copy
    found = Pattern(
        elements=elements,
        free=free,
        starts=starts.astype(index),
        rows=stacked_rows(couples, width, index),
        first=starts[np.append(0, np.cumsum(width))[:-1]],
        place=np.where(held, starts[-1], np.cumsum(~held, axis=1) - 1),
        height=height,
        keys=np.repeat(np.arange(nodes), per_node) * nodes + couples.indices,
        above=above[:-1] - np.repeat(above[couples.indptr[:-1]], per_node),
    )
    Recent.pattern = found if len(found.rows) <= KEPT else None
    return found


def scatter_elements(matrices: FloatArray, grid: Grid, frames: FloatArray, free: IntArray) -> csc_array:
    """Sum of symmetric element matrices (elements, 5 functions, 5 functions) on the free dofs; turned in place."""
    rotate_elements(matrices, grid, frames)
    pattern = pattern_of(grid.elements, grid.nodes.shape[1], free)
    data = np.zeros(len(pattern.rows) + 1, dtype=matrices.dtype)
    for part, slots in pattern.chunks():
        np.add.at(data, slots, matrices[part].ravel())
    rows = pattern.rows.copy() if pattern is Recent.pattern else pattern.rows
    return csc_array((data[:-1], rows, pattern.starts.copy()), shape=(len(free), len(free)))


def added(K: csc_array, edges: csc_array) -> csc_array:
    """K + edges, in the memory of K where its pattern, sorted, holds that of a matrix with few entries."""
    edges = csc_array(edges)
    columns = np.repeat(np.arange(edges.shape[1]), np.diff(edges.indptr))
    filled, column = np.unique(columns, return_inverse=True)
    degree = np.diff(K.indptr)[filled]
    entries = np.repeat(K.indptr[filled] - np.append(0, np.cumsum(degree))[:-1], degree) + np.arange(degree.sum())
    keys = np.repeat(np.arange(len(filled)), degree) * K.shape[0] + K.indices[entries]
    wanted = column * K.shape[0] + edges.indices
    at = np.minimum(np.searchsorted(keys, wanted), max(len(keys) - 1, 0))
    if not (len(keys) and np.array_equal(keys[at], wanted)):
        return csc_array(K + edges)
    np.add.at(K.data, entries[at], edges.data)
    return K


def coupled_nodes(elements: IntArray, nodes: int) -> csr_array:
    """The pattern (nodes, nodes) of nodes that share an element."""
    owner = np.repeat(np.arange(len(elements)), elements.shape[1])
    touches = csr_array((np.ones(elements.size), (owner, elements.ravel())), shape=(len(elements), nodes))
    couples = csr_array(touches.T @ touches)
    couples.sort_indices()
    return couples


def stacked_rows(couples: csr_array, width: IntArray, index: type) -> IntArray:
    """Row numbers of all entries: for each free dof of a node those of the nodes that it is coupled with."""
    counts = width[couples.indices]
    ends = np.append(0, np.cumsum(counts))
    before = (np.cumsum(width) - width)[couples.indices] - ends[:-1]
    rows: IntArray = (np.repeat(before, counts) + np.arange(ends[-1])).astype(index)
    parts = np.split(rows, ends[couples.indptr[1:-1]])
    return np.concatenate([part for part, columns in zip(parts, width.tolist(), strict=True) for _ in range(columns)])


def scatter_blocks(blocks: FloatArray, frames: FloatArray, free: IntArray) -> csc_array:
    """Blocks of each node on its own five dofs (nodes, 5, 5), on the free dofs."""
    turned = np.einsum("nji,njk,nkl->nil", frames, blocks, frames, optimize=True)
    nodes = np.arange(len(frames) + 1)
    size = len(frames) * DOFS
    return csc_array(bsr_array((turned, nodes[:-1], nodes), shape=(size, size)).tocsc()[free][:, free])
