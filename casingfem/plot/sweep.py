"""Sweeps drawn: what was measured over one varied key as curves, over two as maps."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from casingfem.io.arrays import FloatArray
from casingfem.plot.style import AFTER, BEFORE, DIVERGING, new_figure, styled

PANELS = (
    ("amplitude_m", "amplitude [m]"),
    ("contact_fraction", "contact fraction"),
    ("growth_1_s", "growth [1/s]"),
    ("dominant_n", "dominant n"),
)


@styled
def figure_sweep(keys: Sequence[str], values: FloatArray, rows: Sequence[Mapping[str, Any]]) -> Figure:
    """Amplitude, contact fraction, growth and dominant nodal diameter of all runs.

    `keys` names the varied numbers, one or two of them; `values` (runs, keys). Runs that were refused or broke off are
    crosses.
    """
    figure = new_figure(8.2, 6.4)
    done = np.array([row["status"] == "done" for row in rows], dtype=bool)
    for k, (name, label) in enumerate(PANELS):
        axes = figure.add_subplot(2, 2, k + 1)
        measured = np.array([np.nan if row[name] is None else float(row[name]) for row in rows])
        if len(keys) == 1:
            _curve(axes, values[:, 0], measured, done)
            axes.set(xlabel=keys[0], ylabel=label)
        else:
            _map(figure, axes, values, measured, done, label)
            axes.set(xlabel=keys[0], ylabel=keys[1])
        if name == "amplitude_m" and len(keys) == 1 and np.any(measured[done] > 0.0):
            axes.set_yscale("log")
    return figure


def _curve(axes: Any, x: FloatArray, measured: FloatArray, done: np.ndarray[Any, np.dtype[np.bool_]]) -> None:
    order = np.argsort(x[done], kind="stable")
    axes.plot(x[done][order], measured[done][order], ".-", color=BEFORE, markersize=3.5, linewidth=0.8)
    for at in x[~done]:
        axes.axvline(at, color=AFTER, linewidth=0.8, linestyle=":")


def _map(
    figure: Figure,
    axes: Any,
    values: FloatArray,
    measured: FloatArray,
    done: np.ndarray[Any, np.dtype[np.bool_]],
    label: str,
) -> None:
    colours: dict[str, Any] = {}
    if label.startswith("growth"):
        most = float(np.nanmax(np.abs(measured), initial=0.0)) or 1.0
        colours = {"cmap": DIVERGING, "vmin": -most, "vmax": most}
    elif label.startswith("amplitude") and np.any(measured[done] > 0.0):
        colours = {"norm": LogNorm()}
    x, y = np.unique(values[:, 0]), np.unique(values[:, 1])
    column, row = np.searchsorted(x, values[:, 0]), np.searchsorted(y, values[:, 1])
    if x.size * y.size == len(np.unique(column * y.size + row)) and min(x.size, y.size) > 1:
        cells = np.full((y.size, x.size), np.nan)
        cells[row, column] = np.where(done, measured, np.nan)
        drawn = axes.pcolormesh(x, y, cells, shading="nearest", rasterized=True, **colours)
    else:
        drawn = axes.scatter(values[done, 0], values[done, 1], c=measured[done], s=9.0, **colours)
    axes.plot(values[~done, 0], values[~done, 1], "x", color=AFTER, markersize=4.0)
    axes.grid(visible=False)
    figure.colorbar(drawn, ax=axes, label=label)
