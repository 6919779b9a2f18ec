"""Keywords of an Abaqus or CalculiX input file with their data, parts and instances laid out flat.

Each card is returned with the shift of its numbers, the prefix of its names, and the motion of its nodes.

Abaqus moves an instance by its translation, then turns it by an angle [deg] about an axis from a to b:

    *INSTANCE, NAME=I, PART=P
    dx, dy, dz
    ax, ay, az, bx, by, bz, angle

One instance keeps the numbers and names of its part. With several instances, the numbers of the k-th (from 0) are
shifted by k times a power of ten larger than all numbers. Its sets are called `I.set`, as in Abaqus.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import FloatArray
from casingfem.io.included import NumberedLine


@dataclass(slots=True)
class Card:
    """One keyword: its line, parameters and data lines with their line numbers."""

    line: str
    keyword: str
    parameters: dict[str, str]
    data: list[tuple[str, str]] = field(default_factory=list)


def cards(lines: Iterable[NumberedLine]) -> Iterator[Card]:
    """Keywords with their data, without comments and empty lines; continued keyword lines are joined."""
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


DIGITS = 15  # of numbers that a mesh has: beyond, a float does not distinguish them
MOST = 10.0**DIGITS


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """Context of a card.

    Attributes
    ----------
    offset
        Shift of the numbers of its nodes and elements.
    prefix
        Prefix of the names of sets to which it refers, and of sets that it defines if `owns` is true.
    turn, shift
        Motion of its nodes: turn @ x + shift.
    """

    offset: int = 0
    prefix: str = ""
    owns: bool = True
    turn: FloatArray = field(default_factory=lambda: np.eye(3))
    shift: FloatArray = field(default_factory=lambda: np.zeros(3))

    def moved(self, x: FloatArray) -> FloatArray:
        """Positions (nodes, 3) of the part in the assembly."""
        return np.asarray(x @ self.turn.T + self.shift)


def laid_out(cards: Iterable[Card], fault: Callable[[str, str], ModelError]) -> Iterator[tuple[Card, Frame]]:
    """Every card with its frame; cards of a part appear once for each of its instances.

    Raises
    ------
    ModelError
        For several parts without instances, an instance of a missing part, or an incomplete motion.
    """
    given = list(cards)
    names = [card for card in given if card.keyword == "INSTANCE"]
    if not names:
        parts = [card for card in given if card.keyword == "PART"]
        if len(parts) > 1:
            raise fault(parts[1].line, "*PART: found several parts without *INSTANCE, expected one for each part")
        yield from ((card, Frame()) for card in given)
        return
    parts_of, rest = split_parts(given)
    step = 10 ** len(str(max([0, *(largest(card) for cards in parts_of.values() for card in cards)])))
    frames: dict[str, Frame] = {}
    inside: Frame | None = None
    for card in rest:
        if card.keyword == "INSTANCE":
            name, part = (card.parameters.get(key, "").upper() for key in ("NAME", "PART"))
            if not name or name in frames:
                raise fault(
                    card.line, f"*INSTANCE: found the name {name!r}, expected a name that no other instance has"
                )
            if part not in parts_of:
                raise fault(card.line, f"*INSTANCE: found no part {part!r} above this line")
            turn, shift = motion(card, fault)
            alone = len(names) == 1
            inside = Frame(len(frames) * step, "" if alone else f"{card.parameters['NAME']}.", True, turn, shift)
            frames[name] = inside
            yield from ((own, inside) for own in parts_of[part])
        elif card.keyword == "END INSTANCE":
            inside = None
        elif inside is not None:
            yield card, inside
        else:
            name = card.parameters.get("INSTANCE", "").upper()
            if name and name not in frames:
                raise fault(card.line, f"*{card.keyword}: found no instance {name!r} above this line")
            frame = frames[name] if name else Frame()
            yield card, Frame(frame.offset, frame.prefix, False, frame.turn, frame.shift)


def split_parts(cards: list[Card]) -> tuple[dict[str, list[Card]], list[Card]]:
    """Cards of each part by its name, and the cards outside parts."""
    parts, rest = dict[str, list[Card]](), list[Card]()
    part: list[Card] | None = None
    for card in cards:
        if card.keyword == "PART":
            part = parts.setdefault(card.parameters.get("NAME", "").upper(), [])
        elif card.keyword == "END PART":
            part = None
        else:
            (rest if part is None else part).append(card)
    return parts, rest


def largest(card: Card) -> int:
    """The largest number of a node or an element on a card."""
    if card.keyword not in ("NODE", "ELEMENT"):
        return 0
    numbers = [text.partition(",")[0].strip() for _, text in card.data]
    return max((int(number) for number in numbers if number.isdecimal() and len(number) <= DIGITS), default=0)


def values(card: Card, kind: type, fault: Callable[[str, str], ModelError]) -> list[list[Any]]:
    """The numbers on each data line."""
    rows = []
    for line, text in card.data:
        try:
            rows.append([kind(cell) for cell in text.rstrip(",").split(",")])
        except ValueError:
            raise fault(line, f"found {text!r}, expected numbers") from None
        if not all(abs(value) < MOST for value in rows[-1]):
            raise fault(line, f"found {text!r}, expected numbers below {MOST:g}")
    return rows


def motion(card: Card, fault: Callable[[str, str], ModelError]) -> tuple[FloatArray, FloatArray]:
    """Turn (3, 3) and shift (3,) of an instance: x -> turn x + shift."""
    from scipy.spatial.transform import Rotation  # loaded with the first part, not by every study

    rows = values(card, float, fault)
    if len(rows) > 2 or (rows and len(rows[0]) != 3) or (len(rows) == 2 and len(rows[1]) != 7):
        found = f"found lines of {' and '.join(str(len(row)) for row in rows)} numbers"
        expected = "expected dx, dy, dz, and maybe a second line ax, ay, az, bx, by, bz, angle"
        raise fault(card.line, f"*INSTANCE: {found}, {expected}")
    shift = np.array(rows[0]) if rows else np.zeros(3)
    if len(rows) < 2:
        return np.eye(3), shift
    a, b, angle = np.array(rows[1][:3]), np.array(rows[1][3:6]), rows[1][6]
    if not np.linalg.norm(b - a) > 0.0:
        raise fault(card.data[1][0], "*INSTANCE: found one place for both points of the axis, expected two places")
    turn = Rotation.from_rotvec(np.radians(angle) * (b - a) / np.linalg.norm(b - a)).as_matrix()
    return turn, turn @ (shift - a) + a
