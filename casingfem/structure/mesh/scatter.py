"""Element matrices and nodal blocks -> sparse matrices on the free dofs, in the nodal frames."""

import numpy as np
from scipy.sparse import bsr_array, coo_array, csc_array

from casingfem.io.arrays import FloatArray, IntArray
from casingfem.structure.mesh.kinematics import DOFS
from casingfem.structure.mesh.shell_mesh import Grid


def rotate_elements(matrices: FloatArray, grid: Grid, frames: FloatArray) -> None:
    """Express the rows and columns of the element matrices in the nodal frames, in place."""
    turned = np.any(frames != np.eye(DOFS), axis=(1, 2))
    for e in np.flatnonzero(turned[grid.elements].any(axis=1)):  # only elements on edges with a frame
        R = frames[grid.elements[e]]
        K = matrices[e].reshape(len(R), DOFS, len(R), DOFS)
        K = np.einsum("nji,njmd,mdk->nimk", R, K, R, optimize=True)
        matrices[e] = K.reshape(matrices[e].shape)


def scatter_elements(matrices: FloatArray, grid: Grid, frames: FloatArray, free: IntArray) -> csc_array:
    """Sum of element matrices (elements, 5 functions, 5 functions) on the free dofs; they are turned in place."""
    rotate_elements(matrices, grid, frames)
    number = np.full(grid.nodes.shape[1] * DOFS, -1, dtype=np.int32)  # what SuperLU takes without a copy
    number[free] = np.arange(len(free), dtype=np.int32)
    dofs = number[(grid.elements[:, :, None] * DOFS + np.arange(DOFS)).reshape(len(grid.elements), -1)]
    rows, columns = np.broadcast_arrays(dofs[:, :, None], dofs[:, None, :])
    i, j = rows.ravel(), columns.ravel()
    kept = (i >= 0) & (j >= 0)
    return coo_array((matrices.ravel()[kept], (i[kept], j[kept])), shape=(len(free), len(free))).tocsc()


def scatter_blocks(blocks: FloatArray, frames: FloatArray, free: IntArray) -> csc_array:
    """Blocks of each node on its own five dofs (nodes, 5, 5), on the free dofs."""
    turned = np.einsum("nji,njk,nkl->nil", frames, blocks, frames, optimize=True)
    nodes = np.arange(len(frames) + 1)
    size = len(frames) * DOFS
    return csc_array(bsr_array((turned, nodes[:-1], nodes), shape=(size, size)).tocsc()[free][:, free])
