"""Read the mesh of a Nastran bulk data file: GRID, solid and shell elements, constraints, attachments.

The parser reads small, large and free fields. It keeps the file's numbers and the constraint sets, and transforms grids
to the basic coordinate system (`coordinates.py`). Elements of property 7 are the group `PID 7`. Grids of SPC and SPC1
with set 3 on components 123 are the group `SPC 3 123`. All grids of set 3, and of sets that an SPCADD 3 names, are `SPC
3`. If the components are along axes of a system 9 of the grid's own (CD), the group is `SPC 3 12 CD 9`.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from casingfem.errors import ModelError, warn
from casingfem.io.arrays import IntArray
from casingfem.io.included import NumberedLine, read_lines
from casingfem.structure.imported.mesh.collapsed import right_handed
from casingfem.structure.imported.readers.bdf_cards import Card, Numbers, cards
from casingfem.structure.imported.readers.coordinates import BY_GRIDS, KINDS_OF_SYSTEMS, CardSystems
from casingfem.structure.imported.readers.draft import Block, Draft, Lookup
from casingfem.structure.imported.readers.nastran import LEFT_OUT, WHOLE, NastranAttachments
from casingfem.structure.imported.readers.nastran_cards import CARDS

SOLIDS = {
    ("CTETRA", 4): "tetra", ("CTETRA", 10): "tetra10", ("CHEXA", 8): "hexahedron", ("CHEXA", 20): "hexahedron20",
    ("CPENTA", 6): "wedge", ("CPENTA", 15): "wedge15", ("CPYRAM", 5): "pyramid", ("CPYRAM", 13): "pyramid13",
}  # fmt: skip
SHELLS = {"CQUAD4": ("quad", 4), "CQUADR": ("quad", 4), "CQUAD8": ("quad8", 8), "CQUAD": ("quad9", 9),
          "CTRIA3": ("triangle", 3), "CTRIAR": ("triangle", 3), "CTRIA6": ("triangle6", 6)}  # fmt: skip
PLACES = {"CTETRA": 10, "CHEXA": 20, "CPENTA": 15, "CPYRAM": 13}
CORNERS = {"CTETRA": 4, "CHEXA": 8, "CPENTA": 6, "CPYRAM": 5, "CQUAD8": 4, "CTRIA6": 3}
WEDGE15 = (*range(9), 12, 13, 14, 9, 10, 11)
BRICK20 = (*range(12), 16, 17, 18, 19, 12, 13, 14, 15)  # upright edges come before the upper ones here
OFFSETS = {"CQUAD4": 7, "CQUADR": 7, "CTRIA3": 6, "CTRIAR": 6, "CQUAD8": 15, "CTRIA6": 9}  # field of ZOFFS
READ = {"GRID", "GRDSET", "SPC", "SPC1", "SPCADD", *PLACES, *SHELLS, *KINDS_OF_SYSTEMS, *BY_GRIDS, *CARDS}


BLANK = [""] * 7  # fields of a GRID, as many as are used


def read_bdf(path: Path) -> Draft:
    """The mesh of a bulk data file.

    Raises
    ------
    ModelError
        If the file is malformed or has unsupported content, with the line.
    """
    return Parser(path.name).read(read_lines(path, READ))


class Parser(Numbers):
    """State of a parser while it reads a file."""

    def __init__(self, source: str) -> None:
        super().__init__(source)
        self.grids: list[tuple[int, float, float, float]] = []
        self.elements: dict[str, list[tuple[int, int, list[int]]]] = {}  # kind -> number, property, nodes
        self.systems = CardSystems(self)
        self.placed: list[tuple[int, int, Card]] = []  # grid by its row, its system, its card
        self.constraints: dict[tuple[str, str], list[int]] = {}  # set, components -> grids
        self.sums: list[Card] = []  # SPCADD
        self.connections = NastranAttachments(self, self.systems)
        self.defaults = BLANK  # fields of GRDSET: system of the place, of the motions, constraints
        self.turned: dict[int, int] = {}  # grid -> coordinate system of its displacements

    def read(self, lines: Sequence[NumberedLine]) -> Draft:
        """Read every card in turn; GRDSET first, since it may be anywhere."""
        if any(line.upper().startswith("GRDSET") for _, line in lines):
            self.defaults = next(([*card.fields, *BLANK] for card in cards(lines) if card.name == "GRDSET"), BLANK)
        takers = {"GRID": self.take_grid, "SPCADD": self.sums.append, "SPC": self.take_constraint}
        takers |= {"SPC1": self.take_constraint} | dict.fromkeys((*PLACES, *SHELLS), self.take_element)
        takers |= dict.fromkeys(KINDS_OF_SYSTEMS, self.systems.take) | dict.fromkeys(CARDS, self.connections.take)
        takers |= dict.fromkeys(BY_GRIDS, self.systems.take_by_grids)
        for card in cards(lines):
            if card.name in takers:
                takers[card.name](card)
            elif LEFT_OUT.match(card.name):
                self.leave_out(card, card.name)
        draft = self.draft()
        if self.left_out:
            found = ", ".join(f"{len(lines)} {name} (from line {lines[0]})" for name, lines in self.left_out.items())
            warn("mesh-left-out", f"{self.source}: {found}", stacklevel=6)
        return draft

    def take_grid(self, card: Card) -> None:
        """Read GRID: number, coordinate system, x, y, z, ..."""
        fields = [cell or default for cell, default in zip([*card.fields, *BLANK], self.defaults, strict=False)]
        if fields[1] not in ("", "0"):
            self.placed.append((len(self.grids), self.integer(card, fields[1]), card))
        if card.room < 5:
            raise self.fault(card, f"found grid {fields[0]} without z, expected it on a second line")
        x, y, z = (self.real(card, text) for text in fields[2:5])
        number = self.integer(card, fields[0])
        self.grids.append((number, x, y, z))
        if fields[5] not in ("", "0"):
            self.turned[number] = self.integer(card, fields[5])
        if fields[6]:
            self.constraints.setdefault(("PS", fields[6]), []).append(number)

    def take_element(self, card: Card) -> None:
        """Read an element: number, property, nodes."""
        places = PLACES.get(card.name) or SHELLS[card.name][1]
        if len(card.fields) < 3:
            raise self.fault(card, f"found {len(card.fields)} fields, expected a number, a property and nodes")
        number = self.integer(card, card.fields[0])
        given = card.fields[2 : 2 + places]
        corners = CORNERS.get(card.name, places)
        beyond = sum(text not in ("", "0") for text in card.fields[2 + places :]) if card.name in PLACES else 0
        if len(given) < corners or not {"", "0"}.isdisjoint(given[:corners]) or beyond:
            count = sum(text not in ("", "0") for text in given) + beyond
            expected = f"expected {corners} corners, then middle nodes or none"
            raise self.fault(card, f"found element {number} with {count} nodes, {expected}")
        middles = sum(text not in ("", "0") for text in given[corners:])
        given = given + [""] * (places - len(given)) if middles else given[:corners]
        kind = SOLIDS[card.name, len(given)] if card.name in PLACES else SHELLS[card.name][0]
        if card.name in SHELLS and not middles:
            kind = kind.rstrip("68")
        if card.name in OFFSETS and self.real(card, (card.fields[OFFSETS[card.name] :] or [""])[0]):
            self.leave_out(card, f"offset (ZOFFS) of {card.name}")
        nodes = [self.integer(card, text or "0") for text in given]
        owner = self.integer(card, card.fields[1] or str(number))
        self.elements.setdefault(kind, []).append((number, owner, nodes))

    def take_constraint(self, card: Card) -> None:
        """Read SPC (set, grid, components, value, ...) or SPC1 (set, components, grids or first THRU last)."""
        fields = card.fields
        if len(fields) < 3 or "" in fields[: 2 if card.name == "SPC1" else 1]:
            raise self.fault(
                card,
                f"found the fields {', '.join(fields) or 'none'}, expected the number of a set, components and grids",
            )
        if card.name == "SPC":
            for k in range(1, len(fields) - 1, 3):
                if fields[k]:
                    grid = self.integer(card, fields[k])
                    self.constraints.setdefault((fields[0], fields[k + 1]), []).append(grid)
            return
        grids = [text for text in fields[2:] if text]
        if len(grids) == 3 and grids[1].upper() == "THRU":
            first, last = self.integer(card, grids[0]), self.integer(card, grids[2])
            members = [grid[0] for grid in self.grids if first <= grid[0] <= last]
        else:
            members = [self.integer(card, text) for text in grids]
        self.constraints.setdefault((fields[0], fields[1]), []).extend(members)

    def draft(self) -> Draft:
        """The draft of the mesh, with numbers replaced by indices."""
        self.systems.place(self.grids, self.placed)
        if not self.grids or not self.elements:
            found = f"{len(self.grids)} grids and no elements"
            raise ModelError("mesh-no-cells", f"{self.source}: found {found}")
        table = np.array(self.grids)
        numbers, points = table[:, 0].astype(np.int64), table[:, 1:]
        nodes = Lookup(numbers, self.source, "grid")
        blocks, sets = list[Block](), dict[str, list[tuple[int, IntArray]]]()
        for kind, rows in self.elements.items():
            table_of = np.array([row[2] for row in rows])
            cells = nodes.some(table_of, table_of != 0)
            if kind in ("hexahedron20", "wedge15"):
                cells = cells[:, BRICK20 if kind == "hexahedron20" else WEDGE15]
            cells = right_handed(kind, cells, points)  # Nastran allows both orientations
            owners = np.array([row[1] for row in rows])
            for owner in np.unique(owners):
                sets.setdefault(f"PID {owner}", []).append((len(blocks), np.flatnonzero(owners == owner)))
            blocks.append(Block(kind, cells, np.array([row[0] for row in rows])))
        Lookup(np.concatenate([b.numbers for b in blocks]), self.source, "element")
        node_sets: dict[str, list[int]] = {}
        for (load_set, components), members in self.constraints.items():
            whole = {int(c) - 1 for c in components if c in "123456"} in WHOLE
            for grid in members:
                own = "" if whole or grid not in self.turned else f" CD {self.turned[grid]}"
                node_sets.setdefault(f"SPC {load_set} {components}{own}", []).append(grid)
            node_sets.setdefault(f"SPC {load_set}", []).extend(members)
        for card in self.sums:
            for part in filter(None, card.fields[1:]):
                for own, members in list(node_sets.items()):
                    if own == f"SPC {part}" or own.startswith(f"SPC {part} "):
                        node_sets.setdefault(own.replace(part, card.fields[0], 1), []).extend(members)
        held = {name: nodes(np.array(members, dtype=np.int64)) for name, members in node_sets.items()}
        attached = self.connections.attachments(points, nodes, self.turned)
        return Draft(
            points=points, node_numbers=numbers, blocks=blocks, node_sets=held, cell_sets=sets, attachments=attached
        )
