"""Read the mesh of a universal file (.unv): nodes, elements, groups, the unit of length.

    set                       lines
    2411, 781, 15             label, two systems, colour; x, y, z (set 15: all on one line)
    2412, 780                 label, descriptor, ..., count of nodes; of lines a line on their section; the nodes
    2467, 2477, 2452, 2435    number, ..., count of members; name; type 7 (node) or 8 (element), label, two more, ...
    2432, 2430, 2429, 2417    the same, with type and label alone
    164                       code of the units; by what lengths are divided to be in metres, ...
    2420                      systems of coordinates: only those that are the global one are taken

Nodes of quadratic elements alternate between corners and middles. Descriptor 114 with 13 nodes is a pyramid, as in
Salome. Line elements in groups are edges of shells. Beams outside groups, springs, rigid elements, masses and unknown
sets are skipped with a warning. Responses and shapes are skipped.
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np

from casingfem.errors import ModelError, warn
from casingfem.io.arrays import IntArray
from casingfem.structure.imported.mesh.collapsed import right_handed
from casingfem.structure.imported.readers.draft import Block, Draft, Lookup
from contact.io.infiles import read_loose_text

NODES, ELEMENTS = (2411, 781, 15), (2412, 780)
WIDE, NARROW = (2467, 2477, 2452, 2435), (2432, 2430, 2429, 2417)  # groups: four numbers a member, or two
UNITS, SYSTEMS = 164, 2420
PASSED_OVER = (55, 56, 57, 58, 82, 151, 2414)  # header, lines to draw, responses, shapes
LINES = (11, 21, 22, 23, 24, 25)  # descriptors with a line on their section; 11 a rod, the others beams
MEMBRANES = (71, 74)  # linear; programs disagree on which has three nodes
FACES = {1: "triangle", 2: "triangle6", 4: "quad", 5: "quad8"}  # last digit of plane, plate, membrane, thin shell
KINDS = {10 * family + k: kind for family in (4, 5, 6, 7, 9) for k, kind in FACES.items()} | {
    111: "tetra", 112: "wedge", 113: "wedge15", 114: "pyramid13", 115: "hexahedron", 116: "hexahedron20",
    118: "tetra10",
}  # fmt: skip
NO_VOLUME = 121  # descriptors from here on: rigid elements, springs, dampers, gaps, masses
ORDER = {  # places of the nodes in VTK's order
    "line": (0, 1), "line3": (0, 2, 1), "triangle": (0, 1, 2), "triangle6": (0, 2, 4, 1, 3, 5), "quad": (0, 1, 2, 3),
    "quad8": (0, 2, 4, 6, 1, 3, 5, 7), "tetra": (0, 1, 2, 3), "tetra10": (0, 2, 4, 9, 1, 3, 5, 6, 7, 8),
    "wedge": tuple(range(6)), "wedge15": (0, 2, 4, 9, 11, 13, 1, 3, 5, 10, 12, 14, 6, 7, 8),
    "pyramid13": (0, 2, 4, 6, 12, 1, 3, 5, 7, 8, 9, 10, 11), "hexahedron": tuple(range(8)),
    "hexahedron20": (0, 2, 4, 6, 12, 14, 16, 18, 1, 3, 5, 7, 13, 15, 17, 19, 8, 9, 10, 11),
}  # fmt: skip
OF_NODES, OF_ELEMENTS = 7, 8  # types of members


class DataSet(NamedTuple):
    """One data set: its number, the first line after it (from 0), and its last line."""

    number: int
    start: int
    end: int


@dataclass(slots=True)
class Universal:
    """Contents of the data sets of a file, by label."""

    source: str
    lines: list[str]
    nodes: list[tuple[int, int, float, float, float]] = field(default_factory=list)  # label, system, x, y, z
    elements: dict[str, list[list[int]]] = field(default_factory=dict)  # kind -> label, nodes
    groups: dict[str, tuple[list[int], list[int]]] = field(default_factory=dict)  # name -> nodes, elements
    beams: list[int] = field(default_factory=list)
    elsewhere: set[int] = field(default_factory=set)  # systems that are not the global one
    metre: float = 1.0
    left_out: Counter[str] = field(default_factory=Counter)

    def fault(self, at: int, message: str) -> ModelError:
        """An error about a malformed file; lines count from 0."""
        return ModelError("mesh-file", f"{self.source}: line {at + 1}: {message}")

    def integers(self, at: int, least: int) -> list[int]:
        """The integers of a line, which must have a least count."""
        words = self.lines[at].split()
        try:
            found = [int(word) for word in words]
        except ValueError:
            found = []
        if len(found) < least or any(abs(number) > 2**53 for number in found):
            shown = self.lines[at].strip()[:60]
            raise self.fault(at, f"found {shown!r}, expected at least {least} whole numbers")
        return found

    def reals(self, at: int, words: Sequence[str], count: int) -> list[float]:
        """Numbers with exponents D or E."""
        try:
            found = [float(word.upper().replace("D", "E")) for word in words[:count]]
        except ValueError:
            found = []
        if len(found) < count:
            raise self.fault(at, f"found {self.lines[at].strip()[:60]!r}, expected {count} numbers")
        return found

    def sets(self) -> Iterator[DataSet]:
        """The data sets of the file, each between two lines of -1."""
        at = 0
        while at < len(self.lines):
            if not self.lines[at].strip():
                at += 1
                continue
            if self.lines[at].strip() != "-1":
                raise self.fault(at, f"found {self.lines[at].strip()[:60]!r}, expected -1 at the begin of a set")
            if at + 1 == len(self.lines):
                found = "found the end of the file, expected the number of a set: cut short?"
                raise self.fault(at, found)
            number, end = self.integers(at + 1, 1)[0] if self.lines[at + 1].split()[:1] != ["58b"] else 58, at + 2
            while end < len(self.lines) and self.lines[end].strip() != "-1":
                end += 1
            if end == len(self.lines):
                found = f"found set {number} without -1 at its end: cut short?"
                raise self.fault(at + 1, found)
            yield DataSet(number, at + 2, end)
            at = end + 1

    def take(self, one: DataSet) -> None:
        """Read the contents of a data set."""
        if one.number in NODES:
            self.take_nodes(one)
        elif one.number in ELEMENTS:
            self.take_elements(one)
        elif one.number in WIDE + NARROW:
            self.take_groups(one)
        elif one.number == UNITS:
            self.take_units(one)
        elif one.number == SYSTEMS:
            self.take_systems(one)
        elif one.number not in PASSED_OVER:
            self.left_out[f"set {one.number}"] += 1

    def inside(self, at: int, one: DataSet, what: str) -> None:
        """Refuse to read a line after the end of a data set."""
        if at >= one.end:
            raise self.fault(one.end, f"found the end of set {one.number} within {what}, expected more lines")

    def take_nodes(self, one: DataSet) -> None:
        """Read nodes: one line each in set 15, two in the others."""
        at, step = one.start, 1 if one.number == 15 else 2
        while at < one.end:
            self.inside(at + step - 1, one, "a node")
            words = self.lines[at].split()
            label, system = (int(x) for x in self.integers(at, 4)[:2]) if step == 2 else self.label_of(at, words)
            place = words[4:] if step == 1 else self.lines[at + 1].split()
            x, y, z = self.reals(at + step - 1, place, 3)
            self.nodes.append((label, system, x, y, z))
            at += step

    def label_of(self, at: int, words: list[str]) -> tuple[int, int]:
        """Label and system of a node of set 15."""
        if len(words) < 7 or not all(word.lstrip("-").isdigit() for word in words[:4]):
            raise self.fault(at, f"found {self.lines[at].strip()[:60]!r}, expected four whole numbers and x, y, z")
        return int(words[0]), int(words[1])

    def take_elements(self, one: DataSet) -> None:
        """Read elements: two lines each, three for line elements, and more if the nodes need them."""
        at = one.start
        while at < one.end:
            facts = self.integers(at, 6)
            label, descriptor, count = facts[0], facts[1], facts[-1] if one.number == 780 else facts[5]
            first, at = at, at + (2 if descriptor in LINES else 1)
            nodes: list[int] = []
            while len(nodes) < count:
                self.inside(at, one, f"element {label}")
                nodes += self.integers(at, 1)
                at += 1
            self.keep(first, label, descriptor, nodes)

    def keep(self, at: int, label: int, descriptor: int, nodes: list[int]) -> None:
        """Add one element by its kind; elements without volume are skipped."""
        kind = KINDS.get(descriptor, "")
        if descriptor in LINES:
            kind = "line3" if len(nodes) == 3 else "line"
            if descriptor > LINES[0]:
                self.beams.append(label)
        elif descriptor in MEMBRANES:
            kind = "triangle" if len(nodes) == 3 else "quad"
        if not kind and descriptor >= NO_VOLUME:
            self.left_out[f"element with descriptor {descriptor}"] += 1
            return
        if not kind:
            found = f"line {at + 1}: found element {label} with descriptor {descriptor}"
            raise ModelError("mesh-unsupported-cell", f"{self.source}: {found}")
        if len(nodes) != len(ORDER[kind]):
            found = f"found element {label} with {len(nodes)} nodes"
            raise self.fault(at, f"{found}, expected {len(ORDER[kind])} for descriptor {descriptor}")
        self.elements.setdefault(kind, []).append([label, *(nodes[k] for k in ORDER[kind])])

    def take_groups(self, one: DataSet) -> None:
        """Read groups: header, name, members."""
        at, width = one.start, 4 if one.number in WIDE else 2
        while at < one.end:
            count = self.integers(at, 8)[7]
            self.inside(at + 1, one, "a group")
            name = self.lines[at + 1].strip() or f"group {self.integers(at, 8)[0]}"
            nodes, elements = self.groups.setdefault(name, ([], []))
            at += 2
            members: list[int] = []
            while len(members) < width * count:
                self.inside(at, one, f"group {name!r}")
                members += self.integers(at, width)
                at += 1
            for kind, label in zip(members[0 : width * count : width], members[1 : width * count : width], strict=True):
                if kind in (OF_NODES, OF_ELEMENTS):
                    (nodes if kind == OF_NODES else elements).append(label)
                else:
                    self.left_out[f"member of type {kind} of group {name!r}"] += 1

    def take_units(self, one: DataSet) -> None:
        """Read the divisor of lengths."""
        self.inside(one.start + 1, one, "the units")
        (factor,) = self.reals(one.start + 1, self.lines[one.start + 1].split(), 1)
        if not (np.isfinite(factor) and factor > 0.0):
            raise self.fault(one.start + 1, f"found {factor:g} as the factor of lengths, expected a number above 0")
        self.metre = 1.0 / factor

    def take_systems(self, one: DataSet) -> None:
        """Read coordinate systems; systems other than the global one are recorded."""
        at = one.start + 2
        while at < one.end:
            self.inside(at + 5, one, "a system of coordinates")
            label, kind = self.integers(at, 2)[:2]
            rows = np.array([self.reals(k, self.lines[k].split(), 3) for k in range(at + 2, at + 6)])
            if kind or not np.allclose(rows, np.vstack([np.eye(3), np.zeros(3)]), atol=1e-12):
                self.elsewhere.add(label)
            at += 6

    def draft(self) -> Draft:
        """The draft of the mesh, with labels replaced by indices."""
        if not self.nodes or not self.elements:
            raise ModelError("mesh-no-cells", f"{self.source}: found {len(self.nodes)} nodes and no elements")
        moved = [label for label, system, *_ in self.nodes if system in self.elsewhere]
        if moved:
            found = f"found {len(moved)} nodes in local coordinate systems, the first {moved[0]}"
            raise ModelError("mesh-file", f"{self.source}: {found}, expected all nodes in the global system")
        numbers = np.array([node[0] for node in self.nodes], dtype=np.int64)
        points = np.array([node[2:] for node in self.nodes])
        nodes = Lookup(numbers, self.source, "node")
        blocks = []
        for kind, rows in self.elements.items():
            table = np.array(rows, dtype=np.int64)
            blocks.append(Block(kind, right_handed(kind, nodes(table[:, 1:]), points), table[:, 0]))
        labels = np.concatenate([block.numbers for block in blocks])
        elements = Lookup(labels, self.source, "element")
        first = np.cumsum([0, *(len(block.numbers) for block in blocks)])
        grouped = {label for _, members in self.groups.values() for label in members}
        if alone := [label for label in self.beams if label not in grouped]:
            self.left_out["beam in no group"] += len(alone)
        cell_sets: dict[str, list[tuple[int, IntArray]]] = {}
        for name, (_, members) in self.groups.items():
            places = elements(np.array(members, dtype=np.int64)) if members else np.zeros(0, dtype=np.int64)
            owner = np.searchsorted(first, places, side="right") - 1
            cell_sets[name] = [(int(k), places[owner == k] - first[k]) for k in np.unique(owner)]
        held = {name: nodes(np.array(members, dtype=np.int64)) for name, (members, _) in self.groups.items() if members}
        return Draft(
            points=points, node_numbers=numbers, blocks=blocks, node_sets=held, cell_sets=cell_sets, metre=self.metre
        )


def read_unv(path: Path) -> Draft:
    """The mesh of a universal file.

    Raises
    ------
    ModelError
        If the file is malformed, truncated, or has unsupported content, with the line.
    """
    content = Universal(path.name, read_loose_text(path).splitlines())
    for one in content.sets():
        content.take(one)
    draft = content.draft()
    if content.left_out:
        found = ", ".join(f"{count} {what}" for what, count in content.left_out.items())
        warn("mesh-left-out", f"{path.name}: {found}", stacklevel=5)
    return draft
