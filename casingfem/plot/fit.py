"""The report's section on an update: in words, figures and tables."""

from casingfem.experiment.correlation.pairing import pair
from casingfem.experiment.frequency_table import FrequencyTable
from casingfem.modal.mode_set import Modes
from casingfem.plot.page import Cell, Picture, Section, Table
from casingfem.plot.update import Paired, figure_comparison, figure_correlation, figure_errors
from casingfem.updating.result import UpdateResult


def update_section(fit: UpdateResult, reference: Modes | None) -> Section:
    """Before and after: figures, parameters, pairs, what the data cannot tell."""
    models = {"imperfect" if reference is not None else "before": Paired(fit.before, fit.pairing_before)}
    if reference is not None:
        models = {"perfect": Paired(reference, pair(reference, fit.table)), **models}
    models["updated"] = Paired(fit.after, fit.pairing)
    figures = []
    if (fit.table.n >= 0).any() and fit.after.rings is not None:
        figures.append(Picture.of(figure_comparison(fit.table, models), comparison_caption(fit.table, models)))
    figures.append(
        Picture.of(
            figure_errors(fit.table, models),
            "Relative frequency error of each measured mode by model; grey is twice the stated uncertainty of the "
            "measurement.",
        )
    )
    if len(fit.parameters) > 1:
        figures.append(
            Picture.of(
                figure_correlation(fit),
                "Correlations of the parameters after the update: near ±1 the data cannot tell two of them apart.",
            )
        )
    return Section("Update", tuple(update_words(fit)), tuple(figures), (parameters_table(fit), pairs_table(fit)))


def comparison_caption(table: FrequencyTable, models: dict[str, Paired]) -> str:
    """What the comparison shows."""
    kind = "Synthetic test data" if table.synthetic else "Measured"
    return (
        f"{kind} against the {', '.join(models)} model: frequencies by nodal diameters, relative split of each "
        "pair, and where the lower member of the pair has its antinode."
    )


def update_words(fit: UpdateResult) -> list[str]:
    """The outcome in sentences."""
    rows = sum(len(match.rows) for match in fit.pairing.matches)
    words = [
        f"RMS relative frequency error {100.0 * fit.rms_before:.3f} % before and "
        f"{100.0 * fit.rms_after:.3f} % after, over {rows} of {len(fit.table)} rows, with "
        f"{len(fit.parameters)} parameters and {len(fit.history)} evaluations. "
        f"The misfit is {fit.misfit:.2f} standard deviations: "
        + ("model and stated uncertainty agree." if fit.misfit < 1.5 else "more than the measurement explains.")
    ]
    words[0] += f" Stopped: {fit.stopped.rstrip('.')}."
    words += [f"The data cannot tell {a} from {b} (correlation {r:+.2f})." for a, b, r in fit.indistinct()]
    named = zip(fit.parameters, fit.prior_only, fit.at_bound, strict=True)
    for p, weak, bound in named:
        words += [f"{p.name} is known from its prior only."] if weak else []
        words += [f"{p.name} ended on a bound: the model or the bound is wrong."] if bound else []
    return words


def parameters_table(fit: UpdateResult) -> Table:
    """Start, value and sigma of each parameter."""
    rows = [
        (p.name, a, b, f"{100.0 * (b / a - 1.0):+.2f}" if a else None, f"{s:.2g}{' decades' if p.log else ''}",
         p.lower, p.upper)
        for p, a, b, s in zip(fit.parameters, fit.start, fit.value, fit.sigma, strict=True)
    ]  # fmt: skip
    columns = ("parameter", "start", "updated", "change [%]", "sigma", "lower bound", "upper bound")
    caption = "Parameters; sigma is one standard deviation given the measurement's uncertainty and the priors."
    return Table(caption, columns, tuple(rows))


def pairs_table(fit: UpdateResult) -> Table:
    """Measured, before and after, mode by mode."""
    rows: list[tuple[Cell, ...]] = []
    for row in fit.pairs():
        measured, after = float(str(row["measured_hz"])), float(str(row["after_hz"]))
        before = None if row["before_hz"] is None else float(str(row["before_hz"]))
        errors = [None if f is None else f"{100.0 * (f / measured - 1.0):+.3f}" for f in (before, after)]
        n = None if row["n"] is None else int(str(row["n"]))
        mode = int(str(row["mode"]))
        rows.append((mode, n, measured, float(str(row["sigma_hz"])), before, errors[0], after, errors[1]))
    columns = ("mode", "n", "measured [Hz]", "sigma [Hz]", "before [Hz]", "error [%]", "updated [Hz]", "error [%]")
    return Table(f"The {len(rows)} paired modes", columns, tuple(rows), folded=len(rows) > 12)
