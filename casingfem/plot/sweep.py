"""What became of many runs: over one varied key as curves, over two as maps; periodic motions over their parameter."""

from collections.abc import Mapping, Sequence
from itertools import groupby
from typing import Any

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from numpy.typing import NDArray

from casingfem.io.arrays import FloatArray
from casingfem.plot.style import AFTER, BEFORE, DIVERGING, GREEN, MEASURED, PERFECT, PURPLE, SKY, new_figure, styled

PANELS = (
    ("amplitude_m", "amplitude [m]"),
    ("contact_fraction", "contact fraction [-]"),
    ("growth_1_s", "growth [1/s]"),
    ("dominant_n", "dominant n [-]"),
)
LOGARITHMIC = ("amplitude_m", "diverged_at_s")
ROBUST = 98.0  # per cent of the values span a colour scale: one run far out leaves the others their colours
COLOURS = (BEFORE, AFTER, GREEN, PURPLE, SKY)
MARKS = {"fold": "s", "flip": "D", "Neimark-Sacker": "o", "branch point": "P", "grazing": "|"}
LABELS = {
    "speed_hz": "speed [turns/s]",
    "freq_hz": "frequency [Hz]",
    "amplitude": "force [N]",
    "clearance": "clearance [m]",
    "friction": "coefficient of friction [-]",
}
Mask = NDArray[np.bool_]
Marks = Mapping[str, tuple[str, Mask]]


@styled
def figure_sweep(keys: Sequence[str], values: FloatArray, rows: Sequence[Mapping[str, Any]]) -> Figure:
    """Amplitude, contact fraction, growth and dominant nodal diameter of all runs.

    `keys` names the varied numbers with their units, one or two of them; `values` (runs, keys). Runs that diverged are
    triangles, with the time they took to where that is drawn; refused or broken ones are crosses.
    """
    status = np.array([row["status"] for row in rows])
    done, lost = status == "done", status == "diverged"
    last = ("diverged_at_s", "diverged after [s]") if lost.any() else PANELS[3]
    chosen = [panel for panel in (*PANELS[:3], last) if any(row[panel[0]] is not None for row in rows)]
    figure = new_figure(8.2, 6.4 if len(chosen) > 2 else 3.4)
    marks = {
        "diverged": ("^", lost),
        "refused or failed": ("x", np.isin(status, ("refused", "failed"))),
    }
    for k, (name, label) in enumerate(chosen):
        axes = figure.add_subplot(-(-len(chosen) // 2), 2, k + 1)
        measured = np.array([np.nan if row[name] is None else float(row[name]) for row in rows])
        shown = lost if name == "diverged_at_s" else done | lost & (name == "growth_1_s")
        if len(keys) == 1:
            _curve(axes, values[:, 0], measured, shown, marks)
            axes.set(xlabel=keys[0], ylabel=label)
        else:
            _map(figure, axes, values, measured, shown, label, marks)
            axes.set(xlabel=keys[0], ylabel=keys[1])
        if name in LOGARITHMIC and len(keys) == 1 and np.any(measured[shown] > 0.0):
            axes.set_yscale("log")
    return figure


def _curve(axes: Any, x: FloatArray, measured: FloatArray, shown: Mask, marks: Marks) -> None:
    order = np.argsort(x[shown], kind="stable")
    axes.plot(x[shown][order], measured[shown][order], ".-", color=BEFORE, markersize=3.5, linewidth=0.8)
    for label, (mark, which) in marks.items():
        if which.any():
            colour = SKY if mark == "^" else AFTER
            axes.plot(
                x[which], np.zeros(which.sum()), mark, color=colour, markersize=4.0, label=label, clip_on=False,
                transform=axes.get_xaxis_transform(),
            )  # fmt: skip
            axes.legend(fontsize=8)


def _map(
    figure: Figure, axes: Any, values: FloatArray, measured: FloatArray, shown: Mask, label: str, marks: Marks
) -> None:
    colours: dict[str, Any] = {}
    known = measured[shown & np.isfinite(measured)]
    if label.startswith("growth"):
        most = float(np.percentile(np.abs(known), ROBUST)) if known.size else 0.0
        colours = {"cmap": DIVERGING, "vmin": -(most or 1.0), "vmax": most or 1.0}
    elif label.startswith(("amplitude", "diverged")) and np.any(known > 0.0):
        low, high = np.percentile(known[known > 0.0], [100.0 - ROBUST, ROBUST])
        colours = {"norm": LogNorm(low, max(high, 1.01 * low))}
    x, y = np.unique(values[:, 0]), np.unique(values[:, 1])
    column, row = np.searchsorted(x, values[:, 0]), np.searchsorted(y, values[:, 1])
    if x.size * y.size == len(np.unique(column * y.size + row)) and min(x.size, y.size) > 1:
        cells = np.full((y.size, x.size), np.nan)
        cells[row, column] = np.where(shown, measured, np.nan)
        drawn = axes.pcolormesh(x, y, cells, shading="nearest", rasterized=True, **colours)
    else:
        drawn = axes.scatter(values[shown, 0], values[shown, 1], c=measured[shown], s=9.0, **colours)
    for mark, which in marks.values():
        if not (mark == "^" and shown[which].all()):
            axes.plot(values[which, 0], values[which, 1], mark, color=SKY if mark == "^" else AFTER, markersize=4.0)
    axes.grid(visible=False)
    figure.colorbar(drawn, ax=axes, label=label, extend="both" if colours else "neither")


@styled
def figure_cycles(
    rows: Sequence[Mapping[str, Any]], marks: Sequence[Mapping[str, Any]], reached: Sequence[Mapping[str, Any]] = ()
) -> Figure:
    """Amplitude of each channel over the parameter, one panel a channel.

    `rows` are those of `Cycles.records`; `marks` its special points: kind, branch, the parameter, amplitudes; `reached`
    the motions of `Basins.records` with the parameter, drawn with the part of random starts that end on them.
    """
    names = [key for key in rows[0] if key.startswith("amplitude_")]
    parameter = list(rows[0])[1]
    figure = new_figure(7.6, 1.2 + 2.9 * len(names))
    panels: Any = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
    for axes, name in zip(panels, names, strict=True):
        for number, part in groupby(rows, key=lambda row: row["branch"]):
            _branch(axes, list(part), parameter, name, COLOURS[(int(number) - 1) % len(COLOURS)])
        for kind, shape in MARKS.items():
            shown = [mark for mark in marks if mark["kind"] == kind]
            x, y = [mark[parameter] for mark in shown], [mark[name] for mark in shown]
            if shown:
                colour = PERFECT if kind == "grazing" else MEASURED
                axes.plot(x, y, shape, color=colour, markersize=6, mfc="white", label=kind, zorder=4)
        for one in reached:
            x, y = one[parameter], one[f"{name}_m"]
            axes.plot(x, y, "o", color=AFTER, markersize=4.0 + 14.0 * one["share"] ** 0.5, alpha=0.5, zorder=5)
            axes.annotate(f"{one['share']:.0%}", (x, y), xytext=(9, 0), textcoords="offset points", va="center")
        axes.set_ylabel(f"max |{name.removeprefix('amplitude_')}| [m]")
    panels[-1].set_xlabel(LABELS.get(parameter, parameter))
    for kept, style in (("stable", "-"), ("unstable", "--")):
        panels[0].plot([], [], color=BEFORE, linestyle=style, label=kept)
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper left", ncols=4)
    return figure


def _branch(axes: Any, rows: list[Mapping[str, Any]], parameter: str, name: str, colour: str) -> None:
    """One branch; a stretch reaches to the first point of the next, so that nothing is left out."""
    start = 0
    for kept, part in groupby(rows, key=lambda row: row["stable"]):
        stop = start + len(list(part))
        shown = rows[start : stop + 1]
        x, y = [row[parameter] for row in shown], [row[name] for row in shown]
        axes.plot(x, y, color=colour, linestyle="-" if kept else "--")
        start = stop
