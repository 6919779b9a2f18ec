"""A motion in time for ParaView: a PVD series of moved cells, the true displacement at their points."""

from collections.abc import Mapping, Sequence

import numpy as np

from casingfem.export.meshes import EXAGGERATION, pvd, vtu
from casingfem.io.arrays import Array, FloatArray, IntArray

FRAMES = 100  # pictures of a run, about
VERTEX = 1  # VTK's number of a point as a cell


def frames(count: int, most: int = FRAMES) -> IntArray:
    """At most so many of `count` instants, evenly, the first and the last among them.

    >>> frames(3).tolist(), frames(1000, 4).tolist()
    ([0, 1, 2], [0, 333, 666, 999])
    """
    return np.unique(np.linspace(0, count - 1, min(count, most)).astype(np.int64))


def factor_of(points: FloatArray, largest: float) -> float:
    """What makes the largest displacement [m] a part EXAGGERATION of the body's diagonal; 1 where nothing moves."""
    diagonal = float(np.linalg.norm(np.ptp(points, axis=0)))
    return EXAGGERATION * diagonal / largest if largest > 0.0 else 1.0


def motion_files(
    name: str, points: FloatArray, cells: Array, time: Sequence[float] | FloatArray, displacement: FloatArray
) -> dict[str, bytes]:
    """File name -> content: `name.pvd`, which plays over time, and a `name_k.vtu` for each of its instants.

    Parameters
    ----------
    points
        At rest [m], (nodes, 3).
    cells
        VTK's number of the kind of each, and its nodes, (cells, 1 + nodes of a cell).
    time, displacement
        Instants [s], (times,), and displacements there [m], (times, nodes, 3).

    The points are moved by the displacement times a factor, which the files carry as `exaggeration`; `displacement` at
    the points is the true one.

    >>> files = motion_files("rod", np.eye(3), np.array([[5, 0, 1, 2]]), [0.0, 0.5], np.zeros((2, 3, 3)))
    >>> list(files)
    ['rod_0000.vtu', 'rod_0001.vtu', 'rod.pvd']
    """
    factor = factor_of(points, float(np.linalg.norm(displacement, axis=2).max(initial=0.0)))
    kind, corners = int(cells[0, 0]), np.asarray(cells[:, 1:], dtype=np.int64)
    files = {}
    for k, moved in enumerate(displacement):
        of_whole = {"time_s": np.array([float(time[k])]), "exaggeration": np.array([factor])}
        at_points = {"displacement": moved.astype(np.float32)}
        place = (points + factor * moved).astype(np.float32)
        files[f"{name}_{k:04d}.vtu"] = vtu(place, corners, at_points, of_whole, kind)
    return files | series(name, time)


def point_files(
    name: str, time: Sequence[float] | FloatArray, places: FloatArray, data: Mapping[str, Array]
) -> dict[str, bytes]:
    """The same of single points (times, points, 3) [m] with data (times, points) at them, `displacement` zero."""
    cells = np.arange(places.shape[1])[:, None]
    files = {}
    for k, at in enumerate(places):
        here = {key: np.asarray(values[k], dtype=np.float32) for key, values in data.items()}
        here = {"displacement": np.zeros_like(at, dtype=np.float32), **here}
        files[f"{name}_{k:04d}.vtu"] = vtu(at, cells, here, {"time_s": np.array([float(time[k])])}, VERTEX)
    return files | series(name, time)


def series(name: str, time: Sequence[float] | FloatArray) -> dict[str, bytes]:
    """The collection of the files of a motion by time."""
    return {f"{name}.pvd": pvd([(float(t), f"{name}_{k:04d}.vtu") for k, t in enumerate(time)])}
