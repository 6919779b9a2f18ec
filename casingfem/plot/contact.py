"""Pictures of a contact run: force, gap and amplitudes against time; the profile of a coating and a map of its wear."""

from typing import Any, Protocol

import numpy as np
from matplotlib.figure import Figure

from casingfem.io.arrays import Array
from casingfem.plot.style import AFTER, BEFORE, GREEN, PERFECT, PURPLE, SKY, new_figure, styled

POINTS = 6000  # drawn per curve: extremes of each bin beyond that


class Run(Protocol):
    """What a contact result shows: arrays over time, one column per contact, states by coordinate."""

    @property
    def time(self) -> Array:
        """Times [s], (n,)."""

    @property
    def gap(self) -> Array:
        """Gaps [m], (n, contacts)."""

    @property
    def state_time(self) -> Array:
        """Times of the states [s], (ns,)."""

    @property
    def state(self) -> Array:
        """Coordinates, (ns, N)."""

    def windowed_force(self) -> Array:
        """Force averaged over the model's shortest period [N], (n, contacts)."""


@styled
def figure_contact(result: Run, contact: int = 0, *, coordinates: int = 4) -> Figure:
    """Force, gap and the largest coordinates of one run over time."""
    states = len(result.state_time) > 1
    figure = new_figure(8.0, 4.2 + 1.9 * states)
    axes: Any = figure.subplots(2 + states, 1, sharex=True)
    axes[0].plot(*thinned(result.time, result.windowed_force()[:, contact]), color=AFTER)
    axes[0].set(ylabel="force, windowed [N]", ylim=(0.0, None))
    axes[1].axhline(0.0, color="#777777", linewidth=0.8)
    axes[1].plot(*thinned(result.time, 1e3 * result.gap[:, contact]), color=BEFORE)
    axes[1].set_ylabel("gap [mm]")
    if states:
        modal = "modal" in getattr(result, "scheme", "modal")
        largest = _largest(result)[:coordinates]
        for k, colour in zip(largest, (BEFORE, AFTER, GREEN, PURPLE, SKY), strict=False):
            axes[2].plot(*thinned(result.state_time, result.state[:, k]), color=colour, label=f"{k + 1}")
        axes[2].set_ylabel("modal coordinate\n[kg$^{1/2}$ m]" if modal else "displacement [m]")
        axes[2].legend(title="mode" if modal else "coordinate", ncols=2, fontsize=8, loc="upper left")
    axes[-1].set_xlabel("time [s]")
    return figure


def _largest(result: Run) -> list[int]:
    """Coordinates by their largest value; what a rub keeps behind them, the forces on its tips, left out."""
    forces = {k for name, a, b in getattr(result, "blocks", ()) if name == "tips" for k in range(a, b)}
    order = np.argsort(-np.abs(result.state).max(axis=0), kind="stable").tolist()
    return [k for k in order if k not in forces]


def thinned(time: Array, values: Array, points: int = POINTS) -> tuple[Array, Array]:
    """A long record as the lowest and highest of each bin, so that no peak is lost.

    >>> t, y = thinned(np.arange(100_000.0), np.eye(1, 100_000, 777)[0])
    >>> len(t) <= POINTS, float(y.max())
    (True, 1.0)
    """
    if len(values) <= points:
        return time, values
    size = 2 * -(-len(values) // points)
    bins = len(values) // size
    whole = values[: bins * size].reshape(bins, size)
    places = np.sort(np.stack([whole.argmin(axis=1), whole.argmax(axis=1)]), axis=0)
    index = (places + size * np.arange(bins)).T.ravel()
    return time[index], values[index]


class Worn(Protocol):
    """What a coating has lost: depths [m] by angle [rad], (cells,), and a map (times, cells)."""

    @property
    def angle(self) -> Array:
        """Angles of the bars [rad]."""

    @property
    def made(self) -> Array:
        """Deviation of the radius as made [m]."""

    @property
    def before(self) -> Array:
        """Deviation before the run [m]."""

    @property
    def after(self) -> Array:
        """Deviation after the run [m]."""

    @property
    def map_time(self) -> Array:
        """Times of the map [s]."""

    @property
    def map(self) -> Array:
        """Worn depths at those times [m]."""


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
    axes[1].set(ylabel="time [s]", xlabel="angle on the casing [deg]")
    return figure
