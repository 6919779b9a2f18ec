"""Read the mesh of an Abaqus or CalculiX input file: nodes, elements, node sets, element sets, element surfaces.

The parser keeps the file's numbers, all blocks of nodes, and nested sets and surfaces. It places instances of parts
(`inp_cards.py`) and reads files of *INCLUDE. Keywords that move or merge nodes (coordinate systems) are refused.
Materials, steps and everything else that is not geometry is skipped.
"""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TypeAlias

import numpy as np

from casingfem.errors import ModelError, warn
from casingfem.io.arrays import FloatArray, IntArray
from casingfem.io.included import NumberedLine, read_lines
from casingfem.structure.imported.attachments.glue import Gluing
from casingfem.structure.imported.readers.abaqus import CONNECTIONS, ELEMENTS, PROPERTIES, AbaqusAttachments
from casingfem.structure.imported.readers.draft import Block, Draft, Lookup
from casingfem.structure.imported.readers.inp_cards import Card, cards, laid_out
from casingfem.structure.imported.readers.inp_names import NODES, Names

FAMILIES = {
    "C3D4": "tetra", "C3D10": "tetra10", "C3D8": "hexahedron", "C3D20": "hexahedron20", "C3D6": "wedge",
    "C3D15": "wedge15", "S4": "quad", "S8": "quad8", "S9": "quad9", "S3": "triangle", "S6": "triangle6",
    "STRI65": "triangle6", "CPS3": "triangle", "CPS4": "quad", "CPS6": "triangle6", "CPS8": "quad8",
    "CPE3": "triangle", "CPE4": "quad", "CPE6": "triangle6", "CPE8": "quad8", "M3D3": "triangle", "M3D4": "quad",
    "M3D6": "triangle6", "M3D8": "quad8", "M3D9": "quad9", "SFM3D3": "triangle", "SFM3D4": "quad",
    "SFM3D6": "triangle6", "SFM3D8": "quad8", "T3D2": "line", "T3D3": "line3", "B31": "line", "B32": "line3",
}  # fmt: skip
REFUSED = {"SYSTEM": "a local coordinate system"} | dict.fromkeys(
    ("NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY"), "nodes or elements that the solver generates"
)
READ = {"NODE", "ELEMENT", "NSET", "ELSET", "SURFACE", "TIE", "INSTANCE", "PART", *PROPERTIES, *CONNECTIONS}
Sides: TypeAlias = list[tuple[int, IntArray]]  # blocks and rows
Rows: TypeAlias = Callable[[IntArray], Sides]
LEFT_OUT = ("SHELL TO SOLID COUPLING", "EMBEDDED ELEMENT",
            "NONSTRUCTURAL MASS", "CONNECTOR SECTION", "CYCLIC SYMMETRY MODEL", "MATRIX INPUT", "MATRIX ASSEMBLE",
            "SUBSTRUCTURE PATH", "TRANSFORM", "BEAM SECTION", "BEAM GENERAL SECTION")  # fmt: skip


def read_inp(path: Path) -> Draft:
    """The mesh of an input file.

    Raises
    ------
    ModelError
        If the file is malformed or has unsupported content, with the line.
    """
    return Parser(path.name).read(read_lines(path, READ))


def stacked(parts: Sequence[IntArray]) -> IntArray:
    """Faces of triangles and squares in one table; triangles repeat their last corner."""
    width = max(part.shape[1] for part in parts)
    return np.concatenate([np.pad(part, ((0, 0), (0, width - part.shape[1])), mode="edge") for part in parts])


class Parser(Names):
    """State of a parser: numbers of nodes and elements, and the sets in the order of the file."""

    def __init__(self, source: str) -> None:
        super().__init__(source)
        self.points: list[FloatArray] = []
        self.numbers: list[IntArray] = []
        self.connections = AbaqusAttachments(self)
        self.ties: list[tuple[Card, str, str, str]] = []  # card, line, follower surface, master surface

    def read(self, lines: Sequence[NumberedLine]) -> Draft:
        """Read every card in turn."""
        self.size = sum(len(line) + 1 for _, line in lines)
        takers = {"NODE": self.take_nodes, "ELEMENT": self.take_elements, "NSET": self.take_set,
                  "ELSET": self.take_set, "SURFACE": self.take_surface, "TIE": self.take_tie}  # fmt: skip
        takers |= dict.fromkeys((*PROPERTIES, *CONNECTIONS), self.connections.take)
        left_out = self.left_out
        for card, frame in laid_out(cards(lines), self.fault):
            self.frame = frame
            if card.keyword in REFUSED:
                found = f"found *{card.keyword}, {REFUSED[card.keyword]}"
                raise self.fault(card.line, f"{found}, expected nodes and elements written out, in global coordinates")
            if card.keyword in LEFT_OUT or (card.keyword == "SHELL SECTION" and "OFFSET" in card.parameters):
                left_out[card.keyword] = card.line
            if card.keyword in takers:
                takers[card.keyword](card)
        if "TRANSFORM" in left_out and self.connections.by_direction:
            line = left_out["TRANSFORM"]
            found = "found *TRANSFORM and springs or equations, expected their directions along the global axes"
            raise self.fault(line, found)
        if left_out:
            found = ", ".join(f"*{name} (line {line})" for name, line in left_out.items())
            warn("mesh-left-out", f"{self.source}: {found}", stacklevel=6)
        return self.draft()

    def take_nodes(self, card: Card) -> None:
        """Read *NODE: number, x, y, z."""
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
        """Read *ELEMENT: number and nodes, over as many lines as they need."""
        name = card.parameters.get("TYPE", "").upper()
        if name in ELEMENTS:
            self.take_points(card, name)
            return
        families = [family for family in FAMILIES if name.startswith(family) and not name[len(family) :][:1].isdigit()]
        if not families:
            found = f"line {card.line}: found *ELEMENT of type {name!r}"
            raise ModelError("mesh-unsupported-cell", f"{self.source}: {found}")
        kind = FAMILIES[max(families, key=len)]
        if name.startswith("B3"):
            self.left_out[f"ELEMENT of type {name}"] = card.line
        wanted, flat = NODES[kind] + 1, list[int]()
        for (line, _), row in zip(card.data, self.values(card, int), strict=True):
            if len(flat) % wanted + len(row) > wanted:  # each element starts on a line of its own
                found = f"found an element of {len(flat) % wanted + len(row)} numbers"
                raise self.fault(line, f"{found}, expected {wanted}: its own number and its nodes")
            flat += row
        if len(flat) % wanted:
            found = f"*ELEMENT {name}: found {len(flat)} numbers"
            raise self.fault(card.line, f"{found}, expected a multiple of {wanted}: element number and nodes")
        table = np.array(flat, dtype=np.int64).reshape(-1, wanted) + self.frame.offset
        self.elements.append((kind, table[:, 0], table[:, 1:]))
        if name.startswith(("CPS", "CPE")):
            self.plane.update(table[:, 0].tolist())
        if "ELSET" in card.parameters:
            self.add(self.element_sets, card.parameters["ELSET"], table[:, 0])

    def take_points(self, card: Card, kind: str) -> None:
        """Read *ELEMENT of point masses and springs."""
        rows = self.values(card, int)
        for (line, text), row in zip(card.data, rows, strict=True):
            if len(row) != 1 + ELEMENTS[kind]:
                raise self.fault(line, f"found {text!r}, expected an element number and {ELEMENTS[kind]} nodes")
        table = np.array(rows, dtype=np.int64).reshape(-1, 1 + ELEMENTS[kind]) + self.frame.offset
        self.connections.take_elements(card.line, kind, table[:, 0], table[:, 1:])
        if "ELSET" in card.parameters:
            self.add(self.element_sets, card.parameters["ELSET"], table[:, 0])

    def take_tie(self, card: Card) -> None:
        """Read *TIE: the follower surface, then the master surface; ties between sectors are skipped."""
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
        """Ties by the names of groups; a follower surface of nodes becomes a group of its own."""
        found = []
        for card, line, *names in self.ties:
            for name in names:
                if name.upper() not in (*self.surfaces, *self.on_nodes):
                    raise self.fault(line, f"*TIE: found no surface {name!r}, expected the name of a *SURFACE")
            first, other = (name.upper() for name in names)
            if first in self.on_nodes:
                self.node_sets.setdefault(first, self.on_nodes[first])
            if other not in self.surfaces:
                raise self.fault(line, f"*TIE: found the surface {names[1]!r} of nodes, expected one of element faces")
            given = card.parameters.get("POSITION TOLERANCE")
            tolerance = None if given is None else self.connections.number(card.line, given)
            follower, master = self.spelling[first], self.spelling[other]
            found.append(Gluing(follower=follower, master=master, tolerance=tolerance, where=f"*TIE (line {line})"))
        return found

    def draft(self) -> Draft:
        """The draft of the mesh, with numbers replaced by indices."""
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
            place = elements(ids[~np.isin(ids, list(self.connections.elements))])
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
            attachments=self.connections.attachments(np.concatenate(self.points), nodes),
            gluings=gluings,
        )

    def faces(
        self, blocks: list[Block], entries: list[tuple[IntArray, str]], rows: Rows
    ) -> tuple[list[IntArray], Sides]:
        """Corners of the faces of a surface, and the shell cells whose sides belong to it."""
        corners, sides = list[IntArray](), list[tuple[int, IntArray]]()
        for ids, face in entries:
            for k, part in rows(ids):
                local = self.local_corners(blocks[k].kind, blocks[k].numbers[part], face)
                if blocks[k].dim == 2 and len(local) > 2:
                    sides.append((k, part))
                else:
                    corners.append(blocks[k].cells[part][:, list(local)])
        return corners, sides
