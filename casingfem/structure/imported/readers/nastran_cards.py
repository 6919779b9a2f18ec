"""Nastran's cards of attachments, collected until the file is read, and the springs of CBUSH with PBUSH.

A CBUSH has six springs at a place between two grids, or from one to the ground.

The springs are at A + S (B - A), S = 1/2 if left out, and reach the grids by rigid arms r: along a direction a

    k/2 (a.(u_A + theta_A x r_A) - a.(u_B + theta_B x r_B))^2,   a.(theta x r) = theta.(r x a)

Directions are those of the system CID at A; without one x points from A to B, and z along x times the orientation
vector (MSC Nastran Quick Reference Guide).
"""

from collections.abc import Callable, Mapping

import numpy as np

from casingfem.io.arrays import FloatArray, IntArray
from casingfem.structure.imported.mesh.attachments import Spring, Term
from casingfem.structure.imported.readers.bdf_cards import Card, Numbers
from casingfem.structure.imported.readers.coordinates import CardSystems

CARDS = ("CONM2", "CELAS1", "CELAS2", "PELAS", "CBUSH", "PBUSH", "RBE2", "RBE3", "RBAR", "MPC", "PARAM")


class NastranCards:
    """Cards of a file, with its numbers of grids, collected until the whole file is read."""

    turned: Mapping[int, int]
    points: FloatArray
    index: Callable[[IntArray], IntArray]

    def __init__(self, numbers: Numbers, systems: CardSystems) -> None:
        self.numbers, self.systems = numbers, systems
        self.cards: dict[str, list[Card]] = {name: [] for name in CARDS}

    def take(self, card: Card) -> None:
        """Add a card."""
        self.cards[card.name].append(card)

    def field(self, card: Card, place: int) -> str:
        """A field; empty beyond the last field."""
        return card.fields[place] if place < len(card.fields) else ""

    def where(self, card: Card) -> str:
        """Card, number and line of an item, for messages."""
        return f"{card.name} {self.field(card, 0)} (line {card.line})"

    def place(self, grid: int) -> FloatArray:
        """Position of a grid, (3,)."""
        return np.asarray(self.points[int(self.index(np.array([grid]))[0])])

    def positive(self, card: Card, k: float) -> float:
        """A stiffness, which must be positive."""
        if k <= 0.0:
            raise self.numbers.fault(card, f"found the stiffness {k:g}, expected one above 0")
        return k


SMALL = 1e-12  # of the size of an arm, and of one: what is round-off


def bush_springs(given: NastranCards, card: Card) -> list[Spring]:
    """CBUSH: number, property, grids A and B, orientation, system, S, system of an offset, offset."""
    of = {given.field(p, 0): p for p in given.cards["PBUSH"]}.get(given.field(card, 1))
    if of is None:
        raise given.numbers.fault(card, f"found the property {given.field(card, 1)} without a PBUSH card, expected one")
    named = [text.upper() for text in of.fields]
    start = named.index("K") + 1 if "K" in named else len(named)
    k = np.zeros(6)
    for c, text in enumerate(of.fields[start : start + 6]):
        if text and given.numbers.real(of, text):
            k[c] = given.positive(of, given.numbers.real(of, text))
    if given.field(card, 9) not in ("", "-1"):
        raise given.numbers.fault(card, f"found an offset in system {given.field(card, 9)} (OCID), expected none")
    grids = [given.numbers.integer(card, text) for text in card.fields[2:4] if text]
    places = [given.place(grid) for grid in grids]
    axes = directions(given, card, grids, places, k)
    at = places[0] + given.numbers.real(card, given.field(card, 8) or "0.5") * (places[-1] - places[0])
    springs = []
    for c in np.flatnonzero(k).tolist():
        ends = zip(grids, places, (1.0, -1.0), strict=False)
        terms = tuple(term for grid, x, sign in ends for term in moved(grid, at - x, axes[c % 3], c > 2, sign))
        springs.append(Spring(terms=terms, stiffness=float(k[c]), where=given.where(card)))
    return springs


def moved(grid: int, arm: FloatArray, along: FloatArray, turning: bool, sign: float) -> list[Term]:
    """Motion along a direction at the end of a grid's arm, or the grid's rotation about the direction."""
    turn = along if turning else np.cross(arm, along)
    turn = np.where(np.abs(turn) > SMALL * (1.0 if turning else np.linalg.norm(arm)), turn, 0.0)
    terms = [] if turning else [Term(grid, c, sign * float(along[c])) for c in range(3) if abs(along[c]) > SMALL]
    return terms + [Term(grid, 3 + c, sign * float(turn[c])) for c in range(3) if turn[c]]


def directions(
    given: NastranCards, card: Card, grids: list[int], places: list[FloatArray], k: FloatArray
) -> FloatArray:
    """Axes of the springs, rows (3, 3)."""
    if system := given.field(card, 7):
        return given.systems.axes(card, given.numbers.integer(card, system), places[0])
    x = places[-1] - places[0]
    if not np.linalg.norm(x) > 0.0:
        raise given.numbers.fault(
            card, "found coincident grids, or one grid, and no coordinate system, expected the number of one (CID)"
        )
    x = x / np.linalg.norm(x)
    if not k[[1, 2, 4, 5]].any():  # along the line alone
        return np.array([x, x, x])
    first, *others = (given.field(card, place) for place in (4, 5, 6))
    if not first:
        raise given.numbers.fault(
            card,
            "found stiffness across the line between its grids and no orientation, expected a vector, G0 or CID",
        )
    if any(others) or not first.isdecimal():
        v = np.array([given.numbers.real(card, text) for text in (first, *others)])
        if grids[0] in given.turned:
            v = v @ given.systems.axes(card, given.turned[grids[0]], places[0])
    else:
        v = given.place(given.numbers.integer(card, first)) - places[0]
    z = np.cross(x, v)
    if not np.linalg.norm(z) > SMALL * np.linalg.norm(v):
        raise given.numbers.fault(card, "found an orientation along the line of its grids, expected one across it")
    z /= np.linalg.norm(z)
    return np.array([x, np.cross(z, x), z])
