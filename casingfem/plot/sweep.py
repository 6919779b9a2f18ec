"""Results of many runs: curves over one varied key, maps over two."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from numpy.typing import NDArray

from casingfem.io.arrays import FloatArray
from casingfem.plot.style import AFTER, BEFORE, DIVERGING, PURPLE, SKY, new_figure, rpm_above, styled
from casingfem.plot.ticks import label_decades
from contact.io.decision import decision
from contact.io.trust import OF_LIMITS

PANELS = (
    ("amplitude_m", "amplitude [mm]", 1e3),
    ("peak_force_N", "largest force [N]", 1.0),
    ("growth_1_s", "growth [1/s]", 1.0),
    ("contact_fraction", "contact, part of the time [-]", 1.0),
    ("dominant_n", "dominant n [-]", 1.0),
)
LATER = ("diverged_at_s", "diverged after [s]", 1.0)
LOGARITHMIC = ("amplitude_m", "diverged_at_s")
SPAN = 100.0  # times: amplitudes that differ by less are drawn on a linear scale
ROBUST = 98.0  # per cent of the values span a colour scale: one run far out leaves the others their colours
WALL = OF_LIMITS["wall"]  # code of the warning of a rim that deflects by more than half of its wall
SPEED = "speed [Hz]"
Mask = NDArray[np.bool_]
Rows = Sequence[Mapping[str, Any]]


class Mark(NamedTuple):
    """A name of some runs and their marker; at the lower edge if they have no value."""

    name: str
    marker: str
    colour: str
    which: Mask


@styled
def figure_sweep(keys: Sequence[str], values: FloatArray, rows: Rows) -> Figure:
    """Amplitude, force, growth, contact and dominant nodal diameter of all runs, with their outcomes.

    `keys` names the varied numbers with their units, one or two of them; `values` (runs, keys). Runs that diverged are
    triangles, refused or failed ones crosses, those with warnings hollow squares. Growth has its 95 % interval. Over
    one key, ranges in which motions grow or runs diverge are shaded.
    """
    keys = [named(key) for key in keys]
    status = np.array([row["status"] for row in rows])
    lost = status == "diverged"
    panels = (*PANELS[:4], LATER) if lost.any() else PANELS
    chosen = [panel for panel in panels if any(row.get(panel[0]) is not None for row in rows)]
    count = max(len(chosen), 1)
    figure = new_figure(8.2, 1.0 + 2.5 * -(-count // 2))
    flagged = np.array([bool(row.get("flags")) for row in rows]) & ~lost
    marks = [
        Mark("diverged", "^", SKY, lost), Mark("refused or failed", "x", AFTER, np.isin(status, ("refused", "failed"))),
        Mark("with warnings", "s", PURPLE, flagged),
    ]  # fmt: skip
    first: Any = None
    for k, (name, label, scale) in enumerate(chosen):
        axes: Any = figure.add_subplot(-(-count // 2), min(count, 2), k + 1, sharex=first)
        first = first or axes
        measured = scale * column(rows, name)
        shown = (lost if name == LATER[0] else (status == "done") | lost & (name == "growth_1_s")) & np.isfinite(
            measured
        )
        if len(keys) == 1:
            _curve(axes, values[:, 0], measured, shown, marks)
            if name == "growth_1_s":
                _interval(axes, values[:, 0], rows, shown)
            _shade(axes, values[:, 0], unsafe(rows) | beyond(rows))
            axes.set(xlabel=keys[0], ylabel=label)
            if k < 2 and keys[0] == SPEED:
                rpm_above(axes)
            known = measured[shown & (measured > 0.0)]
            if name in LOGARITHMIC and known.size and known.max() > SPAN * known.min():
                axes.set_yscale("log")
                label_decades(axes.yaxis)
        else:
            _map(figure, axes, values, measured, shown, label, marks)
            axes.set(xlabel=keys[0], ylabel=keys[1])
    present = [mark for mark in marks if mark.which.any() and first is not None]
    if present:
        handles = [first.plot([], [], **_look(mark))[0] for mark in present]
        figure.legend(handles, [mark.name for mark in present], loc="outside upper left", ncols=3, fontsize=8)
    return figure


def named(label: str) -> str:
    """The name of a varied key on an axis or in a table; for a speed in Hz with rpm.

    >>> named("speed.hz [turns/s]"), named("rod[1].velocity [m/s]")
    ('speed [Hz]', 'rod[1].velocity [m/s]')
    """
    return SPEED if label.partition(" ")[0] == "speed.hz" else label


def column(rows: Rows, name: str) -> FloatArray:
    """Values of a column, nan if a run has none."""
    return np.array([np.nan if row.get(name) is None else float(row[name]) for row in rows])


def unsafe(rows: Rows) -> Mask:
    """Runs whose motion grows, or that diverged (`contact.io.decision`).

    >>> unsafe([{"status": "done", "motion": "grows"}, {"status": "diverged"}, {"status": "done"}]).tolist()
    [True, True, False]
    """
    return np.array([decided(row) is True for row in rows], dtype=bool)


def undecided(rows: Rows) -> Mask:
    """Runs that do not decide whether the motion grows: too short, or the growth is an effect of the step.

    >>> rows = [{"status": "done", "motion": "undecided"}, {"status": "diverged", "motion": "numerical"}]
    >>> undecided([*rows, {"status": "refused"}]).tolist()
    [True, True, False]
    """
    return np.array([decided(row) is None for row in rows], dtype=bool)


def decided(row: Mapping[str, Any]) -> bool | None:
    """Whether the motion of a run grows; None if the run does not decide."""
    return decision(row.get("motion"), passed=row["status"] == "diverged")


def beyond(rows: Rows) -> Mask:
    """Runs that ended, but whose rim deflected by more than half of its wall.

    >>> beyond([{"status": "done", "flags": flags} for flags in ("wall-deflection; slip-reverses", "")]).tolist()
    [True, False]
    """
    return np.array([WALL in str(row.get("flags") or "").split("; ") for row in rows], dtype=bool) & ~unsafe(rows)


def stretches(x: FloatArray, chosen: Mask) -> list[tuple[float, float]]:
    """First and last value of each series of neighbouring values at which a run is chosen.

    >>> stretches(np.array([3.0, 1.0, 2.0, 4.0]), np.array([True, False, True, False]))
    [(2.0, 3.0)]
    """
    at = np.unique(x)
    inside = np.array([chosen[x == value].any() for value in at])
    steps = np.diff(np.concatenate([[0], inside.astype(int), [0]]))
    first, last = np.flatnonzero(steps > 0), np.flatnonzero(steps < 0) - 1
    return [(float(at[a]), float(at[b])) for a, b in zip(first, last, strict=True)]


def _shade(axes: Any, x: FloatArray, chosen: Mask) -> None:
    """Shade up to the middle between a chosen run and the next one."""
    at = np.unique(x)
    edges = np.concatenate([at[:1], 0.5 * (at[1:] + at[:-1]), at[-1:]])
    for low, high in stretches(x, chosen):
        start, stop = np.searchsorted(at, [low, high])
        axes.axvspan(edges[start], edges[stop + 1], color=AFTER, alpha=0.12, linewidth=0.0, zorder=0)


def _look(mark: Mark) -> dict[str, Any]:
    hollow = {"markerfacecolor": "none"} if mark.marker == "s" else {}
    size = 6.0 if mark.marker == "s" else 4.5
    return {"marker": mark.marker, "color": mark.colour, "linestyle": "", "markersize": size, **hollow}


def _curve(axes: Any, x: FloatArray, measured: FloatArray, shown: Mask, marks: Sequence[Mark]) -> None:
    order = np.argsort(x[shown], kind="stable")
    axes.plot(x[shown][order], measured[shown][order], ".-", color=BEFORE, markersize=3.5, linewidth=0.8)
    for mark in marks:
        beside = mark.which & ~shown
        own = mark.which & shown & (mark.marker == "s")
        if own.any():
            axes.plot(x[own], measured[own], **_look(mark))
        if beside.any() and mark.marker != "s":
            low = axes.get_xaxis_transform()
            axes.plot(x[beside], np.zeros(beside.sum()), **_look(mark), label=mark.name, clip_on=False, transform=low)


def _interval(axes: Any, x: FloatArray, rows: Rows, shown: Mask) -> None:
    """The 95 % interval of each growth."""
    low, high = column(rows, "growth_low_1_s"), column(rows, "growth_high_1_s")
    known = shown & np.isfinite(low) & np.isfinite(high)
    axes.vlines(x[known], low[known], high[known], color=BEFORE, linewidth=1.2, alpha=0.45)
    axes.axhline(0.0, color="#777777", linewidth=0.8, zorder=1)


def _map(
    figure: Figure, axes: Any, values: FloatArray, measured: FloatArray, shown: Mask, label: str,
    marks: Sequence[Mark],
) -> None:  # fmt: skip
    colours: dict[str, Any] = {}
    known = measured[shown]
    if label.startswith("growth"):
        most = float(np.percentile(np.abs(known), ROBUST)) if known.size else 0.0
        colours = {"cmap": DIVERGING, "vmin": -(most or 1.0), "vmax": most or 1.0}
    elif label.startswith(("amplitude", "diverged")) and np.any(known > 0.0):
        low, high = np.percentile(known[known > 0.0], [100.0 - ROBUST, ROBUST])
        colours = {"norm": LogNorm(low, high)} if high > SPAN * low else {"vmin": low, "vmax": high}
    x, y = np.unique(values[:, 0]), np.unique(values[:, 1])
    place, row = np.searchsorted(x, values[:, 0]), np.searchsorted(y, values[:, 1])
    if x.size * y.size == len(np.unique(place * y.size + row)) and min(x.size, y.size) > 1:
        cells = np.full((y.size, x.size), np.nan)
        cells[row, place] = np.where(shown, measured, np.nan)
        drawn = axes.pcolormesh(x, y, cells, shading="nearest", rasterized=True, **colours)
    else:
        drawn = axes.scatter(values[shown, 0], values[shown, 1], c=measured[shown], s=9.0, **colours)
    for mark in marks:
        if mark.which.any() and not (mark.marker == "^" and shown[mark.which].all()):
            axes.plot(values[mark.which, 0], values[mark.which, 1], **_look(mark))
    axes.grid(visible=False)
    bar = figure.colorbar(drawn, ax=axes, label=label, extend="both" if colours else "neither")
    if "norm" in colours:
        label_decades(bar.ax.yaxis)
