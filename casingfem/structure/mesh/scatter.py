"""Element matrices, what stands on edges and nodal blocks -> matrices on the free dofs, in the nodal frames."""

from collections.abc import Sequence

import numpy as np
from scipy.sparse import bsr_array, csc_array

from casingfem.io.arrays import FloatArray, IntArray
from casingfem.linalg.element_sum import Elements, ElementSum
from casingfem.structure.mesh.edge_form import EdgeForm
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


def element_sum(
    matrices: FloatArray, grid: Grid, frames: FloatArray, free: IntArray, forms: Sequence[EdgeForm] = ()
) -> ElementSum:
    """Element matrices (elements, 5 functions, 5 functions), turned in place, and what stands on edges, on free dofs.

    Beyond the dofs of the nodes forms may have their own.
    """
    rotate_elements(matrices, grid, frames)
    number = np.full(max(len(frames) * DOFS, int(free.max(initial=0)) + 1), len(free))
    number[free] = np.arange(len(free))
    dofs = (grid.elements[:, :, None] * DOFS + np.arange(DOFS)).reshape(len(matrices), -1)
    walls = Elements(number[dofs], matrices)
    return ElementSum.of([walls, *(edge_elements(form, frames, number) for form in forms)], len(free))


def edge_elements(form: EdgeForm, frames: FloatArray, number: IntArray) -> Elements:
    """What stands on an edge as elements, one for all points on the same dofs; `number` is a dof's among the free."""
    dofs, of = np.unique(form.dofs, axis=0, return_inverse=True)
    B = form.B
    if np.any(frames != np.eye(DOFS)):
        node, which = np.divmod(form.dofs, DOFS)
        own = node >= len(frames)  # not a node's
        turns = frames[np.where(own, 0, node)[:, :, None], which[:, :, None], which[:, None, :]]
        turns = np.where(own[:, :, None], np.eye(form.dofs.shape[1]), turns)
        B = B @ np.where(form.dofs[:, :, None] // DOFS == form.dofs[:, None, :] // DOFS, turns, 0.0)
    matrices = np.zeros((len(dofs), dofs.shape[1], dofs.shape[1]))
    np.add.at(matrices, of.ravel(), B.transpose(0, 2, 1) @ (form.D @ B))
    return Elements(number[dofs], matrices)


def scatter_blocks(blocks: FloatArray, frames: FloatArray, free: IntArray) -> csc_array:
    """Blocks of each node on its own five dofs (nodes, 5, 5), on the free dofs."""
    turned = np.einsum("nji,njk,nkl->nil", frames, blocks, frames, optimize=True)
    nodes = np.arange(len(frames) + 1)
    size = len(frames) * DOFS
    return csc_array(bsr_array((turned, nodes[:-1], nodes), shape=(size, size)).tocsc()[free][:, free])
