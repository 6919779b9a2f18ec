"""Random mistuning drawn: how wide the splits of each doublet spread over the draws."""

import numpy as np
from matplotlib.figure import Figure

from casingfem.modal.mistuning import Mistuning
from casingfem.plot.style import AFTER, BEFORE, GREEN, PURPLE, SKY, new_figure, styled

COLOURS = (BEFORE, AFTER, GREEN, PURPLE, SKY)  # of the meridional ranks 1, 2, ...
FLOOR = 1e-4  # per cent: splits below are drawn there


@styled
def figure_splits(found: Mistuning) -> Figure:
    """Quantiles of the relative split against nodal diameters: 10 to 90 % as a bar, median, 99 % as a tick."""
    figure = new_figure()
    axes = figure.add_subplot()
    ranks = sorted({m for _, m in found.perfect})
    for m in ranks:
        colour = COLOURS[(m - 1) % len(COLOURS)]
        own = sorted(n for n, rank in found.perfect if rank == m)
        present = [n for n in own if np.any((found.n == n) & (found.m == m))]
        if not present:
            continue
        splits = [100.0 * found.split[(found.n == n) & (found.m == m)] for n in present]
        low, middle, high, far = (
            np.maximum([np.quantile(values, level) for values in splits], FLOOR) for level in (0.1, 0.5, 0.9, 0.99)
        )
        x = np.array(present) + 0.18 * (m - 0.5 * (ranks[0] + ranks[-1]))
        axes.vlines(x, low, high, color=colour, linewidth=4.0, alpha=0.45)
        axes.plot(x, middle, "o", color=colour, markersize=4.5, label=f"m = {m}")
        axes.plot(x, far, "_", color=colour, markersize=9.0)
    axes.set_yscale("log")
    axes.set_xlabel("nodal diameters n")
    axes.set_ylabel("split of the pair [%]")
    axes.set_title(f"Splits over {found.draws} draws: median, 10 to 90 %, 99 %")
    axes.legend()
    return figure
