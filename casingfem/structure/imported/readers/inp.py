"""Read the mesh of an Abaqus or CalculiX input file: nodes, elements, node sets, element sets, element surfaces.

A parser of our own: it keeps the file's numbers, every block of nodes, nested sets and surfaces, places instances of
parts (`instances.py`), follows *INCLUDE, and refuses what would move or merge nodes behind the reader's back
(coordinate systems). What is not geometry (materials, steps) is passed over.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from casingfem.errors import ModelError, warn
from casingfem.io.arrays import FloatArray, IntArray
from casingfem.io.included import NumberedLine, read_lines
from casingfem.structure.imported.attachments.glue import Gluing
from casingfem.structure.imported.mesh.cell_kind import KINDS
from casingfem.structure.imported.readers.abaqus import CONNECTIONS, ELEMENTS, PROPERTIES, AbaqusAttachments
from casingfem.structure.imported.readers.draft import Block, Draft, Lookup
from casingfem.structure.imported.readers.faces import face_corners
from casingfem.structure.imported.readers.instances import Frame, laid_out

FAMILIES = {
    "C3D4": "tetra", "C3D10": "tetra10", "C3D8": "hexahedron", "C3D20": "hexahedron20", "C3D6": "wedge",
    "C3D15": "wedge15", "S4": "quad", "S8": "quad8", "S9": "quad9", "S3": "triangle", "S6": "triangle6",
    "STRI65": "triangle6", "CPS3": "triangle", "CPS4": "quad", "CPS6": "triangle6", "CPS8": "quad8",
    "CPE3": "triangle", "CPE4": "quad", "CPE6": "triangle6", "CPE8": "quad8", "M3D3": "triangle", "M3D4": "quad",
    "M3D6": "triangle6", "M3D8": "quad8", "M3D9": "quad9", "SFM3D3": "triangle", "SFM3D4": "quad",
    "SFM3D6": "triangle6", "SFM3D8": "quad8", "T3D2": "line", "T3D3": "line3", "B31": "line", "B32": "line3",
}  # fmt: skip
NODES = {"tetra": 4, "tetra10": 10, "hexahedron": 8, "hexahedron20": 20, "wedge": 6, "wedge15": 15, "quad": 4,
         "quad8": 8, "quad9": 9, "triangle": 3, "triangle6": 6, "line": 2, "line3": 3}  # fmt: skip
REFUSED = {"SYSTEM": "a local coordinate system"} | dict.fromkeys(
    ("NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY"), "nodes or elements that are not written out"
)
READ = {"NODE", "ELEMENT", "NSET", "ELSET", "SURFACE", "TIE", "INSTANCE", "PART", *PROPERTIES, *CONNECTIONS}
Sides: TypeAlias = list[tuple[int, IntArray]]  # blocks and rows
Rows: TypeAlias = Callable[[IntArray], Sides]
MOST = 1e15  # of numbers that a mesh has: beyond, a float does not tell them apart
LEFT_OUT = ("SHELL TO SOLID COUPLING", "EMBEDDED ELEMENT",
            "NONSTRUCTURAL MASS", "CONNECTOR SECTION", "CYCLIC SYMMETRY MODEL", "MATRIX INPUT", "MATRIX ASSEMBLE",
            "SUBSTRUCTURE PATH", "TRANSFORM", "BEAM SECTION", "BEAM GENERAL SECTION")  # fmt: skip


@dataclass(slots=True)
class Card:
    """One keyword: its line, parameters and data lines with their line numbers."""

    line: str
    keyword: str
    parameters: dict[str, str]
    data: list[tuple[str, str]] = field(default_factory=list)


def read_inp(path: Path) -> Draft:
    """The mesh of an input file.

    Raises
    ------
    ModelError
        With the line, if the file is malformed or has what cannot be read.
    """
    return Parser(path.name).read(read_lines(path, READ))


def cards(lines: Iterable[NumberedLine]) -> Iterator[Card]:
    """Keywords with their data; comments and empty lines are left out, continued keyword lines joined."""
    card: Card | None = None
    for number, raw in lines:
        line = raw.strip()
        if not line or line.startswith("**"):
            continue
        if line.startswith("*"):
            if card is not None:
                yield card
            head, *rest = [part.strip() for part in line[1:].split(",")]
            pairs = (part.partition("=") for part in rest if part)
            card = Card(number, " ".join(head.upper().split()), {k.strip().upper(): v.strip() for k, _, v in pairs})
        elif card is not None:
            card.data.append((number, line))
    if card is not None:
        yield card


def stacked(parts: Sequence[IntArray]) -> IntArray:
    """Faces of one table, the last corner of triangles repeated beside squares."""
    width = max(part.shape[1] for part in parts)
    return np.concatenate([np.pad(part, ((0, 0), (0, width - part.shape[1])), mode="edge") for part in parts])


class Parser:
    """State of one reading: numbers of nodes and elements, and the sets in the order of the file."""

    def __init__(self, source: str) -> None:
        self.source = source
        self.size = 0  # of the text
        self.points: list[FloatArray] = []
        self.numbers: list[IntArray] = []
        self.elements: list[tuple[str, IntArray, IntArray]] = []  # kind, numbers, node numbers
        self.node_sets: dict[str, list[IntArray]] = {}
        self.element_sets: dict[str, list[IntArray]] = {}
        self.surfaces: dict[str, list[tuple[IntArray, str]]] = {}
        self.spelling: dict[str, str] = {}
        self.frame = Frame()
        self.left_out: dict[str, str] = {}  # keyword -> its line
        self.hung = AbaqusAttachments(self)
        self.plane: set[int] = set()  # elements in a plane, whose S1 is an edge
        self.on_nodes: dict[str, list[IntArray]] = {}  # surfaces of nodes
        self.ties: list[tuple[Card, str, str, str]] = []  # card, line, surface that follows, surface followed

    def fault(self, line: str, message: str) -> ModelError:
        """A malformed file."""
        return ModelError("mesh-file", f"{self.source}: line {line}: {message}")

    def read(self, lines: Sequence[NumberedLine]) -> Draft:
        """Take every card in turn."""
        self.size = sum(len(line) + 1 for _, line in lines)
        takers = {"NODE": self.take_nodes, "ELEMENT": self.take_elements, "NSET": self.take_set,
                  "ELSET": self.take_set, "SURFACE": self.take_surface, "TIE": self.take_tie}  # fmt: skip
        takers |= dict.fromkeys((*PROPERTIES, *CONNECTIONS), self.hung.take)
        left_out = self.left_out
        for card, frame in laid_out(cards(lines), self.fault):
            self.frame = frame
            if card.keyword in REFUSED:
                raise self.fault(card.line, f"*{card.keyword} refers to {REFUSED[card.keyword]}, expected a flat mesh")
            if card.keyword in LEFT_OUT or (card.keyword == "SHELL SECTION" and "OFFSET" in card.parameters):
                left_out[card.keyword] = card.line
            if card.keyword in takers:
                takers[card.keyword](card)
        if "TRANSFORM" in left_out and self.hung.by_direction:
            line = left_out["TRANSFORM"]
            raise self.fault(line, "*TRANSFORM beside springs or equations, expected them along the global axes")
        if left_out:
            found = ", ".join(f"*{name} (line {line})" for name, line in left_out.items())
            warn("mesh-left-out", f"{self.source}: {found}", stacklevel=6)
        return self.draft()

    def values(self, card: Card, kind: type) -> list[list[Any]]:
        """The numbers on each data line."""
        rows = []
        for line, text in card.data:
            try:
                rows.append([kind(cell) for cell in text.rstrip(",").split(",")])
            except ValueError:
                raise self.fault(line, f"found {text!r}, expected numbers") from None
            if not all(abs(value) < MOST for value in rows[-1]):
                raise self.fault(line, f"found {text!r}, expected numbers below {MOST:g}")
        return rows

    def take_nodes(self, card: Card) -> None:
        """*NODE: number, x, y, z."""
        rows = self.values(card, float)
        for (line, text), row in zip(card.data, rows, strict=True):
            if len(row) != 4:
                raise self.fault(line, f"found {text!r}, expected a node number and x, y, z")
            if not row[0].is_integer():
                raise self.fault(line, f"found the node {row[0]:g}, expected a whole number")
        table = np.array(rows, dtype=float).reshape(-1, 4)
        self.points.append(self.frame.moved(table[:, 1:]))
        self.numbers.append(table[:, 0].astype(np.int64) + self.frame.offset)
        if "NSET" in card.parameters:
            self.add(self.node_sets, card.parameters["NSET"], self.numbers[-1])

    def take_elements(self, card: Card) -> None:
        """*ELEMENT: number and nodes, over as many lines as they need."""
        name = card.parameters.get("TYPE", "").upper()
        if name in ELEMENTS:
            self.take_points(card, name)
            return
        families = [family for family in FAMILIES if name.startswith(family) and not name[len(family) :][:1].isdigit()]
        if not families:
            raise ModelError("mesh-unsupported-cell", f"{self.source}: line {card.line}: *ELEMENT of type {name!r}")
        kind = FAMILIES[max(families, key=len)]
        if name.startswith("B3"):
            self.left_out[f"ELEMENT of type {name}"] = card.line
        wanted, flat = NODES[kind] + 1, list[int]()
        for (line, _), row in zip(card.data, self.values(card, int), strict=True):
            if len(flat) % wanted + len(row) > wanted:  # each element starts on a line of its own
                raise self.fault(line, f"found {len(flat) % wanted + len(row)} numbers, expected {wanted} an element")
            flat += row
        if len(flat) % wanted:
            raise self.fault(card.line, f"*ELEMENT {name}: {len(flat)} numbers, expected {wanted} an element")
        table = np.array(flat, dtype=np.int64).reshape(-1, wanted) + self.frame.offset
        self.elements.append((kind, table[:, 0], table[:, 1:]))
        if name.startswith(("CPS", "CPE")):
            self.plane.update(table[:, 0].tolist())
        if "ELSET" in card.parameters:
            self.add(self.element_sets, card.parameters["ELSET"], table[:, 0])

    def take_points(self, card: Card, kind: str) -> None:
        """*ELEMENT of point masses and springs."""
        rows = self.values(card, int)
        for (line, text), row in zip(card.data, rows, strict=True):
            if len(row) != 1 + ELEMENTS[kind]:
                raise self.fault(line, f"found {text!r}, expected a number and {ELEMENTS[kind]} nodes")
        table = np.array(rows, dtype=np.int64).reshape(-1, 1 + ELEMENTS[kind]) + self.frame.offset
        self.hung.take_elements(card.line, kind, table[:, 0], table[:, 1:])
        if "ELSET" in card.parameters:
            self.add(self.element_sets, card.parameters["ELSET"], table[:, 0])

    def nodes_of(self, cell: str, line: str) -> IntArray:
        """Numbers of a node or node set named so far."""
        return self.numbers_of(self.node_sets, cell, line)

    def elements_of(self, name: str, line: str) -> IntArray:
        """Numbers of an element set named so far."""
        return self.numbers_of(self.element_sets, name, line)

    def node_surface(self, name: str) -> IntArray | None:
        """Numbers of the nodes of a surface of nodes; None for others."""
        found = self.on_nodes.get(name.upper())
        return None if found is None else np.unique(np.concatenate(found))

    def leave_out(self, what: str, line: str) -> None:
        """Warn in the end of what is not taken over."""
        self.left_out[what] = line

    def surface_nodes(self, name: str, line: str) -> IntArray:
        """Numbers of the nodes of a surface, of elements with the middles of their faces."""
        of_nodes = self.node_surface(name)
        if of_nodes is not None:
            return of_nodes
        if name.upper() not in self.surfaces:
            raise self.fault(line, f"no surface {name!r}")
        found = []
        for ids, face in self.surfaces[name.upper()]:
            for kind, numbers, cells in self.elements:
                block = Block(kind, cells[np.isin(numbers, ids)], numbers)
                if len(block.cells):
                    corners = set(self.local_corners(kind, ids, face))
                    stands = KINDS[kind].supports_of_nodes if kind in KINDS else [(k,) for k in range(NODES[kind])]
                    found.append(block.cells[:, [k for k, on in enumerate(stands) if corners >= set(on)]].ravel())
        return np.unique(np.concatenate(found))

    def take_set(self, card: Card) -> None:
        """*NSET and *ELSET: numbers, ranges, names of other sets."""
        sets = self.node_sets if card.keyword == "NSET" else self.element_sets
        name = card.parameters.get(card.keyword, "")
        if not name:
            raise self.fault(card.line, f"*{card.keyword} without a name")
        found: list[IntArray] = []
        for line, text in card.data:
            cells = [cell.strip() for cell in text.rstrip(",").split(",")]
            if "GENERATE" in card.parameters:
                try:
                    first, last, step = [*map(int, cells), 1][:3]
                    members = range(first, last + 1, step)
                except ValueError:
                    raise self.fault(line, f"found {text!r}, expected first, last, step") from None
                if len(members) > self.size:
                    raise self.fault(line, f"found {text!r}, {len(members)} numbers, more than the file can hold")
                found.append(np.array(members, dtype=np.int64) + self.frame.offset)
                continue
            found += [self.numbers_of(sets, cell, line) for cell in cells if cell]
        self.add(sets, name, np.concatenate([*found, np.zeros(0, dtype=np.int64)]))

    def numbers_of(self, sets: dict[str, list[IntArray]], cell: str, line: str) -> IntArray:
        """A number, or the members of a set named before."""
        if cell.isdecimal() and int(cell) < MOST:
            return np.array([int(cell) + self.frame.offset])
        known = [name for name in (f"{self.frame.prefix}{cell}".upper(), cell.upper()) if name in sets]
        if not known:
            raise self.fault(line, f"no set {cell!r} up to here")
        return np.concatenate(sets[known[0]])

    def take_surface(self, card: Card) -> None:
        """*SURFACE of TYPE=ELEMENT: element or set, face S1, S2, ..."""
        name = self.named(card.parameters.get("NAME", ""))
        if card.parameters.get("TYPE", "ELEMENT").upper() == "NODE":
            named = [self.nodes_of(text.split(",")[0].strip(), line) for line, text in card.data]
            self.on_nodes.setdefault(name.upper(), []).extend(named)
            self.spelling.setdefault(name.upper(), name)
            return
        if card.parameters.get("TYPE", "ELEMENT").upper() != "ELEMENT":
            return
        entries = self.surfaces.setdefault(name.upper(), [])
        self.spelling.setdefault(name.upper(), name)
        for line, text in card.data:
            cells = [cell.strip() for cell in text.split(",")]
            if len(cells) < 2 or not cells[1]:
                raise self.fault(line, f"found {text!r}, expected an element or set and a face such as S1")
            entries.append((self.numbers_of(self.element_sets, cells[0], line), cells[1].upper()))

    def take_tie(self, card: Card) -> None:
        """*TIE: surface that follows, surface that it follows; those between sectors are left out."""
        for key in ("CYCLIC SYMMETRY", "MULTISTAGE"):
            if key in card.parameters:
                self.leave_out(f"TIE of {key.lower()}", card.line)
                return
        for line, text in card.data:
            cells = [cell.strip() for cell in text.rstrip(", ").split(",")]
            if len(cells) < 2:
                raise self.fault(line, f"*TIE: found {text!r}, expected two surfaces")
            self.ties.append((card, line, f"{self.frame.prefix}{cells[0]}", f"{self.frame.prefix}{cells[1]}"))

    def gluings(self) -> list[Gluing]:
        """Ties by the names of groups; surfaces of nodes that follow are groups of their own."""
        found = []
        for card, line, *names in self.ties:
            for name in names:
                if name.upper() not in (*self.surfaces, *self.on_nodes):
                    raise self.fault(line, f"*TIE: no surface {name!r}")
            first, other = (name.upper() for name in names)
            if first in self.on_nodes:
                self.node_sets.setdefault(first, self.on_nodes[first])
            if other not in self.surfaces:
                raise self.fault(line, f"*TIE: found the surface {names[1]!r} of nodes, expected one of faces")
            given = card.parameters.get("POSITION TOLERANCE")
            tolerance = None if given is None else self.hung.number(card.line, given)
            follower, master = self.spelling[first], self.spelling[other]
            found.append(Gluing(follower=follower, master=master, tolerance=tolerance, where=f"*TIE (line {line})"))
        return found

    def add(self, sets: dict[str, list[IntArray]], name: str, numbers: IntArray) -> None:
        """Add numbers to a set; names do not know case."""
        name = self.named(name)
        self.spelling.setdefault(name.upper(), name)
        sets.setdefault(name.upper(), []).append(numbers.astype(np.int64))

    def named(self, name: str) -> str:
        """The name of a set or surface in the assembly."""
        return f"{self.frame.prefix}{name}" if self.frame.owns else name

    def draft(self) -> Draft:
        """Numbers to indices."""
        self.elements = [block for block in self.elements if len(block[1])]
        numbers = np.concatenate([np.zeros(0, dtype=np.int64), *self.numbers])
        if not len(numbers) or not self.elements:
            raise ModelError("mesh-no-cells", f"{self.source}: found {len(numbers)} nodes and no elements")
        nodes = Lookup(numbers, self.source, "node")
        blocks = [Block(kind, nodes(cells), ids) for kind, ids, cells in self.elements]
        elements = Lookup(np.concatenate([b.numbers for b in blocks]), self.source, "element")
        owner = np.repeat(np.arange(len(blocks)), [len(b.cells) for b in blocks])
        first = np.cumsum([0, *(len(b.cells) for b in blocks)])
        gluings = self.gluings()

        def rows(ids: IntArray) -> list[tuple[int, IntArray]]:
            place = elements(ids[~np.isin(ids, list(self.hung.elements))])
            return [(int(k), place[owner[place] == k] - first[k]) for k in np.unique(owner[place])]

        on_faces = dict[str, IntArray]()
        on_cells = {self.spelling[n]: rows(np.concatenate(parts)) for n, parts in self.element_sets.items()}
        for name, entries in self.surfaces.items():
            corners, cells = self.faces(blocks, entries, rows)
            if corners:
                on_faces[self.spelling[name]] = stacked(corners)
            if cells:
                on_cells[self.spelling[name]] = [*on_cells.get(self.spelling[name], []), *cells]
        return Draft(
            points=np.concatenate(self.points),
            node_numbers=numbers,
            blocks=blocks,
            node_sets={self.spelling[n]: nodes(np.concatenate(parts)) for n, parts in self.node_sets.items()},
            cell_sets=on_cells,
            facet_sets=on_faces,
            attachments=self.hung.attachments(np.concatenate(self.points), nodes),
            gluings=gluings,
        )

    def local_corners(self, kind: str, ids: IntArray, face: str) -> tuple[int, ...]:
        """Which nodes of elements of a kind are the corners of a face; of shells a side is all of them."""
        plane = bool(len(ids)) and bool(np.isin(ids, list(self.plane)).all())
        if corners := face_corners(kind, face, plane=plane):
            return corners
        raise ModelError("mesh-file", f"{self.source}: a surface on face {face!r} of {kind} elements")

    def faces(
        self, blocks: list[Block], entries: list[tuple[IntArray, str]], rows: Rows
    ) -> tuple[list[IntArray], Sides]:
        """Corners of the faces of a surface, and the cells of shells whose sides it has."""
        corners, sides = list[IntArray](), list[tuple[int, IntArray]]()
        for ids, face in entries:
            for k, part in rows(ids):
                local = self.local_corners(blocks[k].kind, blocks[k].numbers[part], face)
                if blocks[k].dim == 2 and len(local) > 2:
                    sides.append((k, part))
                else:
                    corners.append(blocks[k].cells[part][:, list(local)])
        return corners, sides
