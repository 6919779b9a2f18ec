"""Geometry of universal files: units (164), nodes (15, 2411), trace lines (82), elements (2412), header (151)."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from casingfem.experiment.uff.numbers import Columns, check_end, check_lines, integers, reals, series
from casingfem.experiment.uff.split import RawSet
from casingfem.io.arrays import FloatArray, IntArray, freeze, frozen

BEAMS = (11, 21, 22, 23, 24)  # descriptors of elements with a line about their orientation
HEADER_LINES = 7
# nodes of elements by descriptor: beams, plane stress and strain, thin shells, solids; others have what they state
NODES_OF = {
    **{11: 2, 21: 2, 22: 2},
    **{41: 3, 42: 6, 44: 4, 45: 8, 51: 3, 52: 6, 54: 4, 55: 8},
    **{91: 3, 92: 6, 94: 4, 95: 8, 111: 4, 112: 6, 113: 15, 115: 8, 116: 20, 118: 10},
}


class Units(NamedTuple):
    """Divisors that convert a file's numbers to SI units, and the file's name for its units.

    >>> Units(code=9, name="mm (milli newton)", length=1000.0, force=1000.0).length
    1000.0
    """

    code: int = 1
    name: str = "SI: Meter (newton)"
    length: float = 1.0
    force: float = 1.0
    temperature: float = 1.0
    temperature_offset: float = 273.15


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Nodes:
    """Nodes: labels (nodes,), points [m] (nodes, 3), coordinate systems of positions and of motions.

    >>> import numpy as np
    >>> zeros = np.zeros((2, 3), dtype=int)
    >>> found = Nodes(labels=np.array([1, 2]), points=np.eye(3)[:2], systems=zeros[:, :1], motions=zeros[:, :1])
    >>> found.labels.tolist()
    [1, 2]
    """

    labels: IntArray
    points: FloatArray
    systems: IntArray
    motions: IntArray

    def __post_init__(self) -> None:
        freeze(self, "labels", "points", "systems", "motions")

    def __repr__(self) -> str:
        return f"Nodes({len(self.labels)}, {self.labels.min()} to {self.labels.max()})"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TraceLine:
    """A polyline through nodes; 0 starts a new line.

    >>> import numpy as np
    >>> TraceLine(number=1, name="rim", color=7, nodes=np.array([1, 2, 3, 1])).nodes.size
    4
    """

    number: int
    name: str
    color: int
    nodes: IntArray

    def __post_init__(self) -> None:
        freeze(self, "nodes")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Elements:
    """Elements: labels and descriptors (elements,), property, material and colour (elements, 3), their nodes.

    `beams` contains the orientation node and the two cross-sections of beams, zeros elsewhere, (elements, 3).

    >>> import numpy as np
    >>> found = Elements(labels=np.array([1]), kinds=np.array([94]), properties=np.zeros((1, 3), dtype=int),
    ...                  beams=np.zeros((1, 3), dtype=int), nodes=(np.array([1, 2, 3, 4]),))
    >>> found.nodes[0].tolist()
    [1, 2, 3, 4]
    """

    labels: IntArray
    kinds: IntArray
    properties: IntArray
    beams: IntArray
    nodes: tuple[IntArray, ...]

    def __post_init__(self) -> None:
        freeze(self, "labels", "kinds", "properties", "beams")
        object.__setattr__(self, "nodes", tuple(frozen(row) for row in self.nodes))

    def __repr__(self) -> str:
        return f"Elements({len(self.labels)})"


def read_header(raw: RawSet) -> tuple[str, ...]:
    """Read data set 151: seven lines of text."""
    check_lines(raw, 0, HEADER_LINES, "text")
    check_end(raw, HEADER_LINES, f"{HEADER_LINES} lines of text")
    return tuple(line.rstrip() for line in raw.lines[:HEADER_LINES])


def read_units(raw: RawSet) -> Units:
    """Read data set 164: I10, 20A1 (and a temperature mode, ignored here); three factors and an offset in D25.17."""
    check_lines(raw, 0, 3, "units")
    check_end(raw, 3, "four numbers")
    line = raw.lines[0]
    code = int(integers(raw, [0], Columns(0, 10, 1), last=False)[0, 0])
    length, force, temperature, offset = series(raw, 1, 4, Columns(0, 25, 3), reals, "units").tolist()
    if min(length, force, temperature) <= 0.0:
        raise raw.error(1, f"the factors {length:g}, {force:g}, {temperature:g}", "factors above 0")
    return Units(code, line[10:30].strip(), length, force, temperature, offset)


def read_nodes(raw: RawSet, units: Units) -> Nodes:
    """Read data set 15 (4I10, 3E13.5), or 2411 and 781 (4I10, then 3D25.16 on a separate line)."""
    lines = _filled_lines(raw)
    if raw.number == "15":
        heads = rows = range(lines)
        at, last = Columns(40, 13, 3), False
    else:
        if lines % 2:
            raise raw.error(lines, "a node without coordinates", "two lines for every node")
        heads, rows = range(0, lines, 2), range(1, lines, 2)
        at, last = Columns(0, 25, 3), True
    numbers = integers(raw, heads, Columns(0, 10, 4), last=last)
    points = reals(raw, rows, at) / units.length
    _check_labels(raw, numbers[:, 0], heads)
    return Nodes(labels=numbers[:, 0], points=points, systems=numbers[:, 1], motions=numbers[:, 2])


def read_trace_line(raw: RawSet) -> TraceLine:
    """Read data set 82: number, count, colour (3I10); name; nodes (8I10), as many as the count.

    Zeros may fill the last line.
    """
    check_lines(raw, 0, 2, "header")
    number, count, color = integers(raw, [0], Columns(0, 10, 3))[0].tolist()
    if count < 1:
        raise raw.error(0, f"{count} nodes", "1 or more")
    lines = -(-count // 8)
    check_lines(raw, 2, lines, f"{count} nodes")
    check_end(raw, 2 + lines, f"{count} nodes")
    on_last = -(-len(raw.lines[1 + lines].rstrip()) // 10)
    whole = max(count, 8 * (lines - 1) + min(on_last, 8))
    nodes = series(raw, 2, whole, Columns(0, 10, 8), integers, f"{count} nodes")
    if np.any(nodes[count:] != 0):
        raise raw.error(1 + lines, f"nodes beyond the {count} of the header", "blanks or zeros there")
    if np.any(nodes < 0):
        index = int(np.argmax(nodes < 0))
        raise raw.error(2 + index // 8, f"node {nodes[index]}", "nodes from 1, or 0 for a gap in the line")
    return TraceLine(number=number, name=raw.lines[1].strip(), color=color, nodes=nodes[:count])


def read_elements(raw: RawSet) -> Elements:
    """Read data set 2412: label, descriptor, property, material, colour, count (6I10); beams (3I10); nodes (8I10)."""
    lines = _filled_lines(raw)
    heads: list[int] = []
    row = 0
    while row < lines:
        _, kind, *_, count = integers(raw, [row], Columns(0, 10, 6))[0].tolist()
        if count < 1 or NODES_OF.get(kind, count) != count:
            raise raw.error(row, f"{count} nodes", f"{NODES_OF.get(kind, '1 or more')} for descriptor {kind}")
        heads.append(row)
        row += 1 + (kind in BEAMS) - (-count // 8)
    check_lines(raw, 0, row, "elements")
    numbers = integers(raw, heads, Columns(0, 10, 6))
    beams = np.zeros((len(heads), 3), np.int64)
    nodes = []
    for k, (head, kind, count) in enumerate(zip(heads, numbers[:, 1], numbers[:, 5], strict=True)):
        if kind in BEAMS:
            beams[k] = integers(raw, [head + 1], Columns(0, 10, 3))
        at = head + 1 + (kind in BEAMS)
        nodes.append(series(raw, at, int(count), Columns(0, 10, 8), integers, f"{count} nodes"))
        if nodes[-1].min() < 1:
            raise raw.error(at, f"node {nodes[-1].min()}", "nodes from 1")
    _check_labels(raw, numbers[:, 0], heads)
    return Elements(
        labels=numbers[:, 0], kinds=numbers[:, 1], properties=numbers[:, 2:5], beams=beams, nodes=tuple(nodes)
    )


def _filled_lines(raw: RawSet) -> int:
    """Number of lines up to the last nonblank one; a set without any is refused."""
    filled = [k for k, line in enumerate(raw.lines) if line.strip()]
    if not filled:
        raise raw.error(0, "an empty set", "at least one entry")
    return filled[-1] + 1


def _check_labels(raw: RawSet, labels: IntArray, rows: range | list[int]) -> None:
    """Refuse labels that are not numbers from 1, or that repeat."""
    first = np.zeros(labels.size, bool)
    first[np.unique(labels, return_index=True)[1]] = True
    bad = ~first | (labels < 1)
    if bad.any():
        index = int(np.argmax(bad))
        found = f"{labels[index]}" + (" again" if labels[index] >= 1 else "")
        raise raw.error(rows[index], f"label {found}", "labels from 1, each used once")
