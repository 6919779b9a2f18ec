"""Missing middle nodes: an edge of a quadratic cell without one stays straight and moves linearly.

Half of the shape function of such an edge's middle is added to each of its ends (Nastran, Ansys). A middle node tied to
the mean motion of the ends gives the same, so the reader adds such a node. If another cell has a middle node on the
edge, that node is used, and the cells stay joined. Linear cells among quadratic ones are treated as quadratic cells
without middle nodes. On shells the added middle nodes move freely: a thin shell with a straight edge could not bend
along it.
"""

from collections.abc import Collection, Sequence

import numpy as np

from casingfem.io.arrays import FloatArray, IntArray
from casingfem.structure.imported.mesh.attachments import Tie
from casingfem.structure.imported.mesh.cell_kind import KINDS
from casingfem.structure.imported.mesh.collapsed import right_handed

QUADRATIC = {
    "tetra": "tetra10", "wedge": "wedge15", "pyramid": "pyramid13", "hexahedron": "hexahedron20",
    "triangle": "triangle6", "quad": "quad8",
}  # fmt: skip


def raised(kind: str, cells: IntArray, points: FloatArray, beside: Collection[str]) -> tuple[str, IntArray]:
    """Linear cells among quadratic ones as quadratic cells without middle nodes; others unchanged.

    >>> kind, cells = raised("tetra", np.array([[0, 1, 2, 3]]), np.zeros((4, 3)), ["tetra", "tetra10"])
    >>> kind, cells.tolist()
    ('tetra10', [[0, 1, 2, 3, -1, -1, -1, -1, -1, -1]])
    """
    if kind not in QUADRATIC or not set(QUADRATIC.values()) & set(beside):
        return kind, cells
    name = QUADRATIC[kind]
    upright = right_handed(kind, cells, points) if kind in ("wedge", "pyramid") else cells
    return name, np.pad(upright, ((0, 0), (0, KINDS[name].nodes - cells.shape[1])), constant_values=-1)


def filled(
    points: FloatArray, kinds: Sequence[str], cells: Sequence[IntArray]
) -> tuple[FloatArray, list[IntArray], Tie | None]:
    """Add the missing (-1) middles of cells (m, nodes): points, complete cells, and the tie of the new nodes.

    >>> points = np.vstack([np.zeros(3), np.eye(3), [[0.5, 0.0, 0.0]]])
    >>> points, (cells,), tie = filled(points, ["tetra10"], [np.array([[0, 1, 2, 3, 4, -1, -1, -1, -1, -1]])])
    >>> cells.tolist(), points[5].tolist(), tie.others[0].tolist()
    ([[0, 1, 2, 3, 4, 7, 5, 6, 8, 9]], [0.0, 0.5, 0.0], [0, 2])
    """
    gaps = [np.argwhere(table < 0) for table in cells]
    ends = [
        table[rows[:, :1], np.array([KINDS[kind].supports_of_nodes[slot] for slot in rows[:, 1]])]
        for kind, table, rows in zip(kinds, cells, gaps, strict=True)
        if len(rows)
    ]
    if not ends:
        return points, list(cells), None
    edges, place = np.unique(np.sort(np.concatenate(ends), axis=1), axis=0, return_inverse=True)
    own = known_middles(kinds, cells, edges)
    open_edges = np.flatnonzero(own < 0)
    own[open_edges] = len(points) + np.arange(len(open_edges))
    edges, new = edges[open_edges], own[place.ravel()]
    whole, start = [], 0
    for table, rows in zip(cells, gaps, strict=True):
        whole.append(table.copy())
        whole[-1][rows[:, 0], rows[:, 1]] = new[start : start + len(rows)]
        start += len(rows)
    if not len(edges):
        return points, whole, None
    middles = len(points) + np.arange(len(edges))
    tie = Tie(nodes=middles, others=edges, weights=np.full(edges.shape, 0.5), where="a missing middle node")
    return np.vstack([points, points[edges].mean(axis=1)]), whole, tie


def known_middles(kinds: Sequence[str], cells: Sequence[IntArray], edges: IntArray) -> IntArray:
    """Middle nodes that some cell has on edges (m, 2), ascending pairs; -1 for edges without."""
    pairs, middles = [edges], [np.full(len(edges), -1)]
    for kind, table in zip(kinds, cells, strict=True):
        if kind in QUADRATIC.values():
            corners = len(KINDS[kind].corners)
            ends = np.sort(table[:, np.array(KINDS[kind].edges)], axis=2)
            pairs.append(ends.reshape(-1, 2))
            middles.append(table[:, corners : corners + ends.shape[1]].ravel())
    _, place = np.unique(np.concatenate(pairs), axis=0, return_inverse=True)
    place, found = place.ravel(), np.concatenate(middles)
    best = np.full(place.max() + 1, -1)
    np.maximum.at(best, place, found)
    return best[place[: len(edges)]]
