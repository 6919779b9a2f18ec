"""Solid cells whose nodes are numbered the other way round, as Nastran allows and VTK does with wedges."""

import numpy as np

from casingfem.io.arrays import FloatArray, IntArray
from casingfem.structure.imported.mesh.cell_kind import KINDS

MIRRORED = {"tetra": (0, 2, 1, 3), "wedge": (3, 4, 5, 0, 1, 2), "hexahedron": (4, 5, 6, 7, 0, 1, 2, 3),
            "pyramid": (0, 3, 2, 1, 4), "triangle": (0, 2, 1), "quad": (0, 3, 2, 1)}  # corners  # fmt: skip
UP = {"tetra": (1, 2, 3), "wedge": (1, 2, 3), "hexahedron": (1, 3, 4), "pyramid": (1, 3, 4)}  # ends of three edges


def right_handed(kind: str, cells: IntArray, points: FloatArray) -> IntArray:
    """Cells (m, nodes) in VTK's order, those that are left-handed at their first corner mirrored, middle nodes too.

    >>> corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> right_handed("tetra", np.array([[0, 2, 1, 3]]), corners).tolist()
    [[0, 1, 2, 3]]
    """
    shape = kind.rstrip("0123456789")
    if shape not in UP or not (kind in ("wedge", "pyramid") or kind in KINDS):
        return cells
    x = points[cells[:, [0, *UP[shape]]]]
    edges = x[:, 1:] - x[:, :1]
    left = np.linalg.det(edges) < 0.0
    return np.where(left[:, None], cells[:, mirror(kind)], cells) if left.any() else cells


def mirror(kind: str) -> list[int]:
    """Which node takes the place of each when the corners are those of `MIRRORED`."""
    corners = MIRRORED[kind.rstrip("0123456789")]
    if kind not in KINDS:
        return list(corners)
    stands = KINDS[kind].supports_of_nodes
    number = {frozenset(nodes): k for k, nodes in enumerate(stands)}
    return [number[frozenset(corners[i] for i in nodes)] for nodes in stands]
