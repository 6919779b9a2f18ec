"""Nastran bulk data for matrices: DMIG cards, the meaning of rows, grids and their axes.

EXTRN, G1, C1, G2, C2, ... or G1, THRU, G2, C   the rows of a superelement's matrices: grids, components; 0 a scalar
GRID, ID, CP, X1, X2, X3, CD                    a position in the system CP, and the system CD of the grid's motions
PARAM, G, g                                     structural damping g of the whole part
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from casingfem.io.arrays import FloatArray, IntArray
from casingfem.io.included import read_lines
from casingfem.structure.imported.matrix.dmig import Dmig
from casingfem.structure.imported.readers.bdf import Parser
from casingfem.structure.imported.readers.bdf_cards import Card, cards
from casingfem.structure.imported.readers.coordinates import BY_GRIDS, KINDS_OF_SYSTEMS

READ = {"GRID", "GRDSET", "EXTRN", "DMIG", "PARAM", *KINDS_OF_SYSTEMS, *BY_GRIDS}


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Bulk:
    """Bulk data of a part: `rows` (n, 2) of EXTRN or None, positions and own axes of grids, PARAM G."""

    source: str
    dmig: Dmig
    rows: IntArray | None = None
    points: Mapping[int, FloatArray] = field(default_factory=dict)
    axes: Mapping[int, FloatArray] = field(default_factory=dict)
    g: float = 0.0

    @property
    def boundary(self) -> tuple[int, ...]:
        """Grids of the EXTRN cards."""
        rows = [] if self.rows is None else self.rows.tolist()
        return tuple(dict.fromkeys(node for node, direction in rows if direction))


def read_bulk(paths: Sequence[Path]) -> Bulk:
    """The cards of all files together, in any order.

    Raises
    ------
    ModelError
        With the line, for cards that cannot be read.
    """
    source = ", ".join(path.name for path in paths)
    parser = Parser(source)
    deck = list(cards_of(paths))
    parser.defaults = next(
        ([*card.fields, *parser.defaults] for card in deck if card.name == "GRDSET"), parser.defaults
    )
    dmig, rows, g = Dmig(parser), list[tuple[int, int]](), 0.0
    named = dict[int, Card]()
    for card in deck:
        if card.name == "GRID":
            parser.take_grid(card)
            named[parser.grids[-1][0]] = card
        elif card.name in KINDS_OF_SYSTEMS:
            parser.systems.take(card)
        elif card.name in BY_GRIDS:
            parser.systems.take_by_grids(card)
        elif card.name == "DMIG":
            dmig.take(card)
        elif card.name == "EXTRN":
            rows += extrn_rows(parser, card)
        elif card.name == "PARAM" and card.fields[:1] == ["G"] and len(card.fields) > 1:
            g = parser.real(card, card.fields[1])
    parser.systems.place(parser.grids, parser.placed)
    points = dict[int, FloatArray]()
    for number, *x in parser.grids:
        if number in points and not np.array_equal(points[number], x):
            raise parser.fault(named[number], f"found grid {number} at two places, expected it once")
        points[number] = np.array(x)
    axes = {n: parser.systems.axes(named[n], system, points[n]) for n, system in parser.turned.items()}
    labels = np.array(rows, dtype=np.int64) if rows else None
    return Bulk(source=source, dmig=dmig, rows=labels, points=points, axes=axes, g=g)


def cards_of(paths: Sequence[Path]) -> Iterator[Card]:
    """The cards of all files; with several files, each line is given together with its file."""
    for path in paths:
        for card in cards(read_lines(path, READ)):
            at = card.line if len(paths) == 1 or " of " in card.line else f"{card.line} of {path.name}"
            yield replace(card, line=at)


def extrn_rows(parser: Parser, card: Card) -> list[tuple[int, int]]:
    """Rows of an EXTRN card, a component each, in its order.

    Raises
    ------
    ModelError
        For a grid without components, or invalid components.
    """
    words = [text for text in card.fields if text]
    rows, at = list[tuple[int, int]](), 0
    while at < len(words):
        first = last = parser.integer(card, words[at])
        if words[at + 1 : at + 2] and words[at + 1].upper() == "THRU":
            last, at = parser.integer(card, (words[at + 2 :] or [""])[0]), at + 2
        components = (words[at + 1 :] or [""])[0]
        if not components or not set(components) <= set("0123456") or last < first:
            raise parser.fault(
                card, f"found grid {first} with components {components!r}, expected such as 123456, or 0"
            )
        rows += [(grid, int(c)) for grid in range(first, last + 1) for c in components]
        at += 2
    return rows
