"""The page on one contact scene: what it says, what became of it, and its pictures."""

from collections.abc import Mapping, Sequence
from typing import Any

from matplotlib.figure import Figure

from casingfem.plot.page import Cell, Picture, Section, Table, Verdict, origin, render_page, written

CAPTIONS = {
    "run": "Force averaged over the model's shortest period, gap, and the largest modal coordinates over time.",
    "spectrum": "Spectrum of the contact force over the whole run and its last quarter; below, how it came to be.",
    "spectrum_tip": "The same of the tip's motion along the contact's normal.",
    "orbit": "Orbits of the first tip and of the rim under it in the plane of the contact.",
    "energy": "Energy into the bodies by source, and strain energy over time.",
    "interactions": "The blade over speed: poles of closed contact that grow in colour, speeds that diverge shaded.",
}


def scene_page(
    name: str, scene: str, summary: str, flags: tuple[str, ...], numbers: Mapping[str, Cell],
    figures: Mapping[str, Figure], table: str = "", *, verdict: Verdict, source: Mapping[str, Any],
    films: Sequence[Picture] = (),
) -> str:  # fmt: skip
    """HTML of the page: the scene as written, flags first, the film of a rub, numbers, pictures, its interactions."""
    rows = tuple(numbers.items())
    sections = [
        Section("What became of it", flags, tuple(films), (Table("The run in numbers.", ("quantity", "value"), rows),),
                preformatted=summary),
    ]  # fmt: skip
    shown = [key for key in figures if key != "interactions"]
    if shown:
        sections.append(
            Section("Pictures", figures=tuple(Picture.of(figures[k], CAPTIONS[k], kind="png") for k in shown))
        )
    if table:
        drawn = figures.get("interactions")
        seen = () if drawn is None else (Picture.of(drawn, CAPTIONS["interactions"], kind="png"),)
        sections.append(Section("At which speed", figures=seen, preformatted=table))
    sections.append(Section("The scene", preformatted=scene))
    notice = flags[0] if flags else ""
    return render_page(f"Scene {name}", sections, notice=notice, verdict=verdict, source=origin(source))


def scene_verdict(numbers: Mapping[str, float], flags: Sequence[str], *, diverged: bool, rubs: bool) -> Verdict:
    """What became of a run, by its own checks; `numbers` are those of the command line."""
    closed, span = numbers["time in contact [s]"], numbers["time simulated [s]"]
    share = 100.0 * closed / span if span else 0.0
    found = (
        f"{'Stopped as diverging after' if diverged else 'Ran'} {span:.4g} s in {numbers['steps']:,.0f} steps; contact "
        f"is closed {share:.3g} % of the time, its impulse {numbers['impulse [N s]']:.4g} N s, the largest force, "
        f"averaged over the model's shortest period, {numbers['largest windowed force [N]']:.4g} N."
    )
    sure = (
        f"The law of contact is kept to {written(numbers['law violated by [m]'], 1)} m, and all energy but "
        f"{written(100.0 * numbers['energy not accounted for'], 1)} % is accounted for. That is the scheme's own "
        "check; the step and the number of modes are not checked by it."
    )
    if flags:
        further = "Read what is flagged above; beyond it the model is not the machine."
    else:
        further = "Run it with half the step, and with more modes, and compare the impulse: casingfem sweep does both."
    if rubs:
        further += " At which speeds it grows: below, or casingfem interactions."
    return Verdict(found=found, sure=sure, further=further)
