"""Linear cells of several kinds as cells of one: wedges, pyramids and tetrahedra as bricks, triangles as squares.

A brick or square with two corners at one node has, on the linear kinds, exactly the shape functions of what it
collapses to (Hughes, The Finite Element Method, 1987, section 3.6); on quadratic kinds it has not.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence

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


TURNS = tuple((k, (k + 1) % 4, (k + 2) % 4, (k + 3) % 4) for k in range(4))  # of a square, by its first corner


def native(kind: str, cells: IntArray) -> Iterator[tuple[str, IntArray, IntArray]]:
    """Facets that collapse as what they are: kind, rows (m,) and nodes (m, k) of each kind there is.

    >>> [(kind, nodes.tolist()) for kind, _, nodes in native("quad", np.array([[1, 2, 5, 4], [2, 3, 3, 5]]))]
    [('quad', [[1, 2, 5, 4]]), ('triangle', [[3, 5, 2]])]
    """
    if kind not in ("quad", "quad8"):
        yield kind, np.arange(len(cells)), cells
        return
    corners = cells[:, :4]
    again = corners == np.roll(corners, -1, axis=1)
    if len(whole := np.flatnonzero(~again.any(axis=1))):
        yield kind, whole, cells[whole]
    flat = np.flatnonzero(again.any(axis=1))
    if len(flat):
        first = again[flat].argmax(axis=1)  # corner that the next one repeats
        order = np.array(TURNS)[(first + 1) % 4][:, :3]
        slots = order if kind == "quad" else np.hstack([order, 4 + order])
        yield ("triangle" if kind == "quad" else "triangle6"), flat, np.take_along_axis(cells[flat], slots, axis=1)


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
