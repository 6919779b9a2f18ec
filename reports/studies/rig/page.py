"""Sections of the rig's report: main figures, casing, reduction, rubs, provenance."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import casingfem as cf
from casingfem.plot.body.turning import turning_shapes
from casingfem.plot.contact import figure_contact, rub_film
from casingfem.plot.modes import figure_rim, groups
from casingfem.plot.page import Picture, Section, Table, Verdict
from casingfem.plot.pages.fit import capital, update_section
from casingfem.plot.pages.scene import outcome
from casingfem.plot.pages.sections import inputs_section, provenance_section
from casingfem.plot.pages.speeds import speed_strip, speed_words, with_rpm
from casingfem.plot.style import AFTER, BEFORE, new_figure, styled
from casingfem.study import Study
from contact.model.gaps.limits import WALL
from reports.studies.rig.blade import BladeFit, rms
from reports.studies.rig.rub import LONGER_STEP, Rub
from reports.studies.rig.tuning import RubPlan, Tuning
from reports.tables import Row, text

TURNED = 12  # shapes that a reader can turn
WHAT_IS_REAL = (
    " This holds for the casing's survey and frequencies (python -m reports.studies.rig.synthetic). The fan blade's "
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
        ("measured blade, predicted by updates that left the mode out", f"{100 * blade.left_out.rms:.2f} %"),
        ("casing (SYNTHETIC), RMS frequency error before updating", f"{100 * fit.rms_before:.3f} %"),
        ("casing (SYNTHETIC), after updating", f"{100 * fit.rms_after:.3f} %"),
        *(row for rub in rubs for row in of_rub(rub, plan)),
    )
    return Section("In short", tables=(Table("From the test bench to the rub.", ("what", "value"), rows),))


def of_rub(rub: Rub, plan: RubPlan) -> tuple[tuple[str, str], ...]:
    """Main results of a rub: force, deflection, leading nodal diameter."""
    return (
        (f"rub {rub.name}, largest force, averaged", f"{rub.ran.force:.0f} N"),
        (f"rub {rub.name}, largest deflection of the rim", deflection(rub)),
        (f"rub {rub.name}, n = {plan.n} over the next nodal diameter", f"{rub.excess_db(plan.n):+.1f} dB"),
    )


def deflection(rub: Rub) -> str:
    """Largest deflection of the rim, and its part of the wall."""
    rim = rub.ran.rim
    return f"{1e3 * rim.largest:.3g} mm, {100.0 * rim.largest / rim.wall:.3g} % of the wall"


def verdict(blade: BladeFit, fit: cf.updating.UpdateResult, rubs: list[Rub], speed_hz: float) -> Verdict:
    """Outcome of each rub, its force and its speeds; the uncertainty, and how to reduce it."""
    states = [outcome(rub.ran) for rub in rubs]
    facts = tuple(
        (capital(rub.name), f"{sentence} {' '.join(speed_words(rub.speeds))}")
        for rub, (_, sentence) in zip(rubs, states, strict=True)
    )
    return Verdict(
        found=" ".join(headline(rub, speed_hz) for rub in rubs),
        facts=facts,
        sure=f"The casing's frequencies (SYNTHETIC) are met to {100 * fit.rms_after:.2g} % RMS, with a misfit of "
        f"{fit.misfit:.2g} sigma. The measured blade's are met to {100 * blade.fit.rms_after:.2g} %, with a misfit of "
        f"{blade.fit.misfit:.2g} sigma; an update predicts a frequency that it has not seen to "
        f"{100 * blade.left_out.rms:.2g} %.",
        further="Measure the casing's mode shapes and the wall of the blade. Add an abradable coating to the model: "
        "without wear the forces are too high.",
        state="bad" if any(state == "bad" for state, _ in states) else states[-1][0],
        strips=tuple((f"Speeds, {rub.name}", speed_strip(rub.speeds, speed_hz)) for rub in rubs),
    )


def headline(rub: Rub, speed_hz: float) -> str:
    """Whether all speeds are safe, and the force and the deflection at the speed of the run."""
    low, high = (float(hz) for hz in rub.speeds.peaks.map.speed_hz[[0, -1]])
    span = f"{60.0 * low:,.0f} to {60.0 * high:,.0f} rpm"
    unsafe = [run for run in rub.speeds.runs if run.verdict != "safe"]
    count = f"{len(unsafe)} of {len(rub.speeds.runs)} speeds from {span} are not safe"
    rim = rub.ran.rim
    limit = "" if rim.largest <= WALL * rim.wall else f" (the linear model is valid up to {100.0 * WALL:g} %)"
    speeds = count if unsafe else f"every speed from {span} is safe"
    return (
        f"{capital(rub.name)}, {speeds}: at {60.0 * speed_hz:,.0f} rpm the tip presses with {rub.ran.force:,.0f} N, "
        f"and the rim deflects by {deflection(rub)}{limit}."
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
            "Radial motion of the rim in the lowest modes of the updated casing. The imperfections fix the angle of "
            "each pair; its two members are a quarter wave apart.",
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


def causes(rows: Sequence[Row], rubs: Sequence[Rub], plan: RubPlan) -> Section:
    """Levels of n with the defect, without it, and without one cause of the growth."""
    columns = tuple(rows[0])
    table = Table(
        f"Level of n = {plan.n} over the next nodal diameter, last quarter of the run.", columns,
        tuple(tuple(_level(row[name]) for name in columns) for row in rows),
    )  # fmt: skip
    closed = " and ".join(f"{100.0 * rub.ran.closed / rub.ran.span:.0f} % of the time ({rub.name})" for rub in rubs)
    words = (
        "Friction feeds the motion while the contact is closed, and only if it is above tan(lean). "
        f"The contact is closed {closed}.",
        "A growing motion opens the contact. Impacts then bound it. The causes are taken away from the rim without the "
        "defect alone.",
        f"The rubs have a step of {plan.dt:g} s. The rows below the first and the runs over speed have one of "
        f"{LONGER_STEP * plan.dt:g} s.",
    )
    return Section("What the rub needs to grow", words, tables=(table,))


def _level(cell: object) -> str:
    """Text of a cell: a level [dB] with its sign."""
    return f"{cell:+.1f}" if isinstance(cell, float) else text(cell)


def rub_section(rub: Rub, plan: RubPlan) -> Section:
    """One run in words, force and gap over time, the rim's motion by nodal diameters, the speeds around this one."""
    result, ran = rub.result, rub.ran
    energy = result.energy
    words = (
        outcome(ran)[1],
        f"The casing turns at {with_rpm(plan.speed_hz)} before the blade, which is advanced "
        f"{1e6 * plan.advance:.0f} µm past its first touch. Friction is {plan.friction:g}. The blade leans by "
        f"{plan.lean_deg:g} deg against the motion; friction is above tan(lean), so the blade digs in.",
        f"In the last quarter of the run n = {plan.n} is {rub.excess_db(plan.n):+.1f} dB over the next nodal diameter. "
        "n f is below every frequency of the casing, so f_c + f_b = n f cannot be met. The coincidence is "
        "f_b = f_c - n f.",
        "No coating wears in this model: a motion of a millimetre is not to be expected in a machine.",
        *(f"{capital(str(flag))}." for flag in result.flags),
    )
    numbers = (
        ("impulse", f"{result.impulse[0]:.5g} N s"),
        ("largest force, averaged", f"{ran.force:.4g} N"),
        ("largest force, raw (depends on the time step)", f"{result.peak_force[0]:.4g} N"),
        ("violation of the contact law", f"{result.residual[0]:.1e} m"),
        ("steps in which the tip slipped against the rim's motion", f"{result.reversals[0]:,}"),
        ("energy from the rotation", f"{energy.rotation:.4g} J"),
        ("energy from friction", f"{energy.friction:.4g} J"),
        ("energy unaccounted for, part of the largest", f"{ran.unaccounted:.1e}"),
        ("steps", f"{result.steps:,}"),
        ("time of the run", f"{result.seconds:.3g} s"),
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
    found = rub.speeds.records()
    speeds = (Table.of("Speeds around this one, the worst first.", rub.speeds.COLUMNS, found),) if found else ()
    tables = (Table("The run in numbers.", ("what", "value"), numbers), *speeds)
    return Section(f"Rub, {rub.name}", words, figures, tables)


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
