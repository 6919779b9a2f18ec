"""Read a mesh from a file: Gmsh (msh 2.2, 4.1), VTU, Abaqus (inp), Nastran (bdf, nas, dat), Ansys (cdb), unv, MED.

Physical groups, sets and constraints become groups by name, for supports and materials. Gmsh and VTU files are read
with meshio, which skips or truncates some content without an error. The counts are therefore compared with the file,
and a difference is refused. meshio is loaded only when such a file is read.
"""

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.probe import fault_of
from casingfem.structure.imported.mesh.mesh_data import MeshData
from casingfem.structure.imported.readers.bdf import read_bdf
from casingfem.structure.imported.readers.cdb import read_cdb
from casingfem.structure.imported.readers.draft import Block, Draft, build, joined
from casingfem.structure.imported.readers.inp import read_inp
from casingfem.structure.imported.readers.med import read_med
from casingfem.structure.imported.readers.unv import read_unv
from contact.io.infiles import read_bytes, regular_file
from contact.io.units import units_of

LONGEST = 10_000  # characters of a line of names
WORDS = ("point", "curve", "surface", "volume")


def read_mesh(path: str | Path, *, scale: float = 1.0, join: float = 0.0, units: str | None = None) -> MeshData:
    r"""Read a mesh; the ending of its name states the format.

    Parameters
    ----------
    path
        A .msh (Gmsh 2.2 or 4.1, text or binary), .vtu, .inp, .bdf, .nas, .dat, .cdb, .unv or .med file.
    scale
        Factor of the coordinates to metres: 1e-3 for millimetres.
    join
        Nodes of cells closer than this [m] are merged; 0 merges none.
    units
        Length, mass and time of the file, such as "mm-t-s", instead of `scale`. A file with masses or springs needs
        units if its lengths are not metres.

    Raises
    ------
    ModelError
        For a file that is malformed, truncated, or has unsupported cells.
    OSError
        If there is no such file.

    Examples
    --------
    >>> import tempfile
    >>> import casingfem as cf
    >>> text = "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n*ELEMENT, TYPE=S4, ELSET=WALL\n1, 1, 2, 3, 4\n"
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder, "plate.inp")
    ...     _ = file.write_text(text, encoding="utf-8")
    ...     mesh = cf.read_mesh(file, scale=1e-3)
    >>> mesh.kind, float(mesh.points.max()), sorted(mesh.groups)
    ('quad', 0.001, ['WALL'])
    """
    file = Path(path)
    if not (np.isfinite(scale) and scale > 0.0):
        raise ModelError("mesh-scale", f"{file.name}: scale must be above 0, found {scale!r}")
    if not (np.isfinite(join) and join >= 0.0):
        raise ModelError("mesh-scale", f"{file.name}: join must be 0 or a distance, found {join!r}")
    readers = {".msh": read_gmsh, ".vtu": read_vtu, ".inp": read_inp, ".bdf": read_bdf, ".nas": read_bdf,
               ".dat": read_bdf, ".cdb": read_cdb, ".unv": read_unv, ".med": read_med}  # fmt: skip
    reader = readers.get(file.suffix.lower())
    if reader is None:
        raise ModelError("mesh-format", f"{file.name}: found the ending {file.suffix!r}")
    length, mass, time = sizes_of(file.name, scale, units)
    draft = reader(file)
    if draft.metre != 1.0:
        if scale != 1.0 or units is not None:
            found = f"{file.name}: found scale or units, although the file states its unit of length, {draft.metre:g} m"
            raise ModelError("mesh-scale", f"{found}; expected neither of them")
        length = draft.metre
    mesh = build(draft, file.name)
    if mesh.attachments.weighed and units is None and scale != 1.0:
        found = f"{file.name}: found {mesh.attachments} and scale = {scale:g}"
        raise ModelError("mesh-scale", f"{found}, which does not scale masses and springs; expected units")
    mesh = replace(mesh, points=length * mesh.points, attachments=mesh.attachments.in_si(length, mass, time))
    return joined(mesh, join) if join > 0.0 else mesh


def sizes_of(name: str, scale: float, units: str | None) -> tuple[float, float, float]:
    """Length, mass and time of a file in SI."""
    if units is None:
        return scale, 1.0, 1.0
    if scale != 1.0:
        raise ModelError("mesh-scale", f"{name}: found scale = {scale:g} beside units {units!r}, expected one of them")
    try:
        return units_of(units)
    except ValueError as error:
        raise ModelError("mesh-scale", f"{name}: {error}") from None


def from_meshio(file: Path, module: str) -> Any:
    """Call one of meshio's readers."""
    import meshio

    try:
        return getattr(meshio, module).read(file)
    except OSError:
        raise
    except Exception as error:  # any error of the reader means a malformed file
        what = str(error) or type(error).__name__
        raise ModelError("mesh-file", f"{file.name}: cannot be read ({what})") from None


def blocks_of(mesh: Any, file: Path) -> list[Block]:
    """Cells as blocks, numbered from 1 in the order of the file."""
    blocks, start = [], 1
    for block in mesh.cells:
        if block.type.startswith("polyhedron"):  # lists of faces, of which sizes may differ: no array
            raise ModelError("mesh-unsupported-cell", f"{file.name}: found {block.type}")
        cells = np.asarray(block.data, dtype=np.int64)
        if cells.size and (cells.min() < 0 or cells.max() >= len(mesh.points)):
            bad = start + int(np.flatnonzero((cells < 0).any(axis=1) | (cells >= len(mesh.points)).any(axis=1))[0])
            raise ModelError(
                "mesh-file", f"{file.name}: found a cell, {bad}, with a node that the file does not define"
            )
        blocks.append(Block(block.type, cells, np.arange(start, start + len(cells))))
        start += len(cells)
    return blocks


def read_gmsh(file: Path) -> Draft:
    """Gmsh's msh format; groups are the physical names, or `surface 7` where a number has no name."""
    content = read_bytes(regular_file(file))
    for section in (b"Nodes", b"Elements"):
        if b"$" + section not in content or b"$End" + section not in content:
            found = f"found no complete section ${section.decode()}: cut short?"
            raise ModelError("mesh-file", f"{file.name}: {found}")
    require_modest(content, file)
    mesh = from_meshio(file, "gmsh")
    blocks = blocks_of(mesh, file)
    names = {(int(dim), int(tag)): name for name, (tag, dim) in mesh.field_data.items()}
    sets: dict[str, list[tuple[int, Any]]] = {name: [] for name in names.values()}
    physical = mesh.cell_data.get("gmsh:physical", [])
    for k, (block, tags) in enumerate(zip(blocks, physical, strict=False)):
        for tag in np.unique(np.abs(tags)):
            name = names.get((block.dim, int(tag)), f"{WORDS[block.dim]} {tag}")
            if tag and name not in mesh.cell_sets:
                sets.setdefault(name, []).append((k, np.flatnonzero(np.abs(tags) == tag)))
    for name, parts in mesh.cell_sets.items():  # format 4.1: an entity may be in several groups
        if name in sets:
            sets[name] += [(k, rows) for k, rows in enumerate(parts) if rows is not None and len(rows)]
    points, numbers = np.asarray(mesh.points, dtype=float), np.arange(1, len(mesh.points) + 1)
    blocks, sets = without_copies(blocks, sets)
    return Draft(points=points, node_numbers=numbers, blocks=blocks, cell_sets=sets)


def require_modest(content: bytes, file: Path) -> None:
    """Refuse a file for which meshio would fill the memory; meshio allocates for the largest node number."""
    title = content.partition(b"$PhysicalNames")[2].partition(b"$EndPhysicalNames")[0]
    if len(max(title.split(b"\n"), key=len)) > LONGEST:
        found = f"found a line that is too long, expected at most {LONGEST} characters"
        raise ModelError("mesh-file", f"{file.name}: $PhysicalNames: {found}")
    if re.search(rb"\$MeshFormat\s+\S+\s+1\b", content[:1000]):  # binary
        if fault := fault_of(file, "meshio.gmsh", "read"):
            raise ModelError("mesh-file", f"{file.name}: cannot be read ({fault})")
        return
    most = max(10**7, len(content))
    for number in re.findall(rb"(?<!\S)-?\d{8,}(?!\S)", content):
        if abs(int(number[:30])) > most:
            found = f"found the number {number[:30].decode()} in a file of {len(content)} bytes"
            raise ModelError("mesh-file", f"{file.name}: {found}, expected at most {most}")


def without_copies(blocks: list[Block], sets: dict[str, Any]) -> tuple[list[Block], dict[str, Any]]:
    """Remove copies of cells: format 2.2 writes a cell once for each of its groups.

    The first copy stays, with all its groups.
    """
    kept, places = [], []
    for block in blocks:
        _, first, place = np.unique(block.cells, axis=0, return_index=True, return_inverse=True)
        order = np.argsort(first)
        rank = np.empty_like(order)
        rank[order] = np.arange(len(order))
        kept.append(Block(block.kind, block.cells[first[order]], block.numbers[first[order]]))
        places.append(rank[place.ravel()])
    return kept, {name: [(k, np.unique(places[k][rows])) for k, rows in parts] for name, parts in sets.items()}


def read_vtu(file: Path) -> Draft:
    """VTK's unstructured grid; groups are the integer arrays on cells or points that contain only 0 and 1."""
    pieces = re.findall(rb"<Piece\b[^>]*>", read_bytes(regular_file(file)))
    if len(pieces) != 1:
        raise ModelError("mesh-file", f"{file.name}: found {len(pieces)} pieces, expected one")
    stated = {name.decode(): int(number) for name, number in re.findall(rb'NumberOf(Points|Cells)="(\d+)"', pieces[0])}
    mesh = from_meshio(file, "vtu")
    blocks = blocks_of(mesh, file)
    for name, found in (("Points", len(mesh.points)), ("Cells", sum(len(b.cells) for b in blocks))):
        if stated.get(name) != found:
            why = "other kinds cannot be read" if name == "Cells" else "is the file cut short?"
            what = f"found {found} {name.lower()} that can be read, expected {stated.get(name)} as stated: {why}"
            raise ModelError("mesh-file", f"{file.name}: {what}")
    flags = {name: np.flatnonzero(values) for name, values in mesh.point_data.items() if is_flag([values])}
    marked = {name: parts for name, parts in mesh.cell_data.items() if is_flag(parts)}
    sets = {name: [(k, np.flatnonzero(rows)) for k, rows in enumerate(parts)] for name, parts in marked.items()}
    points, numbers = np.asarray(mesh.points, dtype=float), np.arange(len(mesh.points))
    counted = [Block(b.kind, b.cells, b.numbers - 1) for b in blocks]  # VTK counts from 0
    return Draft(points=points, node_numbers=numbers, blocks=counted, node_sets=flags, cell_sets=sets)


def is_flag(parts: list[Any]) -> bool:
    """Whether arrays contain whole numbers 0 and 1 only, one for each item."""
    arrays = [np.asarray(part) for part in parts]
    return all(a.ndim == 1 and a.dtype.kind in "iub" and np.isin(a, (0, 1)).all() for a in arrays)
