"""Engine orders on a wheel: amplitude over speed with draws of mistuned blades; the SAFE diagram."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from casingfem.plot.style import AFTER, BEFORE, PERFECT, new_figure, rpm_above, styled

BINS = 60


@styled
def figure_response(found: Any, drawn: Any = None) -> Figure:
    """Amplitudes of all blades over speed, dotted for the tuned wheel; bottom.

    Histogram of amplification of drawn wheels.

    `found` is a `cf.modal.EngineOrderResponse`, `drawn` a `cf.modal.Amplification` or None.
    """
    figure = new_figure(7.6, 3.4 if drawn is None else 5.6)
    axes: Any = figure.subplots(1 if drawn is None else 2, 1, squeeze=False)[:, 0]
    axes[0].semilogy(found.speed_hz, 1e3 * found.amplitude, color=AFTER, linewidth=0.6)
    axes[0].plot([], [], color=AFTER, label="each blade")
    axes[0].semilogy(found.speed_hz, 1e3 * found.tuned, ":", color=PERFECT, label="tuned wheel")
    axes[0].set(xlabel="speed [Hz]", ylabel="amplitude [mm]")
    rpm_above(axes[0])
    if drawn is not None:
        axes[1].hist(drawn.amplification, bins=BINS, color=BEFORE)
        axes[1].axvline(drawn.bound, color=PERFECT, linestyle="--", label="Whitehead's bound")
        axes[1].set(xlabel="amplification [-]", ylabel="draws")
    figure.legend(loc="outside upper left", ncols=4)
    return figure


@styled
def figure_safe(wheel: Any, responses: Sequence[Any]) -> Figure:
    """Frequencies over nodal diameters, with the line of each engine order at its largest amplitude: the SAFE diagram.

    The slope of a line is the speed; it is folded at 0 and N/2 diameters. Circles mark the modes that an order excites:
    equal diameter, within 2 % of its frequency. `wheel` is a `cf.modal.BladedWheel`, `responses` are
    `cf.modal.EngineOrderResponse`.
    """
    figure = new_figure(7.6, 4.6)
    axes: Any = figure.subplots()
    axes.plot(wheel.diameters, wheel.freq, "o", color=BEFORE, markersize=4, label="tuned modes")
    top, half = 1.1 * float(wheel.freq.max()), wheel.blades / 2.0
    for k, one in enumerate(responses):
        order = np.linspace(0.0, top / one.tuned_peak_hz, 400)
        rest = order % wheel.blades
        folded = np.where(rest > half, wheel.blades - rest, rest)
        axes.plot(folded, order * one.tuned_peak_hz, color=PERFECT, linewidth=0.7)
        freq = one.order * one.tuned_peak_hz
        hit = (wheel.diameters == one.diameter) & (np.abs(wheel.freq - freq) < 0.02 * freq)
        axes.plot(wheel.diameters[hit], wheel.freq[hit], "o", markersize=13, markerfacecolor="none", color=AFTER,
                  label="excited" if k == 0 else None)  # fmt: skip
        axes.annotate(f"order {one.order}, {one.tuned_peak_hz:.4g} Hz", (one.diameter, freq), xytext=(6, 8),
                      textcoords="offset points", fontsize=8)  # fmt: skip
    axes.set(xlabel="nodal diameters [-]", ylabel="frequency [Hz]", ylim=(0.0, top))
    figure.legend(loc="outside upper left", ncols=3)
    return figure
