"""Mode shapes and motions as files for ParaView: VTU for shapes at rest, VTKHDF for moving surfaces.

Every spectral element of order p is drawn as p x p four-noded quadrilaterals on its own nodes, so nodal values are
those of the model. The arrays of a VTU are binary: base64 of a zlib stream, as VTK's XML formats have it.
"""

import base64
import zlib
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from casingfem.export.series import ENDING, series_file
from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.modal.mesh_modes import MeshModes
from casingfem.modal.mode_set import Modes
from casingfem.structure.imported.mesh.cell_kind import VTK
from casingfem.structure.mesh.kinematics import dot, frame
from casingfem.structure.mesh.shell_mesh import QUAD, quads

EXAGGERATION = 0.05  # largest displacement drawn, as a part of the structure's diagonal
PHASES = 16  # pictures in one period, those of its second half the first ones backwards
FRAMES = 100  # pictures of a run, about
VERTEX = 1  # VTK's number of a point as a cell

NAMES = {"f4": "Float32", "f8": "Float64", "i8": "Int64", "u1": "UInt8"}
HEAD = '<?xml version="1.0"?>\n<VTKFile type="{}" version="1.0" byte_order="LittleEndian" header_type="UInt64"{}>\n'


class Drawn(NamedTuple):
    """A structure for drawing: nodes (nodes, 3), cells of one VTK kind, lines between nodes.

    `rows` are the indices of the nodes in the modes' fields, `labels` their numbers; `normals` (nodes, 3), pointing
    outward, and `thickness` (nodes,) are those of a wall, None on imported parts.
    """

    points: FloatArray
    cells: IntArray
    kind: int
    sides: IntArray
    rows: IntArray
    labels: IntArray
    normals: FloatArray | None = None
    thickness: FloatArray | None = None


def drawn(modes: Modes | MeshModes) -> Drawn:
    """The undeformed structure of a set of modes."""
    return drawn_mesh(modes) if isinstance(modes, MeshModes) else drawn_surface(modes)


def drawn_mesh(modes: MeshModes) -> Drawn:
    """The cells of an imported part and the edges of its outside."""
    mesh = modes.structure.mesh
    used, place = mesh.used, np.zeros(len(mesh.points), dtype=np.int64)
    place[used] = np.arange(len(used))
    if mesh.cell_kind.dim == 3:
        corners = np.array(mesh.cell_kind.facets)[mesh.boundary[:, 1]]
        faces = np.take_along_axis(mesh.cells[mesh.boundary[:, 0]], corners, axis=1)
    else:
        faces = mesh.cells[:, : len(mesh.cell_kind.corners)]
    sides = np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2)
    return Drawn(mesh.points[used], place[mesh.cells], VTK[mesh.kind], place[sides], used, mesh.labels[used])


def drawn_surface(modes: Modes) -> Drawn:
    """The undeformed mid-surface of a set of modes; outward is the chart's first direction."""
    shell, grid = modes.shell, modes.grid
    geometry = shell.geometry(*grid.nodes)
    normals = frame(geometry.surface).normal
    outward = dot(normals, shell.chart.directions(*grid.nodes)[0])
    flip = float(outward.sum()) < 0.0
    cells = quads(grid)[:, ::-1] if flip else quads(grid)
    sides = np.stack([cells, np.roll(cells, -1, axis=1)], axis=-1).reshape(-1, 2)
    points, pointing = np.real(geometry.surface.x.T), np.real(-normals.T if flip else normals.T)
    rows = np.arange(len(points))
    return Drawn(points, cells, QUAD, sides, rows, rows + 1, pointing, np.real(geometry.thickness))


def mode_files(modes: Modes | MeshModes, which: Sequence[int] | None = None) -> dict[str, bytes]:
    """Files by name: for each mode k `mode_k.vtu`, and `mode_k.vtkhdf` with its animated deformed surfaces.

    The VTU is undeformed. Its points have `displacement` (3 components, mass-normalised, kg^-1/2), on a chart also
    `normal_displacement` (outward positive) and `thickness` [m]; freq_hz is field data. The series moves the points,

        x(t) = X + a cos(2 pi t) u,   a max|u| = EXAGGERATION * diagonal,   t = 0, 1/PHASES, ...

    Parameters
    ----------
    which
        Indices into the modes, by default all.

    Raises
    ------
    ValueError
        A mode does not exist.
    MissingExtraError
        h5py is not installed.
    """
    chosen, surface = chosen_modes(modes, which), drawn(modes)
    files: dict[str, bytes] = {}
    for mode in chosen:
        files |= one_mode(modes, mode, surface)
    return files


def chosen_modes(modes: Modes | MeshModes, which: Sequence[int] | None) -> Sequence[int]:
    """Indices into the modes, by default all; ValueError for a mode that does not exist."""
    chosen = range(len(modes)) if which is None else which
    for mode in chosen:
        if not 0 <= mode < len(modes):
            raise ValueError(f"modes: found mode {mode + 1}, expected 1 to {len(modes)}")
    return chosen


def one_mode(modes: Modes | MeshModes, mode: int, surface: Drawn) -> dict[str, bytes]:
    """The VTU of one mode, and the file with its animation."""
    shape = modes.fields[surface.rows, :3, mode]
    facts = {"freq_hz": modes.freq[[mode]], "nodal_diameters": modes.nodal_diameters[[mode]].astype(np.int64)}
    name = f"mode_{mode + 1:03d}"
    diagonal = float(np.linalg.norm(np.ptp(surface.points, axis=0)))
    largest = EXAGGERATION * diagonal / float(np.linalg.norm(shape, axis=1).max())
    parts = [np.cos(2.0 * np.pi * k / PHASES) for k in range(PHASES // 2 + 1)]
    each = [point_data(surface, part * shape) for part in parts]
    played = series_file(
        np.arange(PHASES) / PHASES,
        np.array([surface.points + largest * part * shape for part in parts]),
        surface.cells,
        surface.kind,
        {key: np.array([data[key] for data in each]) for key in each[0]},
        {key: float(values[0]) for key, values in facts.items()},
        order=[min(k, PHASES - k) for k in range(PHASES)],
    )
    at_rest = vtu(surface.points, surface.cells, point_data(surface, shape), facts, surface.kind)
    return {f"{name}.vtu": at_rest, f"{name}{ENDING}": played}


def point_data(surface: Drawn, shape: FloatArray) -> dict[str, Array]:
    """Fields of a file at its points."""
    data: dict[str, Array] = {"displacement": shape}
    if surface.normals is not None and surface.thickness is not None:
        data |= {"normal_displacement": np.einsum("ni,ni->n", surface.normals, shape), "thickness": surface.thickness}
    return data


def vtu(
    points: Array, cells: IntArray, at_points: Mapping[str, Array], of_whole: Mapping[str, Array], kind: int = QUAD
) -> bytes:
    """An unstructured grid of cells of one kind, with data at its points and data of the whole.

    >>> square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    >>> vtu(square, np.array([[0, 1, 2, 3]]), {"thickness": np.ones(4)}, {})[:21]
    b'<?xml version="1.0"?>'
    """
    count, width = cells.shape
    scalars = ' Scalars="normal_displacement"' if "normal_displacement" in at_points else ""
    parts = [
        HEAD.format("UnstructuredGrid", ' compressor="vtkZLibDataCompressor"') + "<UnstructuredGrid>\n<FieldData>\n",
        *(array(name, values, f' NumberOfTuples="{len(values)}"') for name, values in of_whole.items()),
        f'</FieldData>\n<Piece NumberOfPoints="{len(points)}" NumberOfCells="{count}">\n<Points>\n',
        array("Points", points),
        "</Points>\n<Cells>\n",
        array("connectivity", cells.ravel()),
        array("offsets", width * np.arange(1, count + 1)),
        array("types", np.full(count, kind, dtype=np.uint8)),
        f'</Cells>\n<PointData Vectors="displacement"{scalars}>\n',
        *(array(name, values) for name, values in at_points.items()),
        "</PointData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n",
    ]
    return "".join(parts).encode("ascii")


def array(name: str, values: Array, more: str = "") -> str:
    """One DataArray element: (n,) or (n, components), compressed."""
    little = np.ascontiguousarray(values, dtype=values.dtype.newbyteorder("<"))
    raw = little.tobytes()
    packed = zlib.compress(raw, 6)
    sizes = np.array([1, len(raw), len(raw), len(packed)], dtype="<u8")  # blocks, block, last block, compressed
    text = (base64.b64encode(sizes.tobytes()) + base64.b64encode(packed)).decode("ascii")
    components = f' NumberOfComponents="{values.shape[1]}"' if values.ndim > 1 else ""
    kind = NAMES[little.dtype.str[1:]]
    return f'<DataArray type="{kind}" Name="{name}"{components}{more} format="binary">{text}</DataArray>\n'


def frames(count: int, most: int = FRAMES) -> IntArray:
    """Indices of a limited number of `count` times, evenly spaced, including the first and the last.

    >>> frames(3).tolist(), frames(1000, 4).tolist()
    ([0, 1, 2], [0, 333, 666, 999])
    """
    return np.unique(np.linspace(0, count - 1, min(count, most)).astype(np.int64))


def motion_files(
    name: str, points: FloatArray, cells: Array, time: Sequence[float] | FloatArray, displacement: FloatArray
) -> dict[str, bytes]:
    """File name -> content: `name.vtkhdf`, an animation over time.

    Parameters
    ----------
    points
        At rest [m], (nodes, 3).
    cells
        VTK cell type and nodes of each, (cells, 1 + nodes of a cell).
    time, displacement
        Times [s], (times,), and displacements at them [m], (times, nodes, 3).

    The points move by the displacement times a factor, stored as `exaggeration`, for which the largest is EXAGGERATION
    of the body's diagonal. `displacement` at the points is not exaggerated.

    >>> list(motion_files("rod", np.eye(3), np.array([[5, 0, 1, 2]]), [0.0, 0.5], np.zeros((2, 3, 3))))
    ['rod.vtkhdf']
    """
    diagonal = float(np.linalg.norm(np.ptp(points, axis=0)))
    largest = float(np.linalg.norm(displacement, axis=2).max(initial=0.0))
    factor = EXAGGERATION * diagonal / largest if largest > 0.0 else 1.0
    kind, corners = int(cells[0, 0]), np.asarray(cells[:, 1:], dtype=np.int64)
    moved = points + factor * displacement
    data = series_file(time, moved, corners, kind, {"displacement": displacement}, {"exaggeration": factor})
    return {f"{name}{ENDING}": data}


def point_files(
    name: str, time: Sequence[float] | FloatArray, places: FloatArray, data: Mapping[str, Array]
) -> dict[str, bytes]:
    """Files like those of `motion_files` for single points (times, points, 3) [m] with data (times, points)."""
    cells = np.arange(places.shape[1])[:, None]
    return {f"{name}{ENDING}": series_file(time, places, cells, VERTEX, data)}
