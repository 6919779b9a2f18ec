"""The command cycles: periodic motions of a driven body before contacts, or of a rub, over frequency, force, speed."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from casingfem.cli.contact import SCENE
from casingfem.cli.running import STORES, ProgressMessage, deliver, options, source_of
from casingfem.cli.tables import csv_text
from contact.io.outfiles import Content, json_text

if TYPE_CHECKING:
    from contact.growth.cycles.basins import Basins
    from contact.growth.cycles.result import Cycles


@click.command()
@SCENE
@options
def cycles(file: Path, as_json: bool, out: Path | None) -> None:
    """Periodic motions of SCENE over frequency, force or speed: how large, kept or not, where they jump.

    SCENE is a patch with [drive] in place of [scheme], or a rim, a rub or a disk with a range of speed, clearance or
    friction in place of a run. [basins] asks which of these motions random starts reach.

    With --out DIR: cycles.csv, .npz, .json, .png and the page cycles.html; the same command goes on after a stop.
    """
    from contact.scene.cycles import load_cycles

    scene = load_cycles(file)
    part = None if out is None else out / STORES["cycles"]
    if part is not None:
        part.parent.mkdir(parents=True, exist_ok=True)
    with ProgressMessage(f"cycles {file.name}") as working:

        def progress(branch: int, value: float, points: int) -> None:
            working.say(
                f"cycles {file.name}: branch {branch}, {points} orbits, at {value:.6g}, {working.seconds:.0f} s"
            )

        found = scene.solve(progress, part)
        reached = scene.reached(found, lambda k: working.say(f"cycles {file.name}: {k} random starts"))
    document, words = found.to_dict(), repr(found)
    if reached is not None:
        document["basins"] = {"at": reached.value, "starts": len(reached.reached), "motions": reached.records()}
        words += f"\n{reached!r}"
    files = {} if out is None else result_files(found, reached, document, words, file)
    deliver(document, words, as_json=as_json, out=out, files=files)
    if part is not None:
        part.unlink(missing_ok=True)


def result_files(
    found: "Cycles", reached: "Basins | None", document: dict[str, object], words: str, file: Path
) -> dict[str, Content]:
    """The table, the states, the document, the picture and the page."""
    from casingfem.plot.cycles import figure_cycles
    from casingfem.plot.pages.cycles import cycles_page
    from casingfem.plot.style import png

    rows, marks, ends = found.table(), found.marks(), [part.end for part in found.branches]
    motions = [] if reached is None else [{found.name: reached.value, **one} for one in reached.records()]
    return {
        "cycles.html": cycles_page(file.stem, rows, marks, ends, source_of(file), words, motions),
        "cycles.csv": csv_text(rows), "cycles.npz": found.save, "cycles.json": json_text(document, indent=1),
        "cycles.png": png(figure_cycles(rows, marks, motions)),
    }  # fmt: skip
