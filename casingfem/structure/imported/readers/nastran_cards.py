"""Nastran's cards of attachments, kept until a file is read: their fields, their grids and the places of these."""

from collections.abc import Callable, Mapping

import numpy as np

from casingfem.io.arrays import FloatArray, IntArray
from casingfem.structure.imported.readers.bdf_cards import Card, Numbers
from casingfem.structure.imported.readers.coordinates import CardSystems

CARDS = ("CONM2", "CELAS1", "CELAS2", "PELAS", "CBUSH", "PBUSH", "RBE2", "RBE3", "RBAR", "MPC", "PARAM")


class NastranCards:
    """Cards of a file, in its numbers of grids, until all of it is read."""

    turned: Mapping[int, int]
    points: FloatArray
    index: Callable[[IntArray], IntArray]

    def __init__(self, numbers: Numbers, systems: CardSystems) -> None:
        self.numbers, self.systems = numbers, systems
        self.cards: dict[str, list[Card]] = {name: [] for name in CARDS}

    def take(self, card: Card) -> None:
        """Keep a card."""
        self.cards[card.name].append(card)

    def field(self, card: Card, place: int) -> str:
        """A field, empty beyond the last."""
        return card.fields[place] if place < len(card.fields) else ""

    def where(self, card: Card) -> str:
        """Card, number and line of an item."""
        return f"{card.name} {self.field(card, 0)} (line {card.line})"

    def place(self, grid: int) -> FloatArray:
        """Where a grid stands, (3,)."""
        return np.asarray(self.points[int(self.index(np.array([grid]))[0])])

    def positive(self, card: Card, k: float) -> float:
        """A stiffness."""
        if k <= 0.0:
            raise self.numbers.fault(card, f"found the stiffness {k:g}, expected one above 0")
        return k
