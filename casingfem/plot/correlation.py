"""Pictures of a correlation: the MAC matrix and where the shapes differ."""

import numpy as np
from matplotlib.figure import Figure

from casingfem.experiment.correlation.correlate import Correlation
from casingfem.io.arrays import FloatArray
from casingfem.modal.mesh_modes import MeshModes
from casingfem.plot.style import AFTER, BEFORE, new_figure, styled


@styled
def figure_mac(found: Correlation) -> Figure:
    """MAC of measured shapes (rows) with computed modes (columns); pairs are framed, doublets as one."""
    figure = new_figure(7.6, 5.6)
    axes = figure.add_subplot()
    image = axes.imshow(found.mac, cmap="Greys", vmin=0.0, vmax=1.0, aspect="auto", interpolation="nearest")
    for match in found.pairing.matches:
        rows, modes = np.array(match.rows), np.array(match.modes)
        low, high = (rows.min() - 0.5, modes.min() - 0.5), (rows.max() + 0.5, modes.max() + 0.5)
        x, y = [low[1], high[1], high[1], low[1], low[1]], [low[0], low[0], high[0], high[0], low[0]]
        axes.plot(x, y, color=AFTER, linewidth=1.2)
    n = found.modes.nodal_diameters
    columns = range(len(found.modes))
    axes.set_xticks(columns, [f"{k + 1}" if n[k] < 0 else f"{k + 1}\nn {n[k]}" for k in columns], fontsize=6.5)
    axes.set_yticks(range(len(found.measured)), [f"{f:.1f}" for f in found.measured.freq_hz], fontsize=6.5)
    axes.grid(visible=False)
    axes.set_xlabel("computed mode")
    axes.set_ylabel("measured [Hz]")
    axes.set_title("MAC; pairs framed")
    figure.colorbar(image, ax=axes, shrink=0.8)
    return figure


@styled
def figure_comac(found: Correlation) -> Figure:
    """COMAC and enhanced COMAC at the sensors on the wall: by angle and height of a casing, else by what they have."""
    figure = new_figure(7.6, 3.6)
    for place, (name, values, colours) in enumerate(
        (("COMAC", found.comac, ("viridis", 0.0, 1.0)), ("enhanced COMAC", found.ecomac, ("viridis_r", 0.0, None)))
    ):
        axes = figure.add_subplot(1, 2, place + 1)
        (x, across), (y, up) = sensor_places(found)
        colour, low, high = colours
        dots = axes.scatter(x, y, c=values, cmap=colour, vmin=low, vmax=high, s=36, edgecolor=BEFORE)
        axes.set_xlabel(across)
        axes.set_ylabel(up)
        axes.set_title(name)
        figure.colorbar(dots, ax=axes)
    return figure


def sensor_places(found: Correlation) -> tuple[tuple[FloatArray, str], tuple[FloatArray, str]]:
    """Where the sensors are drawn, across and up, with the names of the axes."""
    if isinstance(found.modes, MeshModes):
        wide = np.sort(np.argsort(np.ptp(found.measured.points, axis=0))[1:])
        across, up = ((found.measured.points[:, axis], f"{'xyz'[axis]} [m]") for axis in wide.tolist())
        return across, up
    if found.modes.shell.chart.periodic:
        return (np.degrees(found.sensors.b) % 360.0, "angle [deg]"), (found.sensors.a, "z [m]")
    return (found.sensors.b, "second parameter"), (found.sensors.a, "first parameter")
