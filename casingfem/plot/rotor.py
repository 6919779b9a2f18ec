"""A rotor over speed: whirl frequencies and orbit; a run of a rotor in its casing: speed, orbit, support forces."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from casingfem.io.arrays import Array
from casingfem.plot.history import BINS, envelope
from casingfem.plot.style import AFTER, BEFORE, GREEN, PERFECT, new_figure, rpm_above, styled

SENSES = {"forward": (AFTER, "o"), "backward": (BEFORE, "s"), "planar": (GREEN, "D")}


@styled
def figure_whirl(found: Any, response: Any, critical_hz: Sequence[float]) -> Figure:
    """Whirl frequencies over speed (top) and radius of the steady orbit (bottom); dotted lines: critical speeds.

    `found` and `response` are the results of `ct.rotor.campbell` and `ct.rotor.unbalance_response`.
    """
    figure = new_figure(7.6, 5.6)
    axes: Any = figure.subplots(2, 1, sharex=True)
    sense = np.array(found.sense)
    for name, (colour, mark) in SENSES.items():
        if np.any(sense == name):
            at = sense == name
            axes[0].plot(found.speed_hz[at], found.freq_hz[at], mark, color=colour, markersize=4, label=name)
    top = float(response.speed_hz[-1])
    axes[0].plot([0.0, top], [0.0, top], ":", color=PERFECT, label="once a turn")
    axes[1].semilogy(response.speed_hz, 1e3 * np.abs(response.forward), color=AFTER)
    for axis in axes:
        for hz in critical_hz:
            axis.axvline(hz, color=PERFECT, linestyle=":", linewidth=0.9)
    axes[0].set_ylabel("whirl frequency [Hz]")
    axes[1].set(xlabel="speed [Hz]", ylabel="radius of the orbit [mm]")
    rpm_above(axes[0])
    figure.legend(loc="outside upper left", ncols=4)
    return figure


@styled
def figure_rotor_stability(found: Any) -> Figure:
    """Growth of a rotor over speed, free and in synchronous rub (top); orbit of the rub, and dry whirl (below).

    `found` is a `contact.stability.RotorStability`.
    """
    panels = 3 if found.in_casing else 1
    figure = new_figure(7.6, 2.0 + 1.6 * panels)
    axes: Any = figure.subplots(panels, 1, sharex=True, squeeze=False)[:, 0]
    axes[0].axhline(0.0, color="#777777", linewidth=0.8)
    axes[0].plot(found.speed_hz, found.free.growth, color=BEFORE, label="free rotor")
    for low, high in found.free.bands_hz:
        axes[0].axvspan(low, high, color=AFTER, alpha=0.12, linewidth=0.0)
    axes[0].set_ylabel("growth [1/s]")
    if found.in_casing:
        axes[0].plot(found.speed_hz, found.rub_growth, color=AFTER, label="synchronous rub")
        axes[1].plot(found.speed_hz, 1e3 * found.rub_orbit, color=AFTER)
        axes[1].set_ylabel("rub orbit [mm]")
        axes[2].plot(found.speed_hz, found.dry_hz, color=BEFORE)
        axes[2].set_ylabel("dry whirl [Hz]")
    for axis in axes:
        for one in found.critical:
            if found.speed_hz[0] <= one["speed_hz"] <= found.speed_hz[-1]:
                axis.axvline(one["speed_hz"], color=PERFECT, linestyle=":", linewidth=0.9)
    axes[0].plot([], [], color=PERFECT, linestyle=":", label="critical speed")
    axes[-1].set_xlabel("speed [Hz]")
    rpm_above(axes[0])
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper left", ncols=3)
    return figure


@styled
def figure_rotor_run(history: Any, clearance: float = 0.0) -> Figure:
    """Speed, distance of the disk from rest, forces of bearings and mounts over time; right: the disk's orbit.

    `history` is a `contact.on_rotor.RotorHistory`; `clearance` [m] is drawn as a circle if given.
    """
    figure = new_figure(9.2, 5.2)
    parts: Any = figure.subfigures(1, 2, width_ratios=(1.5, 1.0))
    left, right = parts
    known = history.mounts is not None
    panels: Any = left.subplots(3 if known else 2, 1, sharex=True)
    panels[0].plot(history.time, history.speed_hz, color=PERFECT)
    panels[0].set_ylabel("speed [Hz]")
    moved = [("disk", history.disk, AFTER)]
    moved += [] if history.casing is None else [("casing", history.casing, BEFORE)]
    _sizes(panels[1], history.time, moved, 1e3)
    panels[1].set_ylabel("distance [mm]")
    if known:
        forces = (("bearings", history.bearings, AFTER), ("mounts", history.mounts, BEFORE))
        _sizes(panels[2], history.time, forces, 1e-3)
        panels[2].set_ylabel("force [kN]")
    panels[-1].set_xlabel("time [s]")
    axes: Any = right.subplots()
    for name, path, colour in moved:
        axes.plot(*(1e3 * path.T), color=colour, linewidth=0.4, label=name)
    if clearance > 0.0:
        turn = np.linspace(0.0, 2.0 * np.pi, 181)
        axes.plot(1e3 * clearance * np.cos(turn), 1e3 * clearance * np.sin(turn), ":", color=PERFECT, label="clearance")
    axes.set_aspect("equal", adjustable="datalim")
    axes.set(xlabel="x [mm]", ylabel="y [mm]")
    right.legend(loc="outside upper left", ncols=3)
    return figure


def _sizes(axes: Any, time: Array, curves: Sequence[tuple[str, Array, str]], unit: float) -> None:
    """Lowest and highest length of vectors (ns, 2) in each interval of time."""
    for name, vectors, colour in curves:
        t, low, high = envelope(time, unit * np.hypot(*vectors.T), BINS)
        axes.fill_between(t, low, high, color=colour, linewidth=0.5, alpha=0.7, label=name)
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, fontsize=7.5, borderaxespad=0.1)
