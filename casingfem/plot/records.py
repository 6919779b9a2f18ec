"""Pictures of records: force and responses of a hit with their windows, estimated responses, coherence."""

from typing import Any, cast

import numpy as np
from matplotlib.figure import Figure

from casingfem.experiment.frf.records.estimated import Estimate
from casingfem.plot.experiment import figure_responses, say_synthetic
from casingfem.plot.style import AFTER, BEFORE, MEASURED, PERFECT, new_figure, styled

MOST_SAMPLES = 4000  # of a curve; a longer one is drawn by the extremes of its parts
PULSE = 8.0  # widths of a pulse that the picture of the force shows


@styled
def figure_hit(found: Estimate) -> Figure:
    """Force and responses of the first used hit, with their windows."""
    shown = found.shown
    assert shown is not None  # of a hammer test
    width = max(found.kept[0].width, 2.0 * float(shown.time[1] - shown.time[0]))
    figure = new_figure(9.6, 4.6)
    force, response = figure.subplots(1, 2, width_ratios=(1, 2))
    near = np.abs(shown.time) < PULSE * width
    force.plot(1e3 * shown.time[near], shown.force[near], ".-", color=MEASURED, markersize=3, label="force")
    force.set(xlabel="time from the trigger [ms]", ylabel="force [N]")
    top = float(np.abs(shown.force).max())
    force.plot(
        1e3 * shown.time[near], top * shown.force_window[near], color=AFTER, label="its window, scaled to the peak"
    )
    response.set_title("First hit used: responses and window")
    scale = np.abs(shown.responses).max(axis=1, keepdims=True)
    values = np.abs(shown.responses / np.where(scale > 0.0, scale, 1.0))
    times, envelope = outline(shown.time, values.max(axis=0))
    response.semilogy(times, envelope, color=PERFECT, linewidth=0.6, label="largest response, relative to its peak")
    response.semilogy(shown.time, shown.response_window, color=BEFORE, label="its window")
    response.set(xlabel="time from the trigger [s]", ylabel="response over its peak [-]", ylim=(1e-4, 2.0))
    figure.legend(loc="outside upper left", ncols=2)
    say_synthetic(figure, found.frfs.card)
    return figure


def outline(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A curve by the largest value in each of many parts.

    >>> [len(part) for part in outline(np.arange(9000.0), np.ones(9000))]
    [3000, 3000]
    """
    every = -(-len(x) // MOST_SAMPLES)
    whole = len(x) // every * every
    return x[:whole:every], y[:whole].reshape(-1, every).max(axis=1)


@styled
def figure_estimate(found: Estimate) -> Figure:
    """Responses and the least coherence."""
    return figure_responses(found.frfs, coherence=found.coherence)


@styled
def figure_peaks(found: Estimate) -> Figure:
    """Peak and remaining ringing of every hit; crosses for those that were left out."""
    figure = new_figure(9.6, 2.6)
    peak, left = (cast("Any", axes) for axes in figure.subplots(1, 2))
    for used, style, label in ((True, "o", "used"), (False, "x", "left out")):
        chosen = [(k + 1, hit) for k, hit in enumerate(found.hits) if (not hit.fault) == used]
        if chosen:
            numbers = [number for number, _ in chosen]
            colour = BEFORE if used else AFTER
            peak.plot(numbers, [abs(hit.peak) for _, hit in chosen], style, color=colour, label=label)
            left.plot(numbers, [100.0 * hit.left for _, hit in chosen], style, color=colour, label=label)
    peak.set(xlabel="number of the hit", ylabel="peak of the force [N]")
    left.set(xlabel="number of the hit", ylabel="vibration left at the end [%]")
    for axes in (peak, left):
        axes.set_ylim(0.0, 1.1 * axes.get_ylim()[1])
        axes.xaxis.get_major_locator().set_params(integer=True)
    figure.legend(*peak.get_legend_handles_labels(), loc="outside upper left", ncols=2)
    return figure
