"""Sets and surfaces of an Abaqus or CalculiX input file by name, with the file's numbers of nodes and elements.

Faces of elements are S1, S2, ... of solids; SPOS, SNEG, E1, ... of shells.
"""

import re
from typing import Any

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import IntArray
from casingfem.structure.imported.mesh.cell_kind import KINDS
from casingfem.structure.imported.readers.draft import Block
from casingfem.structure.imported.readers.inp_cards import DIGITS, MOST, Card, Frame, values

TETRA = ((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0))  # S1 to S4
WEDGE = ((0, 1, 2), (3, 5, 4), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5))  # S1 to S5
CUBE = ((0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0))  # S1 to S6
SOLID = {"tetra": TETRA, "wedge": WEDGE, "hexahedron": CUBE}
FLAT = {"triangle": 3, "quad": 4}
NAMED = re.compile(r"(SPOS|SNEG)|([SE])(\d)")


def face_corners(kind: str, face: str, *, plane: bool = False) -> tuple[int, ...]:
    """Local corners of a face of an element: all for a shell's side, two for its edge; () if there is no such face.

    Edges of shells are E1 to E4 (Abaqus) or S3 to S6 (CalculiX, where S1 and S2 are the sides). Edges of elements in a
    `plane` are S1 to S4.

    >>> face_corners("hexahedron20", "S1"), face_corners("quad8", "SPOS"), face_corners("triangle", "E3")
    ((0, 1, 2, 3), (0, 1, 2, 3), (2, 0))
    """
    shape, found = kind.rstrip("0123456789"), NAMED.fullmatch(face)
    if found is None:
        return ()
    if shape in SOLID:
        faces = SOLID[shape]
        return faces[int(found[3]) - 1] if found[2] == "S" and 1 <= int(found[3]) <= len(faces) else ()
    count = FLAT.get(shape, 0)
    if found[1] or (found[2] == "S" and not plane and found[3] in "12"):
        return tuple(range(count))
    edge = int(found[3]) - (1 if plane or found[2] == "E" else 3)
    return (edge, (edge + 1) % count) if 0 <= edge < count else ()


NODES = {"tetra": 4, "tetra10": 10, "hexahedron": 8, "hexahedron20": 20, "wedge": 6, "wedge15": 15, "quad": 4,
         "quad8": 8, "quad9": 9, "triangle": 3, "triangle6": 6, "line": 2, "line3": 3}  # fmt: skip
NONE = np.zeros(0, dtype=np.int64)


class Names:
    """Names defined in a file so far, and errors for its lines."""

    def __init__(self, source: str) -> None:
        self.source = source
        self.size = 0  # of the text
        self.elements: list[tuple[str, IntArray, IntArray]] = []  # kind, numbers, node numbers
        self.node_sets: dict[str, list[IntArray]] = {}
        self.element_sets: dict[str, list[IntArray]] = {}
        self.surfaces: dict[str, list[tuple[IntArray, str]]] = {}
        self.on_nodes: dict[str, list[IntArray]] = {}  # surfaces of nodes
        self.spelling: dict[str, str] = {}
        self.frame = Frame()
        self.plane: set[int] = set()  # elements in a plane, whose S1 is an edge
        self.left_out: dict[str, str] = {}  # keyword -> its line

    def fault(self, line: str, message: str) -> ModelError:
        """An error about a malformed file."""
        return ModelError("mesh-file", f"{self.source}: line {line}: {message}")

    def leave_out(self, what: str, line: str) -> None:
        """Warn, at the end, about keywords that were skipped."""
        self.left_out[what] = line

    def values(self, card: Card, kind: type) -> list[list[Any]]:
        """The numbers on each data line."""
        return values(card, kind, self.fault)

    def named(self, name: str) -> str:
        """The name of a set or surface in the assembly."""
        return f"{self.frame.prefix}{name}" if self.frame.owns else name

    def add(self, sets: dict[str, list[IntArray]], name: str, numbers: IntArray) -> None:
        """Add numbers to a set; names are case-insensitive."""
        name = self.named(name)
        self.spelling.setdefault(name.upper(), name)
        sets.setdefault(name.upper(), []).append(numbers.astype(np.int64))

    def numbers_of(self, sets: dict[str, list[IntArray]], cell: str, line: str) -> IntArray:
        """A number, or the members of a set defined before."""
        if cell.isdecimal() and len(cell) <= DIGITS:
            return np.array([int(cell) + self.frame.offset])
        known = [name for name in (f"{self.frame.prefix}{cell}".upper(), cell.upper()) if name in sets]
        if not known:
            raise self.fault(line, f"found no set {cell!r} above this line")
        return np.concatenate(sets[known[0]])

    def nodes_of(self, cell: str, line: str) -> IntArray:
        """Numbers of a node, or of a node set defined before."""
        return self.numbers_of(self.node_sets, cell, line)

    def elements_of(self, name: str, line: str) -> IntArray:
        """Numbers of an element set defined before."""
        return self.numbers_of(self.element_sets, name, line)

    def node_surface(self, name: str) -> IntArray | None:
        """Numbers of the nodes of a surface of nodes; None for other surfaces."""
        found = self.on_nodes.get(name.upper())
        return None if found is None else np.unique(np.concatenate(found))

    def surface_nodes(self, name: str, line: str) -> IntArray:
        """Numbers of the nodes of a surface; for faces of elements, including the middle nodes."""
        of_nodes = self.node_surface(name)
        if of_nodes is not None:
            return of_nodes
        if name.upper() not in self.surfaces:
            raise self.fault(line, f"found no surface {name!r}")
        found = [NONE]
        for ids, face in self.surfaces[name.upper()]:
            for kind, numbers, cells in self.elements:
                block = Block(kind, cells[np.isin(numbers, ids)], numbers)
                if len(block.cells):
                    corners = set(self.local_corners(kind, ids, face))
                    stands = KINDS[kind].supports_of_nodes if kind in KINDS else [(k,) for k in range(NODES[kind])]
                    found.append(block.cells[:, [k for k, on in enumerate(stands) if corners >= set(on)]].ravel())
        return np.unique(np.concatenate(found))

    def take_set(self, card: Card) -> None:
        """Read *NSET or *ELSET: numbers, ranges, names of other sets."""
        sets = self.node_sets if card.keyword == "NSET" else self.element_sets
        name = card.parameters.get(card.keyword, "")
        if not name:
            raise self.fault(card.line, f"found *{card.keyword} without a name, expected {card.keyword}=NAME")
        found: list[IntArray] = []
        for line, text in card.data:
            cells = [cell.strip() for cell in text.rstrip(",").split(",")]
            if "GENERATE" in card.parameters:
                try:
                    first, last, step = [*map(int, cells), 1][:3]
                    members = range(first, last + 1, step)
                except ValueError:
                    raise self.fault(line, f"found {text!r}, expected first, last, step") from None
                if max(abs(first), abs(last)) >= MOST:
                    raise self.fault(line, f"found {text!r}, expected numbers below {MOST:g}")
                if len(members) > self.size:
                    raise self.fault(line, f"found {text!r}, {len(members)} numbers, more than the file can contain")
                found.append(np.array(members, dtype=np.int64) + self.frame.offset)
                continue
            found += [self.numbers_of(sets, cell, line) for cell in cells if cell]
        self.add(sets, name, np.concatenate([NONE, *found]))

    def take_surface(self, card: Card) -> None:
        """Read *SURFACE of TYPE=ELEMENT: element or set, face S1, S2, ..."""
        name = self.named(card.parameters.get("NAME", ""))
        if not card.data:
            raise self.fault(card.line, f"*SURFACE {name}: found no data lines, expected faces of elements, or nodes")
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

    def local_corners(self, kind: str, ids: IntArray, face: str) -> tuple[int, ...]:
        """Corner nodes of a face of a kind of element; the side of a shell is the whole element."""
        plane = bool(len(ids)) and bool(np.isin(ids, list(self.plane)).all())
        if corners := face_corners(kind, face, plane=plane):
            return corners
        found = f"found a surface on face {face!r} of {kind} elements, which have no such face"
        raise ModelError("mesh-file", f"{self.source}: {found}")
