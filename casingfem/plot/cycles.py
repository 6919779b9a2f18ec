"""Periodic motions: branches over their parameter with stability and special points, Floquet multipliers, orbits."""

from collections.abc import Mapping, Sequence
from itertools import groupby
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from casingfem.plot.style import AFTER, BEFORE, GREEN, MEASURED, PERFECT, PURPLE, SKY, new_figure, rpm_above, styled
from casingfem.plot.ticks import Powers

COLOURS = (BEFORE, AFTER, GREEN, PURPLE, SKY)
MARKS = {"fold": "s", "flip": "D", "Neimark-Sacker": "o", "branch point": "P", "grazing": "|"}
LABELS = {
    "speed_hz": "speed [Hz]",
    "freq_hz": "frequency [Hz]",
    "amplitude": "force [N]",
    "clearance": "clearance [m]",
    "friction": "coefficient of friction [-]",
}
PLANE = 2.0  # magnitude up to which multipliers are drawn in their plane
LARGEST = 6  # multipliers of an orbit that are drawn


@styled
def figure_cycles(
    rows: Sequence[Mapping[str, Any]], marks: Sequence[Mapping[str, Any]], reached: Sequence[Mapping[str, Any]] = ()
) -> Figure:
    """Amplitude of each channel over the parameter, one panel for each channel.

    `rows` are those of `Cycles.records`; `marks` its special points: kind, branch, the parameter, amplitudes; `reached`
    the motions of `Basins.records` with the parameter, drawn with the part of random starts that end on them.
    """
    names = [key for key in rows[0] if key.startswith("amplitude_")]
    largest_m = max((abs(row[name]) for row in rows for name in names if np.isfinite(row[name])), default=0.0)
    scale, unit = (1e3, "mm") if largest_m < 0.1 else (1.0, "m")
    parameter = list(rows[0])[1]
    figure = new_figure(7.6, 1.2 + 2.9 * len(names))
    panels: Any = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
    for axes, name in zip(panels, names, strict=True):
        for number, part in groupby(rows, key=lambda row: row["branch"]):
            _branch(axes, list(part), parameter, name, scale, COLOURS[(int(number) - 1) % len(COLOURS)])
        for kind, shape in MARKS.items():
            shown = [mark for mark in marks if mark["kind"] == kind]
            x, y = [mark[parameter] for mark in shown], [scale * mark[name] for mark in shown]
            if shown:
                colour = PERFECT if kind == "grazing" else MEASURED
                axes.plot(x, y, shape, color=colour, markersize=6, mfc="white", label=kind, zorder=4)
        for one in reached:
            x, y = one[parameter], scale * one[f"{name}_m"]
            axes.plot(x, y, "o", color=AFTER, markersize=4.0 + 14.0 * one["share"] ** 0.5, alpha=0.5, zorder=5)
            axes.annotate(f"{one['share']:.0%}", (x, y), xytext=(9, 0), textcoords="offset points", va="center")
        axes.set_ylabel(f"max |{name.removeprefix('amplitude_')}| [{unit}]")
        axes.yaxis.set_major_formatter(Powers(-3, 4))
    panels[-1].set_xlabel(LABELS.get(parameter, parameter))
    if parameter == "speed_hz":
        rpm_above(panels[0])
    for kept, style in (("stable", "-"), ("unstable", "--")):
        panels[0].plot([], [], color=BEFORE, linestyle=style, label=kept)
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper left", ncols=4)
    return figure


def _branch(
    axes: Any, rows: list[Mapping[str, Any]], parameter: str, name: str, scale: float, colour: str
) -> None:  # fmt: skip
    """One branch; an interval of equal stability extends to the first point of the next, without gaps."""
    start = 0
    for kept, part in groupby(rows, key=lambda row: row["stable"]):
        stop = start + len(list(part))
        shown = rows[start : stop + 1]
        x, y = [row[parameter] for row in shown], [scale * row[name] for row in shown]
        axes.plot(x, y, color=colour, linestyle="-" if kept else "--")
        start = stop


@styled
def figure_multipliers(found: Any) -> Figure:
    """Floquet multipliers of all orbits in the complex plane, and the largest magnitude over the parameter.

    `found` is a `contact.cycles.Cycles`. An orbit is stable if all its multipliers are inside the unit circle. The
    LARGEST of each orbit are drawn, in the plane those up to magnitude PLANE.
    """
    figure = new_figure(8.2, 3.9)
    plane, beside = figure.subplots(1, 2, width_ratios=(1.0, 1.15))
    circle = np.exp(2j * np.pi * np.linspace(0.0, 1.0, 181))
    plane.plot(circle.real, circle.imag, color="#777777", linewidth=0.9)
    points = [point for branch in found.branches for point in branch.points]
    for kept, colour, name in ((True, BEFORE, "stable orbit"), (False, AFTER, "unstable orbit")):
        chosen = [point for point in points if point.stable is kept]
        if chosen:
            values = np.concatenate([largest(point.multipliers) for point in chosen])
            shown = values[np.abs(values) <= PLANE]
            plane.plot(shown.real, shown.imag, ".", color=colour, markersize=3.5, label=name)
    reach = 1.1 * max(1.0, *(float(np.abs(part).max(initial=0.0)) for line in plane.lines for part in line.get_data()))
    plane.set(xlim=(-reach, reach), ylim=(-reach, reach), xlabel="real part of the multiplier [-]",
              ylabel="imaginary part [-]", aspect="equal")  # fmt: skip
    for number, branch in enumerate(found.branches, 1):
        size = [point.multiplier for point in branch.points]
        colour = COLOURS[(number - 1) % len(COLOURS)]
        beside.plot(branch.value, size, ".-", color=colour, markersize=3.0, linewidth=0.8)
    beside.axhline(1.0, color="#777777", linewidth=0.9)
    beside.set(xlabel=LABELS.get(found.name, found.name), ylabel="largest |multiplier| [-]")
    if max(point.multiplier for point in points) > 20.0:
        beside.set_yscale("log")
    figure.legend(*plane.get_legend_handles_labels(), loc="outside upper left", ncols=3, fontsize=8)
    return figure


def largest(multipliers: Any) -> Any:
    """The LARGEST multipliers by magnitude.

    >>> largest(np.array([0.1, -2.0, 0.5j])).tolist()
    [(-2+0j), 0.5j, (0.1+0j)]
    """
    return multipliers[np.argsort(-np.abs(multipliers), kind="stable")[:LARGEST]].astype(complex)


@styled
def figure_orbits(traces: Sequence[Any]) -> Figure:
    """Displacement over the period, and velocity over displacement, of the first channel; one colour for each orbit.

    `traces` are `contact.cycles.Trace`; unstable orbits are dashed.
    """
    figure = new_figure(8.2, 3.7)
    over_time, portrait = figure.subplots(1, 2, width_ratios=(1.25, 1.0))
    for trace, colour in zip(traces, COLOURS, strict=False):
        u = next(iter(trace.displacement.values()))
        style = {"color": colour, "linestyle": "-" if trace.orbit.stable else "--", "linewidth": 1.1}
        step = trace.time[1] - trace.time[0]
        velocity = (np.roll(u[:-1], -1) - np.roll(u[:-1], 1)) / (2.0 * step)  # the motion closes on itself
        unit = LABELS.get(trace.orbit.name, trace.orbit.name).partition("[")[2].partition("]")[0]
        label = f"{trace.orbit.value:.5g} {unit.replace('-', '')}".strip()
        label += f", {trace.orbit.periods} periods" if trace.orbit.periods > 1 else ""
        over_time.plot(trace.time / trace.orbit.period, 1e3 * u, label=label, **style)
        portrait.plot(1e3 * np.append(u[:-1], u[0]), np.append(velocity, velocity[0]), **style)
    channel = next(iter(traces[0].displacement))
    over_time.set(xlabel="time over the orbit's period [-]", ylabel=f"{channel} [mm]", xlim=(0.0, 1.0))
    portrait.set(xlabel=f"{channel} [mm]", ylabel="velocity [m/s]")
    for axes in (over_time, portrait):
        axes.yaxis.set_major_formatter(Powers(-3, 4))
        axes.margins(0.05)
    over_time.set_xlim(0.0, 1.0)
    figure.legend(*over_time.get_legend_handles_labels(), loc="outside upper left", ncols=5, fontsize=8)
    return figure
