"""A test compared with a model: MAC matrix, differences of shapes, bolts or masses that explain a table."""

from collections.abc import Iterable
from itertools import product
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.figure import Figure

from casingfem.experiment.correlation.correlate import Correlation
from casingfem.io.arrays import FloatArray, IntArray
from casingfem.locate.located import Localisation
from casingfem.modal.mesh_modes import MeshModes
from casingfem.modal.mode_set import ModeSet
from casingfem.plot.style import AFTER, BEFORE, PERFECT, SKY, new_figure, styled
from casingfem.structure.geometry.chart import is_axisymmetric

WRITTEN = 0.2  # modal assurance from which it is written into its cell


@styled
def figure_mac(found: Correlation) -> Figure:
    """MAC of measured shapes (rows) with computed modes (columns); pairs are framed, doublets as one."""
    figure = new_figure(7.6, 5.6)
    axes = figure.add_subplot()
    pairs = [(np.array(match.rows), np.array(match.modes)) for match in found.pairing.matches]
    image = mac_panel(axes, found.mac, pairs, found.modes, found.measured.freq_hz, size=6.5)
    axes.set(ylabel="measured mode, by its frequency [Hz]", title="MAC [%]; pairs framed")
    figure.colorbar(image, ax=axes, shrink=0.8, label="MAC [-]")
    return figure


def mac_panel(
    axes: Axes,
    mac: FloatArray,
    pairs: Iterable[tuple[Any, Any]],
    modes: ModeSet,
    freq_hz: FloatArray,
    size: float = 6.5,
) -> QuadMesh:
    """A MAC matrix with rows by frequency, columns by mode and n; frames around rows and modes of each pair.

    Cells are drawn as shapes, since resampling of an image would shift cells against their frames. Members of a pair
    that are not neighbours have separate frames. Values of at least WRITTEN are printed in their cells, in per cent.
    """
    height, width = mac.shape
    edges = np.arange(width + 1) - 0.5, np.arange(height + 1) - 0.5
    cells = axes.pcolormesh(*edges, mac, cmap="Greys", vmin=0.0, vmax=1.0, edgecolors="face", linewidth=0.1)
    axes.set(xlim=(-0.5, width - 0.5), ylim=(height - 0.5, -0.5))
    for row, column in np.argwhere(np.asarray(mac) >= WRITTEN).tolist():
        colour = "white" if mac[row, column] > 0.6 else "black"
        value = axes.text(
            column, row, f"{100.0 * mac[row, column]:.0f}", ha="center", va="center", fontsize=size - 0.5, color=colour
        )
        value.set_in_layout(False)
    for rows, columns in pairs:
        for (top, bottom), (left, right) in product(runs(rows), runs(columns)):
            x, y = np.array([left, right, right, left, left]), np.array([top, top, bottom, bottom, top])
            axes.plot(x, y, color=AFTER, linewidth=1.2, clip_on=False)
    words = [f"{k + 1}" if n < 0 else f"{k + 1}\nn {n}" for k, n in enumerate(modes.nodal_diameters)]
    axes.set_xticks(range(len(words)), words, fontsize=size)
    axes.set_yticks(range(len(freq_hz)), [f"{f:.1f}" for f in freq_hz], fontsize=6.5)
    axes.grid(visible=False)
    axes.set_xlabel("computed mode")
    return cells


def runs(places: IntArray) -> list[tuple[float, float]]:
    """Edges of the cells at these indices, joined for neighbours.

    >>> runs(np.array([4, 2, 3, 7]))
    [(1.5, 4.5), (6.5, 7.5)]
    """
    ordered = np.unique(places)
    parts = np.split(ordered, np.flatnonzero(np.diff(ordered) > 1) + 1)
    return [(float(part[0]) - 0.5, float(part[-1]) + 0.5) for part in parts]


@styled
def figure_comac(found: Correlation) -> Figure:
    """COMAC and enhanced COMAC at the sensors: by angle and height on a casing, else by their coordinates."""
    figure = new_figure(7.6, 3.6)
    for place, (name, values, colours) in enumerate(
        (("COMAC", found.comac, ("viridis", 0.0, 1.0)), ("enhanced COMAC", found.ecomac, ("viridis_r", 0.0, None)))
    ):
        axes = figure.add_subplot(1, 2, place + 1)
        (x, across), (y, up) = sensor_places(found)
        colour, low, high = colours
        dots = axes.scatter(x, y, c=values, cmap=colour, vmin=low, vmax=high, s=36, edgecolor=BEFORE)
        axes.set(xlabel=across, ylabel=up, title=name)
        figure.colorbar(dots, ax=axes, label=f"{name} [-]")
    return figure


def sensor_places(found: Correlation) -> tuple[tuple[FloatArray, str], tuple[FloatArray, str]]:
    """Positions of the sensors in the picture, across and up, with the names of the axes."""
    if isinstance(found.modes, MeshModes):
        wide = np.sort(np.argsort(np.ptp(found.measured.points, axis=0))[1:])
        across, up = ((found.measured.points[:, axis], f"{'xyz'[axis]} [m]") for axis in wide.tolist())
        return across, up
    chart = found.modes.shell.chart
    if is_axisymmetric(chart):
        z = np.real(chart.surface(found.sensors.a, found.sensors.b, None).x[2])
        return (np.degrees(found.sensors.b) % 360.0, "angle [deg]"), (z, "z [m]")
    return (found.sensors.b, "second parameter [m or rad]"), (found.sensors.a, "first parameter [m or rad]")


@styled
def figure_located(found: Localisation) -> Figure:
    """A polar picture: all candidates, the changes found, and equally likely explanations."""
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
    axes.set(ylim=(0.0, 1.15 if bolts else None), title="stiffness left [-]" if bolts else "mass added [g]")
    figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure
