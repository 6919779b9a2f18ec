"""The command mistune: splits and orientations of a casing's pairs over draws of its random fields."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from casingfem.cli.running import ProgressMessage, deliver, options
from casingfem.cli.study import STUDY, chart_study
from casingfem.cli.tables import csv_text
from contact.io.outfiles import Content, json_text

if TYPE_CHECKING:
    from casingfem.modal.mistuning import Mistuning
    from casingfem.study.mistuning import MistuneRun

DRAWS = click.option("--draws", type=click.IntRange(1, 1_000_000), default=200, show_default=True, help="How many.")
PROCESSES = click.option("--processes", type=click.IntRange(1, 256), default=None, help="Worker processes; one a core.")


@click.command()
@STUDY
@DRAWS
@PROCESSES
@options
def mistune(file: Path, draws: int, processes: int | None, as_json: bool, out: Path | None) -> None:
    """Splits and orientations of the pairs of STUDY over draws of its random imperfections.

    With --out DIR finished draws are kept in DIR/draws: the same command goes on where a run was broken off.
    """
    from casingfem.study.mistuning import run_mistune

    study = chart_study(file)
    with ProgressMessage(f"mistuning of {file.name}") as working:

        def progress(done: int) -> None:
            working.say(f"mistuning of {file.name}: {done} of {draws} draws, {working.seconds:.0f} s")

        folder = None if out is None else out / "draws"
        run = run_mistune(study, draws, processes=processes, folder=folder, progress=progress)
    document = {
        "doublets": run.found.summary(),
        "draws": draws,
        "resumed": run.resumed,
        "restart_errors": {str(draw): error for draw, error in run.errors.items()},
        "from_nothing": list(run.from_nothing),
        "seconds": working.seconds,
        "source": study.source,
    }
    files: dict[str, Content] = {} if out is None else result_files(run.found, document)
    deliver(document, f"{run.found!r}\n{words(run)}", as_json=as_json, out=out, files=files)


def words(run: "MistuneRun") -> str:
    """How sure the frequencies are, and what was there already."""
    lines = ["every draw complete by a Sturm count"]
    if run.errors:
        worst = max(run.errors.values())
        lines.append(f"{len(run.errors)} draws also solved from nothing: frequencies differ by {worst:.1e} at most")
    if run.from_nothing:
        lines.append(f"{len(run.from_nothing)} draws solved from nothing: the restart had missed modes")
    if run.resumed:
        lines.append(f"{run.resumed} draws were there already")
    return "\n".join(lines)


def result_files(found: "Mistuning", document: dict[str, Any]) -> dict[str, Content]:
    """The draws, the summary, the picture and the document."""
    from casingfem.plot.modes import figure_splits
    from casingfem.plot.style import png

    source = document["source"]
    versions = ", ".join(f"{name} {number}" for name, number in source["versions"].items())
    card = f"COMPUTED: random mistuning of {source['study']} (sha256 {source['sha256']})\nby {versions}"
    names = ("draw", "n", "m", "freq_hz", "split_rel", "angle_deg")
    columns = (found.draw, found.n, found.m, found.freq, found.split, found.angle_deg)
    rows = [dict(zip(names, row, strict=True)) for row in zip(*(column.tolist() for column in columns), strict=True)]
    summary = document["doublets"]
    return {
        "mistune.csv": csv_text(rows, card, names),
        "mistune_summary.csv": csv_text(summary, card, () if summary else ("n", "m")),
        "mistune.json": json_text(document, indent=1),
        "mistune.png": png(figure_splits(found)),
    }
