"""Pictures of an update: measured against computed, splits and orientations, correlations."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from casingfem.experiment.correlation.pairing import Pairing
from casingfem.experiment.frequency_table import FrequencyTable
from casingfem.io.arrays import FloatArray
from casingfem.modal.mode_set import ModeSet
from casingfem.plot.page import raised
from casingfem.plot.style import AFTER, BEFORE, DIVERGING, MEASURED, PERFECT, new_figure, styled
from casingfem.updating.result import UpdateResult

LOOKS: dict[str, dict[str, Any]] = {
    "measured": {"color": MEASURED, "marker": "D"},
    "perfect": {"color": PERFECT, "marker": "s", "mfc": "white"},
    "imperfect": {"color": BEFORE, "marker": "^"},
    "before": {"color": BEFORE, "marker": "^"},
    "updated": {"color": AFTER, "marker": "o"},
}
SHIFTS = {"measured": 0.08, "perfect": -0.24, "imperfect": -0.08, "before": -0.08, "updated": 0.24}


class Paired(NamedTuple):
    """A model's modes and their pairing with the table."""

    modes: ModeSet
    pairing: Pairing


class Doublets(NamedTuple):
    """Doublets of one source by ascending mean: n, lower and upper [Hz], antinode of the lower [deg]."""

    n: FloatArray
    low: FloatArray
    high: FloatArray
    angle: FloatArray

    @property
    def split(self) -> FloatArray:
        """Relative split."""
        return 2.0 * (self.high - self.low) / (self.high + self.low)


def measured_doublets(table: FrequencyTable) -> Doublets:
    """The doublets of a table; if only the upper's angle is known, the lower's follows from it."""
    rows = [(group.n, *group.rows) for group in table.groups() if len(group.rows) == 2]
    low, high = (np.array([row[k] for row in rows], dtype=int) for k in (1, 2))
    n = np.array([row[0] for row in rows], dtype=float)
    angle = np.where(
        np.isnan(table.angle_deg[low]), table.angle_deg[high] - 90.0 / np.maximum(n, 1.0), table.angle_deg[low]
    )
    return Doublets(n, table.freq_hz[low], table.freq_hz[high], np.mod(angle, 180.0 / np.maximum(n, 1.0)))


def computed_doublets(model: Paired) -> Doublets:
    """The doublets of a model that pair with measured doublets."""
    pairs = [match.modes for match in model.pairing.matches if len(match.modes) == 2]
    low, high = (np.array([pair[k] for pair in pairs], dtype=int) for k in (0, 1))
    modes = model.modes
    return Doublets(modes.nodal_diameters[low].astype(float), modes.freq[low], modes.freq[high], modes.angle_deg[low])


@styled
def figure_comparison(table: FrequencyTable, models: Mapping[str, Paired]) -> Figure:
    """Measured and computed by nodal diameters: frequencies, splits, orientations.

    `models` has the keys "perfect", "imperfect", "updated" (any of them).
    """
    measured = measured_doublets(table)
    panels = 1 + bool(len(measured.n)) + bool(np.isfinite(measured.angle).any())
    figure = new_figure(8.0, 3.2 + 2.0 * (panels - 1))
    grid: Any = figure.subplots(panels, 1, sharex=True, squeeze=False, height_ratios=[2, 1, 1][:panels])
    axes = grid[:, 0]
    kind = "measured (SYNTHETIC)" if table.synthetic else "measured"
    labelled = table.n >= 0
    axes[0].errorbar(
        table.n[labelled] + 0.08, table.freq_hz[labelled], yerr=table.sigma_hz[labelled], fmt="D",
        color=MEASURED, markersize=4.5, label=kind, capsize=2,
    )  # fmt: skip
    for name, model in models.items():
        modes = [mode for match in model.pairing.matches for mode in match.modes]
        x = model.modes.nodal_diameters[modes] + SHIFTS[name]
        axes[0].plot(x, model.modes.freq[modes], linestyle="", markersize=5, label=name, **LOOKS[name])
    axes[0].set_ylabel("frequency [Hz]")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper center", ncols=4)
    sources = {"measured": measured, **{name: computed_doublets(model) for name, model in models.items()}}
    for name, source in sources.items():
        style = {"linestyle": "", "markersize": 4.5, **LOOKS[name]}
        if panels > 1:
            x = source.n + SHIFTS[name]
            axes[1].vlines(x, 0.0, 100.0 * source.split, color=LOOKS[name]["color"], linewidth=1.5)
            axes[1].plot(x, 100.0 * source.split, **style)
        if panels > 2 and name != "perfect":
            axes[2].plot(source.n + SHIFTS[name], source.angle * source.n / 180.0, **style)
    if panels > 1:
        axes[1].set(ylabel="split [%]", ylim=(0.0, None))
    if panels > 2:
        axes[2].set(ylabel="antinode of the lower\nmode [180°/n]", ylim=(-0.05, 1.05))
    axes[-1].set_xlabel("nodal diameters n")
    axes[-1].xaxis.get_major_locator().set_params(integer=True)
    return figure


@styled
def figure_errors(table: FrequencyTable, models: Mapping[str, Paired]) -> Figure:
    """Relative frequency error of every paired row, with two sigma of the measurement."""
    figure = new_figure(8.0, 3.2)
    axes = figure.add_subplot()
    band = 200.0 * table.sigma_hz / table.freq_hz
    x = np.arange(len(table))
    axes.bar(x, 2.0 * band, bottom=-band, width=0.9, color="#dddddd", label="measurement, ± 2 sigma")
    axes.axhline(0.0, color=MEASURED, linewidth=0.8)
    for name, model in models.items():
        rows = [row for match in model.pairing.matches for row in match.rows]
        freq = np.array([model.modes.freq[mode] for match in model.pairing.matches for mode in match.modes])
        error = 100.0 * (freq / table.freq_hz[rows] - 1.0)
        place = np.array(rows) + SHIFTS[name]
        axes.vlines(place, 0.0, error, color=LOOKS[name]["color"], linewidth=1.5)
        axes.plot(place, error, linestyle="", markersize=5.5, label=name, **LOOKS[name])
    axes.set_xticks(x, [str(mode) for mode in table.mode], fontsize=8 if len(table) < 30 else 6)
    axes.set(xlabel="measured mode", ylabel="computed/measured - 1 [%]")
    figure.legend(*axes.get_legend_handles_labels(), loc="outside upper center", ncols=4)
    return figure


PERCENT = 0.1  # decades: a smaller deviation is written in per cent
DRAWS = 2000  # samples that are drawn
REACH = 3.0  # standard deviations to each side that a cell of the corner plot shows
HALF = 0.47  # of a cell


@styled
def figure_corner(fit: UpdateResult, samples: FloatArray | None = None) -> Figure:
    """Posterior of the parameters: densities on the diagonal, ellipses of 1 and 2 sigma below, correlations above.

    Every cell extends REACH standard deviations to each side of the value. A dashed density is the prior. `samples`
    (draws, parameters), in the solver's variables, are dots below the Gaussian of the linearised fit.
    """
    names, R = [wrapped(p.name) for p in fit.parameters], np.asarray(fit.correlation)
    count = len(names)
    figure = new_figure(2.2 + 1.05 * count, 1.6 + 0.85 * count)
    axes: Any = figure.add_subplot()
    above = np.where(np.triu(np.ones_like(R), 1) > 0.0, R, np.nan)
    cells = axes.imshow(np.ma.masked_invalid(above), vmin=-1.0, vmax=1.0, cmap=DIVERGING, aspect="auto")
    turn = np.linspace(0.0, 2.0 * np.pi, 91)
    at = np.linspace(-REACH, REACH, 121)
    for i in range(count):
        axes.plot(i + HALF * at / REACH, i + HALF - 0.85 * np.exp(-0.5 * at**2), color=AFTER, linewidth=1.3)
        prior, sigma = fit.parameters[i].sigma, float(fit.sigma[i])
        if prior is not None and sigma > 0.0:
            wide = np.exp(-0.5 * (at * sigma / prior) ** 2) * min(sigma / prior, 1.0)
            axes.plot(i + HALF * at / REACH, i + HALF - 0.85 * wide, color=PERFECT, linewidth=1.0, linestyle="--")
        for j in range(count):
            if j > i:
                colour = "white" if abs(R[i, j]) > 0.6 else "black"
                axes.text(j, i, f"{R[i, j]:+.2f}", ha="center", va="center", color=colour, fontsize=8.5)
            if j < i:
                if samples is not None and sigma > 0.0:
                    x, y = ((samples[:DRAWS, k] - fit.x[k]) / float(fit.sigma[k]) for k in (j, i))
                    inside = (np.abs(x) < REACH) & (np.abs(y) < REACH)
                    axes.plot(j + HALF * x[inside] / REACH, i - HALF * y[inside] / REACH, ".", color=BEFORE,
                              markersize=1.0, alpha=0.3, rasterized=True)  # fmt: skip
                for size in (1.0, 2.0):  # of unit variances and correlation r: u = cos t, v = r u + sqrt(1 - r^2) sin t
                    u, v = (
                        size * np.cos(turn),
                        size * (R[i, j] * np.cos(turn) + np.sqrt(1.0 - R[i, j] ** 2) * np.sin(turn)),
                    )
                    axes.plot(j + HALF * u / REACH, i - HALF * v / REACH, color=AFTER, linewidth=1.0)
    for edge in np.arange(count + 1) - 0.5:
        axes.axhline(edge, color="#cccccc", linewidth=0.6)
        axes.axvline(edge, color="#cccccc", linewidth=0.6)
    axes.set(xlim=(-0.5, count - 0.5), ylim=(count - 0.5, -0.5))
    axes.grid(visible=False)
    spread = [value_words(fit, k) for k in range(count)]
    axes.set_xticks(range(count), spread, fontsize=7.5)
    axes.set_yticks(range(count), names, fontsize=8)
    axes.tick_params(length=0)
    axes.set_xlabel("value ± standard deviation [as in the study]")
    figure.colorbar(cells, ax=axes, shrink=0.8, label="correlation [-]")
    return figure


def wrapped(name: str, most: int = 16) -> str:
    """A dotted name in lines of limited length, broken at dots.

    >>> wrapped("support.base.k_face.p8.cos").split(chr(10))
    ['support.base', '.k_face.p8.cos']
    """
    lines = [""]
    for k, part in enumerate(name.split(".")):
        word = f".{part}" if k else part
        lines = (
            [*lines[:-1], lines[-1] + word] if len(lines[-1]) + len(word) <= most or not lines[-1] else [*lines, word]
        )
    return "\n".join(lines)


def value_words(fit: UpdateResult, k: int) -> str:
    """A value with its standard deviation, which is relative if the value is much larger."""
    value, sigma, log = float(fit.value[k]), float(fit.sigma[k]), fit.parameters[k].log
    if log:
        spread = f"{100.0 * (10.0**sigma - 1.0):.2g} %" if sigma < PERCENT else f"{sigma:.2g} decades"
        return f"{raised(f'{value:.4g}')}\n± {spread}"
    if abs(value) > 5.0 * sigma:
        return f"{raised(f'{value:.4g}')}\n± {100.0 * sigma / abs(value):.2g} %"
    return f"{raised(f'{value:.3g}')}\n± {raised(f'{sigma:.2g}')}"
