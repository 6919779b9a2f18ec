"""A rotor over speed: whirl frequencies by sense with the speed itself as a line, and the orbit under its unbalance."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from casingfem.plot.style import AFTER, BEFORE, GREEN, PERFECT, new_figure, rpm_above, styled

SENSES = {"forward": (AFTER, "o"), "backward": (BEFORE, "s"), "planar": (GREEN, "D")}


@styled
def figure_whirl(found: Any, response: Any, critical_hz: Sequence[float]) -> Figure:
    """Whirl frequencies over speed (top) and the radius of the steady orbit (bottom); dotted lines: critical speeds.

    `found` and `response` are what `ct.rotor.campbell` and `ct.rotor.unbalance_response` return.
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
