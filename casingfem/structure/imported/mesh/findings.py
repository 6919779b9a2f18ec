"""Text of a fault of a mesh: its code, and the first few of its cells or nodes by number."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.structure.imported.mesh.mesh_data import MeshData

SHOWN = 5  # cells or nodes named in a message


class Finding(NamedTuple):
    """A fault of a mesh: its code in the catalogue, and its cells or nodes."""

    code: str
    message: str


def cells_named(mesh: MeshData, bad: IntArray) -> str:
    """Count and first numbers of cells."""
    return named("cell", mesh.cell_numbers[bad])


def nodes_named(mesh: MeshData, bad: IntArray) -> str:
    """Count and first numbers of nodes."""
    return named("node", mesh.node_numbers[bad])


def named(what: str, numbers: IntArray) -> str:
    """Count and first numbers, such as `3 cells (7, 8, 9)`."""
    first = ", ".join(str(n) for n in numbers[:SHOWN])
    return f"{len(numbers)} {what}{'s' * (len(numbers) > 1)} ({first}{', ...' * (len(numbers) > SHOWN)})"


def where(code: str, bad: Array | np.bool_, message: Callable[[IntArray], str]) -> list[Finding]:
    """A finding if any entry of the mask is true."""
    place = np.flatnonzero(bad)
    return [Finding(code, message(place))] if len(place) else []


def edge_lengths(mesh: MeshData) -> FloatArray:
    """Lengths of the straight edges of every cell, (cells, edges); a collapsed edge counts as the longest one."""
    lengths = np.linalg.norm(edge_vectors(mesh), axis=2)
    gone = (lengths == 0.0) & mesh.collapsed[:, None]
    return np.asarray(np.where(gone, lengths.max(axis=1, keepdims=True), lengths))


def edge_vectors(mesh: MeshData) -> FloatArray:
    """Straight edges of every cell, (cells, edges, 3)."""
    ends = mesh.points[mesh.cells[:, np.array(mesh.cell_kind.edges)]]
    return np.asarray(ends[:, :, 1] - ends[:, :, 0])
