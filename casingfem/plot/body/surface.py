"""The surface for interactive shapes: points, triangles and outward directions of a chart shell or of a mesh's skin."""

from dataclasses import dataclass

import numpy as np

from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.modal.mesh_modes import MeshModes
from casingfem.modal.mode_set import Modes, ModeSet
from casingfem.plot.modes import lattice
from casingfem.structure.imported.mesh.mesh_data import MeshData

MOST, PAINTED = 7000, 1500  # points of a skin: 12 shapes of the one are 1 MB in a page, of the other a second's work
LATTICES = {  # lines of a chart at most, along and around, by whether it is closed and coarse
    (True, False): (17, 361), (True, True): (12, 151), (False, False): (49, 49), (False, True): (33, 25),
}  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Surface:
    """Points [m] (N, 3), faces of three or four nodes (F, 3 or 4), outward directions (N, 3), nodes (N,)."""

    points: FloatArray
    faces: IntArray
    out: FloatArray
    nodes: IntArray
    closed: bool

    @property
    def triangles(self) -> IntArray:
        """The faces as triangles."""
        return split(self.faces) if self.faces.shape[1] == 4 else self.faces

    @property
    def size(self) -> float:
        """Diagonal of its bounding box [m]."""
        return float(np.linalg.norm(np.ptp(self.points, axis=0)))


def surface_of(modes: ModeSet, *, coarse: bool = False) -> Surface:
    """The surface for pictures of these modes; a coarse one for pictures that are painted face by face."""
    if isinstance(modes, MeshModes):
        return skin(modes.structure.mesh, PAINTED if coarse else MOST)
    assert isinstance(modes, Modes)
    return chart_surface(modes, LATTICES[modes.shell.chart.periodic, coarse])


def chart_surface(modes: Modes, most: tuple[int, int]) -> Surface:
    """The mid-surface of a shell on the lines of its mesh; the direction is the chart's: radial, or normal."""
    table = lattice(modes, most)
    nodes, place = np.unique(table, return_inverse=True)
    place = place.reshape(table.shape)
    quads = np.stack([place[:-1, :-1], place[1:, :-1], place[1:, 1:], place[:-1, 1:]], axis=-1).reshape(-1, 4)
    a, b = modes.grid.nodes[:, nodes]
    points = np.real(modes.shell.chart.surface(a, b, None).x).T
    out = np.asarray(modes.shell.chart.directions(a, b)[0]).T
    return Surface(points=points, faces=quads, out=out, nodes=nodes, closed=modes.shell.chart.periodic)


def skin(mesh: MeshData, most: int = MOST) -> Surface:
    """The outside of a solid, or the surface of a shell; above `most` points, merged in the cells of a grid.

    >>> from casingfem.structure.imported.grid import grid_mesh, revolved
    >>> ring = grid_mesh("hexahedron", (1, 24, 2), revolved((0.5, 0.45), (0.0, 0.25), 0.04), wrap=1)
    >>> seen = skin(ring)
    >>> len(seen.points), len(seen.triangles), bool(np.all(np.abs(np.linalg.norm(seen.out, axis=1) - 1.0) < 1e-9))
    (144, 288, True)
    """
    kind = mesh.cell_kind
    if kind.dim == 3:
        cell, facet = mesh.boundary.T
        corners = mesh.facets[cell, facet]
    else:
        corners = mesh.cells[:, : len(kind.corners)]
    triangles = split(corners) if corners.shape[1] == 4 else corners
    nodes = np.unique(triangles)
    lead = merged(mesh.points, nodes, most)
    triangles = lead[triangles]
    a, b, c = triangles.T
    triangles = triangles[(a != b) & (b != c) & (c != a)]
    nodes, places = np.unique(triangles, return_inverse=True)
    points, triangles = mesh.points[nodes], places.reshape(-1, 3)
    return Surface(points=points, faces=triangles, out=normals(points, triangles), nodes=nodes, closed=False)


def split(quads: IntArray) -> IntArray:
    """Two triangles for each quadrilateral, (2 quads, 3)."""
    return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def merged(points: FloatArray, nodes: IntArray, most: int) -> IntArray:
    """For every point the one that represents it: itself, or the first in its cell of the finest sufficient grid."""
    lead = np.arange(len(points))
    low, size = points[nodes].min(axis=0), float(np.ptp(points[nodes], axis=0).max())
    divisions = 4096
    while len(np.unique(lead[nodes])) > most:
        cells = np.floor((points[nodes] - low) * (divisions / size)).astype(np.int64)
        _, first, of = np.unique(cells, axis=0, return_index=True, return_inverse=True)
        lead[nodes] = nodes[first[of.ravel()]]
        divisions = int(divisions / 1.3)
    return lead


def normals(points: FloatArray, triangles: IntArray) -> FloatArray:
    """Unit normals at the points, those of the triangles weighted by area, (N, 3)."""
    corners = points[triangles]
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    total = np.zeros_like(points)
    for k in range(3):
        np.add.at(total, triangles[:, k], area)
    length: Array = np.linalg.norm(total, axis=1, keepdims=True)
    return np.asarray(total / np.maximum(length, 1e-300))
