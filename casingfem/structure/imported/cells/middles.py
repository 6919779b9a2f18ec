"""Middle nodes that a file leaves out: an edge of a quadratic cell without one stays straight and moves linearly.

The shape function of such an edge's middle goes in halves to its ends (Nastran, Ansys), which is what a node in the
middle does whose motion is the mean of theirs: it is put in, tied.
"""

from collections.abc import Sequence

import numpy as np

from casingfem.io.arrays import FloatArray, IntArray
from casingfem.structure.imported.attachments.values import Tie
from casingfem.structure.imported.cell_kind import KINDS


def filled(
    points: FloatArray, kinds: Sequence[str], cells: Sequence[IntArray]
) -> tuple[FloatArray, list[IntArray], Tie | None]:
    """Points with the middles that cells (m, nodes) of some kinds leave out as -1, the cells with them, and their tie.

    >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    >>> points, (cells,), tie = filled(points, ["triangle6"], [np.array([[0, 1, 2, -1, -1, -1]])])
    >>> cells.tolist(), points[3].tolist(), tie.others.tolist()
    ([[0, 1, 2, 3, 5, 4]], [0.5, 0.0, 0.0], [[0, 1], [0, 2], [1, 2]])
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
    new = len(points) + place.ravel()
    whole, start = [], 0
    for table, rows in zip(cells, gaps, strict=True):
        own = table.copy()
        own[rows[:, 0], rows[:, 1]] = new[start : start + len(rows)]
        whole.append(own)
        start += len(rows)
    middles = len(points) + np.arange(len(edges))
    tie = Tie(nodes=middles, others=edges, weights=np.full(edges.shape, 0.5), where="a middle node that is left out")
    return np.vstack([points, points[edges].mean(axis=1)]), whole, tie
