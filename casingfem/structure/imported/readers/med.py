"""Read the mesh of a MED file of Salome, code_aster or Gmsh: HDF5 (needs h5py).

The corners of cells have the opposite orientation to VTK's. Damaged files crash the HDF5 library, so a child process
reads the file.
"""

from pathlib import Path
from typing import Any

import numpy as np

from casingfem.errors import ModelError
from casingfem.extras import remedy
from casingfem.io.arrays import IntArray
from casingfem.io.probe import UnreadableError, arrays_of
from casingfem.structure.imported.mesh.collapsed import right_handed
from casingfem.structure.imported.readers import med_file
from casingfem.structure.imported.readers.draft import Block, Draft
from contact.io.infiles import regular_file

KINDS = {
    "PO1": "vertex", "SE2": "line", "SE3": "line3", "TR3": "triangle", "TR6": "triangle6", "QU4": "quad",
    "QU8": "quad8", "QU9": "quad9", "TE4": "tetra", "T10": "tetra10", "HE8": "hexahedron", "H20": "hexahedron20",
    "PE6": "wedge", "P15": "wedge15", "PY5": "pyramid", "P13": "pyramid13",
}  # fmt: skip


def read_med(path: Path) -> Draft:
    """The mesh of a MED file.

    Raises
    ------
    ModelError
        If the file is malformed, or h5py is not installed.
    """
    try:
        import h5py  # noqa: F401
    except ImportError:
        raise ModelError("mesh-file", f"{path.name}: MED files need h5py: {remedy('test-data')}") from None
    try:
        stored = arrays_of(regular_file(path), med_file.__name__, "med_arrays")
    except UnreadableError as error:
        raise ModelError("mesh-file", f"{path.name}: found no readable MED file ({error})") from None
    points = stored["points"]
    blocks: list[Block] = []
    sets: dict[str, list[tuple[int, IntArray]]] = {name: [] for name in names_in(stored, "cells")}
    for kind in (key.partition(" ")[2] for key in stored if key.startswith("nodes ")):
        if kind not in KINDS:
            found = f"found {len(stored[f'nodes {kind}'])} cells of kind {kind}"
            raise ModelError("mesh-unsupported-cell", f"{path.name}: {found}")
        cells = stored[f"nodes {kind}"].astype(np.int64) - 1
        if cells.size and (cells.min() < 0 or cells.max() >= len(points)):
            found = f"found a cell of kind {kind} with a node that the file does not define"
            raise ModelError("mesh-file", f"{path.name}: {found}")
        for name, rows in members(stored, "cells", stored[f"families {kind}"]).items():
            sets[name].append((len(blocks), rows))
        blocks.append(Block(KINDS[kind], right_handed(KINDS[kind], cells, points), stored[f"numbers {kind}"]))
    if not blocks:
        raise ModelError("mesh-no-cells", f"{path.name}: found {len(points)} nodes and no cells")
    held = members(stored, "nodes", stored["families"])
    held = {name: rows for name, rows in held.items() if len(rows)}
    return Draft(
        points=points, node_numbers=stored["numbers"], blocks=blocks, node_sets=held, cell_sets=sets,
        metre=float(stored["metre"][0]),
    )  # fmt: skip


def names_in(stored: dict[str, Any], of: str) -> list[str]:
    """Names of the groups of nodes or cells, without repetition."""
    return list(dict.fromkeys(name.decode("utf-8", "replace") for name in stored[f"group {of}"].tolist()))


def members(stored: dict[str, Any], of: str, families: IntArray) -> dict[str, IntArray]:
    """Group -> rows of the nodes, or of the cells of one kind, in these families."""
    named, numbers = stored[f"group {of}"], stored[f"family {of}"]
    return {
        name: np.flatnonzero(np.isin(families, numbers[named == name.encode("utf-8")])) for name in names_in(stored, of)
    }
