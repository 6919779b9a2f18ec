"""A mesh as read from a file: points, cells of one kind, and named groups. It is not checked here."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np

from casingfem.io.arrays import BoolArray, FloatArray, IntArray, frozen
from casingfem.structure.imported.mesh.attachments import NOTHING, Attachments
from casingfem.structure.imported.mesh.cell_kind import KINDS, CellKind
from casingfem.structure.imported.mesh.collapsed import distinct, native
from contact.io.brief import brief

NONE: IntArray = frozen(np.zeros(0, dtype=np.int64))
NAMED = 6  # groups that a line names
NATIVE = ("hexahedron20", "quad8", "quad9")  # kinds of which collapsed cells are integrated as what they collapse to


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Group:
    """A named group: always nodes, and cells or facets if the file gives them.

    `facets` are pairs (cell, local facet), (m, 2); None where the group contains nodes only.

    >>> import casingfem as cf
    >>> cube = cf.imported.grid_mesh("tetra10", (1, 1, 1), lambda u: u, groups={"base": (2, 0.0)})
    >>> base = cube.groups["base"]
    >>> base.nodes.size, base.facets.shape
    (9, (2, 2))
    """

    nodes: IntArray
    cells: IntArray = field(default_factory=lambda: NONE)
    facets: IntArray | None = None

    __repr__ = brief

    def __post_init__(self) -> None:
        object.__setattr__(self, "nodes", frozen(np.unique(np.asarray(self.nodes, dtype=np.int64))))
        object.__setattr__(self, "cells", frozen(np.unique(np.asarray(self.cells, dtype=np.int64))))
        if self.facets is not None:
            object.__setattr__(self, "facets", frozen(np.asarray(self.facets, dtype=np.int64).reshape(-1, 2)))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MeshData:
    """A mesh of one kind of cell, solid or shell.

    Attributes
    ----------
    kind
        Name of the kind of cell, as in `KINDS`.
    points
        Positions [m], (nodes, 3).
    cells
        Nodes of each cell in VTK's order, (cells, nodes of the kind).
    groups
        Name -> Group; supports and materials refer to these names.
    cell_numbers, node_numbers
        Numbers that cells and nodes have in the file; counted from 1 where the file has none.
    directors
        Unit normals at the nodes of a shell, (nodes, 3), where they are not the means over its cells.
    attachments
        Point masses, springs and connections between nodes, which become part of the structure.
    source
        Name of the file, for messages.

    Examples
    --------
    >>> mesh = MeshData(kind="tetra", points=np.vstack([np.zeros(3), np.eye(3)]), cells=np.array([[0, 1, 2, 3]]))
    >>> mesh.boundary.tolist()
    [[0, 0], [0, 1], [0, 2], [0, 3]]
    """

    kind: str
    points: FloatArray
    cells: IntArray
    groups: Mapping[str, Group] = field(default_factory=dict)
    cell_numbers: IntArray = field(default_factory=lambda: NONE)
    node_numbers: IntArray = field(default_factory=lambda: NONE)
    directors: FloatArray | None = None
    attachments: Attachments = NOTHING
    source: str = "mesh"

    def __repr__(self) -> str:
        box = " x ".join(f"{side:.4g}" for side in np.ptp(self.points, axis=0))
        groups = f"; {group_names(self.groups)}" if self.groups else ""
        attached = f"; {self.attachments}" if self.attachments else ""
        collapsed = int(self.collapsed.sum())
        kind = f"{self.kind}, {collapsed} of them collapsed" if collapsed else self.kind
        return f"MeshData({self.source}: {len(self.cells)} {kind}, {len(self.points)} nodes, {box} m{groups}{attached})"

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise ValueError(f"{self.source}: cells of kind {self.kind!r}, expected one of {', '.join(KINDS)}")
        points, cells = np.asarray(self.points, dtype=float), np.asarray(self.cells, dtype=np.int64)
        wanted = KINDS[self.kind].nodes
        if points.ndim != 2 or points.shape[1] != 3:
            raise ValueError(f"{self.source}: found points of shape {points.shape}, expected (nodes, 3)")
        if cells.ndim != 2 or cells.shape[1] != wanted or not len(cells):
            raise ValueError(f"{self.source}: found cells of shape {cells.shape}, expected (at least 1, {wanted})")
        if cells.min() < 0 or cells.max() >= len(points):
            raise ValueError(f"{self.source}: cells refer to nodes outside 0 to {len(points) - 1}")
        if self.attachments and not 0 <= self.attachments.nodes[0] <= self.attachments.nodes[-1] < len(points):
            raise ValueError(f"{self.source}: attachments refer to nodes outside 0 to {len(points) - 1}")
        for name, values, count in (("cell_numbers", self.cell_numbers, len(cells)),
                                    ("node_numbers", self.node_numbers, len(points))):  # fmt: skip
            object.__setattr__(self, name, frozen(values if len(values) == count else np.arange(1, count + 1)))
        object.__setattr__(self, "points", frozen(points))
        object.__setattr__(self, "cells", frozen(cells))
        object.__setattr__(self, "groups", MappingProxyType(dict(self.groups)))

    @property
    def cell_kind(self) -> CellKind:
        """The kind of its cells."""
        return KINDS[self.kind]

    @property
    def used(self) -> IntArray:
        """Nodes of cells, ascending."""
        return np.unique(self.cells)

    @property
    def present(self) -> IntArray:
        """Nodes of cells or attachments, ascending."""
        return np.union1d(self.cells, self.attachments.nodes) if self.attachments else self.used

    @property
    def labels(self) -> IntArray:
        """Numbers of the nodes for other programs, (nodes,): the file's numbers, and new ones for nodes without."""
        numbers = self.node_numbers.copy()
        own = numbers == 0  # the middles that eight-noded cells are given
        numbers[own] = numbers.max() + 1 + np.arange(np.count_nonzero(own))
        return numbers

    @property
    def size(self) -> float:
        """Diagonal of the box around the nodes in use [m]."""
        return float(np.linalg.norm(np.ptp(self.points[self.used], axis=0)))

    @property
    def collapsed(self) -> BoolArray:
        """Cells with a repeated node, (cells,): wedges, pyramids, tetrahedra among bricks, triangles among squares."""
        return np.asarray((distinct(self.cells) < 0).any(axis=1))

    @property
    def facets(self) -> IntArray:
        """Corners of every facet of every cell, (cells, facets, corners)."""
        return self.cells[:, np.array(self.cell_kind.facets)]

    @property
    def boundary(self) -> IntArray:
        """Facets that belong to one cell only, as pairs (cell, local facet), (m, 2)."""
        return np.argwhere(self.sharing == 1)

    @property
    def sharing(self) -> IntArray:
        """Number of cells that share each facet, (cells, facets); 0 for facets collapsed to an edge or a node."""
        corners = distinct(self.facets)
        _, inverse, counts = np.unique(corners.reshape(-1, corners.shape[2]), axis=0, return_inverse=True,
                                       return_counts=True)  # fmt: skip
        whole = np.count_nonzero(corners >= 0, axis=2) >= self.cell_kind.dim
        return np.asarray(np.where(whole, counts[inverse.ravel()].reshape(corners.shape[:2]), 0))

    def facet_nodes(self, facets: IntArray) -> IntArray:
        """Nodes of facets (m, 2) in the order of the facet's kind, (m, facet nodes)."""
        return np.take_along_axis(self.cells[facets[:, 0]], self.cell_kind.facet_nodes[facets[:, 1]], axis=1)

    def group_facets(self, name: str) -> IntArray:
        """Facets of a group; for a group of nodes, the boundary facets whose nodes all belong to it."""
        group = self.groups[name]
        if group.facets is not None:
            return group.facets
        inside = np.zeros(len(self.points), dtype=bool)
        inside[group.nodes] = True
        boundary = self.boundary
        return boundary[inside[self.facet_nodes(boundary)].all(axis=1)]


def group_names(groups: Mapping[str, Group]) -> str:
    """The names of groups on one line; of many groups the first ones and their number.

    >>> group_names(dict.fromkeys(("root", "tip")))
    'groups root, tip'
    >>> group_names(dict.fromkeys(f"pid {k}" for k in range(288)))
    'groups pid 0, pid 1, pid 2, pid 3, pid 4, pid 5 and 282 more'
    """
    more = len(groups) - NAMED
    few = ", ".join(list(groups)[:NAMED])
    return f"groups {few}{f' and {more} more' if more > 0 else ''}"


def natives(mesh: MeshData, cells: IntArray | None = None) -> list[tuple[str, IntArray, IntArray]]:
    """Cells of a mesh, or some (m, nodes), by their kind of integration: kind, rows, and its own nodes.

    A linear triangle among the squares of a shell is a collapsed square.
    """
    table = mesh.cells if cells is None else cells
    if mesh.kind in NATIVE:
        return list(native(mesh.kind, table))
    return [(mesh.kind, np.arange(len(table)), np.arange(table.shape[1]))]


def beside(meshes: Mapping[str, MeshData]) -> MeshData:
    """Meshes of one kind as one mesh, without joining nodes. Groups are called `name.group`.

    Group `name` has the cells of a mesh.

    Nodes and cells are numbered anew from 1.

    >>> import casingfem as cf
    >>> cube = cf.imported.grid_mesh("tetra10", (1, 1, 1), lambda u: u)
    >>> far = cf.imported.grid_mesh("tetra10", (1, 1, 1), lambda u: u + [2.0, 0.0, 0.0])
    >>> both = cf.imported.beside({"left": cube, "right": far})
    >>> both.points.shape[0] == 2 * cube.points.shape[0], sorted(both.groups)
    (True, ['left', 'right'])
    """
    parts = list(meshes.values())
    nodes = np.cumsum([0, *(len(mesh.points) for mesh in parts)])
    cells = np.cumsum([0, *(len(mesh.cells) for mesh in parts)])
    groups = {}
    for (name, mesh), first, start in zip(meshes.items(), nodes.tolist(), cells.tolist(), strict=False):
        groups[name] = Group(nodes=first + mesh.used, cells=start + np.arange(len(mesh.cells)))
        for inner, group in mesh.groups.items():
            facets = None if group.facets is None else group.facets + np.array([start, 0])
            groups[f"{name}.{inner}"] = Group(nodes=first + group.nodes, cells=start + group.cells, facets=facets)
    points = np.concatenate([mesh.points for mesh in parts])
    whole = np.concatenate([first + mesh.cells for mesh, first in zip(parts, nodes, strict=False)])
    source = " and ".join(dict.fromkeys(mesh.source for mesh in parts))
    return MeshData(kind=parts[0].kind, points=points, cells=whole, groups=groups, source=source)


def find_facets(mesh: MeshData, corners: IntArray) -> IntArray:
    """The (cell, local facet) of facets given by their corners (m, corners); -1 where no cell has them."""
    own = distinct(mesh.facets).reshape(-1, mesh.facets.shape[2])
    missing = own.shape[1] - corners.shape[1]
    if missing < 0:
        return np.full((len(corners), 2), -1)
    asked = np.pad(distinct(corners), ((0, 0), (missing, 0)), constant_values=-1)
    code = np.unique(np.concatenate([own, asked]), axis=0, return_inverse=True)[1].ravel()
    first = np.full(code.max() + 1, -1)
    first[code[: len(own)][::-1]] = np.arange(len(own))[::-1]
    place = first[code[len(own) :]]
    count = len(mesh.cell_kind.facets)
    return np.where(place[:, None] < 0, -1, np.stack([place // count, place % count], axis=1))
