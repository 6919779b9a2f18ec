"""The arrays of a MED file of Salome, code_aster or Gmsh: HDF5 (needs h5py).

    ENS_MAA/MESH[/STEP]/NOE/COO, NUM, FAM         coordinates, one after another; numbers; families of the nodes
    ENS_MAA/MESH[/STEP]/MAI/KIND/NOD, NUM, FAM    nodes of cells, first all first nodes; numbers; families
    FAS/MESH/NOEUD or ELEME/FAMILY (NUM)/GRO/NOM  names of the groups that a family belongs to

A child process reads them: no finite elements are imported here. (MED file format, Salome's developer documentation.)
"""

from pathlib import Path
from typing import Any

import numpy as np

from casingfem.io.arrays import FloatArray, IntArray

METRES = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "in": 0.0254}
WIDTH = 80  # bytes of a name


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
            raise ValueError(
                f"found {len(steps)} steps of mesh {name!r}, expected one, with nodes (NOE) and cells (MAI)"
            )
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
