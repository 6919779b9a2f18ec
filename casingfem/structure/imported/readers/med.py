"""Read the mesh of a MED file of Salome, code_aster or Gmsh: HDF5 (needs h5py).

    ENS_MAA/MESH[/STEP]/NOE/COO, NUM, FAM         coordinates, one after another; numbers; families of the nodes
    ENS_MAA/MESH[/STEP]/MAI/KIND/NOD, NUM, FAM    nodes of cells, first all first nodes; numbers; families
    FAS/MESH/NOEUD or ELEME/FAMILY (NUM)/GRO/NOM  names of the groups that a family belongs to

The corners of cells have the opposite orientation to VTK's. Damaged files crash the HDF5 library, so a child process
reads the file. (MED file format, Salome's developer documentation.)
"""

from pathlib import Path
from typing import Any

import numpy as np

from casingfem.errors import ModelError
from casingfem.extras import remedy
from casingfem.io.arrays import FloatArray, IntArray
from casingfem.io.probe import UnreadableError, arrays_of
from casingfem.structure.imported.mesh.collapsed import right_handed
from casingfem.structure.imported.readers.draft import Block, Draft
from contact.io.infiles import regular_file

KINDS = {
    "PO1": "vertex", "SE2": "line", "SE3": "line3", "TR3": "triangle", "TR6": "triangle6", "QU4": "quad",
    "QU8": "quad8", "QU9": "quad9", "TE4": "tetra", "T10": "tetra10", "HE8": "hexahedron", "H20": "hexahedron20",
    "PE6": "wedge", "P15": "wedge15", "PY5": "pyramid", "P13": "pyramid13",
}  # fmt: skip
METRES = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "in": 0.0254}
WIDTH = 80  # bytes of a name


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
        stored = arrays_of(regular_file(path), __name__, "med_arrays")
    except UnreadableError as error:
        raise ModelError("mesh-file", f"{path.name}: no readable MED file ({error})") from None
    points = stored["points"]
    blocks: list[Block] = []
    sets: dict[str, list[tuple[int, IntArray]]] = {name: [] for name in names_in(stored, "cells")}
    for kind in (key.partition(" ")[2] for key in stored if key.startswith("nodes ")):
        if kind not in KINDS:
            found = f"found {len(stored[f'nodes {kind}'])} cells of kind {kind}"
            raise ModelError("mesh-unsupported-cell", f"{path.name}: {found}")
        cells = stored[f"nodes {kind}"].astype(np.int64) - 1
        if cells.size and (cells.min() < 0 or cells.max() >= len(points)):
            raise ModelError("mesh-file", f"{path.name}: a cell of kind {kind} names a node that is not given")
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


def med_arrays(path: Path) -> dict[str, Any]:
    """Points, cells and families of the file's mesh by name, in arrays without objects."""
    import h5py

    with h5py.File(path, "r") as file:
        if "ENS_MAA" not in file or len(file["ENS_MAA"]) != 1:
            count = len(file["ENS_MAA"]) if "ENS_MAA" in file else 0
            raise ValueError(f"found {count} meshes, expected one")
        ((name, mesh),) = file["ENS_MAA"].items()
        steps = [mesh] if "NOE" in mesh else list(mesh.values())
        if len(steps) != 1 or "NOE" not in steps[0] or "MAI" not in steps[0]:
            raise ValueError(f"found {len(steps)} steps of mesh {name!r}, expected one with NOE and MAI")
        step = steps[0]
        found = families(file["FAS"][name] if "FAS" in file and name in file["FAS"] else {})
        points = columns(step["NOE"]["COO"], int(mesh.attrs["ESP"]))
        found["points"] = np.pad(points, ((0, 0), (0, 3 - points.shape[1])))
        found |= {key: value for key, value in labels(step["NOE"], len(points)).items()}
        for kind, part in step["MAI"].items():
            count = int(part["NOD"].attrs["NBR"])
            found[f"nodes {kind}"] = columns(part["NOD"], part["NOD"].shape[0] // max(count, 1))
            found |= {f"{key} {kind}": value for key, value in labels(part, count).items()}
        unit = bytes(mesh.attrs.get("UNI", b"")).decode("latin-1")[:16].strip(" \0").lower()
        found["metre"] = np.array([METRES.get(unit, 1.0)])
    return found


def columns(data: Any, count: int) -> FloatArray:
    """Values that are stored component after component, as rows of `count` components."""
    return np.ascontiguousarray(data[()].reshape(count, -1).T)


def labels(part: Any, count: int) -> dict[str, IntArray]:
    """Numbers and families of nodes or cells; the defaults are 1, 2, ... and 0."""
    return {
        "numbers": part["NUM"][()] if "NUM" in part else np.arange(1, count + 1),
        "families": part["FAM"][()] if "FAM" in part else np.zeros(count, dtype=np.int64),
    }


def families(of_mesh: Any) -> dict[str, Any]:
    """Families of nodes and of cells.

    The number of each family, repeated for each of its groups, and the names of these groups.
    """
    found: dict[str, Any] = {}
    for what, key in (("nodes", "NOEUD"), ("cells", "ELEME")):
        numbers, names = [], []
        for family in of_mesh[key].values() if key in of_mesh else ():
            for text in family["GRO"]["NOM"][()] if "GRO" in family else ():
                numbers.append(int(family.attrs["NUM"]))
                names.append(np.asarray(text).astype(np.uint8).tobytes().partition(b"\0")[0].strip())
        found[f"family {what}"] = np.array(numbers, dtype=np.int64)
        found[f"group {what}"] = np.array(names, dtype=f"S{WIDTH}")
    return found
