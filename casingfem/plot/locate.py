"""What a search found, by angle: stiffness left of the bolts, or masses added, with three standard deviations."""

import numpy as np
from matplotlib.figure import Figure

from casingfem.locate.located import Localisation
from casingfem.plot.style import AFTER, PERFECT, SKY, new_figure, styled


@styled
def figure_located(found: Localisation) -> Figure:
    """A polar picture: all candidates, what was found, and the explanations that are as likely."""
    figure = new_figure(5.6, 5.2)
    axes = figure.add_subplot(projection="polar")
    bolts = found.among == "bolts"
    at = np.radians(found.angles_deg)
    axes.plot(at, np.full(len(at), 1.0 if bolts else 0.0), "o", color=PERFECT, markersize=3.5, label="candidates")
    scale = 1.0 if bolts else 1e3
    groups = [("found", AFTER, "o", (found.best,)), ("as likely", SKY, "s", found.others)]
    for label, colour, marker, explanations in groups:
        places = [one for explanation in explanations for one in explanation.found]
        if places:
            angle = np.radians([one.angle_deg for one in places])
            value = scale * np.array([one.value for one in places])
            spread = 3.0 * scale * np.array([one.sigma for one in places])
            axes.errorbar(angle, value, yerr=spread, fmt=marker, color=colour, markersize=6, capsize=3, label=label)
    axes.set_ylim(0.0, 1.15 if bolts else None)
    axes.set_title("stiffness left" if bolts else "mass added [g]")
    figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure
