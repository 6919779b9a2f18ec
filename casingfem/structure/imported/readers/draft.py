"""Make a `MeshData` from the contents of a mesh file: cells of one kind, everything else as groups."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from casingfem.errors import ModelError, warn
from casingfem.io.arrays import BoolArray, FloatArray, IntArray
from casingfem.structure.imported.attachments.glue import Gluing, tied
from casingfem.structure.imported.mesh.attachments import NOTHING, Attachments
from casingfem.structure.imported.mesh.cell_kind import KINDS
from casingfem.structure.imported.mesh.collapsed import common_kind, mirror, written_as
from casingfem.structure.imported.mesh.findings import named
from casingfem.structure.imported.mesh.mesh_data import Group, MeshData, find_facets
from casingfem.structure.imported.mesh.walls import FOLDED, against, neighbours, one_wall
from casingfem.structure.imported.readers.middles import filled, raised
from contact.io.names import names_fault

DIMENSIONS = {"vertex": 0, "wedge": 3, "pyramid": 3, "polygon": 2} | {name: kind.dim for name, kind in KINDS.items()}


@dataclass(frozen=True, slots=True, eq=False)
class Block:
    """Cells of one kind: node indices (cells, nodes) in VTK's order, and their numbers in the file.

    Missing middle nodes are -1.
    """

    kind: str
    cells: IntArray
    numbers: IntArray

    @property
    def dim(self) -> int:
        """Dimension of the cells. Unknown kinds have 3, so that they are refused and not skipped."""
        return DIMENSIONS.get(self.kind, DIMENSIONS.get(self.kind.rstrip("0123456789"), 3))


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Draft:
    """Contents of a mesh file before checks.

    `node_sets` are node indices; `cell_sets` pairs (block, rows); `facet_sets` corner node indices (m, corners);
    `attachments` are in the file's units; `gluings` name sets; `metre` is the file's unit of length [m].
    """

    points: FloatArray
    node_numbers: IntArray
    blocks: Sequence[Block]
    node_sets: Mapping[str, IntArray] = field(default_factory=dict)
    cell_sets: Mapping[str, Sequence[tuple[int, IntArray]]] = field(default_factory=dict)
    facet_sets: Mapping[str, IntArray] = field(default_factory=dict)
    attachments: Attachments = NOTHING
    gluings: Sequence[Gluing] = ()
    metre: float = 1.0


class Lookup:
    """Numbers of a file -> indices; unknown and repeated numbers are refused."""

    def __init__(self, numbers: IntArray, source: str, what: str) -> None:
        self.order = np.argsort(numbers, kind="stable")
        self.sorted, self.source, self.what = numbers[self.order], source, what
        twice = self.sorted[:-1][np.diff(self.sorted) == 0]
        if len(twice):
            raise ModelError("mesh-file", f"{source}: found {what} {twice[0]} twice, expected it once")

    def __call__(self, wanted: IntArray) -> IntArray:
        """Indices of numbers, of their shape."""
        place = np.minimum(np.searchsorted(self.sorted, wanted), len(self.sorted) - 1)
        missing = np.asarray(wanted)[self.sorted[place] != wanted]
        if len(missing):
            raise ModelError("mesh-file", f"{self.source}: found no {self.what} {missing[0]}, although it is used")
        return np.asarray(self.order[place])

    def some(self, wanted: IntArray, given: BoolArray) -> IntArray:
        """Indices of node numbers, in an array of the same shape; -1 for missing middle nodes."""
        cells = np.full(wanted.shape, -1)
        cells[given] = self(wanted[given])
        return cells


def build(draft: Draft, source: str) -> MeshData:
    """The mesh of a draft.

    Raises
    ------
    ModelError
        If there are no cells, several kinds of the highest dimension, or an unsupported kind.
    """
    draft = with_middles(draft)
    dims = [block.dim for block in draft.blocks]
    top = max(dims, default=0)
    kinds = Counter[str]()
    for block in (block for block in draft.blocks if block.dim == top):
        kinds[block.kind] += len(block.cells)
    found = ", ".join(f"{count} {kind}" for kind, count in kinds.items())
    if top < 2:
        raise ModelError("mesh-no-cells", f"{source}: found {found or 'no cells'}")
    kind = common_kind(kinds)
    if not kind:
        raise ModelError("mesh-mixed-cells" if len(kinds) > 1 else "mesh-unsupported-cell", f"{source}: found {found}")
    if kind not in KINDS or kind.startswith("triangle"):
        raise ModelError("mesh-unsupported-cell", f"{source}: found {found}")
    main = [k for k, dim in enumerate(dims) if dim == top]
    start = dict(zip(main, np.cumsum([0, *(len(draft.blocks[k].cells) for k in main)]).tolist(), strict=False))
    blocks = [draft.blocks[k] for k in main]
    mesh = MeshData(
        kind=kind,
        points=draft.points,
        cells=np.concatenate([written_as(kind, block.kind, block.cells, draft.points) for block in blocks]),
        cell_numbers=np.concatenate([draft.blocks[k].numbers for k in main]),
        node_numbers=draft.node_numbers,
        attachments=draft.attachments,
        source=source,
    )
    if top == 2:
        mesh = alike(mesh)
    names = dict.fromkeys([*draft.cell_sets, *draft.facet_sets, *draft.node_sets])
    if fault := names_fault(names):
        raise ModelError("mesh-file", f"{source}: found the group {fault}")
    mesh = replace(mesh, groups={name: make_group(name, draft, mesh, start) for name in names})
    return tied(mesh, draft.gluings)


def alike(mesh: MeshData) -> MeshData:
    """A shell whose cells are turned where normals of one wall are opposite, and a warning."""
    given = neighbours(mesh)
    pairs = given.facets[one_wall(given, FOLDED)]
    turned = to_turn(len(mesh.cells), pairs[:, :, 0], against(mesh, pairs))
    if not turned.any():
        return mesh
    found = f"found {named('cell', mesh.cell_numbers[turned])} with normals opposite to their neighbours'"
    warn("mesh-turned-shell", f"{mesh.source}: {found}", stacklevel=5)
    return replace(mesh, cells=np.where(turned[:, None], mesh.cells[:, mirror(mesh.kind)], mesh.cells))


def with_middles(draft: Draft) -> Draft:
    """A draft with the missing middle nodes added; these have no numbers in the file."""
    top = max((block.dim for block in draft.blocks), default=0)
    given = [block.kind for block in draft.blocks if block.dim == top]
    found = [
        raised(block.kind, block.cells, draft.points, given) if block.dim == top else (block.kind, block.cells)
        for block in draft.blocks
    ]
    kinds = [kind for kind, _ in found]
    points, cells, tie = filled(draft.points, kinds, [cells for _, cells in found])
    blocks = [Block(k, own, b.numbers) for b, k, own in zip(draft.blocks, kinds, cells, strict=True)]
    if tie is None:
        return replace(draft, blocks=blocks)
    numbers = np.concatenate([draft.node_numbers, np.zeros(len(tie.nodes), dtype=np.int64)])
    whole = replace(draft, points=points, node_numbers=numbers, blocks=blocks)
    if top < 3:  # shells bend along their edges; what contains both ends of one contains its middle
        own = draft.node_sets.items()
        sets = {name: np.concatenate([nodes, tie.nodes[np.isin(tie.others, nodes).all(axis=1)]]) for name, nodes in own}
        return replace(whole, node_sets=sets)
    return replace(whole, attachments=replace(draft.attachments, glued=(tie, *draft.attachments.glued)))


def make_group(name: str, draft: Draft, mesh: MeshData, start: Mapping[int, int]) -> Group:
    """One group from everything that has this name in the file: nodes, cells of the mesh, facets, smaller cells."""
    nodes = [np.asarray(draft.node_sets.get(name, []), dtype=np.int64)]
    cells, corners = [np.zeros(0, dtype=np.int64)], []
    below = mesh.cell_kind.dim - 1
    for k, rows in draft.cell_sets.get(name, ()):
        block = draft.blocks[k]
        nodes.append(block.cells[rows].ravel())
        if k in start:
            cells.append(start[k] + np.asarray(rows, dtype=np.int64))
        elif block.dim == below and len(rows):
            corners.append(block.cells[rows][:, : len(KINDS[block.kind].corners)])
    if name in draft.facet_sets:
        corners.append(draft.facet_sets[name])
    facets = [locate(name, part, mesh) for part in corners]
    nodes += [mesh.facet_nodes(part).ravel() for part in facets]
    on = np.concatenate(facets) if facets else None
    return Group(nodes=np.concatenate(nodes), cells=np.concatenate(cells), facets=on)


def locate(name: str, corners: IntArray, mesh: MeshData) -> IntArray:
    """Facets given by corners as pairs (cell, local facet). Facets of no cell are skipped with a warning."""
    facets = find_facets(mesh, corners)
    lost = int(np.count_nonzero(facets[:, 0] < 0))
    if lost:
        found = f"{mesh.source}: found group {name!r} with {lost} of {len(corners)} facets that belong to no cell"
        warn("mesh-loose-facets", found, stacklevel=6)
    return facets[facets[:, 0] >= 0]


def joined(mesh: MeshData, distance: float) -> MeshData:
    """The mesh after merging nodes of cells closer than a distance [m]; nodes of attachments only are not merged."""
    from scipy.spatial import cKDTree  # loaded with the first part, not by every study

    used = mesh.used
    pairs = used[cKDTree(mesh.points[used]).query_pairs(distance, output_type="ndarray")]
    count = len(mesh.points)
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    _, part = connected_components(graph, directed=False)
    _, first, place = np.unique(part, return_index=True, return_inverse=True)
    groups = {name: replace(group, nodes=place[group.nodes]) for name, group in mesh.groups.items()}
    points, cells, numbers = mesh.points[first], place[mesh.cells], mesh.node_numbers[first]
    attached = mesh.attachments.renumbered(lambda nodes: place[nodes])
    return replace(mesh, points=points, cells=cells, groups=groups, node_numbers=numbers, attachments=attached)


def to_turn(count: int, pairs: IntArray, against: BoolArray) -> BoolArray:
    """Cells to turn so that all normals agree with their neighbours', (cells,).

    Of each connected part the smaller number.

    `pairs` (pairs, 2) are neighbours among `count` cells; `against` (pairs,) marks those with opposite normals. A part
    with one side only (a Moebius strip) is not changed.

    >>> to_turn(3, np.array([[0, 1], [1, 2]]), np.array([True, True])).tolist()
    [False, True, False]
    """
    a, b = pairs.T
    # each cell has two copies, unchanged and turned; copies of neighbours are joined if their normals agree
    i, j = np.concatenate([a, a + count]), np.concatenate([b + count * against, b + count * ~against])
    graph = coo_array((np.ones(len(i)), (i, j)), shape=(2 * count, 2 * count))
    part = connected_components(graph, directed=False)[1].reshape(2, count)
    kept = np.bincount(part[0], minlength=part.max() + 1)  # cells that stay as they are if this copy of a part is taken
    turned: BoolArray = kept[part[1]] > kept[part[0]]
    even = (kept[part[1]] == kept[part[0]]) & (part[0] != part[1])
    turned |= even & (part[1] < part[0])
    return turned
