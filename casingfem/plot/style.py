"""How figures look: one set of colours that colour-blind readers can tell apart, one size of type."""

import base64
import io
from collections.abc import Callable
from functools import wraps
from typing import Any, ParamSpec, TypeVar

import matplotlib as mpl
from matplotlib.figure import Figure

# Okabe & Ito, and one meaning for each colour throughout
MEASURED, PERFECT, BEFORE, AFTER = "#000000", "#8a8a8a", "#0072B2", "#D55E00"
GREEN, SKY, PURPLE = "#009E73", "#56B4E9", "#CC79A7"
DIVERGING = "RdBu_r"

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

P = ParamSpec("P")
R = TypeVar("R")


def styled(draw: Callable[P, R]) -> Callable[P, R]:
    """Draw with this style, whatever the user's matplotlibrc says."""

    @wraps(draw)
    def styled_draw(*args: P.args, **kwargs: P.kwargs) -> R:
        style: dict[Any, Any] = {**mpl.rcParamsDefault, **RC}
        with mpl.rc_context({key: value for key, value in style.items() if not key.startswith("backend")}):
            return draw(*args, **kwargs)

    return styled_draw


def new_figure(width: float = 7.6, height: float = 4.0) -> Figure:
    """An empty figure (inches) that no global state knows of."""
    return Figure(figsize=(width, height), layout="constrained")


@styled
def embed(figure: Figure, alt: str, *, kind: str = "svg") -> str:
    """The figure as an <img> that carries its own data; "png" for surfaces with many faces.

    >>> embed(new_figure(1.0, 1.0), "an empty figure")[:38]
    '<img alt="an empty figure" src="data:i'
    """
    if kind not in ("svg", "png"):
        raise ValueError(f'kind must be "svg" or "png", found {kind!r}')
    if kind == "png":
        return image(png(figure), kind, alt)
    buffer = io.BytesIO()
    figure.savefig(buffer, format=kind, metadata={"Date": None})
    return image(buffer.getvalue(), "svg+xml", alt)


def png(figure: Figure, *, dpi: int = 150) -> bytes:
    r"""The figure as a PNG file that names neither date nor program: the same picture, the same bytes.

    >>> png(new_figure(1.0, 1.0))[:8]
    b'\x89PNG\r\n\x1a\n'
    """
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=dpi, metadata={"Software": None})
    return buffer.getvalue()


def image(data: bytes, kind: str, alt: str, *, role: str = "") -> str:
    """An <img> that carries a picture of a kind such as "png"; `role` is its class on the page."""
    words = alt.replace("&", "&amp;").replace('"', "&quot;").replace("<", "&lt;")
    named = f' class="{role}"' if role else ""
    return f'<img{named} alt="{words}" src="data:image/{kind};base64,{base64.b64encode(data).decode("ascii")}">'
