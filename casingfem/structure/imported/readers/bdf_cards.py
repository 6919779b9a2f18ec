"""Cards of a Nastran bulk data file in small, large and free fields, and the numbers in their fields."""

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from casingfem.errors import ModelError
from casingfem.io.included import NumberedLine

MOST = 99_999_999  # of numbers, which have eight digits
LARGEST = 1e100  # of real numbers: squares of larger ones overflow
SHORT_EXPONENT = re.compile(r"(?<=[0-9.])([+-]\d+)$")


@dataclass(slots=True)
class Card:
    """One card: its line, name and fields after the name."""

    line: str
    name: str
    fields: list[str]
    room: int = 0  # fields on its lines, also empty ones


def split_line(line: str) -> tuple[str, list[str]]:
    """Name and data fields of one line, which has free, large or small fields.

    >>> split_line("GRID*   1                               0.5             0.25            *")
    ('GRID*', ['1', '', '0.5', '0.25'])
    >>> split_line("CTETRA,1,7,1,2,3,4")
    ('CTETRA', ['1', '7', '1', '2', '3', '4'])
    """
    if "," in line:
        head, *data = [part.strip() for part in line.split(",")]
        return head, data[: 4 if "*" in head else 8]
    line = line.expandtabs(8)
    head, width = line[:8].strip(), 16 if "*" in line[:8] else 8
    data = [line[k : k + width].strip() for k in range(8, 72, width)]
    while data and not data[-1]:
        data.pop()
    return head, data


def cards(lines: Sequence[NumberedLine]) -> Iterator[Card]:
    """Cards of the bulk data, with continuations joined and comments removed."""
    begin = next((k + 1 for k, (_, line) in enumerate(lines) if re.match(r"\s*BEGIN\s+BULK", line, re.IGNORECASE)), 0)
    card: Card | None = None
    for number, raw in lines[begin:]:
        line = raw.partition("$")[0].rstrip()
        if not line.strip():
            continue
        head, data = split_line(line)
        if head.upper().startswith("ENDDATA"):
            break
        if card is not None and (not head or head[0] in "+*"):
            card.fields += [""] * (card.room - len(card.fields))
            card.fields += data
        else:
            if card is not None:
                yield card
            card = Card(number, head.rstrip("*_").upper(), data)  # CTETRA_ of meshio, CTETRA of Nastran
        card.room += 4 if "*" in head else 8
    if card is not None:
        yield card


class Numbers:
    """Reader of the numbers on the cards of a file; it also records refused and skipped cards."""

    def __init__(self, source: str) -> None:
        self.source = source
        self.left_out: dict[str, list[str]] = {}  # card -> its lines

    def fault(self, card: Card, message: str) -> ModelError:
        """An error about a malformed file."""
        return ModelError("mesh-file", f"{self.source}: line {card.line}: {card.name}: {message}")

    def leave_out(self, card: Card, what: str) -> None:
        """Warn, at the end, about cards that were skipped."""
        self.left_out.setdefault(what, []).append(card.line)

    def integer(self, card: Card, text: str) -> int:
        """An integer."""
        try:
            number = int(text)
        except ValueError:
            raise self.fault(card, f"found {text!r}, expected a whole number") from None
        if abs(number) > MOST:
            raise self.fault(card, f"found {text!r}, expected a number of at most eight digits")
        return number

    def real(self, card: Card, text: str) -> float:
        """A real number in Nastran's forms, 1.5, 1.5-3 or 1.5D-3; an empty field is zero."""
        plain = SHORT_EXPONENT.sub(r"e\1", text.upper().replace("D", "E").lower()) if "e" not in text.lower() else text
        try:
            value = float(plain or 0.0)
        except ValueError:
            value = math.nan
        if not abs(value) < LARGEST:
            raise self.fault(card, f"found {text!r}, expected a real number")
        return value
