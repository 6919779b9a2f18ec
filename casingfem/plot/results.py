"""The picture of each kind of result, by the name of its class, for the `plot` method of results."""

from collections.abc import Callable
from functools import partial
from importlib import import_module
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from casingfem.plot.style import AFTER, BEFORE, MEASURED, new_figure, placed, styled

Draw = Callable[..., Figure]


def draw(result: Any, ax: Axes | None = None, **options: Any) -> Figure | None:
    """The figure of a result, drawn in `ax` if given; None if there is none for its kind.

    >>> from casingfem.experiment.frequency_table import FrequencyTable
    >>> table = FrequencyTable.from_arrays(freq_hz=[367.9, 368.4], sigma_hz=0.2, n=[8, 8])
    >>> draw(table).axes[0].get_xlabel(), draw("a text")
    ('nodal diameters n', None)
    """
    kinds = (f"{kind.__module__}.{kind.__qualname__}" for kind in type(result).__mro__)
    painter = next((PICTURES[name] for name in kinds if name in PICTURES), None)
    if painter is None:
        return None
    whole: Any = None if ax is None else ax.figure.figure
    with placed(ax):
        figure = painter(result, **options)
    return figure if whole is None else whole


def by_name(module: str, name: str) -> Draw:
    """A function of another module of this folder, imported when it draws."""

    def call(result: Any, **options: Any) -> Figure:
        figure: Figure = getattr(import_module(f"casingfem.plot.{module}"), name)(result, **options)
        return figure

    return call


@styled
def columns(
    result: Any, *, x: str, y: str, labels: tuple[str, str], sigma: str | None = None, level: float | None = None
) -> Figure:
    """Dots of one column of a table over another, with three standard deviations, and a line at `level`."""
    rows = list(result.records())
    at = [row[x] for row in rows]
    words = any(isinstance(value, str) for value in at)
    places = np.arange(len(at)) if words else np.array(at, dtype=float)
    figure = new_figure()
    axes = figure.add_subplot()
    if level is not None:
        axes.axhline(level, color=MEASURED, linewidth=0.8)
    values = np.array([np.nan if row[y] is None else row[y] for row in rows], dtype=float)
    spread = None if sigma is None else 3.0 * np.array([row[sigma] for row in rows], dtype=float)
    axes.errorbar(places, values, yerr=spread, fmt="o", color=BEFORE, markersize=5, capsize=3)
    if words:
        axes.set_xticks(places, at, rotation=30, ha="right", fontsize=8)
    axes.set(xlabel=labels[0], ylabel=labels[1])
    return figure


@styled
def samples(result: Any, *, bins: int = 40) -> Figure:
    """Histograms of the samples of each parameter, with the Gaussian of the linearised fit."""
    found = result.columns()
    figure = new_figure(2.6 * len(found), 2.6)
    panels = figure.subplots(1, len(found), squeeze=False)[0]
    for axes, (name, values), sigma in zip(panels, found.items(), result.gauss_newton, strict=True):
        axes.hist(values, bins=bins, density=True, color=BEFORE, alpha=0.5)
        at = np.linspace(values.min(), values.max(), 200)
        axes.plot(at, np.exp(-0.5 * ((at - values.mean()) / sigma) ** 2) / (sigma * np.sqrt(2.0 * np.pi)), color=AFTER)
        axes.set_title(name, fontsize=8)
        axes.set_yticks([])
    return figure


@styled
def deflection(result: Any) -> Figure:
    """Magnitude of the displacement of all nodes, at their positions in space."""
    table = result.columns()
    figure = new_figure(6.0, 5.0)
    axes: Any = figure.add_subplot(projection="3d")
    size = np.linalg.norm([table[f"u_{k}_m"] for k in "xyz"], axis=0)
    dots = axes.scatter(*(table[f"{k}_m"] for k in "xyz"), c=size, s=4.0, cmap="viridis")
    axes.set_box_aspect([max(float(np.ptp(table[f"{k}_m"])), 1e-9) for k in "xyz"])
    figure.colorbar(dots, ax=axes, label="displacement [m]", shrink=0.7)
    return figure


def sweep(result: Any) -> Figure:
    """Results of the runs over the varied keys."""
    values = np.array([run.values for run in result.plan.runs], dtype=float)
    return by_name("sweep", "figure_sweep")(result.plan.labels, values=values, rows=result.rows)


def identified(result: Any) -> Figure:
    """The fit over all lines; without stored responses, the modes with their uncertainty."""
    if result.lines.size:
        return by_name("identify", "figure_fit")(result)
    return columns(result, x="mode", y="freq_hz", sigma="sigma_hz", labels=("mode", "identified frequency [Hz]"))


def scan(result: Any, *, most: int = 8) -> Figure:
    """Deflections of the strongest waves above the noise."""
    seen = sorted((wave for wave in result.waves() if wave.seen), key=lambda wave: -wave.amplitude)[:most]
    tones = result.tones.tolist()
    shown = [(tones.index(wave.tone), wave.n) for wave in seen]
    return by_name("experiment", "figure_deflections")(result, waves=shown)


def update(result: Any) -> Figure:
    """Measured and computed, before and after: by nodal diameters if the table has them, else their errors."""
    from casingfem.plot.update import Paired, figure_comparison, figure_errors

    before, after = Paired(result.before, result.pairing_before), Paired(result.after, result.pairing)
    picture = figure_comparison if np.any(result.table.n >= 0) else figure_errors
    return picture(result.table, {"before": before, "updated": after})


def measured(result: Any) -> Figure:
    """Measured frequencies by nodal diameters if the table has them, else by mode."""
    known = np.any(result.n >= 0)
    labels = ("nodal diameters n" if known else "mode", "measured frequency [Hz]")
    return columns(result, x="n" if known else "mode", y="freq_hz", sigma="sigma_hz", labels=labels)


def run(result: Any, *, contact: int | None = None) -> Figure:
    """Force, gap and largest coordinates of a contact, counted from 1; by default that of the largest impulse."""
    place = int(result.impulse.argmax()) if contact is None else contact - 1
    return by_name("contact", "figure_contact")(result, contact=place)


def cycles(result: Any) -> Figure:
    """Amplitudes over the parameter."""
    return by_name("cycles", "figure_cycles")(result.records(), marks=result.marks())


def over_modes(y: str, label: str) -> Draw:
    """A column over the mode numbers."""
    return partial(columns, x="mode", y=y, labels=("mode", label))


PICTURES: dict[str, Draw] = {
    "casingfem.modal.mode_set.ModeSet": by_name("modes", "figure_frequencies"),
    "casingfem.modal.whirl.WhirlModes": over_modes("freq_hz", "frequency in the rotating frame [Hz]"),
    "casingfem.modal.campbell.Campbell": by_name("interaction", "figure_speeds"),
    "casingfem.modal.interaction.Interactions": partial(
        columns, x="speed_hz", y="casing_hz", labels=("speed [Hz]", "frequency of the coinciding casing mode [Hz]")
    ),
    "casingfem.modal.mistuning.Mistuning": by_name("modes", "figure_splits"),
    "casingfem.modal.basis.ModalBasis": over_modes("freq_hz", "frequency [Hz]"),
    "casingfem.structure.shell.static.Deflection": deflection,
    "casingfem.structure.imported.loads.MeshDeflection": deflection,
    "casingfem.experiment.frequency_table.FrequencyTable": measured,
    "casingfem.experiment.identify.identified.Identified": identified,
    "casingfem.experiment.frf.records.estimated.Estimate": by_name("records", "figure_estimate"),
    "casingfem.experiment.correlation.correlate.Correlation": by_name("correlation", "figure_mac"),
    "casingfem.experiment.correlation.matches.Pairing": partial(
        columns, x="measured_hz", y="computed_hz", labels=("measured [Hz]", "computed [Hz]")
    ),
    "casingfem.experiment.circle.scan.CircleScan": scan,
    "casingfem.locate.located.Localisation": by_name("correlation", "figure_located"),
    "casingfem.updating.result.UpdateResult": update,
    "casingfem.updating.shape_fit.ShapeFit": by_name("pages.fit", "figure_shape_mac"),
    "casingfem.updating.uncertainty.posterior.Laplace": partial(
        columns, x="name", y="sigma", labels=("", "standard deviation, whole Hessian")
    ),
    "casingfem.updating.uncertainty.sampling.PosteriorSamples": samples,
    "casingfem.updating.uncertainty.prediction.LeftOut": over_modes("deviation", "predicted - measured [sigma]"),
    "casingfem.updating.identifiability.Identifiability": partial(
        columns, x="direction", y="singular", level=1.0, labels=("", "singular value: determined by the data above 1")
    ),
    "contact.result.Result": run,
    "contact.record.wear.Wear": by_name("contact", "figure_wear"),
    "contact.sweep.sweep.SweepResult": sweep,
    "contact.stability.growth_map.StabilityMap": by_name("interaction", "figure_stability"),
    "contact.stability.peaks.Peaks": partial(
        columns, x="speed_hz", y="growth", labels=("speed [Hz]", "growth of closed contact [1/s]")
    ),
    "contact.interacting.Interactions": by_name("interaction", "figure_interactions"),
    "contact.cycles.result.Cycles": cycles,
    "contact.cycles.basins.Basins": partial(
        columns, x="periods", y="share", labels=("periods", "share of the initial states")
    ),
}
