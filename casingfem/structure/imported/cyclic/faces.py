"""The two faces of a sector: nodes that rotation by one sector's angle maps onto each other."""

from typing import NamedTuple

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import FloatArray, IntArray
from casingfem.structure.geometry.rotation import Vector, axis_frame
from casingfem.structure.imported.checks import check_groups, spacing
from casingfem.structure.imported.mesh.mesh_data import MeshData, find_facets

MATCH = 1e-3  # of the shortest edge: how far apart paired nodes may be
NEAR = 0.25  # of the shortest edge: nodes that miss each other by less were meant to be paired
ALIKE = 1e-3  # relative error of the angle between two faces
SEVERAL = "interior nodes lie on other nodes: found several sectors, expected one"


class Turn(NamedTuple):
    """The rotation about an axis through a point by one sector's angle [rad]."""

    axis: Vector
    point: Vector
    angle: float

    @property
    def matrix(self) -> FloatArray:
        """Rotation matrix, (3, 3)."""
        e1, e2, a = axis_frame(self.axis)
        c, s = np.cos(self.angle), np.sin(self.angle)
        return np.asarray(np.outer(a, a) + c * (np.eye(3) - np.outer(a, a)) + s * (np.outer(e2, e1) - np.outer(e1, e2)))

    def places(self, points: FloatArray, times: int = 1) -> FloatArray:
        """Points (nodes, 3) rotated by a number of sectors."""
        return np.asarray((points - self.point) @ np.linalg.matrix_power(self.matrix, times).T + self.point)

    def across(self, points: FloatArray) -> FloatArray:
        """Components across the axis, x + i y, (nodes,) complex."""
        e1, e2, _ = axis_frame(self.axis)
        away = points - np.asarray(self.point)
        return np.asarray(away @ e1 + 1j * (away @ e2))

    def __str__(self) -> str:
        """The rotation in words."""
        axis, point = (f"({x:g}, {y:g}, {z:g})" for x, y, z in (self.axis, self.point))
        return f"rotated by {np.degrees(self.angle):.6g} degrees about {axis} through {point}"


class Pairs(NamedTuple):
    """Nodes of the low face, and the nodes of the high face onto which the rotation maps them.

    A node on the axis is its own partner.
    """

    low: IntArray
    high: IntArray


def paired_faces(mesh: MeshData, turn: Turn, names: tuple[str, str] | None, tolerance: float | None) -> Pairs:
    """The pairs of two groups, or of all nodes that the rotation maps onto another, to a tolerance [m].

    Raises
    ------
    ModelError
        `cyclic-sectors` if the angle between the faces differs, `cyclic-faces` if nodes or facets do not match, with
        the distance and the node.

    Examples
    --------
    >>> from casingfem.structure.imported.grid import grid_mesh, revolved
    >>> wall = revolved((0.5, 0.45), (0.0, 0.25), 0.12)
    >>> part = grid_mesh("hexahedron20", (1, 2, 2), lambda u: wall(u * [1.0, 0.125, 1.0]))
    >>> pairs = paired_faces(part, Turn((0.0, 0.0, 1.0), (0.0, 0.0, 0.0), np.pi / 4.0), None, None)
    >>> len(pairs.low)  # two bricks of 20 nodes with a common facet
    13
    """
    edge = spacing(mesh)
    reach = MATCH * edge if tolerance is None else tolerance
    near = max(NEAR * edge, reach)
    pairs = found_pairs(mesh, turn, reach, near) if names is None else named(mesh, turn, names, reach)
    own = pairs.low != pairs.high
    both = names is None and turn.angle >= np.pi  # a half turn lays each face on the other
    if not both and len(np.intersect1d(pairs.low[own], pairs.high[own])):
        raise ModelError("cyclic-sectors", f"{mesh.source}: {turn}, {SEVERAL}")
    if not own.any():
        raise ModelError("cyclic-faces", f"{mesh.source}: {turn}, only nodes on the axis match")
    require_facets(mesh, pairs)
    return one_way(mesh, turn, pairs) if both else pairs


def one_way(mesh: MeshData, turn: Turn, pairs: Pairs) -> Pairs:
    """Each pair of a half turn once: the rotation finds every pair twice.

    A half turn that maps cells onto cells is refused.
    """
    partner = partners(mesh, pairs)
    facets = mesh.boundary
    turned = partner[mesh.facets[facets[:, 0], facets[:, 1]]]
    on = (turned >= 0).all(axis=1)
    middle = mesh.points[turned[on]].mean(axis=1)
    owners = facets[on, 0], find_facets(mesh, turned[on])[:, 0]
    here, there = (mesh.points[mesh.cells[cells]].mean(axis=1) for cells in owners)
    if np.sum((turn.places(here) - middle) * (there - middle)) > 0.0:
        raise ModelError("cyclic-sectors", f"{mesh.source}: {turn}, {SEVERAL}")
    once = pairs.low <= pairs.high
    return Pairs(pairs.low[once], pairs.high[once])


def found_pairs(mesh: MeshData, turn: Turn, reach: float, near: float) -> Pairs:
    """Nodes of the surface that the rotation maps onto another node of it."""
    from scipy.spatial import cKDTree  # loaded with the first part, not by every study

    nodes = np.unique(mesh.facet_nodes(mesh.boundary))
    distance, partner = cKDTree(mesh.points[nodes]).query(turn.places(mesh.points[nodes]))
    hit = distance <= reach
    missed = np.flatnonzero(~hit & (distance <= near))
    if not hit.any() or len(missed):
        k = int(distance.argmin()) if not hit.any() else int(missed[distance[missed].argmax()])
        found = miss(mesh, nodes[k], nodes[partner[k]], distance[k])
        raise ModelError("cyclic-faces", f"{mesh.source}: {turn}, {found}")
    return Pairs(nodes[hit], nodes[partner[hit]])


def named(mesh: MeshData, turn: Turn, names: tuple[str, str], reach: float) -> Pairs:
    """The pairs of two groups, in either order."""
    from scipy.spatial import cKDTree  # loaded with the first part, not by every study

    check_groups(mesh, names)
    low, high = (np.intersect1d(mesh.groups[name].nodes, mesh.used) for name in names)
    if len(low) != len(high):
        found = f"{len(low)} nodes in {names[0]!r}, {len(high)} in {names[1]!r}"
        raise ModelError("cyclic-faces", f"{mesh.source}: found {found}, expected equal numbers")
    first, last = (turn.across(mesh.points[nodes]).sum() for nodes in (low, high))
    apart = float(np.angle(last / first)) if first != 0.0 else np.nan
    if abs(apart + turn.angle) <= ALIKE * turn.angle:
        low, high, apart = high, low, -apart
    if not abs(apart - turn.angle) <= ALIKE * turn.angle and turn.angle < np.pi:
        would = round(2.0 * np.pi / abs(apart)) if apart else 0
        found = f"an angle of {abs(np.degrees(apart)):.6g} degrees between the faces, that of {would} sectors"
        wanted = f"{np.degrees(turn.angle):.6g} degrees, that of {round(2.0 * np.pi / turn.angle)} sectors"
        raise ModelError("cyclic-sectors", f"{mesh.source}: found {found}, expected {wanted}")
    distance, partner = cKDTree(mesh.points[high]).query(turn.places(mesh.points[low]))
    worst = int(distance.argmax())
    if distance[worst] > reach or len(np.unique(partner)) < len(partner):
        found = miss(mesh, low[worst], high[partner[worst]], distance[worst])
        raise ModelError("cyclic-faces", f"{mesh.source}: {turn}, {found}")
    return Pairs(low, high[partner])


def miss(mesh: MeshData, node: int, partner: int, distance: float) -> str:
    """The text of a message about a node that does not match its partner."""
    return f"node {mesh.labels[node]} lies {distance:.3g} m from the nearest node, {mesh.labels[partner]}"


def partners(mesh: MeshData, pairs: Pairs) -> IntArray:
    """The node onto which the rotation maps each node, (nodes,); -1 if there is none."""
    partner = np.full(len(mesh.points), -1)
    partner[pairs.low] = pairs.high
    return partner


def require_facets(mesh: MeshData, pairs: Pairs) -> None:
    """Refuse faces whose facets do not match, such as facets with other diagonals or other sizes."""
    partner = partners(mesh, pairs)
    facets = mesh.facet_nodes(mesh.boundary)
    turned = np.sort(partner[facets[(partner[facets] >= 0).all(axis=1)]], axis=1)
    own = {tuple(row) for row in np.sort(facets, axis=1).tolist()}
    alone = [row for row in turned.tolist() if tuple(row) not in own]
    if not len(turned) or alone:
        what = (
            f"a facet lies on nodes {mesh.labels[alone[0]].tolist()}, which form no facet" if alone else "no facet fits"
        )
        raise ModelError("cyclic-faces", f"{mesh.source}: one face, rotated onto the other: {what}")
