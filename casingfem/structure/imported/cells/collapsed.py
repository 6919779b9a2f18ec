"""Linear cells of several kinds as cells of one: wedges, pyramids and tetrahedra as bricks, triangles as squares.

A brick or square with two corners at one node has, on the linear kinds, exactly the shape functions of what it
collapses to (Hughes, The Finite Element Method, 1987, section 3.6); on quadratic kinds it has not.
"""

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from casingfem.io.arrays import FloatArray, IntArray
from casingfem.structure.imported.cells.handed import right_handed

CORNERS: Mapping[str, Mapping[str, Sequence[int]]] = {
    "hexahedron": {
        "hexahedron": (0, 1, 2, 3, 4, 5, 6, 7), "wedge": (0, 1, 2, 2, 3, 4, 5, 5), "pyramid": (0, 1, 2, 3, 4, 4, 4, 4),
        "tetra": (0, 1, 2, 2, 3, 3, 3, 3),
    },
    "quad": {"quad": (0, 1, 2, 3), "triangle": (0, 1, 2, 2)},
}  # of a kind, written as a brick or square  # fmt: skip
LEAST = {"hexahedron": 4, "quad": 3}  # corners that a collapsed cell keeps


def common_kind(kinds: Collection[str]) -> str:
    """The kind that cells of some kinds can all be written as: their own where there is one; "" for none.

    >>> common_kind(["tetra"]), common_kind(["tetra", "wedge"]), common_kind(["triangle"]), common_kind(["quad8", "x"])
    ('tetra', 'hexahedron', 'quad', '')
    """
    if len(kinds) == 1 and not set(kinds) & {"wedge", "pyramid", "triangle"}:
        return next(iter(kinds))
    return next((target for target, known in CORNERS.items() if set(kinds) <= set(known)), "")


def written_as(target: str, kind: str, cells: IntArray, points: FloatArray) -> IntArray:
    """Cells of a kind (m, nodes) as those of another; wedges, which VTK numbers from above, from below."""
    if kind == target:
        return cells
    upright = right_handed(kind, cells, points) if kind == "wedge" else cells
    return np.asarray(upright[:, list(CORNERS[target][kind])])


def distinct(corners: IntArray) -> IntArray:
    """Corners of facets (..., c) in ascending order, those given again as -1.

    >>> distinct(np.array([[7, 3, 3, 5]])).tolist()
    [[-1, 3, 5, 7]]
    """
    ordered = np.sort(corners, axis=-1)
    again = np.zeros(ordered.shape, dtype=bool)
    again[..., 1:] = ordered[..., 1:] == ordered[..., :-1]
    return np.sort(np.where(again, -1, ordered), axis=-1)
