"""Figures quoted by pages: docs/figures.csv keeps them as a run printed them; they are found and renewed in the pages.

A page marks where it quotes a run by a comment, which no reader sees: `<!-- verification.cylinder: 0.005 -->` behind a
row of a table or within a paragraph says that the figures of that row of the store are in this line of the table, or
in this paragraph, in that order; `<!-- verification.rubs.bladed_disk: 2 @ off [%] -->` names some of them. A figure
is there if a number of the page equals it at the precision printed, or bounds it, as `< 1e-12` does.
`reports.tools.campaign` writes store and pages.
"""

import csv
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from reports.tables import ROOT, write

STORE = Path("docs", "figures.csv")
PAGES = ("README.md", *(f"docs/{page.name}" for page in sorted((ROOT / "docs").glob("*.md"))))
MARK = re.compile(r"<!-- (?P<report>[\w.]+): (?P<row>[^@]+?)(?: @ (?P<names>.+?))? -->")
NUMBER = re.compile(
    r"(?<![\w.,])(?P<below>< )?(?P<digits>[+-]?(?:\d[\d,]*\d|\d)?(?:\.\d+)?)(?P<power>e[+-]?\d+)?(?!\w)"
)
UNSEEN = re.compile(r"<!--.*?-->|`[^`]*`|\]\([^)]*\)", re.DOTALL)
BLOCK = re.compile(r"^\|.*$|(?:^(?!\|).+\n?)+", re.MULTILINE)  # a row of a table, or lines up to an empty one

Figures = dict[str, dict[str, float]]  # row -> name -> value
Store = dict[str, Figures]  # report -> its figures


@dataclass(frozen=True, slots=True)
class Number:
    """A number of a page; `below` if the page gives it as a bound."""

    start: int
    text: str
    below: bool

    @property
    def value(self) -> float:
        """The value of the number."""
        return float(self.text.replace(",", ""))

    @property
    def decimals(self) -> int:
        """Digits after the decimal point."""
        return len(self.text.partition("e")[0].partition(".")[2])

    def says(self, figure: float) -> bool:
        """Whether the number is this figure at the precision printed, or a bound of it."""
        if self.below:
            return abs(figure) < self.value
        unit = 10.0 ** (int(self.text.partition("e")[2] or 0) - self.decimals)
        off = abs(self.value - figure)
        whole = self.text.lstrip("+-").isdigit()  # 1 is no way to print .6, nor 0 one to print 1e-4
        return off <= 0.5 * unit * (1.0 + 1e-6) and (not whole or off <= 0.1 * abs(figure) or abs(figure) < 1e-9)

    def saying(self, figure: float) -> str:
        """Another figure in the same format."""
        if self.below:
            return self.text if self.says(figure) else f"{10.0 * abs(figure):.0e}".replace("e-0", "e-")
        if "e" in self.text:
            digits, power = f"{figure:.{self.decimals}e}".split("e")
            return f"{digits}e{int(power)}"
        sign = "+" if self.text.startswith("+") else ""
        return f"{figure:{sign}{',' if abs(figure) >= 1000.0 else ''}.{self.decimals}f}"


@dataclass(frozen=True, slots=True)
class Mark:
    """A mark of a page and the text that contains its figures, from `start` of the page."""

    start: int
    block: str
    report: str
    row: str
    names: tuple[str, ...]

    def figures(self, store: Mapping[str, Figures]) -> dict[str, float]:
        """The figures that a mark names; KeyError if the store has no such row or name."""
        row = store[self.report][self.row]
        return {name: row[name] for name in self.names} if self.names else row


def numbers(text: str) -> Iterator[Number]:
    """The numbers that a reader sees, without those in code and in addresses."""
    seen = UNSEEN.sub(lambda found: " " * len(found[0]), text)
    for found in NUMBER.finditer(seen):
        if found["digits"].strip("+-"):
            word = found["digits"] + (found["power"] or "")
            yield Number(start=found.start("digits"), text=word, below=found["below"] is not None)


def marks(page: str) -> Iterator[Mark]:
    """The marks of a page's text."""
    for block in BLOCK.finditer(page):
        for found in MARK.finditer(block[0]):
            names = tuple(found["names"].split(", ")) if found["names"] else ()
            yield Mark(start=block.start(), block=block[0], report=found["report"], row=found["row"], names=names)


def placed(mark: Mark, figures: Mapping[str, float]) -> list[Number]:
    """Positions of the figures, in order; ValueError names the first one that is missing."""
    rest = numbers(mark.block)
    places = []
    for name, figure in figures.items():
        place = next((number for number in rest if number.says(figure)), None)
        if place is None:
            raise ValueError(
                f"{mark.report}, {mark.row}, {name}: {figure:.6g} is not in '{' '.join(mark.block.split())}'"
            )
        places.append(place)
    return places


def renewed(page: str, report: str, old: Store, new: Store) -> str:
    """The page with the old figures of a report replaced by new ones, each in its former format."""
    changes: dict[int, tuple[int, str]] = {}
    for mark in marks(page):
        if mark.report == report and mark.row in old.get(report, {}):
            quoted = mark.figures(old)
            for place, name in zip(placed(mark, quoted), quoted, strict=True):
                figure = new[report][mark.row][name]
                changes[mark.start + place.start] = (len(place.text), place.saying(figure))
    for start, (length, word) in sorted(changes.items(), reverse=True):
        page = page[:start] + word + page[start + length :]
    return page


def read_store(root: Path = ROOT) -> Store:
    """The contents of docs/figures.csv."""
    store: Store = {}
    with (root / STORE).open(newline="", encoding="utf-8") as stream:
        for line in csv.DictReader(stream):
            store.setdefault(line["report"], {}).setdefault(line["row"], {})[line["figure"]] = float(line["value"])
    return store


def write_store(store: Store, root: Path = ROOT) -> None:
    """Write docs/figures.csv, six digits of each figure."""
    lines = [
        {"report": report, "row": row, "figure": name, "value": f"{value:.6g}"}
        for report, rows in sorted(store.items())
        for row, figures in rows.items()
        for name, value in figures.items()
    ]
    write(root / STORE, lines)


def adopt(report: str, figures: Figures, root: Path = ROOT, pages: Sequence[str] = PAGES) -> list[str]:
    """Put the figures that a report printed into the store and the pages; returns the pages that changed."""
    old = read_store(root)
    new = old | {report: figures}
    texts = {name: (root / name).read_text(encoding="utf-8") for name in pages}
    again = {name: renewed(text, report, old, new) for name, text in texts.items()}  # all of them, or none is written
    changed = [name for name in pages if again[name] != texts[name]]
    for name in changed:
        (root / name).write_text(again[name], encoding="utf-8")
    write_store(new, root)
    return changed
