"""Pictures of an abradable coating: its profile before and after, and a map of its wear by angle and time."""

from typing import Any, Protocol

import numpy as np
from matplotlib.figure import Figure

from casingfem.io.arrays import Array
from casingfem.plot.style import AFTER, BEFORE, PERFECT, new_figure, styled


class Worn(Protocol):
    """What a coating has lost: depths [m] by angle [rad], (cells,), and a map (times, cells)."""

    @property
    def angle(self) -> Array:
        """Angles of the bars [rad]."""
        ...

    @property
    def made(self) -> Array:
        """Deviation of the radius as made [m]."""
        ...

    @property
    def before(self) -> Array:
        """Deviation before the run [m]."""
        ...

    @property
    def after(self) -> Array:
        """Deviation after the run [m]."""
        ...

    @property
    def map_time(self) -> Array:
        """Times of the map [s]."""
        ...

    @property
    def map(self) -> Array:
        """Worn depths at those times [m]."""
        ...


@styled
def figure_wear(wear: Worn) -> Figure:
    """Profile of the coating's surface above, the map of its wear below; larger radius upwards."""
    figure = new_figure(8.0, 6.0)
    axes: Any = figure.subplots(2, 1, sharex=True)
    degrees = np.degrees(wear.angle)
    axes[0].plot(degrees, 1e6 * wear.made, color=PERFECT, linestyle=":", label="as made")
    axes[0].plot(degrees, 1e6 * wear.before, color=BEFORE, label="before the run")
    axes[0].plot(degrees, 1e6 * wear.after, color=AFTER, label="after")
    axes[0].set_ylabel("deviation of the\nradius [µm]")
    axes[0].legend(ncols=3, fontsize=8)
    extent = (0.0, 360.0, float(wear.map_time[0]), float(wear.map_time[-1]))
    axes[1].grid(False)
    image = axes[1].imshow(
        1e6 * wear.map, aspect="auto", origin="lower", extent=extent, cmap="magma_r", interpolation="nearest"
    )
    figure.colorbar(image, ax=axes[1], label="worn depth [µm]")
    axes[1].set_ylabel("time [s]")
    axes[1].set_xlabel("angle on the casing [deg]")
    return figure
