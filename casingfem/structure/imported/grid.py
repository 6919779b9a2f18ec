"""Structured meshes of blocks, tubes and surfaces without a mesher, for comparisons and tests.

A grid with nodes at half steps contains the nodes of all kinds. Bricks of 27 nodes use every node. Bricks of 20 nodes
use all but the inner ones. The middle nodes of the six tetrahedra of a cube (Kuhn) are nodes of the grid too.
"""

from collections.abc import Callable, Mapping
from itertools import permutations

import numpy as np

from casingfem.io.arrays import Array, FloatArray
from casingfem.structure.imported.mesh.cell_kind import KINDS
from casingfem.structure.imported.mesh.mesh_data import Group, MeshData

Placing = Callable[[FloatArray], FloatArray]


def grid_mesh(
    kind: str,
    counts: tuple[int, ...],
    place: Placing,
    *,
    groups: Mapping[str, tuple[int, float]] | None = None,
    wrap: int | None = None,
) -> MeshData:
    """Mesh the unit cube (or square, for shells) with cells of a kind, and move its nodes.

    Parameters
    ----------
    kind
        Name of a kind of cell: hexahedron, hexahedron20, hexahedron27, tetra, tetra10, wedge15,
        pyramid13, triangle, triangle6, quad, quad8 or quad9.
    counts
        Cubes (squares) along each axis.
    place
        Unit coordinates (nodes, dim) -> positions (nodes, 3); right-handed.
    groups
        Name -> (axis, 0.0 or 1.0): the end of an axis as nodes and facets.
    wrap
        An axis whose ends are joined.

    Examples
    --------
    >>> import casingfem as cf
    >>> beam = cf.imported.grid_mesh("hexahedron20", (4, 1, 1), lambda u: u * [1.0, 0.1, 0.1],
    ...                              groups={"root": (0, 0.0)})
    >>> len(beam.points), len(beam.cells), beam.groups["root"].nodes.shape
    (56, 4, (8,))
    """
    dim = len(counts)
    steps = 2 * np.array(counts)
    corner = np.stack(np.meshgrid(*(np.arange(n) for n in counts), indexing="ij"), axis=-1).reshape(-1, dim)
    local = (2 * cube_cells(kind, dim)).astype(np.int64)  # half steps, (cells of a cube, nodes, dim)
    lattice = (2 * corner[:, None, None] + local).reshape(-1, local.shape[1], dim)
    if wrap is not None:
        lattice = np.where(np.arange(dim) == wrap, lattice % steps[wrap], lattice)
    nodes, cells = np.unique(lattice.reshape(-1, dim), axis=0, return_inverse=True)
    mesh = MeshData(kind=kind, points=place(nodes / steps), cells=cells.reshape(lattice.shape[:2]), source="grid")
    named = {name: end_group(mesh, nodes[:, axis] == end * steps[axis]) for name, (axis, end) in (groups or {}).items()}
    return MeshData(kind=kind, points=mesh.points, cells=mesh.cells, groups=named, source="grid")


def cube_cells(kind: str, dim: int) -> FloatArray:
    """Nodes of the cells that fill the unit cube or square, (cells, nodes, dim)."""
    if not kind.startswith("tetra"):
        if KINDS[kind].dim != dim:
            raise ValueError(f"counts: found {dim} numbers, expected {KINDS[kind].dim} for cells of kind {kind}")
        return KINDS[kind].places[None]
    corners = []
    for order in permutations(range(3)):
        path = np.cumsum([np.zeros(3), *np.eye(3)[list(order)]], axis=0)
        even = np.linalg.det(path[1:] - path[0]) > 0
        corners.append(path if even else path[[0, 2, 1, 3]])
    return np.stack([[tet[list(nodes)].mean(axis=0) for nodes in KINDS[kind].supports_of_nodes] for tet in corners])


def end_group(mesh: MeshData, inside: Array) -> Group:
    """The group of the nodes in a mask, with the boundary facets that are completely in it."""
    boundary = mesh.boundary
    return Group(nodes=np.flatnonzero(inside), facets=boundary[inside[mesh.facet_nodes(boundary)].all(axis=1)])


def revolved(r: tuple[float, float], z: tuple[float, float], thickness: float) -> Placing:
    """Map unit coordinates (through the wall, around, along the axis) to a frustum's wall.

    Parameters
    ----------
    r, z
        Radius of the mid-surface and position along the axis at both ends [m].
    thickness
        Thickness of the wall, across the mid-surface [m].

    Examples
    --------
    >>> import casingfem as cf
    >>> place = cf.imported.revolved((0.5, 0.4), (0.0, 0.2), 0.01)
    >>> tube = cf.imported.grid_mesh("hexahedron20", (1, 12, 2), place, groups={"base": (2, 0.0)}, wrap=1)
    >>> len(tube.cells), len(tube.groups["base"].facets)
    (24, 12)
    """
    slant = np.array([r[1] - r[0], z[1] - z[0]])
    normal = np.array([slant[1], -slant[0]]) / np.linalg.norm(slant)

    def place(u: FloatArray) -> FloatArray:
        through, around, along = u.T
        theta = 2.0 * np.pi * around
        depth = (through - 0.5) * thickness
        radius = r[0] + along * slant[0] + depth * normal[0]
        height = z[0] + along * slant[1] + depth * normal[1]
        return np.stack([radius * np.cos(theta), radius * np.sin(theta), height], axis=1)

    return place
