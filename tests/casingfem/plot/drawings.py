"""Reads what a figure shows: lines by their labels, units of its axes."""

import re

import numpy as np
from matplotlib.figure import Figure
from matplotlib.projections.polar import PolarAxes

COUNTED = ("nodal diameters n", "mode", "measured mode", "computed mode", "model order", "number of the hit")


def drawn(axes, label: str) -> tuple[np.ndarray, np.ndarray]:
    """The only line of this label."""
    (line,) = [line for line in axes.lines if line.get_label() == label]
    return np.asarray(line.get_xdata(), float), np.asarray(line.get_ydata(), float)


def same(line, x, y) -> bool:
    """Whether a line is drawn through these points exactly."""
    return np.array_equal(line.get_xdata(), x) and np.array_equal(line.get_ydata(), y)


def require_units(figure: Figure) -> None:
    """Every axis that has numbers names its unit, or counts."""
    for axes in figure.axes:
        shared = axes.get_shared_x_axes().get_siblings(axes)
        if isinstance(axes, PolarAxes):  # angles have their sign of degrees, and the title names the radius
            continue
        x = next((other.get_xlabel() for other in (axes, *shared) if other.get_xlabel()), "")
        for label, ticks in ((x, axes.get_xticks()), (axes.get_ylabel(), axes.get_yticks())):
            assert re.search(r"\[[^\]]+\]", label) or label in COUNTED or not len(ticks), (label, axes)
