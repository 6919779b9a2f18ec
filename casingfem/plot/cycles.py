"""Branches of periodic motions drawn: amplitude over the parameter, kept ones full, others dashed."""

from collections.abc import Mapping, Sequence
from itertools import groupby
from typing import Any

from matplotlib.figure import Figure

from casingfem.plot.style import AFTER, BEFORE, GREEN, MEASURED, PERFECT, PURPLE, SKY, new_figure, styled

COLOURS = (BEFORE, AFTER, GREEN, PURPLE, SKY)
MARKS = {"fold": "s", "flip": "D", "Neimark-Sacker": "o", "branch point": "P", "grazing": "|"}
LABELS = {
    "speed_hz": "speed [turns/s]",
    "freq_hz": "frequency [Hz]",
    "amplitude": "force [N]",
    "clearance": "clearance [m]",
}


@styled
def figure_cycles(
    rows: Sequence[Mapping[str, Any]], marks: Sequence[Mapping[str, Any]], reached: Sequence[Mapping[str, Any]] = ()
) -> Figure:
    """Amplitude of each channel over the parameter, one panel a channel.

    `rows` are those of `Cycles.table`; `marks` its special points: kind, branch, the parameter, amplitudes; `reached`
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
