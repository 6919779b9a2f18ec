"""Springs, beams and masses on an edge, as one kind of quadratic form.

    2 energy = sum_q (B_q x_q)^T D_q (B_q x_q),   x_q the dofs numbered dofs[q]

Assembly takes its matrices, sensitivities its products with modes; both are analytic in B and D, so complex steps
pass. Supports see an edge as an `EdgeLine` and answer with `PointSprings`.
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
        """The symmetric matrix A over `size` dofs."""
        local = np.matmul(self.B.transpose(0, 2, 1), np.matmul(self.D, self.B))
        i, j = np.broadcast_arrays(self.dofs[:, :, None], self.dofs[:, None, :])
        return coo_array((local.ravel(), (i.ravel(), j.ravel())), shape=(size, size)).tocsc()


class LineFrame(NamedTuple):
    """An edge at places (q,): chart parameters, unit vectors (3, 3, q), thickness, length per parameter.

    `tangents` are those of the rotations (3, 2, q); `bend` is the curvature along the edge (q,) [1/m], counted as the
    wall's kind counts it: 0 for a linear one.
    """

    a: Array
    b: Array
    directions: Array
    thickness: Array
    stretch: Array
    tangents: Array
    bend: Array


class EdgeLine(NamedTuple):
    """An edge as its supports see it, along its own parameter (an angle on a casing).

    `nodes`, `weights` and `nodal` belong to the Lobatto points of its elements (q,): a node between two elements
    is there twice, once for each side. `breaks` are the elements' ends; `frame(x)` is the `LineFrame` at places x,
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
    """Springs at points of an edge, weights of integration included.

    They act on what `values` (q, m) interpolate from `nodes` (q, m): blocks (q, 3, 3) [N/m] on the displacement,
    rotation (q,) [N m] on the rotations of the normal, coupling (q, 3, 2) [N] between the two.
    """

    nodes: IntArray
    values: Array
    blocks: Array
    rotation: Array
    coupling: Array | None = None


@runtime_checkable
class Sprung(Protocol):
    """A support that adds springs; any object with these two will do."""

    @property
    def uniform(self) -> bool:
        """Whether the springs are the same all along the edge."""

    def springs(self, line: EdgeLine) -> PointSprings:
        """The springs on an edge."""


@runtime_checkable
class Numbered(Sprung, Protocol):
    """A sprung support that knows its own numbers by path, for updating; KeyError where it has none."""

    def number(self, path: tuple[str, ...]) -> Any:
        """The number at a path."""

    def with_number(self, path: tuple[str, ...], value: Any) -> Self:
        """The same support with that number replaced."""


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
    """An edge at theta = 0 only, per unit angle, for one harmonic of a perfect casing."""
    node, whole = np.zeros(1, dtype=np.int64), np.ones(1)
    alone = node[:, None], whole[:, None]
    return EdgeLine(node, whole, at, np.zeros(1), order=0, closed=True, frame=lambda x: at, interpolate=lambda x: alone)


def along_springs(stiffness: Array, directions: Array) -> Array:
    """Blocks (..., 3, 3) of springs (k_r, k_theta, k_z) (3, ...) along directions (3, 3, ...)."""
    return np.asarray(np.einsum("k...,ki...,kj...->...ij", stiffness, directions, directions))
