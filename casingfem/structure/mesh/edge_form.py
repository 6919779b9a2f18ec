"""Springs, beams and masses on an edge, all as quadratic forms of one kind.

    2 energy = sum_q (B_q x_q)^T D_q (B_q x_q),   x_q the dofs numbered dofs[q]

Assembly uses its matrix; sensitivities use its products with modes. Both are analytic in B and D, so complex steps can
be used. A support gets an edge as an `EdgeLine` and returns `PointSprings`.
"""

from collections.abc import Callable
from typing import Any, NamedTuple, Protocol, Self, runtime_checkable

import numpy as np
from scipy.sparse import coo_array, csc_array

from casingfem.io.arrays import Array, IntArray
from casingfem.structure.mesh.kinematics import DOFS


class EdgeForm(NamedTuple):
    """One quadratic form: dofs (points, local), B (points, rows, local), D (points, rows, rows)."""

    dofs: IntArray
    B: Array
    D: Array

    def product(self, fields: Array) -> Array:
        """Phi^T A Phi for columns Phi over all dofs, (columns, columns).

        >>> spring = EdgeForm(dofs=np.array([[1]]), B=np.ones((1, 1, 1)), D=np.full((1, 1, 1), 5.0))
        >>> spring.product(np.array([[7.0], [2.0]])).tolist()
        [[20.0]]
        """
        strain = np.matmul(self.B, fields[self.dofs])
        stress = np.matmul(self.D, strain)
        columns = fields.shape[1]
        return np.asarray(strain.reshape(-1, columns).T @ stress.reshape(-1, columns))

    def matrix(self, size: int) -> csc_array:
        """The symmetric matrix A on `size` dofs."""
        local = np.matmul(self.B.transpose(0, 2, 1), np.matmul(self.D, self.B))
        i, j = np.broadcast_arrays(self.dofs[:, :, None], self.dofs[:, None, :])
        return coo_array((local.ravel(), (i.ravel(), j.ravel())), shape=(size, size)).tocsc()


class LineFrame(NamedTuple):
    """An edge at points (q,): chart parameters, unit vectors (3, 3, q), thickness, length per parameter.

    `tangents` (3, 2, q) are the axes of the rotations. `bend` is the curvature along the edge (q,) [1/m], 0 for a
    linear wall.
    """

    a: Array
    b: Array
    directions: Array
    thickness: Array
    stretch: Array
    tangents: Array
    bend: Array


class EdgeLine(NamedTuple):
    """An edge as its supports need it, along its own parameter (an angle on a casing).

    `nodes`, `weights` and `nodal` belong to the Lobatto points of its elements (q,): a node between two elements
    appears twice, once for each. `breaks` are the elements' ends. `frame(x)` is the `LineFrame` at points x.
    `interpolate(x)` gives node numbers and values, each (q, order + 1).
    """

    nodes: IntArray
    weights: Array
    nodal: LineFrame
    breaks: Array
    order: int
    closed: bool
    frame: Callable[[Array], LineFrame]
    interpolate: Callable[[Array], tuple[IntArray, Array]]


class PointSprings(NamedTuple):
    """Springs at points of an edge, multiplied by the integration weights.

    They act on motions that `values` (q, m) interpolate from `nodes` (q, m). `blocks` (q, 3, 3) [N/m] act on the
    displacement, `rotation` (q,) [N m] on the rotations of the normal. `coupling` (q, 3, 2) [N] is between the two.
    """

    nodes: IntArray
    values: Array
    blocks: Array
    rotation: Array
    coupling: Array | None = None


@runtime_checkable
class Sprung(Protocol):
    """Interface of a support that adds springs; any object with these two members can be used."""

    @property
    def uniform(self) -> bool:
        """Whether the springs are the same along the whole edge."""

    def springs(self, line: EdgeLine) -> PointSprings:
        """The springs on an edge."""


@runtime_checkable
class Numbered(Sprung, Protocol):
    """Interface of a support whose numbers an update can vary by path; KeyError for an unknown path."""

    def number(self, path: tuple[str, ...]) -> Any:
        """The number at a path."""

    def with_number(self, path: tuple[str, ...], value: Any) -> Self:
        """The same support with the number at a path replaced."""


def spring_form(springs: PointSprings) -> EdgeForm:
    """Springs on the five dofs of the edge's own nodes."""
    points, m = springs.nodes.shape
    dofs = (springs.nodes[:, :, None] * DOFS + np.arange(DOFS)).reshape(points, -1)
    B = np.einsum("qm,ij->qimj", springs.values, np.eye(DOFS)).reshape(points, DOFS, m * DOFS)
    D = np.zeros((points, DOFS, DOFS), dtype=np.result_type(*(part for part in springs[2:] if part is not None)))
    D[:, :3, :3] = springs.blocks
    D[:, 3, 3] = D[:, 4, 4] = springs.rotation
    if springs.coupling is not None:
        D[:, :3, 3:], D[:, 3:, :3] = springs.coupling, springs.coupling.swapaxes(1, 2)
    return EdgeForm(dofs=dofs, B=B, D=D)


def places_of(nodes: IntArray, numbers: IntArray) -> IntArray:
    """Positions of node numbers in the list of an edge's nodes.

    >>> places_of(np.array([7, 3, 9]), np.array([[9, 7]])).tolist()
    [[2, 0]]
    """
    order = np.argsort(nodes)
    return np.asarray(order[np.searchsorted(nodes, numbers, sorter=order)])


def single_place(at: LineFrame) -> EdgeLine:
    """An edge with the single point theta = 0, per unit angle, for one harmonic of a perfect casing."""
    node, whole = np.zeros(1, dtype=np.int64), np.ones(1)
    alone = node[:, None], whole[:, None]
    return EdgeLine(node, whole, at, np.zeros(1), order=0, closed=True, frame=lambda x: at, interpolate=lambda x: alone)


def along_springs(stiffness: Array, directions: Array) -> Array:
    """Blocks (..., 3, 3) of springs (k_r, k_theta, k_z) (3, ...) along the directions (3, 3, ...)."""
    return np.asarray(np.einsum("k...,ki...,kj...->...ij", stiffness, directions, directions))
