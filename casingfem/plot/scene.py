"""The page on one contact scene: what it says, what became of it, and its pictures."""

from collections.abc import Mapping

from matplotlib.figure import Figure

from casingfem.plot.page import Cell, Picture, Section, Table, render_page

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
    figures: Mapping[str, Figure], table: str = "",
) -> str:  # fmt: skip
    """HTML of the page: the scene as written, flags first, numbers, pictures, the table of interactions."""
    rows = tuple(numbers.items())
    sections = [
        Section("What became of it", flags, tables=(Table("The run in numbers.", ("quantity", "value"), rows),),
                preformatted=summary),
    ]  # fmt: skip
    drawn = [Picture.of(figure, CAPTIONS[key], kind="png") for key, figure in figures.items() if key != "interactions"]
    sections.append(Section("Pictures", figures=tuple(drawn)))
    if table:
        shown = (Picture.of(figures["interactions"], CAPTIONS["interactions"], kind="png"),)
        sections.append(Section("At which speed", figures=shown, preformatted=table))
    sections.append(Section("The scene", preformatted=scene))
    notice = flags[0] if flags else ""
    return render_page(f"Scene {name}", sections, notice=notice)
