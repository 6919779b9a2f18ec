"""Checks of an imported mesh: everything is scanned, and messages name the first cells or nodes of each fault.

Faults that would give wrong frequencies are refused, all in one error; features that may be intended give a warning.
"""

from collections.abc import Sequence

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from casingfem.errors import ModelError, sentence, warn
from casingfem.io.arrays import Array, BoolArray, FloatArray, IntArray
from casingfem.structure.imported.cells.mapped import mapped
from casingfem.structure.imported.mesh.cell_kind import KINDS, SHELLS, shape_functions
from casingfem.structure.imported.mesh.collapsed import LEAST, distinct
from casingfem.structure.imported.mesh.findings import SHOWN, Finding, cells_named, edge_lengths, nodes_named, where
from casingfem.structure.imported.mesh.mesh_data import NATIVE, MeshData, natives
from casingfem.structure.imported.mesh.walls import FLAT, FOLDED, against, neighbours, one_wall
from casingfem.structure.material import Material
from casingfem.structure.shell.plausible import SOUND
from contact.io.names import hint

STRAY = 0.35  # a middle node this far from the middle, relative to its corners, belongs elsewhere
COINCIDENT = 1e-3  # nodes closer than this part of the shortest edge are the same place
ASPECT, DISTORTED = 100.0, 0.02
SHORT_OF = 1e-3  # of the way from a node to the middle of its cell
BOW = 0.15  # bow of a cell's edges over its thickness
SMALL = 0.01  # of a part's volume
LARGE = 25.0  # m: beyond this a part is probably in millimetres


def check_mesh(mesh: MeshData) -> None:
    """Refuse a mesh with faults, all named; warn of features that may be intended.

    Raises
    ------
    ModelError
        With every fault on a line of its own; its code is that of the last line.
    """
    found = non_finite(mesh) or repeated_nodes(mesh) or [f for scan in SCANS for f in scan(mesh)]
    if found:
        lines = [sentence(f.code, f"{mesh.source}: {f.message}") for f in found[:-1]]
        raise ModelError(found[-1].code, "\n".join([*lines, f"{mesh.source}: {found[-1].message}"]))
    for finding in [f for look in WARNINGS for f in look(mesh)]:
        warn(finding.code, f"{mesh.source}: {finding.message}", stacklevel=5)


def non_finite(mesh: MeshData) -> list[Finding]:
    """Coordinates that are nan or infinite."""
    bad = ~np.isfinite(mesh.points).all(axis=1)
    return where("mesh-not-finite", bad, lambda k: f"{nodes_named(mesh, k)} without finite coordinates")


def repeated_nodes(mesh: MeshData) -> list[Finding]:
    """Cells with a repeated node, except bricks and squares that collapse to a valid solid or triangle."""
    kept = np.count_nonzero(distinct(mesh.cells) >= 0, axis=1)
    bad = kept < LEAST.get(mesh.kind, mesh.cell_kind.nodes)
    if mesh.kind in NATIVE:  # only what is read as another kind has the middles of that
        for kind, rows, slots in natives(mesh):
            own = np.count_nonzero(distinct(mesh.cells[rows][:, slots]) >= 0, axis=1)
            bad[rows] |= (own < KINDS[kind].nodes) | (kept[rows] > own)
    return where("mesh-collapsed-cell", bad, lambda k: f"{cells_named(mesh, k)} that contain a node twice")


def extremes(mesh: MeshData, *, nodes: bool) -> tuple[FloatArray, FloatArray]:
    """Smallest and largest local volume or area of each cell at quadrature points or nodes, relative to a cube."""
    least, most = np.empty((2, len(mesh.cells)))
    for kind, rows, slots in natives(mesh):
        inner, at_nodes = local_sizes(mesh, kind, mesh.cells[rows][:, slots])
        local = np.concatenate([inner, at_nodes], axis=1) if nodes else inner
        least[rows], most[rows] = local.min(axis=1), local.max(axis=1)
    size = edge_lengths(mesh).max(axis=1) ** mesh.cell_kind.dim
    return least / size, most / size


def local_sizes(mesh: MeshData, name: str, cells: IntArray) -> tuple[FloatArray, FloatArray]:
    """Local volume or area of cells of one kind at quadrature points, and at nodes, (cells, points) each."""
    kind = KINDS[name]
    on = mapped(name, mesh.points, cells)
    places = kind.places
    if name == "pyramid13":  # without a size at its apex
        places = places + SHORT_OF * (places.mean(axis=0) - places)
    _, slopes = shape_functions(name, np.ascontiguousarray(places.T))
    at_nodes = np.einsum("dkq,ekc->eqdc", slopes, mesh.points[cells], optimize=True)
    tangents = np.concatenate([on.tangents, at_nodes], axis=1)
    if kind.dim == 3:
        local = np.linalg.det(tangents)
    else:
        normal = np.cross(tangents[:, :, 0], tangents[:, :, 1])
        middle = on.measure[:, :, None] * normal[:, : on.measure.shape[1]]
        centre = middle.sum(axis=1)
        centre /= np.maximum(np.linalg.norm(centre, axis=1, keepdims=True), np.finfo(float).tiny)
        local = np.einsum("eqc,ec->eq", normal, centre)
    return local[:, : on.measure.shape[1]], local[:, on.measure.shape[1] :]


def bad_cells(mesh: MeshData) -> list[Finding]:
    """Cells without volume, inside out, or with nodes in another order than that of the format."""
    least, most = extremes(mesh, nodes=False)
    flat = np.maximum(most, -least) < 1e-9
    inverted = ~flat & (most < 0.0)
    mixed = ~flat & ~inverted & ((least <= 0.0) | stray_middles(mesh))
    return [
        *where("mesh-flat-cell", flat, lambda k: f"{cells_named(mesh, k)} without volume or area"),
        *where("mesh-inverted-cell", inverted, lambda k: f"{cells_named(mesh, k)} with negative volume"),
        *where("mesh-scrambled-cell", mixed, lambda k: f"{cells_named(mesh, k)} folded, with nodes in a wrong order"),
    ]


def stray_middles(mesh: MeshData) -> Array:
    """Cells with a middle node far from the middle of its corners."""
    stray = np.zeros(len(mesh.cells), dtype=bool)
    for kind, rows, slots in natives(mesh):
        points = mesh.points[mesh.cells[rows][:, slots]]
        for k, corners in enumerate(KINDS[kind].supports_of_nodes):
            around = points[:, list(corners)]
            reach = np.linalg.norm(around - around[:, :1], axis=2).max(axis=1)
            stray[rows] |= np.linalg.norm(points[:, k] - around.mean(axis=1), axis=1) > STRAY * reach
    return stray


def spacing(mesh: MeshData) -> float:
    """The shortest distance expected between nodes of one cell: its shortest edge, halved by a middle node."""
    return float(edge_lengths(mesh).min()) * (0.5 if mesh.cell_kind.middles else 1.0)


def coincident(mesh: MeshData) -> list[Finding]:
    """Nodes at the same position that no cell joins: an open seam, or parts that were not merged."""
    from scipy.spatial import cKDTree  # loaded with the first part, not by every study

    used = mesh.used
    reach = max(COINCIDENT * spacing(mesh), 1e-12 * mesh.size)
    pairs = used[cKDTree(mesh.points[used]).query_pairs(reach, output_type="ndarray")]
    pairs = pairs[~attached_pairs(mesh, pairs)]
    if not len(pairs):
        return []
    first = nodes_named(mesh, np.unique(pairs))
    return [Finding("mesh-open-seam", f"{first} coincide with another node but are not joined to it")]


def attached_pairs(mesh: MeshData, pairs: IntArray) -> BoolArray:
    """Pairs of nodes (m, 2) that one attachment joins: bolts of springs, tied faces."""
    together = np.zeros(len(pairs), dtype=bool)
    if len(pairs):
        for link in mesh.attachments.links:
            together |= np.isin(pairs, link).all(axis=1)
    return together


def parts(mesh: MeshData) -> list[Finding]:
    """Cells that are not connected by common nodes, connections or ties."""
    cells = mesh.cells
    count = len(cells)
    owner = np.repeat(np.arange(count), cells.shape[1])
    size = count + len(mesh.points)
    first, other = owner, count + cells.ravel()
    for link in mesh.attachments.links:
        first = np.append(first, count + np.broadcast_to(link[0], len(link)))
        other = np.append(other, count + link)
    graph = coo_array((np.ones(len(first)), (first, other)), shape=(size, size))
    part = connected_components(graph, directed=False)[1][:count]
    _, part, sizes = np.unique(part, return_inverse=True, return_counts=True)
    if len(sizes) == 1:
        return []
    largest = ", ".join(map(str, np.sort(sizes)[::-1][:SHOWN]))
    alone = cells_named(mesh, np.flatnonzero(part != sizes.argmax()))
    found = f"{len(sizes)} parts that do not touch, of {largest} cells; not in the largest: {alone}"
    return [Finding("mesh-parts", found)]


def overlaps(mesh: MeshData) -> list[Finding]:
    """Repeated cells, facets of solids in more than two cells, and shell cells that overlap."""
    _, first = np.unique(np.sort(mesh.cells, axis=1), axis=0, return_index=True)
    copies = ~np.isin(np.arange(len(mesh.cells)), first)
    found = where("mesh-overlap", copies, lambda k: f"{cells_named(mesh, k)} with the same nodes as another")
    if found:
        return found
    if mesh.kind not in SHELLS:
        others = "share a facet with two or more others"
        return where("mesh-overlap", (mesh.sharing > 2).any(axis=1), lambda k: f"{cells_named(mesh, k)} {others}")
    given = neighbours(mesh)
    back = given.facets[given.ahead < -np.cos(np.radians(FLAT))]
    over = np.isin(np.arange(len(mesh.cells)), back[:, :, 0])
    at = nodes_named(mesh, np.unique(mesh.facet_nodes(back[:, 0])))
    beside = f"overlap a neighbour, folded back at their common edge, at {at}"
    return where("mesh-overlap", over, lambda k: f"{cells_named(mesh, k)} {beside}")


def hanging(mesh: MeshData) -> list[Finding]:
    """Corners on a neighbour's middle node, and neighbours whose common facet has different middle nodes."""
    if not mesh.cell_kind.middles:
        return []
    corners = len(mesh.cell_kind.corners)
    first, middles = mesh.cells[:, :corners], mesh.cells[:, corners:]
    own = (middles[:, :, None] == first[:, None, :]).any(axis=2)  # of cells that collapse
    both = (np.isin(middles, first) & ~own).any(axis=1)
    what = "use a corner of another cell as a middle node"
    return [*where("mesh-hanging-node", both, lambda k: f"{cells_named(mesh, k)} {what}"), *split_facets(mesh)]


def split_facets(mesh: MeshData) -> list[Finding]:
    """Neighbours with equal corners but different middle nodes on their common facet."""
    count = len(mesh.cell_kind.facets)
    full = distinct(mesh.facet_nodes(np.argwhere(np.ones((len(mesh.cells), count)))))
    _, inverse, counts = np.unique(full, axis=0, return_inverse=True, return_counts=True)
    alike = counts[inverse.ravel()].reshape(len(mesh.cells), count)
    bad = ((alike != mesh.sharing) & (mesh.sharing > 0)).any(axis=1)
    what = "share the corners of a facet with a neighbour, but not its middle nodes"
    return where("mesh-hanging-node", bad, lambda k: f"{cells_named(mesh, k)} {what}")


def normals(mesh: MeshData) -> list[Finding]:
    """Cells of a shell whose normal is opposite to a neighbour's within `FOLDED`.

    Both have their edge in the same direction.

    At sharper folds and at branches normals are independent.
    """
    if mesh.kind not in SHELLS:
        return []
    given = neighbours(mesh)
    pairs = given.facets[one_wall(given, FOLDED)]
    bad = np.isin(np.arange(len(mesh.cells)), pairs[against(mesh, pairs), :, 0])
    return where("mesh-flipped-shell", bad, lambda k: f"{cells_named(mesh, k)} with a normal opposite to a neighbour's")


def orphans(mesh: MeshData) -> list[Finding]:
    """Nodes without cell and attachment."""
    alone = np.ones(len(mesh.points), dtype=bool)
    alone[mesh.present] = False
    return where("mesh-orphan-nodes", alone, lambda k: f"{nodes_named(mesh, k)} without a cell")


def slender(mesh: MeshData) -> list[Finding]:
    """Cells much longer than wide, or nearly folded."""
    edges = edge_lengths(mesh)
    ratio = edges.max(axis=1) / edges.min(axis=1)
    least, most = extremes(mesh, nodes=True)
    lowest = np.where(mesh.collapsed & (mesh.kind not in NATIVE), 1.0, least / most)
    long = f"ratio of longest to shortest edge up to {ratio.max():.3g}"
    return [
        *where("mesh-aspect", ratio > ASPECT, lambda k: f"{cells_named(mesh, k)}, {long}"),
        *where("mesh-distorted-cell", lowest < DISTORTED, lambda k: f"{cells_named(mesh, k)} nearly folded"),
    ]


def thin_and_curved(mesh: MeshData) -> list[Finding]:
    """Solid cells whose bow, from an edge's chord to its middle node, is large compared with their thickness.

    They lock.

    On the frustum of reports/verification/modes/imported.py (27 nodes) a bow of 0.06 thicknesses raises the lowest
    frequency by 0.5 %, of 0.2 by 5 %, and of 0.6 by 23 %. Cells that fill at most a hundredth of the part are ignored:
    those in a blade's edges are thin in two directions and change no frequency.
    """
    kind = mesh.cell_kind
    if kind.dim < 3 or not kind.middles:
        return []
    first = len(kind.corners)
    ends = mesh.points[mesh.cells[:, np.array(kind.edges)]].mean(axis=2)
    bow = np.linalg.norm(mesh.points[mesh.cells[:, first : first + len(kind.edges)]] - ends, axis=2).max(axis=1)
    ratio = bow / edge_lengths(mesh).min(axis=1)
    volume = volumes(mesh)
    if volume[ratio > BOW].sum() <= SMALL * volume.sum():
        return []
    worst = f"whose edges are curved by up to {ratio.max():.2g} of the thickness"
    return where("mesh-thin-curved", ratio > BOW, lambda k: f"{cells_named(mesh, k)} {worst}")


def volumes(mesh: MeshData) -> FloatArray:
    """Volume of each cell of a solid [m^3], (cells,)."""
    found = np.empty(len(mesh.cells))
    for kind, rows, slots in natives(mesh):
        found[rows] = mapped(kind, mesh.points, mesh.cells[rows][:, slots]).measure.sum(axis=1)
    return found


def linear(mesh: MeshData) -> list[Finding]:
    """Warn of linear solids, which lock in bending."""
    if mesh.kind in ("tetra", "hexahedron"):
        return [Finding("mesh-linear-cells", f"{len(mesh.cells)} linear cells ({mesh.kind})")]
    return []


SCANS = (bad_cells, coincident, overlaps, hanging, normals, parts)
WARNINGS = (orphans, slender, thin_and_curved, linear)


def check_groups(mesh: MeshData, names: Sequence[str]) -> None:
    """Refuse names that are not groups of the mesh, with similar ones, and empty groups."""
    for name in names:
        if name not in mesh.groups:
            known = [repr(group) for group in mesh.groups]
            found = (
                f"found no group {name!r}{hint(repr(name), known, most=3)}; its groups: {', '.join(known) or 'none'}"
            )
            raise ModelError("mesh-no-group", f"{mesh.source}: {found}")
        if not np.isin(mesh.groups[name].nodes, mesh.present).any():
            raise ModelError("mesh-group-empty", f"{mesh.source}: found a group {name!r} without a node of a cell")


def check_units(mesh: MeshData, material: Material) -> None:
    """Warn of sizes that suggest millimetres, and of implausible materials."""
    speed, size = float(np.sqrt(material.E / material.rho)), mesh.size
    if size > LARGE and SOUND[0] <= speed <= SOUND[1]:
        found = f"found a part of {size:.4g} m across, with E = {material.E:.3g} Pa"
        warn("mesh-units", f"{mesh.source}: {found}", stacklevel=4)
    if not SOUND[0] <= speed <= SOUND[1]:
        found = f"E = {material.E:.3g} Pa and rho = {material.rho:.3g} kg/m^3 give a speed of sound of {speed:.3g} m/s"
        warn("material-units", found, stacklevel=4)
