"""Cells stored as another kind, or numbered in the opposite sense.

Wedges, pyramids and tetrahedra become bricks, triangles squares. A brick or square with two corners at one node has, on
the linear kinds, exactly the shape functions of what it collapses to (Hughes, The Finite Element Method, 1987, section
3.6). On quadratic kinds this is not true. Such cells are stored as bricks or squares so that facets and groups are the
same for all cells, and are integrated as their true kind (`native`). Nastran allows left-handed solid cells, and VTK's
wedges are left-handed.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
from functools import cache

import numpy as np

from casingfem.io.arrays import FloatArray, IntArray, frozen
from casingfem.structure.imported.mesh.cell_kind import KINDS

BRICK = {
    "hexahedron": (0, 1, 2, 3, 4, 5, 6, 7), "wedge": (0, 1, 2, 2, 3, 4, 5, 5), "pyramid": (0, 1, 2, 3, 4, 4, 4, 4),
    "tetra": (0, 1, 2, 2, 3, 3, 3, 3),
}  # fmt: skip
CORNERS: Mapping[str, Mapping[str, Sequence[int]]] = {  # of a kind, written as a brick or square
    "hexahedron": BRICK,
    "quad": {"quad": (0, 1, 2, 3), "triangle": (0, 1, 2, 2)},
    "hexahedron20": dict(zip(("hexahedron20", "wedge15", "pyramid13", "tetra10"), BRICK.values(), strict=True)),
    "quad8": {"quad8": (0, 1, 2, 3), "triangle6": (0, 1, 2, 2)},
    "quad9": {"quad9": (0, 1, 2, 3), "triangle6": (0, 1, 2, 2)},
}
LEAST = {"hexahedron": 4, "quad": 3, "hexahedron20": 10, "quad8": 6, "quad9": 6}  # nodes that a collapsed cell keeps


FLAT: Mapping[str, str] = {"quad": "triangle", "quad8": "triangle6", "quad9": "triangle6"}  # what squares collapse to


@cache
def forms(kind: str) -> tuple[tuple[str, tuple[int, ...], IntArray], ...]:
    """Shapes of cells of a kind.

    The true kind, the first corner that each corner repeats, positions of the true kind's nodes.

    Linear solids stay bricks, whose shape functions are those of what they collapse to.
    """
    if kind in FLAT:
        turns = [[(k + 1) % 4, (k + 2) % 4, (k + 3) % 4] for k in range(4)]  # corner k + 1 repeats corner k
        again = [(0, 0, 2, 3), (0, 1, 1, 3), (0, 1, 2, 2), (0, 1, 2, 0)]
        slots = [turn if kind == "quad" else turn + [4 + i for i in turn] for turn in turns]
        return tuple((FLAT[kind], first, frozen(np.array(row))) for first, row in zip(again, slots, strict=True))
    if kind != "hexahedron20":
        return ()
    found = []
    for name, corners in CORNERS[kind].items():
        if name != kind:
            on = spread(kind, name)
            first = tuple(corners.index(c) for c in corners)
            found.append((name, first, frozen(np.array([on.index(k) for k in range(KINDS[name].nodes)]))))
    return tuple(found)


def spread(target: str, kind: str) -> list[int]:
    """For each node of the kind in which a cell is stored, the node of the cell's own kind."""
    corners = CORNERS[target][kind]
    if kind not in KINDS:
        return list(corners)
    number = {frozenset(nodes): k for k, nodes in enumerate(KINDS[kind].supports_of_nodes)}
    stand = [frozenset(corners[i] for i in nodes) for nodes in KINDS[target].supports_of_nodes]
    return [number.get(nodes, corners[-1]) for nodes in stand]  # a triangle has no node in its middle


def native(kind: str, cells: IntArray) -> Iterator[tuple[str, IntArray, IntArray]]:
    """Cells or facets by their true kind: kind, rows (m,), and positions of the true kind's nodes, in its order.

    >>> squares = np.array([[1, 2, 5, 4], [2, 3, 3, 5]])
    >>> [(kind, squares[rows][:, slots].tolist()) for kind, rows, slots in native("quad", squares)]
    [('triangle', [[3, 5, 2]]), ('quad', [[1, 2, 5, 4]])]
    """
    known = forms(kind)
    every = np.arange(cells.shape[1])
    if not known:
        yield kind, np.arange(len(cells)), every
        return
    corners = cells[:, : len(known[0][1])]
    first = (corners[:, :, None] == corners[:, None, :]).argmax(axis=2)
    left = np.ones(len(cells), dtype=bool)
    for name, again, slots in known:
        here = (first == np.array(again)).all(axis=1)
        left &= ~here
        if here.any():
            yield name, np.flatnonzero(here), slots
    if left.any():
        yield kind, np.flatnonzero(left), every


def common_kind(kinds: Collection[str]) -> str:
    """The kind in which cells of some kinds can all be stored; if there is only one kind, that kind.

    "" if there is none.

    >>> common_kind(["tetra"]), common_kind(["tetra", "wedge"]), common_kind(["triangle"]), common_kind(["quad8", "x"])
    ('tetra', 'hexahedron', 'quad', '')
    """
    if len(kinds) == 1 and not set(kinds) & {"wedge", "pyramid", "triangle", "wedge15", "pyramid13", "triangle6"}:
        return next(iter(kinds))
    return next((target for target, known in CORNERS.items() if set(kinds) <= set(known)), "")


def written_as(target: str, kind: str, cells: IntArray, points: FloatArray) -> IntArray:
    """Cells of a kind (m, nodes) stored as those of another.

    Wedges, which VTK numbers from above, are numbered from below.
    """
    if kind == target:
        return cells
    upright = right_handed(kind, cells, points) if kind.startswith(("wedge", "pyramid")) else cells
    return np.asarray(upright[:, spread(target, kind)])


def distinct(corners: IntArray) -> IntArray:
    """Corners of facets (..., c) in ascending order; repeated corners become -1.

    >>> distinct(np.array([[7, 3, 3, 5]])).tolist()
    [[-1, 3, 5, 7]]
    """
    ordered = np.sort(corners, axis=-1)
    again = np.zeros(ordered.shape, dtype=bool)
    again[..., 1:] = ordered[..., 1:] == ordered[..., :-1]
    return np.sort(np.where(again, -1, ordered), axis=-1)


MIRRORED = {"tetra": (0, 2, 1, 3), "wedge": (3, 4, 5, 0, 1, 2), "hexahedron": (4, 5, 6, 7, 0, 1, 2, 3),
            "pyramid": (0, 3, 2, 1, 4), "triangle": (0, 2, 1), "quad": (0, 3, 2, 1)}  # corners  # fmt: skip
UP = {"tetra": (1, 2, 3), "wedge": (1, 2, 3), "hexahedron": (1, 3, 4), "pyramid": (1, 3, 4)}  # ends of three edges


def right_handed(kind: str, cells: IntArray, points: FloatArray) -> IntArray:
    """Cells (m, nodes) in VTK's order.

    Those that are left-handed at their first corner are mirrored with their middle nodes.

    >>> corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> right_handed("tetra", np.array([[0, 2, 1, 3]]), corners).tolist()
    [[0, 1, 2, 3]]
    """
    shape = kind.rstrip("0123456789")
    if shape not in UP or not (kind in ("wedge", "pyramid") or kind in KINDS):
        return cells
    x = points[cells[:, [0, *UP[shape]]]]
    left = np.linalg.det(x[:, 1:] - x[:, :1]) < 0.0
    return np.where(left[:, None], cells[:, mirror(kind)], cells) if left.any() else cells


def mirror(kind: str) -> list[int]:
    """Node that replaces each node when the corners are those of `MIRRORED`."""
    corners = MIRRORED[kind.rstrip("0123456789")]
    if kind not in KINDS:
        return list(corners)
    stands = KINDS[kind].supports_of_nodes
    number = {frozenset(nodes): k for k, nodes in enumerate(stands)}
    return [number[frozenset(corners[i] for i in nodes)] for nodes in stands]
