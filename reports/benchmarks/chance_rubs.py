"""Processor time of rubs of random casings, each with a basis of its own.

`python -m reports.benchmarks.chance_rubs [--quick] [--out DIR]`. The first casings of data/scenes/chance that are
dangerous at some speed, each run for 100 turns at its worst speed, as `casingfem chance` with `runs` does. The time
contains the bases, the steps and the verdicts. The time of 10,000 runs is extrapolated from it. --quick takes a smaller
casing, 32 draws and 4 runs.
"""

import shutil
import time
from pathlib import Path

import numpy as np

import casingfem as cf
from casingfem.chance.evaluate import Drawing
from casingfem.chance.load import load_chance
from casingfem.chance.rubs import GROUP, group_of
from reports.tables import Row, command_line, show, write
from reports.verification.robustness.chance_kills import prepared

TURNS = 100


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print and write the row."""
    draws, most = (32, 4) if quick else (2_048, 3 * GROUP)
    folder = (out / "chance_rubs").resolve()
    shutil.rmtree(folder, ignore_errors=True)
    prepared(folder, draws, quick)
    scene = folder / "scene.toml"
    scene.write_text(
        scene.read_text(encoding="utf-8").replace("[chance]\n", f"[chance]\nturns = {TURNS}\n"), encoding="utf-8"
    )
    own = Drawing.of(load_chance(scene))
    lot = own.lot(cf.chance.points(own.given.table.seed, range(draws), own.dimension))
    chosen = np.flatnonzero(own.dangerous(lot).any(axis=1))[:most].tolist() or list(range(most))
    group_of(own, chosen[:2], lot["growth"][chosen[:2]])  # compiles
    began, rows = time.process_time(), []
    for first in range(0, len(chosen), GROUP):
        group = chosen[first : first + GROUP]
        rows += group_of(own, group, lot["growth"][group])
    each = (time.process_time() - began) / len(rows)
    steps = float(np.mean([row["seconds"] for row in rows])) / float(own.given.scene.dt or np.nan)
    row: Row = {
        "runs": len(rows), "turns": TURNS, "mean steps": steps, "s a run": each,
        "10,000 runs, minutes of a core": each * 1e4 / 60.0,
        "unstable": sum(row["verdict"] == "unstable" for row in rows),
    }  # fmt: skip
    show("Rubs of random casings", [row])
    write(out / "chance_rubs.csv", [row])
    return [row]


if __name__ == "__main__":
    command_line(__doc__, main)
