"""A page that stands alone: sections of paragraphs, tables and figures, with the style inside."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from matplotlib.figure import Figure

from casingfem.plot.style import embed

NUMBER = re.compile(r"[+-]?\d+(\.\d+)?(e[+-]?\d+)?( decades)?")
Cell = str | float | int | None


@dataclass(frozen=True, slots=True, eq=False)
class Table:
    """A table with its caption; numbers align right, None shows as a dash."""

    caption: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    folded: bool = False  # shown only when asked for


@dataclass(frozen=True, slots=True, eq=False)
class Picture:
    """A figure ready for the page, its caption says what one sees; `alt` is for those who do not."""

    html: str
    caption: str

    @classmethod
    def of(cls, figure: Figure, caption: str, *, kind: str = "svg") -> "Picture":
        """Embed a figure with its caption as its text for screen readers."""
        return cls(embed(figure, caption, kind=kind), caption)


@dataclass(frozen=True, slots=True, eq=False)
class Section:
    """One heading and what stands under it, in this order."""

    title: str
    paragraphs: tuple[str, ...] = ()
    figures: tuple[Picture, ...] = ()
    tables: tuple[Table, ...] = ()
    preformatted: str = ""


def written(cell: Cell, digits: int = 6) -> str:
    """A cell as text.

    >>> written(371.2345678), written(None), written("base")
    ('371.235', '–', 'base')
    """
    if cell is None:
        return "–"
    return f"{cell:.{digits}g}" if isinstance(cell, float) else str(cell)


def numeric(cell: Cell) -> bool:
    """Whether a cell belongs to the right, with the numbers.

    >>> numeric(3.1), numeric("-0.12"), numeric("0.95 decades"), numeric(None), numeric("2.4.6")
    (True, True, True, True, False)
    """
    return not isinstance(cell, str) or NUMBER.fullmatch(cell) is not None


def render_page(
    title: str,
    sections: Sequence[Section],
    *,
    lead: str = "",
    notice: str = "",
    footer: str = "",
) -> str:
    """HTML of a page that needs no other file; `notice` stands out at the top (SYNTHETIC, say).

    >>> page = render_page("Casing", [Section("Modes", ("Forty modes.",))], notice="SYNTHETIC data")
    >>> "SYNTHETIC data" in page, "http" in page
    (True, False)
    """
    folder = FileSystemLoader(Path(__file__).parent)
    environment = Environment(loader=folder, autoescape=True, undefined=StrictUndefined, trim_blocks=True)
    environment.filters["written"] = written
    environment.tests["numeric"] = numeric
    template = environment.get_template("report.html.j2")
    return template.render(title=title, sections=sections, lead=lead, notice=notice, footer=footer)
