"""Style of figures: colours that colour-blind readers can distinguish, one font size."""

import base64
import io
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from functools import cached_property, wraps
from typing import Any, ParamSpec, TypeVar, cast

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backend_bases import FigureCanvasBase
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure, FigureBase, SubFigure
from matplotlib.gridspec import GridSpec

from casingfem.plot.thousands import in_thousands

# Okabe & Ito, and one meaning for each colour throughout
MEASURED, PERFECT, BEFORE, AFTER = "#000000", "#8a8a8a", "#0072B2", "#D55E00"
GREEN, SKY, PURPLE = "#009E73", "#56B4E9", "#CC79A7"
DIVERGING = "RdBu_r"
SCREEN = 96  # dots an inch, in a notebook; of a pixel of a page
SHARP = 192  # dots an inch of pictures on a page: two for each of its pixels
PACKING = 4  # of 9: effort to pack a PNG file; more costs time and saves little

RC: dict[str, Any] = {
    "font.size": 9.5,
    "axes.titlesize": 10,
    "axes.titleweight": "bold",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#e4e4e4",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "axes.edgecolor": "#555555",
    "legend.frameon": False,
    "lines.linewidth": 1.4,
    "figure.dpi": 110,
    "savefig.dpi": 110,
    "svg.hashsalt": "casingfem",
}

PLACE: ContextVar[Axes | None] = ContextVar("place", default=None)


@contextmanager
def placed(ax: Axes | None) -> Iterator[None]:
    """Within this context new figures are drawn in these axes."""
    token = PLACE.set(ax)
    try:
        yield
    finally:
        PLACE.reset(token)


class Inset(SubFigure):
    """A stand-in for a figure inside some axes: one plain panel uses these axes, several replace them."""

    def __init__(self, ax: Axes) -> None:
        self.given = ax
        root: Any = ax.figure
        spec = ax.get_subplotspec()
        if spec is None:
            box = ax.get_position()
            spec = GridSpec(1, 1, figure=root, left=box.x0, right=box.x1, bottom=box.y0, top=box.y1)[0]
        super().__init__(root, spec)
        self.root = root

    def add_subplot(self, *args: Any, **kwargs: Any) -> Any:
        """The given axes for one plain panel, else panels in their place."""
        if not args and not kwargs and self.given in self.root.axes:
            return self.given
        self._take_place()
        return super().add_subplot(*args, **kwargs)

    def subplots(self, *args: Any, **kwargs: Any) -> Any:
        """Panels in the place of the axes."""
        self._take_place()
        return super().subplots(*args, **kwargs)

    def legend(self, *args: Any, **kwargs: Any) -> Any:
        """A legend that would be outside a figure's panels, moved inside axes that are one of many."""
        if self.given in self.root.axes:
            kwargs.pop("loc", None)
            return self.given.legend(*(args or self.given.get_legend_handles_labels()), **kwargs)
        return super().legend(*args, **kwargs)

    def colorbar(self, *args: Any, **kwargs: Any) -> Any:
        """A colour bar next to its panel."""
        if self.given in self.root.axes:
            return self.root.colorbar(*args, **kwargs)
        return super().colorbar(*args, **kwargs)

    def _take_place(self) -> None:
        if self.given in self.root.axes:
            self.given.remove()
            self.root.subfigs.append(self)


P = ParamSpec("P")
R = TypeVar("R")


def styled(draw: Callable[P, R]) -> Callable[P, R]:
    """Draw in this style, independent of the user's matplotlibrc; axes that reach 10,000 Hz or N in kHz or kN."""

    @wraps(draw)
    def styled_draw(*args: P.args, **kwargs: P.kwargs) -> R:
        style: dict[Any, Any] = {**mpl.rcParamsDefault, **RC}
        with mpl.rc_context({key: value for key, value in style.items() if not key.startswith("backend")}):
            found = draw(*args, **kwargs)
            for axes in cast("Any", found).axes if isinstance(found, FigureBase) else ():
                in_thousands(axes.xaxis)
                in_thousands(axes.yaxis)
            return found

    return styled_draw


def new_figure(width: float = 7.6, height: float = 4.0) -> Figure:
    """An empty figure (inches) outside matplotlib's global state; inside `placed`, one in the given axes."""
    ax = PLACE.get()
    know_in_notebook()
    return Figure(figsize=(width, height), layout="constrained") if ax is None else cast(Figure, Inset(ax))


def rpm_above(axes: Any) -> None:
    """The speed of the lower axis [Hz] in revolutions per minute, above."""
    above = axes.secondary_xaxis("top", functions=(lambda f: 60.0 * f, lambda rpm: rpm / 60.0))
    above.set_xlabel("speed [rpm]")


def know_in_notebook() -> None:
    """Let a notebook show figures; by itself it only shows those of pyplot, which this package does not load."""
    ipython: Any = sys.modules.get("IPython")
    shell = None if ipython is None else ipython.get_ipython()
    if shell is not None:
        formatter = shell.display_formatter.formatters["image/png"]
        if Figure not in formatter.type_printers:
            formatter.for_type(Figure, lambda figure: png(figure, dpi=SCREEN))


@dataclass(frozen=True, eq=False)
class Drawn:
    """A complete figure, drawn once for both the file and the page."""

    figure: Figure

    @cached_property
    def png(self) -> bytes:
        """As a PNG file, with two dots for each pixel of a page."""
        return png(self.figure, dpi=SHARP)


@styled
def embed(figure: Figure, alt: str, *, kind: str = "svg") -> str:
    """The figure as an <img> with embedded data; "png" for surfaces with many faces.

    >>> embed(new_figure(1.0, 1.0), "an empty figure")[:38]
    '<img alt="an empty figure" src="data:i'
    """
    if kind not in ("svg", "png"):
        raise ValueError(f'kind must be "svg" or "png", found {kind!r}')
    if kind == "png":
        return image(png(figure, dpi=SHARP), kind, alt, width=figure.get_size_inches()[0])
    from matplotlib.backends.backend_svg import FigureCanvasSVG  # files of a run are PNG alone

    buffer = io.BytesIO()
    with _canvas(FigureCanvasSVG, figure, mpl.rcParams["savefig.dpi"]) as canvas:
        canvas.print_svg(buffer, metadata={"Date": None})
    return image(buffer.getvalue(), "svg+xml", alt)


def png(figure: Figure, *, dpi: int = 150) -> bytes:
    r"""The figure as a PNG file without date and program name, so that the same picture gives the same bytes.

    >>> png(new_figure(1.0, 1.0))[:8]
    b'\x89PNG\r\n\x1a\n'
    """
    buffer = io.BytesIO()
    with _canvas(FigureCanvasAgg, figure, dpi) as canvas:
        canvas.print_png(buffer, metadata={"Software": None}, pil_kwargs={"compress_level": PACKING})
    return buffer.getvalue()


@contextmanager
def _canvas(kind: type[FigureCanvasBase], figure: Figure, dpi: float) -> Iterator[Any]:
    """A canvas of this kind for one drawing, which also finds the layout, since `savefig` would draw twice."""
    canvas, own = figure.canvas, figure.dpi
    figure.dpi = dpi
    try:
        yield kind(figure)
    finally:
        figure.set_canvas(canvas)
        figure.dpi = own


def image(data: bytes, kind: str, alt: str, *, role: str = "", width: float = 0.0) -> str:
    """An <img> with the data of a picture of a kind such as "png"; `role` is its class, `width` [inch] its width."""
    words = alt.replace("&", "&amp;").replace('"', "&quot;").replace("<", "&lt;")
    named = f' class="{role}"' if role else ""
    named += f' width="{SCREEN * width:.0f}"' if width else ""
    return f'<img{named} alt="{words}" src="data:image/{kind};base64,{base64.b64encode(data).decode("ascii")}">'
