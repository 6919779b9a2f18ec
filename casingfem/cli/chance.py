"""Command chance: probability that random casings interact with their blades."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from casingfem.cli.contact import SCENE
from casingfem.cli.progress import ProgressMessage
from casingfem.cli.running import STORES, deliver, options
from casingfem.cli.tables import csv_text
from contact.io.outfiles import Content, json_text

if TYPE_CHECKING:
    from casingfem.chance.result import Chance


@click.command()
@SCENE
@click.option(
    "--processes",
    type=click.IntRange(1, 256),
    default=None,
    help="Number of worker processes; one for each core if left out.",
)
@click.option("--scheduler", metavar="ADDRESS", help="A Dask scheduler, tcp://host:port, instead of processes.")
@options
def chance(file: Path, processes: int | None, scheduler: str | None, as_json: bool, out: Path | None) -> None:
    """Probability of dangerous speeds of SCENE over random casings, blades, clearances and friction.

    [chance] of SCENE names the study of the casing, whose random imperfections are drawn. With --out DIR finished draws
    are stored in DIR/draws, so the same command continues a stopped run. DIR also gets tables, a page, and the worst
    casings as self-contained studies and scenes.
    """
    from casingfem.chance.evaluate import Drawing
    from casingfem.chance.load import load_chance
    from casingfem.chance.result import Chance
    from casingfem.chance.rubs import run_rubs, words_of_runs
    from casingfem.chance.run import run_draws
    from casingfem.chance.worst import worst_files

    with ProgressMessage(f"chance {file.name}: the perfect casing") as working:
        given = load_chance(file)

        def progress(words: str, share: float) -> None:
            working.say(f"chance {file.name}, {words}", share)

        folder = None if out is None else out / STORES["chance"]
        drawn = run_draws(given, processes=processes, scheduler=scheduler, folder=folder, progress=progress)
        found = Chance.of(drawn)

        def ran(runs: int, most: int) -> None:
            working.say(f"chance {file.name}, {runs} of {most} runs", runs / most)

        rows = run_rubs(found, folder, ran, processes=processes, scheduler=scheduler) if given.table.runs else []
        own = Drawing.of(given) if out is not None and given.table.worst else None
        files: dict[str, Content] = {}
        if out is not None and own is not None:
            working.say(f"chance {file.name}: the worst casings")
            files = worst_files(found, own, lambda k: working.say(f"chance {file.name}: {k} of the worst casings"))
    words = words_of_runs(rows)
    document = {**found.to_dict(), "runs": rows, "words_of_runs": words, "seconds": working.seconds}
    if out is not None:
        files |= result_files(file, found, document)
    deliver(document, "\n".join(filter(None, [repr(found), words])), as_json=as_json, out=out, files=files)


def result_files(file: Path, found: "Chance", document: dict[str, Any]) -> dict[str, Content]:
    """Tables, the document and the page."""
    from casingfem.plot.pages.chance import chance_page

    source = document["source"]
    card = f"COMPUTED: chances of {source['scene']} (sha256 {source['sha256']}), {document['casings']} casings"
    runs = {"chance_runs.csv": csv_text(document["runs"], card)} if document["runs"] else {}
    return {
        **runs,
        "chance.csv": csv_text(found.draws(), card),
        "chance_pairs.csv": csv_text(document["pairs"], card),
        "chance_speeds.csv": csv_text(document["speeds"], card),
        "chance.json": json_text(document, indent=1),
        "chance.html": chance_page(file.stem, found, document["words_of_runs"]),
    }
