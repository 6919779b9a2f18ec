"""Pictures of chances of random casings: probability over speed, splits of the pairs, importance of each input."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from casingfem.io.arrays import FloatArray
from casingfem.plot.style import AFTER, BEFORE, new_figure, rpm_above, styled
from casingfem.plot.ticks import label_decades

SHOWN = 6  # pairs of the histogram
BINS = 40
Rows = Sequence[Mapping[str, Any]]


@styled
def figure_probability(rows: Rows) -> Figure:
    """Probability of a dangerous speed over speed, with its 95 % interval."""
    figure = new_figure(7.0, 3.4)
    axes: Any = figure.add_subplot()
    names = ("speed_hz", "probability", "low", "high")
    speed, value, low, high = (np.array([row[name] for row in rows]) for name in names)
    axes.fill_between(speed, 100.0 * low, 100.0 * high, color=AFTER, alpha=0.25, linewidth=0.0, label="95 % interval")
    axes.plot(speed, 100.0 * value, color=AFTER, label="probability")
    axes.set(xlabel="speed [Hz]", ylabel="dangerous [% of casings]", xlim=(speed[0], speed[-1]))
    axes.set_ylim(bottom=0.0)
    figure.legend(loc="outside upper left", fontsize=8, ncols=2)
    rpm_above(axes)
    return figure


@styled
def figure_splits_of(splits: FloatArray, names: Sequence[str]) -> Figure:
    """Histograms of the splits of the lowest pairs, (pairs, casings), on a logarithmic axis."""
    figure = new_figure(7.0, 3.4)
    axes: Any = figure.add_subplot()
    shown = [part[part > 0.0] for part in splits[:SHOWN]]
    ends = np.percentile(np.concatenate(shown), [0.1, 99.9])
    edges = 100.0 * np.geomspace(ends[0], ends[1], BINS + 1)
    for part, name in zip(shown, names, strict=False):
        axes.hist(100.0 * part, bins=edges, histtype="step", label=name, density=False)
    axes.set(xlabel="split of the pair [%]", ylabel="casings", xscale="log")
    label_decades(axes.xaxis)
    figure.legend(loc="outside upper left", fontsize=8, ncols=3)
    return figure


@styled
def figure_importance(rows: Rows) -> Figure:
    """Total and first-order Sobol indices of each input for each result, with 95 % intervals."""
    results = list(dict.fromkeys(str(row["result"]) for row in rows))
    figure = new_figure(7.0, 1.0 + 0.5 * len(rows))
    for k, result in enumerate(results):
        axes: Any = figure.add_subplot(len(results), 1, k + 1)
        own = [row for row in rows if row["result"] == result]
        place = np.arange(len(own))[::-1]
        for shift, name, colour in ((0.18, "total", AFTER), (-0.18, "first", BEFORE)):
            value = np.array([row[name] for row in own])
            ends = np.array([[row[name] - row[f"{name}_low"], row[f"{name}_high"] - row[name]] for row in own]).T
            label = "total" if name == "total" else "alone"
            axes.barh(place + shift, value, height=0.34, color=colour, label=label, xerr=np.maximum(ends, 0.0))
        axes.set_yticks(place, [str(row["group"]) for row in own])
        axes.set_title(result, loc="left")
        axes.set_xlabel("Sobol index [-]")
        axes.set_xlim(left=0.0)
        if k == 0:
            axes.legend(fontsize=8, ncols=2, loc="lower right", bbox_to_anchor=(1.0, 1.0))
    return figure
