"""Universal files of test and simulation software: `read_uff(path)`.

The data sets 15, 55, 58, 58b, 82, 151, 164, 781, 2411, 2412 are read; others are listed as skipped, or refused on
request. Data are complete: points are counted and compared with headers, columns are checked, and references between
sets are followed. This reader exists because pyuff 2.5 returns fewer points or none for many damaged files.
"""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from casingfem.errors import warn
from casingfem.experiment.uff.nodes import (
    Elements,
    Nodes,
    TraceLine,
    Units,
    read_elements,
    read_header,
    read_nodes,
    read_trace_line,
    read_units,
)
from casingfem.experiment.uff.set_55 import Shape, read_shape
from casingfem.experiment.uff.set_58 import Function, FunctionHeader, read_function, read_function_header
from casingfem.experiment.uff.split import KINDS, RawSet, split
from casingfem.io.arrays import IntArray
from contact.io.infiles import read_bytes

SAME = 1e-5  # two sets name one node: coordinates equal to this part of the structure's size
FEW = 4  # numbers left out are doubted where they are fewer than a quarter of those there
_SYSTEMS = ("18", "2420")


class Skipped(NamedTuple):
    """A data set that was not read: number, kind, line."""

    number: str
    kind: str
    line: int


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class UniversalFile:
    """Contents of a universal file. Points are in metres; shapes and functions in the units that the file names.

    >>> UniversalFile(path="test.uff").functions
    ()
    """

    path: str
    header: tuple[str, ...] = ()
    units: Units | None = None
    nodes: Nodes | None = None
    elements: Elements | None = None
    lines: tuple[TraceLine, ...] = ()
    shapes: tuple[Shape, ...] = ()
    functions: tuple[Function, ...] = ()
    skipped: tuple[Skipped, ...] = ()

    def __repr__(self) -> str:
        return f"UniversalFile({self.path}: {self.contents})"

    @property
    def contents(self) -> str:
        """A line that lists the contents of the file."""
        parts = [f"{len(self.nodes.labels)} nodes"] if self.nodes is not None else []
        parts += [f"{len(self.elements.labels)} elements"] if self.elements is not None else []
        for what, items in (("trace lines", self.lines), ("shapes", self.shapes), ("functions", self.functions)):
            parts += [f"{len(items)} {what}"] if items else []
        for (number, kind), often in Counter((each.number, each.kind) for each in self.skipped).items():
            parts.append(f"{often} set{'s'[: often > 1]} {number} ({kind}) skipped")
        return ", ".join(parts) or "no set of a kind that this reader supports"


def read_uff(path: str | os.PathLike[str], *, strict: bool = False) -> UniversalFile:
    """Read a universal file with every data set complete, or refuse it.

    Parameters
    ----------
    path
        The file, with text or binary functions, UTF-8 or Latin-1, and any line ends.
    strict
        Refuse sets that are not read, instead of listing them in `skipped`.

    Raises
    ------
    InputError
        A data set deviates from its format or header; the message has set, line, finding and expectation.
    FileNotFoundError
        The file does not exist.

    Warns
    -----
    ModelWarning
        `uff-gap`, `uff-local`, `uff-shapes`, `uff-unknown`: data seem incomplete, although the format has no count for
        them. `uff-bytes`, `uff-empty`, `uff-end`: binary data have another length than stated, a set is empty, the
        closing -1 is missing.

    Examples
    --------
    >>> import tempfile
    >>> import casingfem as cf
    >>> nodes = cf.uff.Nodes(labels=np.array([1, 2]), points=np.eye(3)[:2], systems=np.zeros(2), motions=np.zeros(2))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     cf.uff.read_uff(cf.uff.write_uff(f"{folder}/two.uff", nodes=nodes)).nodes
    Nodes(2, 1 to 2)
    """
    return parse_uff(read_bytes(path), str(path), strict=strict)


def read_headers(path: str | os.PathLike[str]) -> tuple[FunctionHeader, ...]:
    """Headers of the functions of a universal file, including functions whose numbers are truncated.

    Raises
    ------
    InputError
        A header deviates from its format.
    FileNotFoundError
        The file does not exist.

    Examples
    --------
    >>> import tempfile
    >>> import casingfem as cf
    >>> one = cf.frf.FrfSet.from_arrays(kind="frf", x=[10.0, 20.0], responses=[1.0, 2.0j], unit="m/N")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     heads = read_headers(cf.uff.write_uff(f"{folder}/test.uff", functions=one.functions()))
    >>> [head.points for head in heads]
    [2]
    """
    sets = split(read_bytes(path), str(path))
    return tuple(read_function_header(raw) for raw in sets if raw.number in ("58", "58b"))


def parse_uff(data: bytes, path: str, *, strict: bool = False) -> UniversalFile:
    """Read a universal file from its bytes; ``path`` is only used in messages."""
    found = _Found()
    sets = split(data, path)
    for raw in sets:
        _read_set(raw, found, strict)
    nodes = _merged_nodes(found.nodes)
    elements = _merged_elements(found.elements)
    _check_references(found, nodes)
    _warn(path, found, nodes, elements)
    _warn_of_bytes(path, sets)
    return UniversalFile(
        path=path,
        header=found.header,
        units=found.units,
        nodes=nodes,
        elements=elements,
        lines=tuple(part for _, part in found.lines),
        shapes=tuple(part for _, part in found.shapes),
        functions=tuple(found.functions),
        skipped=tuple(found.skipped),
    )


@dataclass(slots=True)
class _Found:
    """Data read so far, each with its data set."""

    header: tuple[str, ...] = ()
    units: Units | None = None
    nodes: list[tuple[RawSet, Nodes]] = field(default_factory=list)
    elements: list[tuple[RawSet, Elements]] = field(default_factory=list)
    lines: list[tuple[RawSet, TraceLine]] = field(default_factory=list)
    shapes: list[tuple[RawSet, Shape]] = field(default_factory=list)
    functions: list[Function] = field(default_factory=list)
    skipped: list[Skipped] = field(default_factory=list)


def _read_set(raw: RawSet, found: _Found, strict: bool) -> None:
    match raw.number:
        case "151":
            found.header = read_header(raw)
        case "164":
            found.units = read_units(raw)
        case "15" | "781" | "2411":
            found.nodes.append((raw, read_nodes(raw, found.units or Units())))
        case "82":
            found.lines.append((raw, read_trace_line(raw)))
        case "2412":
            found.elements.append((raw, read_elements(raw)))
        case "55":
            found.shapes.append((raw, read_shape(raw)))
        case "58" | "58b":
            found.functions.append(read_function(raw))
        case _ if strict:
            raise raw.error(-1, "a set of another kind", "one of 15, 55, 58, 58b, 82, 151, 164, 781, 2411, 2412")
        case _:
            if raw.number not in KINDS:
                warn("uff-unknown", f"{raw.path}, line {raw.first - 1}: set {raw.number}", stacklevel=5)
            found.skipped.append(Skipped(raw.number, KINDS.get(raw.number, "unknown"), raw.first - 1))


def _merged_nodes(parts: Sequence[tuple[RawSet, Nodes]]) -> Nodes | None:
    """All nodes of a file; a node in two sets must have one position, of which the more precise is used."""
    if not parts:
        return None
    ordered = sorted(parts, key=lambda part: part[0].number == "15")  # stable: sets with all digits first
    merged = {
        name: np.concatenate([getattr(nodes, name) for _, nodes in ordered])
        for name in ("labels", "points", "systems", "motions")
    }
    _, first, which = np.unique(merged["labels"], return_index=True, return_inverse=True)
    points = merged["points"]
    apart = np.abs(points - points[first][which]).max(axis=1) > SAME * np.ptp(points, axis=0).max()
    if apart.any():
        label = int(merged["labels"][apart][0])
        raw = next(raw for raw, nodes in reversed(ordered) if label in nodes.labels)
        raise raw.error(0, f"node {label} at another place than in the set before", "one place for every node")
    kept = np.sort(first)
    return Nodes(**{name: values[kept] for name, values in merged.items()})


def _merged_elements(parts: Sequence[tuple[RawSet, Elements]]) -> Elements | None:
    """All elements of a file; each label may occur in only one set."""
    if not parts:
        return None
    seen: set[int] = set()
    for raw, elements in parts:
        repeated = seen & set(elements.labels.tolist())
        if repeated:
            raise raw.error(0, f"element {min(repeated)} again", "labels that differ from those of the sets before")
        seen |= set(elements.labels.tolist())
    arrays: dict[str, Any] = {
        name: np.concatenate([getattr(elements, name) for _, elements in parts])
        for name in ("labels", "kinds", "properties", "beams")
    }
    return Elements(**arrays, nodes=tuple(row for _, elements in parts for row in elements.nodes))


def _check_references(found: _Found, nodes: Nodes | None) -> None:
    """Refuse lines, elements and shapes at nodes that the file does not define, if it defines any."""
    if nodes is None:
        return
    users: Iterable[tuple[RawSet, IntArray]] = (
        *((raw, line.nodes[line.nodes > 0]) for raw, line in found.lines),
        *((raw, np.concatenate(elements.nodes)) for raw, elements in found.elements),
        *((raw, shape.nodes) for raw, shape in found.shapes),
    )
    for raw, used in users:
        missing = np.setdiff1d(used, nodes.labels)
        if missing.size:
            what = f"node {missing[0]}" + (f" and {missing.size - 1} more" if missing.size > 1 else "")
            raise raw.error(0, f"{what}, not among the nodes of the file", "nodes of the file's sets 15, 781 or 2411")


def _warn(path: str, found: _Found, nodes: Nodes | None, elements: Elements | None) -> None:
    """Warn of data that seem incomplete where the format contains no count."""
    for what, labels in (("nodes", nodes), ("elements", elements)):
        gaps = few_gaps(labels.labels) if labels is not None else np.empty(0)
        if gaps.size:
            first = ", ".join(map(str, gaps[:5].tolist())) + f" and {gaps.size - 5} more" * (gaps.size > 5)
            warn("uff-gap", f"{path}: {what} {first} missing in the numbering", stacklevel=5)
    if nodes is not None and nodes.systems.any() and any(number in _SYSTEMS for number, _, _ in found.skipped):
        message = f"{path}: {np.count_nonzero(nodes.systems)} nodes in coordinate systems of the file"
        warn("uff-local", message, stacklevel=5)
    lists = {tuple(np.sort(shape.nodes).tolist()): shape.nodes.size for _, shape in found.shapes}
    if len(lists) > 1:
        counts = sorted(lists.values())
        warn(
            "uff-shapes",
            f"{path}: shapes at {counts[0]} to {counts[-1]} nodes, expected the same nodes for all",
            stacklevel=5,
        )


def _warn_of_bytes(path: str, sets: Iterable[RawSet]) -> None:
    """Warn once of all binary functions whose first line states another number of bytes than they have."""
    wrong = [raw for raw in sets if raw.binary is not None and raw.binary.size != len(raw.payload)]
    if wrong:
        first, size = wrong[0], 0 if wrong[0].binary is None else wrong[0].binary.size
        more = f", and {len(wrong) - 1} more such sets" if len(wrong) > 1 else ""
        found = f"found {len(first.payload)} bytes of data, expected {size} as line {first.first - 1} states{more}"
        warn("uff-bytes", f"{path}, {first.name}: {found}", stacklevel=5)


def few_gaps(labels: IntArray) -> IntArray:
    """Numbers that are missing in a consecutive count, if fewer than a quarter are missing; else none.

    The count begins at 1 if the lowest number is near it, else at the lowest number.

    >>> few_gaps(np.array([1, 2, 3, 5, 6])).tolist(), few_gaps(np.array([101, 102, 201, 202])).tolist()
    ([4], [])
    """
    low, high, room = int(labels.min()), int(labels.max()), labels.size / FEW
    start = 1 if low - 1 < room else low
    if high - start + 1 - labels.size >= room:
        return np.empty(0, np.int64)
    return np.setdiff1d(np.arange(start, high + 1), labels)
