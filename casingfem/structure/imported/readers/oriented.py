"""Shell cells whose normals point to one side: those that point against their neighbours' are turned round."""

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from casingfem.io.arrays import BoolArray, IntArray


def against(edges: IntArray) -> BoolArray:
    """Cells to turn so that all normals agree with their neighbours', (cells,): of each connected part the fewer ones.

    `edges` (cells, edges, 2) are the ends of each cell's edges on its way round. Edges of more than two cells join
    nothing; a part without two sides (a Moebius strip) is left as it is.

    >>> against(np.array([[[0, 1], [1, 2], [2, 0]], [[1, 2], [2, 3], [3, 1]], [[2, 3], [3, 4], [4, 2]]])).tolist()
    [False, True, False]
    """
    count = len(edges)
    ends = edges.reshape(-1, 2)
    _, place, shared = np.unique(np.sort(ends, axis=1), axis=0, return_inverse=True, return_counts=True)
    order = np.argsort(place.ravel(), kind="stable")
    first = np.cumsum(shared)[(shared == 2) & (np.ptp(ends[order[np.cumsum(shared) - 1]], axis=1) > 0)] - 2
    one, other = order[first], order[first + 1]
    a, b = one // edges.shape[1], other // edges.shape[1]
    alike = (ends[one] != ends[other]).all(axis=1)  # they run along their common edge in opposite ways
    # each cell stands twice, as it is and turned; neighbours are joined where they agree
    i, j = np.concatenate([a, a + count]), np.concatenate([b + count * ~alike, b + count * alike])
    graph = coo_array((np.ones(len(i)), (i, j)), shape=(2 * count, 2 * count))
    part = connected_components(graph, directed=False)[1].reshape(2, count)
    kept = np.bincount(part[0], minlength=part.max() + 1)  # cells that stay as they are if this copy of a part is taken
    turned: BoolArray = kept[part[1]] > kept[part[0]]
    even = (kept[part[1]] == kept[part[0]]) & (part[0] != part[1])
    turned |= even & (part[1] < part[0])
    return turned
