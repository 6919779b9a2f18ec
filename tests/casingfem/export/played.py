"""Steps of a VTKHDF file of a motion, read as its format says: offsets of each step into arrays of all pictures."""

from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace

import h5py
import numpy as np


def steps_of(path: Path) -> list[SimpleNamespace]:
    """Time, points, cells and data at the points of each step; field data of the whole."""
    with h5py.File(path, "r") as file:
        root = file["VTKHDF"]
        assert root.attrs["Type"] == b"UnstructuredGrid"
        assert root.attrs["Version"].tolist() == [2, 0]
        played, size = root["Steps"], int(root["NumberOfPoints"][0])
        offsets = np.asarray(root["Offsets"])
        connectivity = np.asarray(root["Connectivity"])
        assert root["NumberOfCells"][0] == len(offsets) - 1 == len(root["Types"])
        assert root["NumberOfConnectivityIds"][0] == len(connectivity) == offsets[-1]
        assert not np.any(played["PartOffsets"])
        assert not np.any(played["CellOffsets"])
        assert not np.any(played["ConnectivityIdOffsets"])
        field = {name: values[0] for name, values in root.get("FieldData", {}).items()}
        return [
            SimpleNamespace(
                time=float(played["Values"][k]),
                points=np.asarray(root["Points"][played["PointOffsets"][k] :][:size]),
                cells=[connectivity[a:b].tolist() for a, b in pairwise(offsets)],
                kinds=np.asarray(root["Types"]),
                point_data={
                    name: np.asarray(values[played["PointDataOffsets"][name][k] :][:size])
                    for name, values in root["PointData"].items()
                },
                field_data=field,
            )
            for k in range(int(played.attrs["NSteps"]))
        ]
