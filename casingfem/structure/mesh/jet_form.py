"""Quadratic forms on the jets of a displacement -> element matrices -> matrices on the free dofs, in nodal frames.

The jet of U at a point is (U, d_1 U, d_2 U). With functions f_a(x) f_b(y) on a tensor of points, a form H on the jets
is summed over the points of one direction, then over those of the other. This takes (p + 1)^5 operations for each pair
of dofs; sums over all points at once take (p + 1)^6 (sum factorisation: S.A. Orszag, J. Comput. Phys. 37, 1980, 70).
Forms are symmetric, so each pair of functions of the second direction is summed once.
"""

from collections.abc import Sequence
from functools import cache

import numpy as np
from scipy.sparse import bsr_array, csc_array

from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.linalg.element_sum import Elements, ElementSum
from casingfem.structure.mesh.edge_form import EdgeForm
from casingfem.structure.mesh.element import ElementQuadLobatto, gauss, lagrange
from casingfem.structure.mesh.kinematics import DOFS
from casingfem.structure.mesh.shell_mesh import Grid
from contact.io.threads import with_one_thread

JET = 3 * DOFS
CHUNK = 200_000  # entries of element matrices made together: what stays in a core's cache
SLOTS = ((slice(0, 2), 2), (slice(2, 3), 1))  # of a jet: those with f, with f' of the second direction, and their count


@cache
def products(order: int) -> tuple[tuple[FloatArray, ...], FloatArray, IntArray]:
    """Products of two functions of one direction at its points, and the positions of the products of both.

    First direction: each pair of parts of `SLOTS`, ((a, b), (slots, slots, points)). Second direction: only a <= b,
    ((a, b), (parts, parts, points)). The last array (functions 5 functions 5,) gives, for each entry of an element's
    matrix, its number among all (pair of the second direction, pair of the first, dof, dof).
    """
    n = order + 1
    f = np.stack(lagrange(order, gauss(n)[0]))
    both = np.einsum("kaq,lbq->abklq", f, f)
    first = tuple(both[:, :, :k, :m].reshape(n * n, -1) for _, k in SLOTS for _, m in SLOTS)
    low, high = np.triu_indices(n)
    couple = np.zeros((n, n), dtype=np.int64)
    couple[low, high] = couple[high, low] = np.arange(len(low))
    a, b = (np.repeat(x, DOFS) for x in ElementQuadLobatto(order).pairs.T)
    dof = np.tile(np.arange(DOFS), n * n)
    row, column = a * n * DOFS**2 + dof * DOFS, a * DOFS**2 + dof
    place = np.where(b[:, None] <= b, row[:, None] + column, row + column[:, None])
    place += couple[b[:, None], b] * (n * DOFS) ** 2
    return first, both[low, high].reshape(len(low), -1), place.ravel()


def point_jets(grid: Grid, fields: Array) -> Array:
    """U, d_1 U, d_2 U of nodal fields (nodes, 5, k) at the quadrature points: (elements, points, 15, k)."""
    local = fields[grid.elements]
    elements, points = len(grid.elements), grid.table.shape[2]
    flat = local.reshape(elements, grid.table.shape[1], -1)
    jets = np.empty((elements, points, 3, flat.shape[2]), dtype=np.result_type(fields, grid.size))
    for slot, table in enumerate(grid.table):
        np.matmul(table.T, flat, out=jets[:, :, slot])
    jets[:, :, 1:] /= grid.size.T[:, None, :, None]
    return np.asarray(jets.reshape(elements, points, JET, fields.shape[2]))


def nodal_forces(grid: Grid, jets: Array) -> Array:
    """Forces (nodes, 5, k) that do the work of `jets` (elements, points, 15, k): the transpose of `point_jets`."""
    elements, functions, points = len(grid.elements), grid.table.shape[1], grid.table.shape[2]
    slots = jets.reshape(elements, points, 3, -1).copy()
    slots[:, :, 1:] /= grid.size.T[:, None, :, None]
    local = sum(np.matmul(table, slots[:, :, slot]) for slot, table in enumerate(grid.table))
    count = elements * functions
    ones = np.ones(count), grid.elements.ravel(), np.arange(count + 1)  # one in each column: nothing to sort
    sums = csc_array(ones, (grid.nodes.shape[1], count)) @ np.asarray(local).reshape(count, -1)
    return np.asarray(sums.reshape(grid.nodes.shape[1], DOFS, jets.shape[3]))


@with_one_thread
def jet_elements(grid: Grid, H: Array) -> FloatArray:
    """Element matrices (elements, 5 functions, 5 functions) of a form on the jets (elements, points, 15, 15)."""
    n, elements = grid.mesh.order + 1, len(grid.elements)
    first, second, place = products(grid.mesh.order)
    scale = np.repeat(np.concatenate([np.ones((1, elements)), 1.0 / grid.size]), DOFS, axis=0).T  # of d_1, d_2
    matrices = np.empty((elements, (n * n * DOFS) ** 2))
    step = max(1, CHUNK // (DOFS * n * n) ** 2)
    for low in range(0, elements, step):
        own = slice(low, low + step)
        scaled = H[own] * (scale[own, :, None] * scale[own, None, :])[:, None]
        order = (0, 2, 3, 5, 1, 4, 6)  # e, y, slot, slot, x, dof, dof
        jets = scaled.reshape(-1, n, n, 3, DOFS, 3, DOFS).transpose(order)
        sums = np.empty((len(scaled), 4, n, n * n, DOFS * DOFS))
        for part, table in enumerate(first):
            (rows, _), (columns, _) = SLOTS[part // 2], SLOTS[part % 2]
            at_x = jets[:, :, rows, columns].reshape(len(scaled), n, -1, DOFS * DOFS)
            np.matmul(table, at_x, out=sums[:, part])
        half = np.matmul(second, sums.reshape(len(scaled), 4 * n, -1)).reshape(len(scaled), -1)
        for whole, part in zip(matrices[own], half, strict=True):
            np.take(part, place, out=whole, mode="clip")  # without a buffer
    return matrices.reshape(elements, n * n * DOFS, n * n * DOFS)


def rotate_elements(matrices: FloatArray, grid: Grid, frames: FloatArray) -> None:
    """Express the rows and columns of symmetric element matrices in the nodal frames, in place."""
    shift = np.zeros_like(frames)
    shift[:, :3, 3:] = frames[:, :3, 3:]
    plain = np.all(frames == np.eye(DOFS) + shift, axis=(1, 2))  # rotations that take displacements with them
    if shift[plain].any():
        shift_elements(matrices, np.where(plain[:, None, None], shift, 0.0)[grid.elements])
    frames, turned = np.where(plain[:, None, None], np.eye(DOFS), frames), ~plain
    for e in np.flatnonzero(turned[grid.elements].any(axis=1)):  # only elements on edges with a frame
        R = frames[grid.elements[e]]
        K = matrices[e].reshape(len(R), DOFS, len(R), DOFS)
        K = np.einsum("nji,njmd,mdk->nimk", R, K, R, optimize=True)
        matrices[e] = K.reshape(matrices[e].shape)


def shift_elements(matrices: FloatArray, shift: FloatArray) -> None:
    """Express symmetric element matrices in rotations that also displace the nodes, in place.

    `shift` (elements, functions, 5, 5) is the displacement due to a node's rotation. K R is computed as (R^T K)^T, so
    both products are of contiguous rows.
    """
    nodal = np.ascontiguousarray(shift[:, :, :3, 3:].swapaxes(2, 3))
    for K, node in zip(matrices, nodal, strict=True):
        rows = K.reshape(len(node), DOFS, len(K))
        rows[:, 3:] += np.matmul(node, rows[:, :3])
        K[:] = K.T.copy()
        rows[:, 3:] += np.matmul(node, rows[:, :3])


def element_sum(
    matrices: FloatArray, grid: Grid, frames: FloatArray, free: IntArray, forms: Sequence[EdgeForm] = ()
) -> ElementSum:
    """Sum of element matrices (elements, 5 functions, 5 functions), rotated in place, and edge terms, on the free dofs.

    Forms may have dofs of their own after those of the nodes.
    """
    rotate_elements(matrices, grid, frames)
    number = np.full(max(len(frames) * DOFS, int(free.max(initial=0)) + 1), len(free))
    number[free] = np.arange(len(free))
    dofs = (grid.elements[:, :, None] * DOFS + np.arange(DOFS)).reshape(len(matrices), -1)
    walls = Elements(number[dofs], matrices)
    return ElementSum.of([walls, *(edge_elements(form, frames, number) for form in forms)], len(free))


def edge_elements(form: EdgeForm, frames: FloatArray, number: IntArray) -> Elements:
    """Edge forms as elements, one for all points with the same dofs.

    `number` maps a dof to its index among the free ones.
    """
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
    """Blocks (nodes, 5, 5) on each node's five dofs, as a matrix on the free dofs."""
    turned = np.einsum("nji,njk,nkl->nil", frames, blocks, frames, optimize=True)
    nodes = np.arange(len(frames) + 1)
    size = len(frames) * DOFS
    return csc_array(bsr_array((turned, nodes[:-1], nodes), shape=(size, size)).tocsc()[free][:, free])
