"""Interfaces of imported parts: rows over the nodal displacements at a group's facets, or at nodes of the file.

A group of facets (the end face of a solid, the edge of a shell) is represented by surface integrals of the shape
functions N_i: a tip by the mean displacement of its pieces, sum_i u_i int N_i dA/A, a rim by the best-fitting harmonics
of its motion, c = G^-1 int phi u dA with G = int phi phi^T dA. A force on a channel is distributed over the same
facets.
"""

from typing import NamedTuple

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import FloatArray, IntArray
from casingfem.modal.interface.kinds import AtNodes, Rim, Tip, TipNodes
from casingfem.structure.geometry.rotation import axis_frame
from casingfem.structure.imported.assembly import MeshSystem
from casingfem.structure.imported.cells.mapped import mapped
from casingfem.structure.imported.cells.shell import directors
from casingfem.structure.imported.checks import check_groups
from casingfem.structure.imported.mesh.cell_kind import rule
from casingfem.structure.imported.mesh.collapsed import native
from casingfem.structure.imported.mesh.mesh_data import MeshData
from casingfem.structure.imported.mesh.walls import walls_apart

DEGREE = 8  # of the quadrature on facets: pieces cut them, harmonics are no polynomials
OPEN = np.pi / 12.0  # largest angle between neighbouring points of a rim [rad]
CLOSED = 0.5  # net normal over area of a tip's facets below which they point nowhere


class Facets(NamedTuple):
    """A group's facets at quadrature points, flattened: positions, weights, normals (outwards), shape functions."""

    x: FloatArray  # (points, 3)
    weight: FloatArray  # area or length, (points,)
    outward: FloatArray  # (points, 3): normal of a solid's face; of a shell's edge square to it in the surface
    normal: FloatArray  # (points, 3): of a shell's wall; as `outward` of a solid
    nodes: IntArray  # (points, nodes of a facet)
    values: FloatArray  # (points, nodes of a facet)

    def sums(self, functions: FloatArray, count: int) -> FloatArray:
        """Integrals of f N_i over the facets for functions f at the points (functions, points): (functions, count)."""
        total = np.zeros((len(functions), count))
        np.add.at(total.T, self.nodes, (functions * self.weight).T[:, None, :] * self.values[:, :, None])
        return total


def facets_of(system: MeshSystem, name: str) -> Facets:
    """The facets of a group; ModelError if it has none."""
    mesh = system.structure.mesh
    check_groups(mesh, [name])
    facets = mesh.group_facets(name)
    if not len(facets):
        raise ModelError("mesh-group-no-facets", f"{mesh.source}: interface {name!r}")
    nodes = mesh.facet_nodes(facets)
    kinds = native(mesh.cell_kind.facet, nodes)
    lean = None
    if mesh.cell_kind.dim == 2:
        walls = walls_apart(mesh).mesh
        lean = directors(walls)[walls.facet_nodes(facets)]
    parts = [
        part_of(mesh, kind, nodes[rows], slots, facets[rows], None if lean is None else lean[rows])
        for kind, rows, slots in kinds
    ]
    return parts[0] if len(parts) == 1 else Facets(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))


def part_of(
    mesh: MeshData, kind: str, nodes: IntArray, slots: IntArray, facets: IntArray, lean: FloatArray | None
) -> Facets:
    """Facets of one kind with `slots` for their nodes; unused slots have shape functions of 0.

    `lean` (facets, nodes, 3): for shells, the directors of the walls at the facets.
    """
    own = nodes[:, slots]
    on = mapped(kind, mesh.points, own, DEGREE)
    values = rule(kind, DEGREE)[2].T  # (q, nodes)
    if lean is None:
        outward = normal = np.cross(on.tangents[:, :, 0], on.tangents[:, :, 1])
    else:
        normal = np.einsum("qk,ekc->eqc", values, lean[:, slots])
        outward = np.cross(on.tangents[:, :, 0], normal)
        middle = mesh.points[mesh.cells[facets[:, 0]]].mean(axis=1)
        outward *= np.sign(np.einsum("eqc,eqc->eq", outward, on.x - middle[:, None]).sum(axis=1))[:, None, None]
    outward = outward / np.linalg.norm(outward, axis=2, keepdims=True)
    q = len(values)
    whole = np.zeros((q, nodes.shape[1]))
    whole[:, slots] = values
    at_points = on.x.reshape(-1, 3), np.abs(on.measure).ravel(), outward.reshape(-1, 3), normal.reshape(-1, 3)
    return Facets(*at_points, np.repeat(nodes, q, axis=0), np.tile(whole, (len(nodes), 1)))


def tip_frame(system: MeshSystem, facets: Facets, name: str) -> FloatArray:
    """Span, flap and chord of a tip, (3, 3) unit rows, with span = chord x flap.

    Span is the mean outward normal of the facets; chord their longest extent across it, towards positive values of its
    largest component. On shells flap follows the surface normal, and chord = flap x span.
    """
    total = facets.weight @ facets.outward
    size = float(np.linalg.norm(total))
    if size < CLOSED * facets.weight.sum():
        found = f"{system.structure.mesh.source}: found facets of {name!r} whose normals cancel, expected a face"
        raise ModelError("interface-edge", found)
    span = total / size
    away = facets.x - np.average(facets.x, axis=0, weights=facets.weight)
    away -= np.outer(away @ span, span)
    chord = np.linalg.eigh((away.T * facets.weight) @ away)[1][:, -1]
    chord = chord * np.sign(chord[np.abs(chord).argmax()])
    flap = np.cross(span, chord)
    if system.structure.mesh.cell_kind.dim == 2:
        turn = np.sign(facets.weight @ facets.normal @ flap)
        flap, chord = turn * flap, turn * chord
    return np.array([span, flap, chord])


def tip_rows(system: MeshSystem, tip: Tip | TipNodes) -> tuple[FloatArray, FloatArray, dict[str, list[list[float]]]]:
    """Rows (channels, nodes, 3) of a tip as a whole or in pieces of equal chord, its directions (3, 3), and facts.

    For pieces with the directions of the machine the facts contain their positions: along the axis [m], radius [m] and
    angle [degrees] from the middle of the tip.
    """
    facets = facets_of(system, tip.edge)
    frame = tip_frame(system, facets, tip.edge)
    pieces = pieces_of(system, tip, facets, chord_of(tip, facets, frame[2]))
    area = pieces @ facets.weight
    means = facets.sums(pieces / area[:, None], len(system.points))
    if not isinstance(tip, TipNodes) or tip.axis is None:
        directions = frame if isinstance(tip, TipNodes) else frame[:2]
        return np.einsum("kn,dc->kdnc", means, directions).reshape(-1, len(system.points), 3), frame, {}
    places = np.array([*((pieces * facets.weight) @ facets.x / area[:, None]), facets.weight @ facets.x / area.sum()])
    axes = machine_axes(places, tip)
    middle, away = axes[-1], places[:-1] - np.asarray(tip.point)
    angle = np.degrees(np.arctan2(away @ middle[1], away @ middle[0]))
    at = np.stack([away @ middle[2], np.einsum("kc,kc->k", away, axes[:-1, 0]), angle], axis=1)
    rows = np.einsum("kn,kdc->kdnc", means, axes[:-1]).reshape(-1, len(system.points), 3)
    return rows, middle, {"places": at.round(12).tolist()}


def chord_of(tip: Tip | TipNodes, facets: Facets, chord: FloatArray) -> FloatArray:
    """The direction in which pieces are counted: along the axis of a machine, or towards growing angles."""
    if not isinstance(tip, TipNodes) or tip.axis is None:
        return chord
    middle = machine_axes(np.average(facets.x, axis=0, weights=facets.weight)[None], tip)[0]
    along = middle @ chord
    leading = along[2] if abs(along[2]) > 0.1 else along[1]
    return np.asarray(chord * np.sign(leading))


def pieces_of(system: MeshSystem, tip: Tip | TipNodes, facets: Facets, chord: FloatArray) -> FloatArray:
    """1 for points of the facets that belong to a piece of equal chord, else 0, (pieces, points)."""
    count = tip.count if isinstance(tip, TipNodes) else 1
    if not 1 <= count <= 100:
        raise ModelError("interface-nodes", f"TipNodes.count must lie between 1 and 100, found {count!r}")
    along = facets.x @ chord
    ends = system.points[np.unique(facets.nodes)] @ chord
    piece = np.clip(((along - ends.min()) / np.ptp(ends) * count).astype(int), 0, count - 1)
    pieces = (piece == np.arange(count)[:, None]).astype(float)
    weight = pieces @ facets.weight
    if not weight.all():
        empty = int(weight.argmin())
        raise ModelError("interface-nodes", f"TipNodes: piece {empty} of {count} on {tip.edge!r} has no facet")
    return np.asarray(pieces)


def machine_axes(places: FloatArray, tip: TipNodes) -> FloatArray:
    """Radial, tangential and axial unit vectors at points (n, 3) about the axis of a tip, (n, 3, 3)."""
    assert tip.axis is not None
    axial = axis_frame(tip.axis)[2]
    away = places - np.asarray(tip.point)
    away = away - np.outer(away @ axial, axial)
    radius = np.linalg.norm(away, axis=1)
    if radius.min() <= 1e-9 * max(1.0, radius.max()):
        raise ModelError("interface-axis", f"found a piece of {tip.edge!r} on the axis, expected a tip away from it")
    radial = away / radius[:, None]
    return np.asarray(np.stack([radial, np.cross(axial, radial), np.broadcast_to(axial, radial.shape)], axis=1))


class RimView(NamedTuple):
    """A rim: rows (channels, nodes, 3), axial position and mean radius [m], radius harmonics, and its axes (3, 3)."""

    rows: FloatArray
    line: FloatArray
    shape: FloatArray
    axes: FloatArray


def rim_rows(system: MeshSystem, rim: Rim) -> RimView:
    """A rim by harmonics about its axis.

    Raises
    ------
    ModelError
        `interface-edge` for facets that do not close around the axis, `interface-harmonics` for more harmonics than
        its nodes resolve, `interface-lines` for lines, which need a chart.
    """
    if rim.lines:
        found = ", ".join(f"{at:g}" for at in rim.lines)
        raise ModelError("interface-lines", f"lines: found {found} m on an imported mesh, expected a group of facets")
    facets, count = facets_of(system, rim.edge), len(system.points)
    axes = axis_frame(rim.axis)
    x = (facets.x - np.asarray(rim.point)) @ axes.T
    radius, theta = np.hypot(x[:, 0], x[:, 1]), np.arctan2(x[:, 1], x[:, 0])
    places = (system.points[np.unique(facets.nodes)] - np.asarray(rim.point)) @ axes.T
    resolved = len(np.unique(np.round(np.arctan2(places[:, 1], places[:, 0]), 6))) // 3
    if not 0 < rim.n_max <= resolved:
        found = f"rim.n_max must lie between 1 and {resolved} on {rim.edge!r}, found {rim.n_max}"
        raise ModelError("interface-harmonics", found)
    n = np.arange(rim.n_max + 1)[:, None]
    waves = np.concatenate([np.cos(n * theta), np.sin(n[1:] * theta)])
    gap = float(np.diff(np.sort(theta), append=theta.min() + 2.0 * np.pi).max())
    if gap > OPEN:
        found = f"found a gap of {np.degrees(gap):.0f} degrees in {rim.edge!r}"
        raise ModelError("interface-edge", f"rim: {found}, expected facets all around the axis")
    waves = np.linalg.solve((waves * facets.weight) @ waves.T, waves)
    e1, e2, a = axes
    c, s = np.cos(theta)[:, None], np.sin(theta)[:, None]
    units = [c * e1 + s * e2, c * e2 - s * e1, np.broadcast_to(a, (len(theta), 3))][: len(rim.directions)]
    sums = np.array([[facets.sums(waves * unit[:, k], count) for k in range(3)] for unit in units])
    rows = np.moveaxis(sums, 1, -1).reshape(-1, count, 3)
    mean = float(np.average(radius, weights=facets.weight))
    shape = (waves * facets.weight) @ (radius - mean)
    shape[0] = 0.0
    shape[np.abs(shape) < 1e-9 * mean] = 0.0
    line = np.array([[float(np.average(x[:, 2], weights=facets.weight)), mean]])
    return RimView(rows, line, shape[None], axes)


def node_rows(system: MeshSystem, at: AtNodes) -> FloatArray:
    """Rows (3 nodes, nodes, 3) of nodes by their numbers in the file."""
    places = node_places(system, at.nodes)
    moving = system.moving
    for number, place in zip(at.nodes, places, strict=True):
        if not moving[place, :3].any():
            source = system.structure.mesh.source
            raise ModelError("interface-held", f"{source}: found node {number} fixed, where forces have no effect")
    rows = np.zeros((len(places), 3, len(system.points), 3))
    rows[np.arange(len(places))[:, None], np.arange(3), places[:, None], np.arange(3)] = 1.0
    return rows.reshape(-1, len(system.points), 3)


def node_places(system: MeshSystem, numbers: tuple[int, ...]) -> IntArray:
    """Indices of nodes by their numbers in the file; ModelError for a missing or repeated one."""
    mesh = system.structure.mesh
    used = mesh.present
    places = dict(zip(mesh.node_numbers[used[::-1]].tolist(), used[::-1].tolist(), strict=True))  # the first of each
    missing = [number for number in numbers if number not in places]
    if missing or len(set(numbers)) < len(numbers) or not numbers:
        what = f"node {missing[0]} that no cell has" if missing else f"the nodes {list(numbers)}, expected each once"
        raise ModelError("interface-nodes", f"{mesh.source}: at: found {what}")
    return np.array([places[number] for number in numbers], dtype=np.int64)
