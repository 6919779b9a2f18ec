"""Keywords of an Abaqus or CalculiX input file with their parameters and data lines."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from casingfem.io.included import NumberedLine


@dataclass(slots=True)
class Card:
    """One keyword: its line, parameters and data lines with their line numbers."""

    line: str
    keyword: str
    parameters: dict[str, str]
    data: list[tuple[str, str]] = field(default_factory=list)


def cards(lines: Iterable[NumberedLine]) -> Iterator[Card]:
    """Keywords with their data; comments and empty lines are left out, continued keyword lines joined."""
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
