"""Write one mesh in five formats, each from its own published description: Gmsh 2.2 and 4.1, VTU, INP, BDF.

They are written here without the library that reads them, so that reading is checked against the formats and not
against its own mistakes. Groups of facets are written as the format has them: physical surfaces, sets, constraints.
"""

import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np

from casingfem.io.arrays import FloatArray, IntArray
from casingfem.structure.imported.mesh.cell_kind import KINDS
from casingfem.structure.imported.mesh.mesh_data import MeshData, natives

GMSH = {"triangle": 2, "quad": 3, "tetra": 4, "hexahedron": 5, "triangle6": 9, "quad9": 10, "tetra10": 11,
        "hexahedron27": 12, "quad8": 16, "hexahedron20": 17, "line": 1, "line3": 8}  # fmt: skip
# Gmsh's order as VTK node numbers: edges by their lowest corner, facets z- y- x- x+ y+ z+
GMSH_ORDER = {
    "tetra10": (0, 1, 2, 3, 4, 5, 6, 7, 9, 8),
    "hexahedron20": (*range(8), 8, 11, 16, 9, 17, 10, 18, 19, 12, 15, 13, 14),
    "hexahedron27": (*range(8), 8, 11, 16, 9, 17, 10, 18, 19, 12, 15, 13, 14, 24, 22, 20, 21, 23, 25, 26),
}
VTK = {"tetra": 10, "hexahedron": 12, "tetra10": 24, "hexahedron20": 25, "hexahedron27": 29, "quad": 9, "quad8": 23,
       "quad9": 28}  # fmt: skip
ABAQUS = {"tetra": "C3D4", "tetra10": "C3D10", "hexahedron": "C3D8", "hexahedron20": "C3D20", "wedge15": "C3D15",
          "quad": "S4", "quad8": "S8R", "quad9": "S9R5"}  # fmt: skip
NASTRAN = {"tetra": "CTETRA", "tetra10": "CTETRA", "hexahedron": "CHEXA", "hexahedron20": "CHEXA", "quad": "CQUAD4",
           "quad8": "CQUAD8"}  # fmt: skip
BRICK20 = (*range(12), 16, 17, 18, 19, 12, 13, 14, 15)  # Nastran: upright edges before the upper ones


def gmsh_cells(mesh: MeshData) -> list[tuple[str, int, int, IntArray]]:
    """Kind, dimension, physical number and cells in Gmsh's order: groups of facets, then the body."""
    dim, order = mesh.cell_kind.dim, GMSH_ORDER.get(mesh.kind, tuple(range(mesh.cell_kind.nodes)))
    rows = [
        (mesh.cell_kind.facet, dim - 1, tag, mesh.facet_nodes(mesh.group_facets(name)))
        for tag, name in enumerate(mesh.groups, 1)
    ]
    return [*rows, (mesh.kind, dim, len(rows) + 1, mesh.cells[:, list(order)])]


def gmsh_names(mesh: MeshData) -> str:
    """The block of physical names; the body is called `body`."""
    dim = mesh.cell_kind.dim
    names = [f'{dim - 1} {tag} "{name}"' for tag, name in enumerate(mesh.groups, 1)]
    names.append(f'{dim} {len(names) + 1} "body"')
    return "\n".join(["$PhysicalNames", str(len(names)), *names, "$EndPhysicalNames"]) + "\n"


def write_gmsh22(mesh: MeshData, path: Path) -> None:
    """Gmsh 2.2, text."""
    lines = ["$MeshFormat\n2.2 0 8\n$EndMeshFormat", gmsh_names(mesh).rstrip(), "$Nodes", str(len(mesh.points))]
    lines += [f"{k} {x!r} {y!r} {z!r}" for k, (x, y, z) in enumerate(mesh.points.tolist(), 1)]
    cells = [
        f"{GMSH[kind]} 2 {tag} {tag} {' '.join(map(str, row))}"
        for kind, _, tag, block in gmsh_cells(mesh)
        for row in (block + 1).tolist()
    ]
    lines += ["$EndNodes", "$Elements", str(len(cells)), *(f"{k} {text}" for k, text in enumerate(cells, 1))]
    path.write_text("\n".join([*lines, "$EndElements"]) + "\n")


def write_gmsh41(mesh: MeshData, path: Path) -> None:
    """Gmsh 4.1, binary: one entity for each group, nodes on the body's."""
    blocks = gmsh_cells(mesh)
    dim = mesh.cell_kind.dim
    counts = [0, 0, 0, 0]
    for _, of_dim, _, _ in blocks:
        counts[of_dim] += 1
    out = [b"$MeshFormat\n4.1 1 8\n", struct.pack("<i", 1), b"\n$EndMeshFormat\n", gmsh_names(mesh).encode()]
    out += [b"$Entities\n", struct.pack("<4Q", *counts)]
    for _, _, tag, _ in sorted(blocks, key=lambda block: block[1]):
        out.append(struct.pack("<i6dQiQ", tag, *[0.0] * 6, 1, tag, 0))
    total = len(mesh.points)
    out += [b"\n$EndEntities\n$Nodes\n", struct.pack("<4Q3iQ", 1, total, 1, total, dim, blocks[-1][2], 0, total)]
    out += [np.arange(1, total + 1, dtype="<u8").tobytes(), mesh.points.astype("<f8").tobytes(), b"\n$EndNodes\n"]
    number = sum(len(block[3]) for block in blocks)
    out += [b"$Elements\n", struct.pack("<4Q", len(blocks), number, 1, number)]
    first = 1
    for kind, of_dim, tag, cells in blocks:
        out.append(struct.pack("<3iQ", of_dim, tag, GMSH[kind], len(cells)))
        ids = np.arange(first, first + len(cells))
        out.append(np.column_stack([ids, cells + 1]).astype("<u8").tobytes())
        first += len(cells)
    path.write_bytes(b"".join([*out, b"\n$EndElements\n"]))


def write_inp(mesh: MeshData, path: Path) -> None:
    """Abaqus and CalculiX: node sets of the groups, sixteen numbers a line at most; bricks that collapse as wedges."""
    lines = ["*HEADING", "*NODE"]
    lines += [f"{k}, {x!r}, {y!r}, {z!r}" for k, (x, y, z) in enumerate(mesh.points.tolist(), 1)]
    for kind, rows, slots in natives(mesh):
        lines.append(f"*ELEMENT, TYPE={ABAQUS[kind]}, ELSET=body")
        numbered = np.column_stack([rows, mesh.cells[rows][:, slots]]) + 1
        lines += wrapped(numbered.tolist())
    for name, group in mesh.groups.items():
        lines += [f"*NSET, NSET={name}", *wrapped([(group.nodes + 1).tolist()], continued=False)]
    path.write_text("\n".join(lines) + "\n")


def wrapped(rows: list[list[int]], *, continued: bool = True) -> list[str]:
    """Rows of numbers over lines of sixteen; a comma at the end says that an element goes on."""
    lines = []
    for row in rows:
        parts = [", ".join(map(str, row[k : k + 16])) for k in range(0, len(row), 16)]
        lines += [part + "," * continued for part in parts[:-1]] + parts[-1:]
    return lines


def write_bdf(mesh: MeshData, path: Path) -> None:
    """Nastran: grids in large fields, elements in small ones, each group a set of SPC1 in the order of the groups."""
    lines = ["SOL 103", "BEGIN BULK"]
    for k, point in enumerate(mesh.points, 1):
        x, y, z = (large(value) for value in point)
        lines += [f"GRID*   {k:<16d}{'':16s}{x}{y}*", f"*       {z}"]
    cells = mesh.cells[:, list(BRICK20)] if mesh.kind == "hexahedron20" else mesh.cells
    for k, row in enumerate((cells + 1).tolist(), 1):
        fields = [k, 1, *row]
        lines.append(f"{NASTRAN[mesh.kind]:<8s}" + "".join(f"{n:<8d}" for n in fields[:8]))
        lines += ["+       " + "".join(f"{n:<8d}" for n in fields[j : j + 8]) for j in range(8, len(fields), 8)]
    for tag, group in enumerate(mesh.groups.values(), 1):
        for j in range(0, len(group.nodes), 6):
            lines.append(",".join(["SPC1", str(tag), "123456", *map(str, (group.nodes[j : j + 6] + 1).tolist())]))
    path.write_text("\n".join([*lines, "ENDDATA"]) + "\n")


def large(value: float) -> str:
    """A real number in sixteen characters, with as many digits as they hold."""
    texts = [f"{value:.{digits}f}" for digits in range(15, 0, -1)] + [
        f"{value:.{digits}e}" for digits in range(10, 0, -1)
    ]
    fitting = [text for text in texts if len(text) <= 16]
    return f"{min(fitting, key=lambda text: abs(float(text) - value)):>16s}"


def write_vtu(mesh: MeshData, path: Path) -> None:
    """VTK's unstructured grid, text; each group a flag on the points."""
    flat = "\n".join(" ".join(map(repr, row)) for row in mesh.points.tolist())
    ends = np.arange(1, len(mesh.cells) + 1) * mesh.cells.shape[1]

    def array(kind: str, name: str, text: str, more: str = "") -> str:
        return f'<DataArray type="{kind}" Name="{name}"{more} format="ascii">\n{text}\n</DataArray>\n'

    def numbers(values: IntArray | FloatArray) -> str:
        return " ".join(map(str, values.ravel().tolist()))

    flags = ""
    for name, group in mesh.groups.items():
        flags += array("Int32", name, numbers(np.isin(np.arange(len(mesh.points)), group.nodes).astype(int)))
    path.write_text(
        '<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian">\n'
        f'<UnstructuredGrid>\n<Piece NumberOfPoints="{len(mesh.points)}" NumberOfCells="{len(mesh.cells)}">\n'
        f"<PointData>\n{flags}</PointData>\n"
        f"<Points>\n{array('Float64', 'Points', flat, ' NumberOfComponents=' + chr(34) + '3' + chr(34))}</Points>\n"
        f"<Cells>\n{array('Int64', 'connectivity', numbers(mesh.cells))}{array('Int64', 'offsets', numbers(ends))}"
        f"{array('UInt8', 'types', numbers(np.full(len(mesh.cells), VTK[mesh.kind])))}</Cells>\n"
        "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n"
    )


WRITERS: dict[str, tuple[str, Callable[[MeshData, Path], None]]] = {
    "Gmsh 2.2, text": ("gmsh22.msh", write_gmsh22),
    "Gmsh 4.1, binary": ("gmsh41.msh", write_gmsh41),
    "Abaqus/CalculiX": ("part.inp", write_inp),
    "Nastran, large fields": ("part.bdf", write_bdf),
    "VTU": ("part.vtu", write_vtu),
}


def writable(kind: str, name: str) -> bool:
    """Whether a format has a kind of cell."""
    tables = {"Abaqus/CalculiX": ABAQUS, "Nastran, large fields": NASTRAN}
    return kind in tables.get(name, KINDS)


def group_name(name: str, group: str, groups: list[str]) -> str:
    """Name of a group after reading: bulk data files have numbers only."""
    return f"SPC {groups.index(group) + 1}" if name.startswith("Nastran") else group
