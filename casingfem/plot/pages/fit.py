"""The report's sections on an update as text, figures and tables: parameters and frequencies, then mode shapes."""

import numpy as np
from matplotlib.figure import Figure

from casingfem.experiment.correlation.matches import listed
from casingfem.experiment.correlation.pairing import pair
from casingfem.experiment.frequency_table import FrequencyTable
from casingfem.io.arrays import FloatArray, IntArray
from casingfem.modal.mode_set import Modes
from casingfem.plot.correlation import mac_panel
from casingfem.plot.page import Picture, Section, Table, Verdict, capital, powers, written
from casingfem.plot.style import new_figure, styled
from casingfem.plot.update import Paired, figure_comparison, figure_corner, figure_errors, value_words
from casingfem.updating.columns import PAIRS, units
from casingfem.updating.result import UpdateResult
from casingfem.updating.shape_fit import ShapeComparison, ShapeFit

CORNER = (
    "Posterior of the parameters. Diagonal: density, dashed the prior. Below: ellipses of one and two standard "
    "deviations. Above: correlations; near ±1 the data cannot distinguish two parameters. Every cell spans three "
    "standard deviations to each side."
)
WIDE = 14  # columns of a MAC matrix: wider ones are one below the other
WORST = 4  # parameters that a sentence names


def update_section(fit: UpdateResult, reference: Modes | None, samples: FloatArray | None = None) -> Section:
    """Before and after: figures, parameters, pairs; `samples` of the posterior (draws, parameters) if there are any."""
    models = {"imperfect" if reference is not None else "before": Paired(fit.before, fit.pairing_before)}
    if reference is not None:
        models = {"perfect": Paired(reference, pair(reference, fit.table)), **models}
    models["updated"] = Paired(fit.after, fit.pairing)
    figures = []
    if (fit.table.n >= 0).any() and fit.after.rings is not None:
        figures.append(Picture.of(figure_comparison(fit.table, models), comparison_caption(fit.table, models)))
    within = (
        "Relative frequency error of each measured mode by model; grey is twice the stated uncertainty of the "
        "measurement."
    )
    figures.append(Picture.of(figure_errors(fit.table, models), within))
    if len(fit.parameters) > 1:
        figures.append(Picture.of(figure_corner(fit, samples), CORNER))
    caption = "Parameters; sigma is one standard deviation given the measurement's uncertainty and the priors."
    pairs = fit.pairs()
    tables = (
        Table.of(caption, fit.COLUMNS, fit.records()),
        Table.of(f"The {len(pairs)} paired modes", PAIRS, pairs, folded=len(pairs) > 12),
    )
    return Section("Update", tuple(update_words(fit)), tuple(figures), tables)


def comparison_caption(table: FrequencyTable, models: dict[str, Paired]) -> str:
    """Caption of the comparison."""
    kind = "Synthetic test data" if table.synthetic else "Measured"
    return (
        f"{kind} against the {', '.join(models)} model: frequencies by nodal diameters, relative split of each "
        "pair, and the angle of the first antinode of its lower mode as a part of 180°/n, after which the shape "
        "repeats (0 and 1 are the same angle). If the split is small compared with the measurement uncertainty, the "
        "angle is not determined."
    )


def update_words(fit: UpdateResult) -> list[str]:
    """The result in sentences."""
    words = [
        f"RMS relative frequency error {written(100.0 * fit.rms_before, 3)} % at the start values and "
        f"{written(100.0 * fit.rms_after, 3)} % after the update, over {used_words(fit)}, with "
        f"{len(fit.parameters)} parameters and {len(fit.history)} evaluations. {misfit_words(fit)} "
        f"{stop_words(fit.stopped)}"
    ]
    return words + [words_of for _, words_of in unsure(fit)]


def stop_words(stopped: str) -> str:
    """Reason why a fit ended, as a sentence.

    >>> stop_words("converged: no step promises to lower chi^2")
    'The fit ended (converged): no step promises to lower chi^2.'
    """
    state, _, why = stopped.rstrip(".").partition(": ")
    return f"The fit ended ({state}): {why}." if why else f"The fit ended: {state}."


def unsure(fit: UpdateResult) -> list[tuple[str, str]]:
    """Names of parameters that the data do not determine, and the reason."""
    found = [
        (f"{a} and {b}", f"The data cannot distinguish {a} from {b} (correlation {r:+.2f}).")
        for a, b, r in fit.indistinct()
    ]
    unseen = fit.identifiability.unseen
    for p, weak, bound in zip(fit.parameters, fit.prior_only, fit.at_bound, strict=True):
        found += [(p.name, f"The table hardly depends on {p.name}.")] if p.name in unseen and not weak else []
        found += [(p.name, f"Only its prior determines {p.name}.")] if weak else []
        found += [(p.name, f"{p.name} ended on a bound: the model or the bound is wrong.")] if bound else []
    return found


def update_verdict(fit: UpdateResult, shapes: ShapeFit | None = None) -> Verdict:
    """Summary of an update: quality of the model, sure and unsure parameters, measurements that would help."""
    converged = fit.stopped.startswith("converged")
    poor = not converged or fit.inflation > 1.0
    sentence = (
        f"The updated model has an RMS frequency error of {written(100.0 * fit.rms_after, 2)} %, against "
        f"{written(100.0 * fit.rms_before, 2)} % before, over {used_words(fit)}."
    )
    doubtful = unsure(fit)
    facts = [("Worst rows", f"{capital(worst_rows(fit))}, relative to the uncertainty of each row.")]
    if shapes is not None:
        facts.append(("Shapes", f"The MAC of paired shapes is {shapes.after.mean_plane:.3f} in the mean; before the "
                                f"update it was {shapes.before.mean_plane:.3f}."))  # fmt: skip
    facts += [("Sure", sure)] if (sure := sure_words(fit)) else []
    facts += [("Not sure", " ".join(words for _, words in doubtful[:WORST]))] if doubtful else []
    sure_of = misfit_words(fit) + ("" if converged else f" The fit did not converge: {fit.stopped.rstrip('.')}.")
    state = "bad" if not converged else "open" if poor or doubtful else "good"
    return Verdict(found=sentence, sure=sure_of, further=" ".join(remedies(fit)), facts=tuple(facts), state=state)


def sure_words(fit: UpdateResult) -> str:
    """Value and standard deviation of the parameters that the data determine, the most certain first."""
    open_ = {name for a, b, _ in fit.indistinct() for name in (a, b)} | set(fit.identifiability.unseen)
    kept = [
        k for k, p in enumerate(fit.parameters)
        if p.name not in open_ and not fit.prior_only[k] and not fit.at_bound[k]
    ]  # fmt: skip
    spread = {
        k: float(fit.sigma[k]) / (1.0 if fit.parameters[k].log else abs(float(fit.value[k])) or 1.0) for k in kept
    }
    kept.sort(key=lambda k: spread[k])
    names = units(fit.structure, [p.name for p in fit.parameters])
    words = "; ".join(f"{fit.parameters[k].name} = {with_unit(value_words(fit, k), names[k])}" for k in kept[:WORST])
    more = f"; and {len(kept) - WORST} more" if len(kept) > WORST else ""
    return f"{words}{more} (one standard deviation)." if kept else ""


def with_unit(words: str, unit: str) -> str:
    r"""A value with its spread, and the unit after the value.

    >>> with_unit("8.8 × 10¹²\n± 1.4 %", "N/m^3"), with_unit("0.23\n± 10 %", "-")
    ('8.8 × 10¹² N/m³ ± 1.4 %', '0.23 ± 10 %')
    """
    value, _, spread = words.partition("\n")
    return " ".join(part for part in (value, "" if unit == "-" else powers(unit), spread) if part)


def used_words(fit: UpdateResult) -> str:
    """Number of rows of the measured table that were used, and that were excluded."""
    rows, aside = sum(len(match.rows) for match in fit.pairing.matches), len(fit.set_aside)
    return f"{rows} of {len(fit.measured)} measured rows" + (f" ({aside} excluded as outliers)" if aside else "")


def misfit_words(fit: UpdateResult) -> str:
    """Comparison of the residuals with the stated uncertainty."""
    times = written(fit.misfit, 2)
    if fit.overstated:
        return (
            f"The residuals are only {times} times what the stated uncertainty explains: the uncertainty is too large, "
            "or the table was computed with a model."
        )
    if fit.inflation == 1.0:
        return f"The stated uncertainty of the measurement explains the residuals ({times} times its size)."
    return (
        f"The residuals are {times} times what the stated uncertainty explains; all standard deviations were "
        f"multiplied by {times}."
    )


def remedies(fit: UpdateResult) -> list[str]:
    """Recommended next steps, depending on the weaknesses of the fit."""
    alike = fit.indistinct()
    bounds = [p.name for p, bound in zip(fit.parameters, fit.at_bound, strict=True) if bound]
    weak = [p.name for p, known in zip(fit.parameters, fit.prior_only, strict=True) if known]
    words = [f"{', '.join(bounds)} ended on a bound: widen it, or search for what the model lacks."] if bounds else []
    words += [f"Fix {a} or {b}: the data cannot distinguish them." for a, b, _ in alike]
    words += [f"Take {', '.join(weak)} out of the fit, or measure modes that depend on it: these data do not."
              ] if weak else []  # fmt: skip
    if fit.set_aside:
        what = f"modes {listed(fit.set_aside)}" if len(fit.set_aside) > 1 else f"mode {fit.set_aside[0]}"
        words.append(f"Check {what} of the table: excluded as an outlier, far from what the other rows predict.")
    if fit.inflation > 1.0:
        words.append(f"Check {worst_rows(fit)}: the measurement, or a part of the model that is not varied, is wrong.")
    return words or [
        "Check the predictions: `casingfem update --leave-one-out` predicts every measured row from the others."
    ]


def worst_rows(fit: UpdateResult, count: int = 2) -> str:
    """The rows of the table with the largest residuals relative to their uncertainty, and their remaining error."""
    rows = fit.pairs()
    rows.sort(key=lambda row: -abs(row["after_hz"] - row["measured_hz"]) / row["sigma_hz"])
    return " and ".join(
        f"mode {row['mode']} of the table ({100.0 * (row['after_hz'] / row['measured_hz'] - 1.0):+.2g} %)"
        for row in rows[:count]
    )


def shapes_section(found: ShapeFit) -> Section:
    """MAC before and after, sensors with the lowest agreement, and unpaired shapes on both sides."""
    caption = (
        "MAC of measured shapes (rows) with computed modes (columns) before and after the update; pairs are framed, "
        "with one frame for a doublet, whose shapes may be rotated in their plane. Numbers: MAC in per cent, from 20 %."
    )
    return Section(
        "Mode shapes",
        tuple(shape_words(found)),
        (Picture.of(figure_shape_mac(found), caption),),
        (shapes_table(found), sensors_table(found)),
    )


def shape_words(found: ShapeFit) -> list[str]:
    """The result in sentences."""
    table, after = found.fit.table, found.after
    words = [
        f"Shapes were measured at {len(found.shapes.a)} sensors for {len(after.rows)} of the table's "
        f"{len(found.fit.measured)} rows and fitted together with the frequencies. The mean MAC of planes, each "
        f"spanned by the two shapes of a doublet, is {found.before.mean_plane:.3f} before the update and "
        f"{after.mean_plane:.3f} after it."
    ]
    bare = [str(table.mode[row]) for row in range(len(table)) if row not in after.rows]
    words += [f"Without a shape: modes {', '.join(bare)} of the table."] if bare else []
    if found.fit.set_aside:
        words.append(f"Excluded by the fit as outliers: modes {listed(found.fit.set_aside)} of the table.")
    if found.shapes.unused_hz:
        without = ", ".join(f"{f:.2f}" for f in found.shapes.unused_hz)
        words.append(f"Measured shapes without a row in the table: {without} Hz.")
    lost = [str(table.mode[row]) for row in after.pairing.unpaired_rows]
    words += [f"Measured, but paired with no computed mode: {', '.join(lost)}."] if lost else []
    top = float(table.freq_hz.max())
    extra = [mode for mode in after.pairing.unpaired_modes if after.modes.freq[mode] <= top]
    if extra:
        named = ", ".join(f"{mode + 1} ({after.modes.freq[mode]:.2f} Hz)" for mode in extra)
        words.append(f"Computed below {top:.1f} Hz, but not measured: modes {named}.")
    return words


def shapes_table(found: ShapeFit) -> Table:
    """Every shape: the modes with which it pairs, MAC and MAC of the plane, before and after."""
    caption = "Measured shapes and the computed modes that they pair with, before and after."
    return Table.of(caption, found.COLUMNS, found.records(), folded=len(found.after.rows) > 12)


def sensors_table(found: ShapeFit) -> Table:
    """The sensors with the lowest COMAC after the update."""
    rows = [
        tuple(None if isinstance(cell, float) and np.isnan(cell) else cell if k == 0 else f"{cell:.4f}"
              for k, cell in enumerate(one))
        for one in found.worst_sensors()
    ]  # fmt: skip
    caption = "The sensors with the lowest COMAC over all paired shapes; 1 where measured and computed shapes agree."
    return Table(caption, ("sensor", "COMAC before", "after"), tuple(rows))


@styled
def figure_shape_mac(found: ShapeFit) -> Figure:
    """MAC before and after, side by side."""
    columns = max(found.before.mac.shape[1], found.after.mac.shape[1])
    wide = columns > WIDE
    figure = new_figure(8.2, 2.0 + 0.36 * len(found.after.rows) if wide else 4.2)
    for place, (name, side) in enumerate((("before", found.before), ("updated", found.after))):
        axes = figure.add_subplot(*((2, 1) if wide else (1, 2)), place + 1)
        freq_hz = found.fit.table.freq_hz[side.rows]
        image = mac_panel(axes, side.mac, framed(side), side.modes, freq_hz, size=5.5)
        axes.set(ylabel="measured [Hz]" if place == 0 or wide else "", title=name)
    figure.colorbar(image, ax=figure.axes, shrink=0.8, label="MAC [-]")
    return figure


def framed(side: ShapeComparison) -> list[tuple[IntArray, IntArray]]:
    """Rows and modes of every pair with a shape, both members of a doublet together."""
    place = {row: k for k, row in enumerate(side.rows.tolist())}
    shown = [(match, [place[row] for row in match.rows if row in place]) for match in side.pairing.matches]
    return [(np.array(rows), np.array(match.modes)) for match, rows in shown if rows]
