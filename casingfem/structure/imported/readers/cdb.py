"""Read the mesh of an Ansys archive (.cdb): nodes, solids and shells, components, materials.

The parser reads the blocks that CDWRITE writes and checks their fixed columns line by line. (The common library crashes
the process on damaged files.) Elements of material 2 are the group `MAT 2`; components keep their names. Bricks that
are written with repeated nodes are tetrahedra, wedges or pyramids. Other elements (MESH200, MASS21, contact, surface
effects) are skipped, with a warning that counts them.

    NBLOCK,6,SOLID,last,count   (3i9,6e21.13e3)   number, two facts, x, y, z, angles; ends with N,R5.3,LOC,-1,
    EBLOCK,19,SOLID,last,count  (19i9)            material, type, six facts, nodes, 0, number, nodes; ends with -1
    CMBLOCK,NAME,NODE,count     (8i10)            numbers; one below zero ends a range
"""

import re
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from casingfem.errors import ModelError, warn
from casingfem.io.arrays import IntArray
from casingfem.structure.imported.mesh.cell_kind import KINDS
from casingfem.structure.imported.mesh.collapsed import native
from casingfem.structure.imported.readers.draft import Block, Draft, Lookup
from contact.io.infiles import read_loose_text

BRICKS = ("45", "95", "185", "186", "190")
TETRAHEDRA = ("92", "187", "285")
SHELLS = ("63", "93", "181", "281")
FULL = {"92": (4, 10), "187": (4, 10), "95": (8, 20), "186": (8, 20), "93": (4, 8), "281": (4, 8)}  # corners, nodes
WHOLE = {8: "hexahedron", 20: "hexahedron20", 4: "tetra", 10: "tetra10"}
TETRA8 = (0, 1, 2, 4)  # distinct corners of a brick collapsed to a tetrahedron
WIDEST = 100  # columns, and numbers on a line
FACTS, COUNT, OWN = 11, 8, 10  # numbers before an element's nodes; among them how many nodes, and its own number
NAME = re.compile(r"(\d+)$")
COLUMNS = re.compile(r"\(((?:\d*i\d+,?)+)(?:(\d*)e(\d+)\.\d+(?:e\d+)?)?\)$", re.IGNORECASE)
INTEGERS = re.compile(r"(\d*)i(\d+)", re.IGNORECASE)


@dataclass(slots=True)
class Archive:
    """Contents of the blocks of a file."""

    source: str
    lines: list[str]
    nodes: list[tuple[int, float, float, float]] = field(default_factory=list)
    elements: list[list[int]] = field(default_factory=list)  # facts, then nodes
    types: dict[int, str] = field(default_factory=dict)
    components: dict[str, tuple[str, list[int]]] = field(default_factory=dict)
    left_out: Counter[str] = field(default_factory=Counter)

    def fault(self, at: int, message: str) -> ModelError:
        """An error about a malformed file; lines count from 0."""
        return ModelError("mesh-file", f"{self.source}: line {at + 1}: {message}")

    def integer(self, at: int, text: str) -> int:
        """An integer."""
        try:
            return int(text)
        except ValueError:
            raise self.fault(at, f"found {text.strip()!r}, expected a whole number") from None

    def layout(self, at: int) -> tuple[list[int], int]:
        """Widths of the integers on a line, and of the reals after them."""
        found = COLUMNS.match(self.lines[at].strip()) if at < len(self.lines) else None
        if found is None:
            at = min(at, len(self.lines) - 1)
            line = self.lines[at].strip()
            raise self.fault(at, f"found {line!r}, expected the columns of a block, such as (19i9)")
        fields = [(int(times or 1), int(width)) for times, width in INTEGERS.findall(found[1])]
        if not all(0 < times < WIDEST and 0 < width < WIDEST for times, width in fields):
            raise self.fault(at, f"found {self.lines[at].strip()!r}, expected columns such as (19i9)")
        return [width for times, width in fields for _ in range(times)], int(found[3] or 0)

    def whole(self, at: int, width: int) -> list[int]:
        """The integers of a line with fixed columns."""
        line = self.lines[at].rstrip()
        return [self.integer(at, line[k : k + width]) for k in range(0, len(line), width)]


def read_cdb(path: Path) -> Draft:
    """The mesh of an archive.

    Raises
    ------
    ModelError
        For a malformed or truncated archive, or elements with missing nodes, with the line.
    """
    archive = Archive(path.name, read_loose_text(path).splitlines())
    at = 0
    while at < len(archive.lines):
        head, *fields = [part.strip() for part in archive.lines[at].upper().split(",")]
        take = {"NBLOCK": take_nodes, "EBLOCK": take_elements, "CMBLOCK": take_component}.get(head)
        if take is not None:
            at = take(archive, at, fields)
            continue
        if head == "ET" and len(fields) > 1:
            archive.types[archive.integer(at, fields[0])] = fields[1]
        elif head in ("CE", "CP", "CERIG", "RBE3") and archive.lines[at][:1] not in "/!":
            archive.left_out[f"constraints ({head})"] += 1
        elif head in ("N", "E", "EN") and len(fields) > 1 and not fields[0].startswith("R5."):
            found = f"found the command {head} for a single node or element"
            raise archive.fault(at, f"{found}, expected blocks, as CDWRITE,DB writes them")
        at += 1
    return draft(archive)


def check_count(archive: Archive, at: int, fields: list[str], found: int) -> None:
    """Refuse a block with fewer or more items than it states."""
    wanted = int(fields[-1]) if len(fields) > 2 and fields[-1].isdecimal() else 0
    if wanted and found != wanted:
        short = ": cut short?" if found < wanted else ""
        raise archive.fault(at, f"found {found} items, expected {wanted}{short}")


def take_nodes(archive: Archive, at: int, fields: list[str]) -> int:
    """Read NBLOCK; returns the line after it."""
    begun, (widths, real) = at, archive.layout(at + 1)
    if not real:
        found = f"found {archive.lines[at + 1].strip()!r}"
        raise archive.fault(at + 1, f"{found}, expected columns of whole and real numbers, such as (3i9,6e21.13e3)")
    at += 2
    first = len(archive.nodes)
    while at < len(archive.lines):
        line = archive.lines[at].rstrip()
        if line.upper().startswith("N,") or line.strip() == "-1":
            check_count(archive, begun, fields, len(archive.nodes) - first)
            return at + 1
        start = sum(widths)
        parts = [line[start + k * real : start + (k + 1) * real] for k in range(3)]
        if (len(line) - start) % real and len(line) > start:
            raise archive.fault(
                at, f"found a line of {len(line)} characters, expected columns of {widths[0]} and {real} characters"
            )
        try:
            x, y, z = (float(part) if part.strip() else 0.0 for part in parts)
        except ValueError:
            raise archive.fault(at, f"found {line[start:].strip()!r}, expected coordinates") from None
        archive.nodes.append((archive.integer(at, line[: widths[0]]), x, y, z))
        at += 1
    raise archive.fault(begun, "found NBLOCK without its end: cut short?")


def take_elements(archive: Archive, at: int, fields: list[str]) -> int:
    """Read EBLOCK; returns the line after it."""
    if "SOLID" not in fields:
        raise archive.fault(at, "found an EBLOCK that is not SOLID, expected EBLOCK,19,SOLID")
    begun, width = at, archive.layout(at + 1)[0][0]
    at += 2
    first = len(archive.elements)
    while at < len(archive.lines):
        numbers = archive.whole(at, width)
        if numbers == [-1]:
            check_count(archive, begun, fields, len(archive.elements) - first)
            return at + 1
        if len(numbers) <= FACTS:
            raise archive.fault(at, f"found {len(numbers)} numbers, expected {FACTS} and then the nodes of an element")
        wanted = FACTS + numbers[COUNT]
        while len(numbers) < wanted and at + 1 < len(archive.lines) and archive.lines[at + 1].strip() != "-1":
            at += 1
            numbers += archive.whole(at, width)
        if len(numbers) != wanted:
            found = f"found element {numbers[OWN]} with {len(numbers) - FACTS} nodes, expected {numbers[COUNT]}"
            raise archive.fault(at, f"{found}{': cut short?' if len(numbers) < wanted else ''}")
        archive.elements.append(numbers)
        at += 1
    raise archive.fault(begun, "found EBLOCK without its end: cut short?")


def take_component(archive: Archive, at: int, fields: list[str]) -> int:
    """Read CMBLOCK; returns the line after it."""
    if len(fields) < 3 or fields[1] not in ("NODE", "ELEM", "ELEMENT"):
        found = f"found {archive.lines[at].strip()!r}"
        raise archive.fault(at, f"{found}, expected CMBLOCK, name, NODE or ELEM, number of members")
    begun, count = at, archive.integer(at, fields[2].partition("!")[0])
    widths, _ = archive.layout(at + 1)
    per_line, width = len(widths), widths[0]
    given: list[int] = []
    at += 2
    while len(given) < count and at < len(archive.lines):
        given += archive.whole(at, width)
        at += 1
    if len(given) != count:
        found = f"found {len(given)} numbers, expected {count}, {per_line} on each line"
        raise archive.fault(begun, f"{found}: cut short?")
    members: list[int] = []
    most = sum(map(len, archive.lines))
    for number in given:
        ranged = range(members[-1] + 1 if members else 1, 1 - number)
        if number <= 0 and len(ranged) > most:
            raise archive.fault(begun, f"found a range up to {-number}, expected at most {most} numbers in this file")
        members += [number] if number > 0 else ranged
    name = archive.lines[begun].split(",")[1].strip()
    archive.components[name] = (fields[1][:4], members)
    return at


def kind_of(element: str, nodes: IntArray) -> tuple[str, IntArray] | None:
    """Kind and nodes in VTK's order of one element; None if it is neither solid nor shell."""
    number = NAME.search(element)
    name = number[1] if number else element
    corners, full = FULL.get(name, (0, 0))
    if corners < len(nodes) < full:  # the last middle nodes may be left out of the count
        nodes = np.pad(nodes, (0, full - len(nodes)))
    if name in TETRAHEDRA:
        return WHOLE.get(len(nodes), "tetra14"), nodes
    if name in SHELLS:
        if len(nodes) == 4 and nodes[2] == nodes[3]:
            return "triangle", nodes[:3]
        if len(nodes) == 8:
            kind, _, slots = next(iter(native("quad8", nodes[None])))
            return kind, nodes[slots]
        return {4: "quad", 3: "triangle", 6: "triangle6"}.get(len(nodes), "polygon"), nodes
    if name not in BRICKS:
        return None
    corners = len(set(nodes[:8].tolist()))
    if corners == 8 or len(nodes) < 8:
        return WHOLE.get(len(nodes), "polyhedron"), nodes
    if len(nodes) == 20:
        kind, _, slots = next(iter(native("hexahedron20", nodes[None])))
        return ("polyhedron" if kind == "hexahedron20" else kind), nodes[slots]
    return ("tetra", nodes[list(TETRA8)]) if corners == 4 and len(nodes) == 8 else ("hexahedron", nodes)


def draft(archive: Archive) -> Draft:
    """The draft of the mesh, with numbers replaced by indices."""
    source = archive.source
    if not archive.nodes or not archive.elements:
        found = f"{len(archive.nodes)} nodes and {len(archive.elements)} elements in blocks (NBLOCK, EBLOCK)"
        raise ModelError("mesh-no-cells", f"{source}: found {found}")
    table = np.array(archive.nodes)
    numbers = table[:, 0].astype(np.int64)
    nodes = Lookup(numbers, source, "node")
    rows: dict[str, list[tuple[int, int, IntArray]]] = {}  # kind -> number, material, nodes
    left_out = archive.left_out
    for element in archive.elements:
        kind = archive.types.get(element[1], "")
        if not kind:
            found = f"found element {element[OWN]} of type {element[1]}, expected a command ET for this type"
            raise ModelError("mesh-file", f"{source}: {found}")
        found_kind = kind_of(kind, np.array(element[FACTS:], dtype=np.int64))
        if found_kind is None:
            left_out[f"elements of type {kind}"] += 1
            continue
        name, own = found_kind
        if name in KINDS and (own[: len(KINDS[name].corners)] <= 0).any():
            raise ModelError("mesh-file", f"{source}: found element {element[OWN]} without one of its corner nodes")
        if name in KINDS and KINDS[name].dim == 2 and not (own[len(KINDS[name].corners) :] > 0).any():
            name, own = name.rstrip("68"), own[: len(KINDS[name].corners)]
        rows.setdefault(name, []).append((element[OWN], element[0], own))
    if left_out:
        found = ", ".join(f"{count} {kind}" for kind, count in left_out.items())
        warn("mesh-left-out", f"{source}: {found}", stacklevel=5)
    if not rows:
        raise ModelError("mesh-no-cells", f"{source}: found {len(numbers)} nodes and no solid or shell elements")
    blocks, sets = list[Block](), dict[str, list[tuple[int, IntArray]]]()
    for k, (kind, entries) in enumerate(rows.items()):
        own_numbers = np.array([entry[0] for entry in entries])
        given = np.array([entry[2] for entry in entries])
        blocks.append(Block(kind, nodes.some(given, given > 0), own_numbers))
        materials = np.array([entry[1] for entry in entries])
        for material in np.unique(materials):
            sets.setdefault(f"MAT {material}", []).append((k, np.flatnonzero(materials == material)))
        for name, (what, members) in archive.components.items():
            if what == "ELEM":
                sets.setdefault(name, []).append((k, np.flatnonzero(np.isin(own_numbers, members))))
    Lookup(np.concatenate([block.numbers for block in blocks]), source, "element")
    on_nodes = {name: members for name, (what, members) in archive.components.items() if what == "NODE"}
    node_sets = {name: nodes(np.array(members, dtype=np.int64)) for name, members in on_nodes.items()}
    return Draft(points=table[:, 1:], node_numbers=numbers, blocks=blocks, node_sets=node_sets, cell_sets=sets)
