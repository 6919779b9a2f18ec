"""Element matrices and nodal blocks -> sparse matrices on the free dofs, in the nodal frames."""

import numpy as np
from scipy.sparse import bsr_array, csc_array, csr_array

from casingfem.io.arrays import FloatArray, IntArray
from casingfem.structure.mesh.kinematics import DOFS
from casingfem.structure.mesh.shell_mesh import Grid

CHUNK = 4_000_000  # entries placed together


def rotate_elements(matrices: FloatArray, grid: Grid, frames: FloatArray) -> None:
    """Express the rows and columns of the element matrices in the nodal frames, in place."""
    turned = np.any(frames != np.eye(DOFS), axis=(1, 2))
    for e in np.flatnonzero(turned[grid.elements].any(axis=1)):  # only elements on edges with a frame
        R = frames[grid.elements[e]]
        K = matrices[e].reshape(len(R), DOFS, len(R), DOFS)
        K = np.einsum("nji,njmd,mdk->nimk", R, K, R, optimize=True)
        matrices[e] = K.reshape(matrices[e].shape)


def scatter_elements(matrices: FloatArray, grid: Grid, frames: FloatArray, free: IntArray) -> csc_array:
    """Sum of symmetric element matrices (elements, 5 functions, 5 functions) on the free dofs; turned in place.

    The pattern is that of the nodes: which are coupled is found once, and where a couple's entries stand follows.
    """
    rotate_elements(matrices, grid, frames)
    nodes, elements = grid.nodes.shape[1], grid.elements
    number = np.full(nodes * DOFS, -1)
    number[free] = np.arange(len(free))
    held = number.reshape(nodes, DOFS) < 0
    width = DOFS - np.count_nonzero(held, axis=1)  # free dofs of a node
    couples = coupled_nodes(elements, nodes)
    per_node = np.diff(couples.indptr)
    above = np.append(0, np.cumsum(width[couples.indices]))
    height = np.diff(above[couples.indptr])  # entries of each column of a node
    above = above[:-1] - np.repeat(above[couples.indptr[:-1]], per_node)  # of them, those above a couple
    starts = np.append(0, np.cumsum(np.repeat(height, width)))
    first = starts[np.append(0, np.cumsum(width))[:-1]]
    place = np.where(held, starts[-1], np.cumsum(~held, axis=1) - 1)  # among the free dofs of the node; held: outside
    keys = np.repeat(np.arange(nodes), per_node) * nodes + couples.indices
    data = np.zeros(starts[-1] + 1, dtype=matrices.dtype)
    step = max(1, CHUNK // max(1, matrices[:1].size))
    for low in range(0, len(elements), step):
        own = elements[low : low + step]
        couple = np.searchsorted(keys, own[:, :, None] * nodes + own[:, None, :])
        columns = first[own][:, :, None] + place[own] * height[own][:, :, None]
        slots = columns[:, :, :, None, None] + above[couple][:, :, None, :, None] + place[own][:, None, None, :, :]
        np.add.at(data, np.minimum(slots, starts[-1], out=slots).ravel(), matrices[low : low + step].ravel())
    index = np.int32 if starts[-1] < 2**31 else np.int64  # what sparse factors take without a copy
    rows = stacked_rows(couples, width, index)
    return csc_array((data[:-1], rows, starts.astype(index)), shape=(len(free), len(free)))


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
