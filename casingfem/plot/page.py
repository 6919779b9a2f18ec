"""A page in one file: verdict, sections of paragraphs, tables and figures, with embedded style and scripts.

The scripts read numbers as small integers with a scale, in base64.
"""

import base64
import datetime
import json
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup, escape
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from casingfem.plot.hover import hover_values
from casingfem.plot.style import Drawn, embed, image
from contact.io.columns import Columns, Rows, cells_of

NUMBER = re.compile(r"[+-]?\d+(,\d{3})*(\.\d+)?(e[+-]?\d+)?(( × 10)?[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)?( decades| times| %)?")
POWER = re.compile(r"(?<![\w.])[+-]?\d+(?:\.\d+)?e[+-]?\d+(?![\w.]\w)")
EXPONENT = re.compile(r"(?<=\w)\^(-?\d+)\b")
CODE = re.compile(r"`([^`]+)`")
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
SIXTEEN, EIGHT = 32767, 127
Cell = str | float | int | None


@dataclass(frozen=True, slots=True, eq=False)
class Table:
    """A table with its caption; numbers align right, None shows as a dash.

    >>> Table("Modes.", ("n", "label"), ((8, "split"), (None, "whole"))).right()
    [True, False]
    """

    caption: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    folded: bool = False  # shown only when asked for
    meanings: tuple[str, ...] = ()  # one sentence for each column, shown under the pointer

    @classmethod
    def of(cls, caption: str, columns: Columns, rows: Rows, *, folded: bool = False) -> "Table":
        """A result's columns as a table; `rows` are its records."""
        shown, cells = cells_of(columns, rows)
        heads, meanings = tuple(column.header for column in shown), tuple(column.text for column in shown)
        lines = (
            tuple(cell if cell is None or one.words else raised(cell) for one, cell in zip(shown, line, strict=True))
            for line in cells
        )
        return cls(caption, heads, tuple(lines), folded, meanings)

    def right(self) -> list[bool]:
        """Whether each column contains only numbers, which align right."""
        columns = [[cell for cell in column if cell is not None] for column in zip(*self.rows, strict=True)]
        return [bool(cells) and all(map(numeric, cells)) for cells in columns] or [False] * len(self.columns)


@dataclass(frozen=True, slots=True, eq=False)
class Picture:
    """A figure ready for the page, with a caption that describes it; `scripts` are those that it needs.

    >>> Picture("<img alt='rim'>", "The rim at 300 Hz.").scripts
    ()
    """

    html: str
    caption: str
    scripts: tuple[str, ...] = ()

    @classmethod
    def of(cls, figure: Figure | Drawn, caption: str, *, kind: str = "svg") -> "Picture":
        """Embed a figure with its caption as alternative text, and values that show at the pointer."""
        if isinstance(figure, Drawn):
            wide = float(figure.figure.get_size_inches()[0])
            html, values = image(figure.png, "png", caption, width=wide), hover_values(figure.figure)
        else:
            html, values = embed(figure, caption, kind=kind), hover_values(figure)
        return cls(island("hover", values, html), caption, ("hover",)) if values else cls(html, caption)


@dataclass(frozen=True, slots=True, eq=False)
class Section:
    """One heading and its contents, in this order.

    >>> Section("Modes", ("The lowest mode has 366.2 Hz.",)).tables
    ()
    """

    title: str
    paragraphs: tuple[str, ...] = ()
    figures: tuple[Picture, ...] = ()
    tables: tuple[Table, ...] = ()
    preformatted: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Verdict:
    """The summary at the top of a page: the finding, facts by name, confidence, next steps.

    `state` colours it: "good", "bad", "open", or nothing. `strips` are pictures of speed ranges by name, as HTML.

    >>> verdict = Verdict(found="The rub stays bounded.", sure="At half the step too.", further="Run longer.")
    >>> "stays bounded" in render_page("Rub", [], verdict=verdict)
    True
    """

    found: str
    sure: str
    further: str
    facts: tuple[tuple[str, str], ...] = ()
    state: str = ""
    strips: tuple[tuple[str, Markup], ...] = ()


def capital(words: str) -> str:
    """A sentence's first letter in upper case.

    >>> capital("mode 1")
    'Mode 1'
    """
    return words[:1].upper() + words[1:]


def written(cell: Cell, digits: int = 5) -> str:
    """A cell as text.

    >>> written(371.2345678), written(None), written("rho = 4e-05"), written(8.792613e12), written(-0.923955)
    ('371.23', '–', 'rho = 4 × 10⁻⁵', '8.7926 × 10¹²', '-0.92395')
    """
    if cell is None:
        return "–"
    return raised(f"{cell:.{digits}g}") if isinstance(cell, float) else powers(str(cell))


def raised(text: str) -> str:
    """A number with its power of ten in the usual notation.

    >>> raised("1e+13"), raised("2.5e-06"), raised("7")
    ('10¹³', '2.5 × 10⁻⁶', '7')
    """
    mantissa, _, power = text.partition("e")
    if not power:
        return text
    ten = "10" + str(int(power)).translate(RAISED)
    return {"1": ten, "-1": f"-{ten}"}.get(mantissa, f"{mantissa} × {ten}")


def powers(text: str) -> str:
    """A text with its powers in the usual notation.

    >>> powers("2.5e-06 N/m^3")
    '2.5 × 10⁻⁶ N/m³'
    """
    return EXPONENT.sub(lambda found: found[1].translate(RAISED), POWER.sub(lambda found: raised(found[0]), text))


def prose(text: str) -> Markup:
    """A sentence as HTML: powers of ten in the usual notation, and commands between backticks as code.

    >>> prose("The rim moves 4.2e-05 m, less than 1e-3 m.")
    Markup('The rim moves 4.2 × 10⁻⁵ m, less than 10⁻³ m.')
    >>> prose("`casingfem rub` where n < 3")
    Markup('<code>casingfem rub</code> where n &lt; 3')
    """
    written_out = str(escape(powers(str(text))))
    return Markup(CODE.sub(r"<code>\1</code>", written_out))


def numeric(cell: Cell) -> bool:
    """Whether a cell aligns right, like numbers.

    >>> numeric(3.1), numeric("-0.12"), numeric("0.95 decades"), numeric("8.79 × 10¹²"), numeric("2.4.6")
    (True, True, True, True, False)
    """
    return not isinstance(cell, str) or NUMBER.fullmatch(cell) is not None


def origin(source: Mapping[str, Any]) -> str:
    """One line on the origin of a page: input and its hash, versions, date (SOURCE_DATE_EPOCH if that is set).

    `source` is that of results, with "study", "scene" or "file", "sha256", and "versions" or the packages themselves.

    >>> import os; os.environ["SOURCE_DATE_EPOCH"] = "1000000000"
    >>> origin({"scene": "rub.toml", "sha256": "0123456789abcdef", "numpy": "2.0.0"})
    'rub.toml · sha256 0123456789ab · numpy 2.0.0 · 9 September 2001'
    >>> del os.environ["SOURCE_DATE_EPOCH"]
    """
    named = ("study", "scene", "file", "sha256", "seed")
    name = next((source[key] for key in named[:3] if key in source), "")
    digest = str(source.get("sha256", ""))[:12]
    epoch = os.environ.get("SOURCE_DATE_EPOCH")
    now = datetime.datetime.now() if epoch is None else datetime.datetime.fromtimestamp(int(epoch), datetime.UTC)
    packages = source.get("versions", {key: value for key, value in source.items() if key not in named})
    versions = [f"{package} {number}" for package, number in packages.items()]
    parts = [Path(str(name)).name, f"sha256 {digest}" if digest else "", ", ".join(versions)]
    return " · ".join([part for part in parts if part] + [f"{now.day} {now:%B %Y}"])


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Page:
    """The contents of a page: title, verdict, sections; `notice` is in a frame at the top (such as SYNTHETIC).

    `source` is the line of `origin`.

    >>> "Forty modes." in Page(title="Casing", sections=(Section("Modes", ("Forty modes.",)),)).html()
    True
    """

    title: str
    sections: Sequence[Section]
    verdict: Verdict | None = None
    lead: str = ""
    notice: str = ""
    source: str = ""

    def html(self) -> str:
        """HTML of this page only."""
        return render_pages(self.title, [self])


def render_page(
    title: str,
    sections: Sequence[Section],
    *,
    verdict: Verdict | None = None,
    lead: str = "",
    notice: str = "",
    source: str = "",
) -> str:
    """HTML of a page, with the arguments of `Page`.

    >>> page = render_page("Casing", [Section("Modes", ("Forty modes.",))], notice="SYNTHETIC data")
    >>> "SYNTHETIC data" in page, "http" in page
    (True, False)
    """
    return Page(title=title, sections=sections, verdict=verdict, lead=lead, notice=notice, source=source).html()


def render_pages(title: str, pages: Sequence[Page]) -> str:
    """HTML of one page with the contents of several, their verdicts first, independent of other files.

    >>> html = render_pages("Rotor", [Page(title=name, sections=(Section("Modes"),)) for name in ("Blade", "Casing")])
    >>> html.count("<h1>"), html.count("<h2"), html.count("<h3>")
    (1, 2, 2)
    >>> runs = [Verdict(found=words, sure="One step.", further="Halve it.") for words in ("Safe.", "Grows.")]
    >>> html = render_pages("Rubs", [Page(title=run.found, sections=(Section("Run"),), verdict=run) for run in runs])
    >>> html.index("Grows.") < html.index("<nav") < html.index("Halve it.")
    True
    """
    folder = FileSystemLoader(Path(__file__).parent)
    environment = Environment(loader=folder, autoescape=True, undefined=StrictUndefined, trim_blocks=True)
    environment.filters["written"] = written
    environment.filters["prose"] = prose
    template = environment.get_template("page.html.j2")
    figures = [figure for page in pages for section in page.sections for figure in section.figures]
    scripts = dict.fromkeys(name for figure in figures for name in figure.scripts)  # each once; what all share is first
    return template.render(title=title, pages=pages, scripts=["shared", *scripts] if scripts else [])


def packed(values: ArrayLike, *, most: float | None = None, bits: int = 16) -> dict[str, Any]:
    """Values as little-endian integers with a number of bits, and the value of the largest, which is `most` if given.

    >>> packed([0.5, -1.0, 0.25])
    {'data': '/z8BgP8f', 'most': 1.0}
    """
    array = np.asarray(values, dtype=float)
    worth = float(np.abs(array).max(initial=0.0)) if most is None else most
    whole = SIXTEEN if bits == 16 else EIGHT
    steps = np.clip(np.trunc(whole / (worth or 1.0) * array), -whole, whole)
    return {"data": coded(steps.astype("<i2" if bits == 16 else "i1")), "most": worth}


def coded(array: np.ndarray[Any, Any]) -> str:
    """The bytes of an array in base64."""
    return base64.b64encode(np.ascontiguousarray(array).tobytes()).decode("ascii")


def island(script: str, data: Mapping[str, Any] | list[Any], inside: str = "") -> str:
    r"""The element with the data for a script of this name; `inside` is shown if scripts do not run.

    >>> island("shapes", {"a": "</script>"})
    '<div class="live" data-live="shapes"><script type="application/json">{"a":"\\u003c/script>"}</script></div>'
    """
    text = json.dumps(data, separators=(",", ":"), ensure_ascii=False).replace("<", "\\u003c")
    return f'<div class="live" data-live="{script}"><script type="application/json">{text}</script>{inside}</div>'
