"""The command cycles: periodic motions of a driven body before contacts, or of a rub, over frequency, force, speed."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from casingfem.cli.contact import SCENE
from casingfem.cli.running import ProgressMessage, deliver, options, source_of
from casingfem.cli.tables import csv_text
from contact.io.outfiles import Content, json_text

if TYPE_CHECKING:
    from contact.growth.cycles.result import Cycles


@click.command()
@SCENE
@options
def cycles(file: Path, as_json: bool, out: Path | None) -> None:
    """Periodic motions of SCENE over frequency, force or speed: how large, kept or not, where they jump.

    SCENE is a patch with [drive] in place of [scheme], or a rim with a range of speed.

    With --out DIR: cycles.csv, .npz, .json, .png and the page cycles.html.
    """
    from contact.scene.cycles import load_cycles

    scene = load_cycles(file)
    with ProgressMessage(f"cycles {file.name}") as working:

        def progress(branch: int, value: float, points: int) -> None:
            working.say(
                f"cycles {file.name}: branch {branch}, {points} orbits, at {value:.6g}, {working.seconds:.0f} s"
            )

        found = scene.solve(progress)
    document = found.to_dict()
    deliver(document, repr(found), as_json=as_json, out=out, files={} if out is None else result_files(found, file))


def result_files(found: "Cycles", file: Path) -> dict[str, Content]:
    """The table, the states, the document, the picture and the page."""
    from casingfem.plot.cycles import figure_cycles
    from casingfem.plot.pages.cycles import cycles_page
    from casingfem.plot.style import png

    rows = found.table()
    page = cycles_page(
        file.stem, rows, found.marks(), [part.end for part in found.branches], source_of(file), repr(found)
    )
    return {
        "cycles.html": page,
        "cycles.csv": csv_text(rows), "cycles.npz": found.save, "cycles.json": json_text(found.to_dict(), indent=1),
        "cycles.png": png(figure_cycles(rows, found.marks())),
    }  # fmt: skip
