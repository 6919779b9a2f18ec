"""Time histories as envelopes of lowest and highest values, with a close-up of one time."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from casingfem.io.arrays import Array
from casingfem.plot.style import new_figure, styled
from casingfem.plot.thousands import in_thousands
from casingfem.plot.ticks import Powers

BINS = 600  # stretches over the width of a panel
BESIDE = 0.11  # of a panel: where its legend begins, beside the power of ten
SHORT = 40  # letters of all names of a panel that have room in one line
POINTS = 4000  # drawn per curve of a close-up: extremes of each bin beyond that


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Panel:
    """Curves over time that share an axis, each (name, values, colour); `level` is a horizontal line with its name."""

    label: str
    time: Array
    curves: Sequence[tuple[str, Array, str]]
    level: tuple[float, str] | None = None
    from_zero: bool = False


@styled
def figure_history(panels: Sequence[Panel], closeup: tuple[float, float] | None = None) -> Figure:
    """Panels one below the other over the whole run, with the same curves over a short interval at their right.

    A long record is drawn as the band between the lowest and the highest value of each of BINS intervals. `figure.axes`
    are the panels of the whole run, then those of the close-up.
    """
    figure = new_figure(8.2, 0.7 + 1.75 * len(panels))
    span = max((float(panel.time[-1] - panel.time[0]) for panel in panels if len(panel.time)), default=1.0)
    scale, unit = time_unit(span)
    closeup = None if closeup is None else (scale * closeup[0], scale * closeup[1])
    panels = [replace(panel, time=scale * panel.time) for panel in panels]
    columns = 1 if closeup is None else 2
    grid = figure.add_gridspec(len(panels), columns, width_ratios=(2.1, 1.0)[:columns])
    for column in range(columns):
        made: list[Any] = []
        for row, panel in enumerate(panels):
            axes: Any = figure.add_subplot(grid[row, column], sharex=made[0] if made else None)
            made.append(axes)
            _one(axes, panel, closeup if column else None)
            if row < len(panels) - 1:
                axes.tick_params(labelbottom=False)
            if column == 0:
                axes.set_ylabel(panel.label)
                if closeup is not None:
                    axes.axvspan(*closeup, color="#f0c000", alpha=0.3, linewidth=0.0, zorder=0)
        made[-1].set_xlabel(f"time [{unit}]")
        if column:
            made[0].set_title("close-up", fontsize=9)
            made[0].set_xlim(closeup)
            made[-1].xaxis.set_major_locator(MaxNLocator(3))
            made[-1].ticklabel_format(axis="x", useOffset=False)
    for row in range(len(panels)):
        in_thousands(*(axes.yaxis for axes in figure.axes[row :: len(panels)]))
    return figure


def _one(axes: Any, panel: Panel, stretch: tuple[float, float] | None) -> None:
    """The curves of a panel over the whole run, or over an interval of it."""
    if panel.level is not None:
        value, name = panel.level
        axes.axhline(value, color="#777777", linewidth=0.8, linestyle="--" if name else "-", label=name or None)
    named = False
    for name, values, colour in panel.curves:
        time = panel.time
        if stretch is not None:
            kept = (time >= stretch[0]) & (time <= stretch[1])
            axes.plot(*thinned(time[kept], values[kept], POINTS), color=colour, linewidth=1.0)
        elif len(values) <= 2 * BINS:
            axes.plot(time, values, color=colour, linewidth=1.0, label=name or None)
        else:
            at, low, high = envelope(time, values, BINS)
            axes.fill_between(at, low, high, color=colour, alpha=0.4, linewidth=0.0)
            axes.plot(at, low, color=colour, linewidth=0.6)
            axes.plot(at, high, color=colour, linewidth=0.6, label=name or None)
        named = named or bool(name)
    if panel.from_zero:
        axes.set_ylim(bottom=0.0)
    axes.yaxis.set_major_formatter(Powers(-4, 5))
    if stretch is None and (named or (panel.level is not None and panel.level[1])):
        letters = sum(len(name) for name, _, _ in panel.curves)
        axes.legend(
            loc="lower left", bbox_to_anchor=(BESIDE, 1.0), ncols=4 if letters < SHORT else 2, fontsize=7.5,
            borderaxespad=0.1, columnspacing=1.0,
        )  # fmt: skip


def time_unit(span: float) -> tuple[float, str]:
    """Factor and unit for times of a run with this length [s].

    >>> time_unit(0.4), time_unit(2.5e-4)
    ((1.0, 's'), (1000.0, 'ms'))
    """
    return (1.0, "s") if span >= 0.05 else (1e3, "ms") if span >= 5e-5 else (1e6, "µs")


def envelope(time: Array, values: Array, bins: int) -> tuple[Array, Array, Array]:
    """Middle, lowest and highest value of intervals with equally many samples; no peak is lost.

    >>> at, low, high = envelope(np.arange(6.0), np.array([0.0, 5.0, 1.0, -2.0, 3.0, 9.0]), 3)
    >>> at.tolist(), low.tolist(), high.tolist()
    ([0.5, 2.5, 4.5], [0.0, -2.0, 3.0], [5.0, 1.0, 9.0])
    """
    starts = np.unique(np.linspace(0, len(values), bins + 1).astype(int))[:-1]
    ends = np.append(starts[1:], len(values)) - 1
    middle = 0.5 * (time[starts] + time[ends])
    return middle, np.minimum.reduceat(values, starts), np.maximum.reduceat(values, starts)


def thinned(time: Array, values: Array, points: int) -> tuple[Array, Array]:
    """A long record as the lowest and highest value of each bin, so that no peak is lost.

    >>> t, y = thinned(np.arange(100_000.0), np.eye(1, 100_000, 777)[0], 6000)
    >>> len(t) <= 6000, float(y.max())
    (True, 1.0)
    """
    if len(values) <= points:
        return time, values
    size = 2 * -(-len(values) // points)
    bins = len(values) // size
    whole = values[: bins * size].reshape(bins, size)
    places = np.sort(np.stack([whole.argmin(axis=1), whole.argmax(axis=1)]), axis=0)
    index = (places + size * np.arange(bins)).T.ravel()
    return time[index], values[index]


def closeup_of(time: Array, force: Array, least: float) -> tuple[float, float] | None:
    """An interval about the largest value of `force`, three times as long as it is positive there.

    It is at least 3 `least` [s] and at most a third of the record; None if these contradict each other, or without
    positive values.

    >>> t = np.linspace(0.0, 10.0, 1001)
    >>> closeup_of(t, np.where(abs(t - 4.0) < 0.105, 1.0, 0.0), 0.0)
    (3.7, 4.3)
    """
    span = float(time[-1] - time[0]) if len(time) else 0.0
    if not len(force) or not force.max() > 0.0 or 9.0 * least >= span:
        return None
    peak = int(force.argmax())
    before, after = np.flatnonzero(force[:peak] <= 0.0), np.flatnonzero(force[peak:] <= 0.0)
    start = float(time[int(before[-1]) + 1]) if before.size else float(time[0])
    end = float(time[peak + int(after[0]) - 1]) if after.size else float(time[-1])
    length = max(end - start, least)
    middle = 0.5 * (start + end)
    if length > span / 9.0:
        length, middle = span / 9.0, float(time[peak])
    return round(max(middle - 1.5 * length, float(time[0])), 12), round(min(middle + 1.5 * length, float(time[-1])), 12)
