"""Isoparametric cells and facets at quadrature points, their measures, and sums of their matrices."""

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array, csc_array

from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.structure.imported.mesh.cell_kind import KINDS, rule
from casingfem.structure.imported.mesh.collapsed import native
from casingfem.structure.imported.mesh.mesh_data import MeshData, natives


class Mapped(NamedTuple):
    """Isoparametric cells at quadrature points: positions, tangents, shape functions, measure."""

    x: FloatArray  # (cells, q, 3)
    tangents: FloatArray  # dx/dr_i, (cells, q, dim, 3)
    values: FloatArray  # shape functions, (nodes, q)
    slopes: FloatArray  # their local derivatives, (dim, nodes, q)
    measure: FloatArray  # signed volume, area or length with the weights, (cells, q)


def mapped(kind: str, points: FloatArray, cells: IntArray, degree: int | None = None) -> Mapped:
    """Quadrature of the reference cell mapped to cells with nodes at points (nodes, 3)."""
    _, weights, values, slopes = rule(kind, degree)
    nodes = points[cells]
    x = np.einsum("kq,ekc->eqc", values, nodes, optimize=True)
    tangents = np.einsum("dkq,ekc->eqdc", slopes, nodes, optimize=True)
    dim = KINDS[kind].dim
    if dim == 3:
        measure = np.linalg.det(tangents)
    elif dim == 2:
        measure = np.linalg.norm(np.cross(tangents[:, :, 0], tangents[:, :, 1]), axis=-1)
    else:
        measure = np.linalg.norm(tangents[:, :, 0], axis=-1)
    return Mapped(x, tangents, values, slopes, measure * weights)


def mapped_parts(mesh: MeshData, degree: int | None = None) -> Iterator[tuple[IntArray, IntArray, Mapped]]:
    """The cells of a mesh by their kind of integration: rows, their own nodes (m, k), and the mapped cells."""
    for kind, rows, slots in natives(mesh):
        nodes = mesh.cells[rows][:, slots]
        yield rows, nodes, mapped(kind, mesh.points, nodes, degree)


def facet_shape_products(mesh: MeshData, facets: IntArray) -> tuple[FloatArray, IntArray, FloatArray]:
    """Integrals of N_i N_j over facets (m, k, k), their nodes (m, k), and the area or length of each (m,)."""
    nodes = mesh.facet_nodes(facets)
    products, size = shape_products(mesh.points, nodes, native(mesh.cell_kind.facet, nodes))
    return products, nodes, size


def shape_products(
    points: FloatArray, cells: IntArray, parts: Iterable[tuple[str, IntArray, IntArray]]
) -> tuple[FloatArray, FloatArray]:
    """Integrals of N_i N_j over cells or facets (m, k), (m, k, k), and the size of each (m,), part by part.

    Parts are kinds, rows and indices of a kind's own nodes, as in `native`.
    """
    count = cells.shape[1]
    products, size = np.zeros((len(cells), count, count)), np.zeros(len(cells))
    for kind, rows, slots in parts:
        on = mapped(kind, points, cells[rows][:, slots])
        own = np.einsum("iq,jq,mq->mij", on.values, on.values, on.measure, optimize=True)
        products[rows[:, None, None], slots[:, None], slots] = own
        size[rows] = on.measure.sum(axis=1)
    return products, size


CHUNK = 4_000_000  # entries of a strain table held at a time


def cell_dofs(cells: IntArray, dofs: int) -> IntArray:
    """Dofs of each cell, node by node, (cells, dofs * nodes)."""
    return np.asarray((cells[:, :, None] * dofs + np.arange(dofs)).reshape(len(cells), -1))


def scatter(matrices: Array, rows: IntArray, size: int) -> csc_array:
    """Sum cell matrices (cells, m, m) into a sparse one (size, size) at the dofs rows (cells, m), without zeros.

    Cells are processed in batches whose indexed entries fit into memory; sums of similar size are added.
    """
    small, m = rows.astype(np.int32), rows.shape[1]
    step = max(1, 2 * CHUNK // m**2)
    sums = [csc_array((size, size), dtype=matrices.dtype)]
    for start in range(0, len(rows), step):
        part = small[start : start + step]
        i, j = np.broadcast_arrays(part[:, :, None], part[:, None, :])
        one = coo_array((matrices[start : start + step].ravel(), (i.ravel(), j.ravel())), shape=(size, size)).tocsc()
        one.eliminate_zeros()
        sums.append(one)
        while len(sums) > 1 and sums[-2].nnz < 2 * sums[-1].nnz:
            sums[-2:] = [csc_array(sums[-2] + sums[-1])]
    while len(sums) > 1:
        sums[-2:] = [csc_array(sums[-2] + sums[-1])]
    return sums[0]


def scatter_forces(forces: FloatArray, rows: IntArray, size: int) -> FloatArray:
    """Sum forces of cells (cells, m) into a vector (size,) at the dofs rows (cells, m)."""
    return np.asarray(np.bincount(rows.ravel(), forces.ravel(), size), dtype=float)


def on_free(A: csc_array, free: IntArray) -> csc_array:
    """Rows and columns of the free dofs, without stored zeros, exactly symmetric."""
    return symmetric(csc_array(A[:, free][free]))


def symmetric(A: csc_array) -> csc_array:
    """The symmetric part of a matrix that is symmetric up to round-off, without stored zeros."""
    A = csc_array(0.5 * (A + A.T))
    A.eliminate_zeros()
    A.sort_indices()  # products of sparse matrices are not in order
    return A


def put(total: FloatArray, rows: IntArray, slots: IntArray, matrices: FloatArray, dofs: int) -> None:
    """Add matrices of cells with some of the nodes, in their order, to the matrices of all nodes, (cells, m, m)."""
    if dofs * len(slots) == total.shape[1]:
        total[rows] = matrices
        return
    places = cell_dofs(slots[None], dofs)[0]
    total[rows[:, None, None], places[:, None], places] = matrices
