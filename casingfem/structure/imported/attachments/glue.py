"""Faces of parts that do not share nodes, tied: nodes of one follow the shape functions of the other's facets.

    u_i = sum_k N_k(r_i) u_k

with r_i the point on the facets that is nearest to node i. The node is moved there, since a tie across a gap would
resist rotation. Linear motions are reproduced, so rigid motions and uniform strains cause no force. A constant stress
is transmitted exactly between matching meshes and approximately between others (collocation at nodes, like *TIE in
other programs; only an integral mortar tie is exact).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated, NamedTuple

import numpy as np

from casingfem.errors import ModelError, warn
from casingfem.io.arrays import FloatArray, IntArray
from casingfem.structure.imported.mesh.attachments import Tie
from casingfem.structure.imported.mesh.cell_kind import KINDS, shape_functions
from casingfem.structure.imported.mesh.collapsed import native
from casingfem.structure.imported.mesh.findings import nodes_named
from casingfem.structure.imported.mesh.mesh_data import MeshData
from contact.io.keys import Key
from contact.io.names import hint

TOLERANCE = 0.05  # of the facet's size: how far from it a node is still tied


@dataclass(frozen=True, slots=True, kw_only=True)
class Gluing:
    """Two faces to be tied.

    Attributes
    ----------
    follower, master
        Groups: nodes of the first follow the facets of the second; for shells edges or cells. The finer face should
        follow.
    tolerance
        Distance [m] up to which nodes are tied; by default a twentieth of the facet's size.
    where
        Origin of the tie, for messages.

    Examples
    --------
    >>> Gluing(follower="flange", master="ring", tolerance=1e-4).tolerance
    0.0001
    """

    follower: Annotated[str, Key("group whose nodes follow, on the smaller face or that with the finer mesh")]
    master: Annotated[str, Key("group of facets that these nodes follow")]
    tolerance: Annotated[
        float | None, Key("largest gap that is tied [m]; 1/20 of the facet size if left out", "positive")
    ] = None
    where: str = "tie"


def tied(mesh: MeshData, gluings: Sequence[Gluing]) -> MeshData:
    """A mesh with tied faces; following nodes are moved onto the facets that they follow.

    Raises
    ------
    ModelError
        `mesh-tie` for unknown groups, groups without facets, or groups far from each other.

    Warns
    -----
    ModelWarning
        `mesh-tie-loose` for nodes that are too far away to be tied.

    Examples
    --------
    >>> import casingfem as cf
    >>> ends = {"low": (0, 0.0), "high": (0, 1.0)}
    >>> coarse = cf.imported.grid_mesh("hexahedron20", (1, 1, 1), lambda u: u, groups=ends)
    >>> fine = cf.imported.grid_mesh("hexahedron20", (2, 3, 3), lambda u: u + [1.0, 0.0, 0.0], groups=ends)
    >>> gluing = cf.imported.Gluing(follower="b.low", master="a.high")
    >>> both = cf.imported.tied(cf.imported.beside({"a": coarse, "b": fine}), [gluing])
    >>> both.attachments, len(both.attachments.glued[0].nodes)
    (1 tie, 40)
    """
    for gluing in gluings:
        mesh = glued(mesh, gluing)
    return mesh


def glued(mesh: MeshData, gluing: Gluing) -> MeshData:
    """A mesh with one more pair of faces tied."""
    where = f"{mesh.source}: {gluing.where}"
    for name in (gluing.follower, gluing.master):
        if name not in mesh.groups:
            raise ModelError("mesh-tie", f"{where}: found no group {name!r}{hint(name, list(mesh.groups), most=3)}")
    kind, facets = faces_of(mesh, gluing.master)
    if not len(facets):
        raise ModelError("mesh-tie", f"{where}: found a group {gluing.master!r} without facets, expected a face")
    earlier = [tie.nodes for tie in mesh.attachments.glued]
    apart = np.setdiff1d(mesh.groups[gluing.follower].nodes, np.concatenate([facets.ravel(), *earlier]))
    if not len(apart):
        return mesh
    parts = [(of, facets[rows][:, slots]) for of, rows, slots in native(kind, facets)]
    found = [nearest_places(of, mesh.points[nodes], mesh.points[apart]) for of, nodes in parts]
    best = np.array([places.distance for places in found]).argmin(axis=0)
    width = facets.shape[1]
    others, weights = np.zeros((len(apart), width), dtype=np.int64), np.zeros((len(apart), width))
    x, far = mesh.points.copy(), np.zeros(len(apart), dtype=bool)
    for k, ((_, nodes), places) in enumerate(zip(parts, found, strict=True)):
        own = np.flatnonzero(best == k)
        others[own, : nodes.shape[1]] = nodes[places.facet[own]]
        weights[own, : nodes.shape[1]] = places.weights[own]
        reach = TOLERANCE * places.size[own] if gluing.tolerance is None else gluing.tolerance
        far[own] = places.distance[own] > reach
        x[apart[own]] = np.where(far[own, None], x[apart[own]], places.x[own])
    if far.all():
        least = min(float(places.distance.min()) for places in found)
        message = f"{where}: found a gap of {least:.3g} m or more between {gluing.follower!r} and {gluing.master!r}"
        raise ModelError("mesh-tie", message)
    if far.any():
        message = f"{nodes_named(mesh, apart[far])} of {gluing.follower!r} beyond the tolerance from {gluing.master!r}"
        warn("mesh-tie-loose", f"{where}: found {message}", stacklevel=4)
    weights[np.abs(weights) < 1e-12] = 0.0
    tie = Tie(nodes=apart[~far], others=others[~far], weights=weights[~far], where=gluing.where)
    attachments = replace(mesh.attachments, glued=(*mesh.attachments.glued, tie))
    return replace(mesh, points=x, attachments=attachments)


def faces_of(mesh: MeshData, name: str) -> tuple[str, IntArray]:
    """Kind and nodes of the surface of a group: its facets, or the cells of a shell."""
    group = mesh.groups[name]
    if mesh.cell_kind.dim == 2 and group.facets is None and len(group.cells):
        return mesh.kind, mesh.cells[group.cells]
    return mesh.cell_kind.facet, mesh.facet_nodes(mesh.group_facets(name))


NEAR, STEPS = 12, 15  # facets examined for each point, nearest centres first; Gauss-Newton steps on each
SETTLED = 1e-14  # of the reference facet: a step that changes nothing


class Places(NamedTuple):
    """For each point: facet, shape functions (points, nodes of a facet), position (points, 3), distance, facet size."""

    facet: IntArray
    weights: FloatArray
    x: FloatArray
    distance: FloatArray
    size: FloatArray


def nearest_places(kind: str, nodes: FloatArray, points: FloatArray) -> Places:
    """The nearest positions to points (p, 3) on facets of a kind with nodes (m, nodes, 3), lines or surfaces."""
    from scipy.spatial import cKDTree  # loaded where parts are glued, not by every study

    size = np.linalg.norm(np.ptp(nodes, axis=1), axis=1)
    count = min(NEAR, len(nodes))
    near = cKDTree(nodes.mean(axis=1)).query(points, count)[1].reshape(len(points), count)
    x = np.repeat(points, count, axis=0)
    local, found = projected(kind, nodes[near.ravel()], x)
    distance = np.linalg.norm(found - x, axis=1).reshape(len(points), count)
    best = distance.argmin(axis=1)
    place = np.arange(len(points)) * count + best
    facet = near[np.arange(len(points)), best]
    weights = shape_functions(kind, local[place].T)[0].T
    return Places(facet, weights, found[place], distance[np.arange(len(points)), best], size[facet])


def projected(kind: str, nodes: FloatArray, x: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Local coordinates (p, dim) and places (p, 3) nearest to points x (p, 3), each on its own facet (p, nodes, 3).

    Gauss-Newton steps on |x - X(r)|^2, kept inside the facet.
    """
    local = np.tile(np.array(KINDS[kind].corners, dtype=float).mean(axis=0), (len(x), 1))
    for _ in range(STEPS):
        values, slopes = shape_functions(kind, np.ascontiguousarray(local.T))
        away = x - np.einsum("kp,pkc->pc", values, nodes)
        tangents = np.einsum("dkp,pkc->pdc", slopes, nodes)
        gram = tangents @ tangents.swapaxes(1, 2)
        rise = np.einsum("pdc,pc->pd", tangents, away)
        moved = inside(kind, local + np.linalg.solve(gram + tiny(gram), rise[:, :, None])[:, :, 0])
        step, local = np.abs(moved - local).max(initial=0.0), moved
        if step < SETTLED:
            break
    values, _ = shape_functions(kind, np.ascontiguousarray(local.T))
    return local, np.einsum("kp,pkc->pc", values, nodes)


def tiny(gram: FloatArray) -> FloatArray:
    """A small term, far below round-off, that keeps a flat facet's matrix regular."""
    trace = np.einsum("pdd->p", gram)[:, None, None]
    return np.asarray(np.eye(gram.shape[1]) * np.maximum(1e-15 * trace, np.finfo(float).tiny))


def inside(kind: str, local: FloatArray) -> FloatArray:
    """Local coordinates moved into the reference facet: a line, a triangle or a square."""
    local = np.clip(local, 0.0, 1.0)
    if len(KINDS[kind].corners) != 3:
        return local
    beyond = np.maximum(local.sum(axis=1) - 1.0, 0.0)
    return np.asarray(np.clip(local - 0.5 * beyond[:, None], 0.0, 1.0))
