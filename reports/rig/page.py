"""Sections of the rig's report: what leads, the casing, the reduction, the rubs, where it all comes from."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import casingfem as cf
from casingfem.plot.contact import figure_contact, rub_film
from casingfem.plot.modes import figure_rim, groups
from casingfem.plot.page import Picture, Section, Table, Verdict
from casingfem.plot.pages.fit import update_section
from casingfem.plot.pages.sections import inputs_section, provenance_section
from casingfem.plot.style import AFTER, BEFORE, new_figure, styled
from casingfem.plot.turning import turning_shapes
from casingfem.study import Study
from reports.rig.blade import BladeFit, rms
from reports.rig.rub import Rub
from reports.rig.tuning import RubPlan, Tuning
from reports.tables import Row, text

TURNED = 12  # shapes that a reader can turn
WHAT_IS_REAL = (
    " This holds for the casing's survey and frequencies (python -m reports.rig.synthetic). The fan blade's "
    "frequencies are measured."
)


def shortened(plan: RubPlan) -> RubPlan:
    """The same rub over one turn and a bit: enough to test the chain."""
    return replace(plan, t_end=1.2 / plan.speed_hz)


def overview(blade: BladeFit, fit: cf.updating.UpdateResult, rubs: list[Rub], plan: RubPlan) -> Section:
    """The figures an engineer asks for first."""
    rows = (
        (
            "measured blade, RMS frequency error, clamped (nominal)",
            f"{100 * rms(blade.errors_nominal):.2f} %",
        ),
        ("measured blade, after updating three parameters", f"{100 * blade.fit.rms_after:.2f} %"),
        ("measured blade, predicted by updates that left the mode out", f"{100 * rms(blade.left_out):.2f} %"),
        ("casing (SYNTHETIC), RMS frequency error before updating", f"{100 * fit.rms_before:.3f} %"),
        ("casing (SYNTHETIC), after updating", f"{100 * fit.rms_after:.3f} %"),
        *(
            (
                f"rub {rub.name}: n = {plan.n} over the next nodal diameter",
                f"{rub.excess_db(plan.n):+.1f} dB",
            )
            for rub in rubs
        ),
    )
    return Section("In short", tables=(Table("From the test bench to the rub.", ("what", "value"), rows),))


def verdict(blade: BladeFit, fit: cf.updating.UpdateResult, rubs: list[Rub], plan: RubPlan) -> Verdict:
    """What the chain says, how sure it is, what would make it surer."""
    said = ", ".join(f"{rub.excess_db(plan.n):+.1f} dB {rub.name}" for rub in rubs)
    flagged = sorted({flag for rub in rubs for flag in rub.result.flags})
    return Verdict(
        found=f"The measured blade's frequencies are met to {100 * blade.fit.rms_after:.2g} % RMS, the casing's "
        f"(SYNTHETIC) to {100 * fit.rms_after:.2g} %. Level of n = {plan.n} over the next nodal diameter in the rub: "
        f"{said}.",
        sure=f"The misfit is {blade.fit.misfit:.2g} sigma for the blade, {fit.misfit:.2g} for the casing; "
        f"a blade's frequency that its update has not seen is predicted to {100 * rms(blade.left_out):.2g} %."
        + (f" Linear theory ends within a run: {len(flagged)} warnings, given below." if flagged else ""),
        further="Measure the casing's shapes and the wall over the blade; run the rubs with half the step.",
    )


def casing_section(study: Study, fit: cf.updating.UpdateResult, ideal: cf.Modes) -> Section:
    """Survey, update, and the updated casing's shapes."""
    given = inputs_section(study)
    base = update_section(fit, ideal)
    which = groups(fit.after, 8)
    figures = (
        *base.figures,
        Picture.of(
            figure_rim(fit.after, which),
            "Radial motion of the rim in the lowest modes of the updated casing; the members of a doublet stand a "
            "quarter wave apart, where the imperfections hold them.",
        ),
        turning_shapes(
            fit.after,
            [low for low, *_ in groups(fit.after, TURNED)],
            "Shapes of the updated casing, one of each pair, drawn exaggerated; colour is the radial displacement, red "
            "outward. Beside them the radius as surveyed.",
        ),
    )
    words = (
        "A frustum of 3 mm steel with a surveyed radius on an elastic embedding. There is no public frequency table "
        "of the original rig: survey and frequencies are SYNTHETIC, made by a finer model with thickness variations, "
        "radius and embedding harmonics that the updated model does not have, and noise.",
    )
    return Section("The casing", words + base.paragraphs, figures, given.tables + base.tables, given.preformatted)


def reduction(files: tuple[Path, Path], tuning: Tuning, plan: RubPlan) -> Section:
    """The two bases and the blade's tuning."""
    bases = [cf.ModalBasis.load(file) for file in files]
    rows = tuple(
        (
            file.name,
            len(basis),
            float(basis.freq[0]),
            float(basis.freq[-1]),
            len(basis.channels),
            100.0 * float(np.trace(basis.S) / np.trace(basis.compliance)),
        )
        for file, basis in zip(files, bases, strict=True)
    )
    grows = tuning.grows
    words = (
        f"The blade is a strip whose thickness, {1e3 * tuning.thickness:.3f} mm, puts its first mode at "
        f"{tuning.target:.2f} Hz. The free coincidence f_b = f_c - n f of the casing's n = {plan.n} mode at "
        f"{plan.speed_hz:g} Hz ({60.0 * plan.speed_hz:g} rpm) is at {tuning.coincidence:.2f} Hz; f_c is the frequency "
        "of the wave against the rotation, in the frame of the casing.",
        f"In a contact that stays closed n = {plan.n} leads the motion that grows from {tuning.low:.2f} to "
        f"{tuning.high:.2f} Hz, by the poles of both reduced bodies with the matrices of the casing's rotation. Below, "
        f"nothing grows; above, another nodal diameter leads. The blade is tuned {100 * plan.into_band:g} % into this "
        f"band: the motion grows by {grows.growth:.3g} 1/s at {grows.freq_hz:.2f} Hz, n = {plan.n} "
        f"{grows.excess_db:+.1f} dB over the next nodal diameter.",
        "Free modes with the residual compliance S of all that they leave out; these files are the only thing "
        "handed on to contact.",
    )
    columns = ("file", "modes", "first [Hz]", "last [Hz]", "channels", "S, share of static compliance [%]")
    return Section("Reduction", words, tables=(Table("Reduced bodies.", columns, rows),))


def causes(rows: Sequence[Row], plan: RubPlan) -> Section:
    """Levels of n with the defect and without, and with a cause of the growth taken away."""
    columns = tuple(rows[0])
    table = Table(
        f"Level of n = {plan.n} over the next nodal diameter, last quarter of the run.", columns,
        tuple(tuple(text(row[name]) if name == "blade" else f"{row[name]:+.1f}" for name in columns) for row in rows),
    )  # fmt: skip
    words = (
        "The growth needs a contact that stays closed and a friction above tan(lean). As built, the rim is closed for "
        "a small part of each turn; with the defect machined away the contact is permanent.",
    )
    return Section("What the rub needs to grow", words, tables=(table,))


def rub_section(rub: Rub, plan: RubPlan) -> Section:
    """One run in words, force and gap over time, and the rim's motion by nodal diameters."""
    result = rub.result
    intervals = result.intervals[0]
    closed = sum(end - start for start, end in intervals) / (result.steps * result.dt)
    energy = result.energy
    words = (
        f"The casing turns at {plan.speed_hz:g} Hz in front of the blade, advanced {1e6 * plan.advance:.0f} µm past "
        f"its first touch; friction {plan.friction:g}, lean {plan.lean_deg:g} deg against the motion (friction above "
        f"tan(lean): the blade digs in). Contact is closed {100 * closed:.0f} % of {plan.t_end:g} s, in "
        f"{len(intervals)} intervals, one for each closing.",
        f"In the last quarter of the run n = {plan.n} is {rub.excess_db(plan.n):+.1f} dB over the next nodal diameter. "
        "With n f below every casing frequency f_c + f_b = n f cannot be met here. The coincidence is f_b = f_c - n f.",
        "Motions of a millimetre are the model's, not a machine's: without an abradable coating nothing wears.",
        *(f"Flag: {flag}." for flag in result.flags),
    )
    numbers = (
        ("impulse [N s]", float(result.impulse[0])),
        ("largest windowed force [N]", float(result.windowed_force()[:, 0].max())),
        ("largest raw force [N] (does not converge with the step)", float(result.peak_force[0])),
        ("complementarity residual [m]", float(result.residual[0])),
        ("steps in which the tip slipped against the rim's motion", int(result.reversals[0])),
        ("energy brought in by the rotation [J]", float(energy.rotation)),
        ("energy brought in by friction [J]", float(energy.friction)),
        ("energy unaccounted, relative", float(abs(energy.unaccounted) / max(energy.scale, 1e-300))),
        ("steps", result.steps),
        ("run time [s]", float(result.seconds)),
    )
    figures = (
        Picture.of(
            figure_contact(result),
            "Force averaged over the model's shortest period, gap, and the largest modal coordinates.",
            kind="png",
        ),
        *(() if rub.film is None else (rub_film(rub.film, result),)),
        Picture.of(
            figure_levels(rub, plan.n),
            f"Radial motion of the rim by nodal diameters in the last quarter of the run; n = {plan.n} is marked.",
        ),
    )
    return Section(f"Rub, {rub.name}", words, figures, (Table("The run in numbers.", ("what", "value"), numbers),))


@styled
def figure_levels(rub: Rub, n: int) -> Figure:
    """RMS radial motion of the rim by nodal diameters."""
    figure = new_figure(8.0, 2.8)
    axes: Any = figure.add_subplot()
    k = np.arange(len(rub.levels))
    axes.bar(k, 1e6 * rub.levels, color=[AFTER if i == n else BEFORE for i in k])
    axes.set_yscale("log")
    axes.set_xlabel("nodal diameters n")
    axes.set_ylabel("radial motion, RMS [µm]")
    return figure


def provenance(study: Study, seconds: dict[str, float]) -> Section:
    """Run times, versions, and what the rub assumes."""
    base = provenance_section(study, seconds)
    words = (
        "Assumptions the source study does not state: friction above tan(lean); the blade's frequency, set by its "
        "thickness; one contact point, acting through harmonics of the rim up to n = 40; no wear.",
    )
    return replace(base, paragraphs=base.paragraphs + words)
