"""Processor time of rubs of random casings, each with a basis of its own.

`python -m reports.benchmarks.chance_rubs [--quick] [--whole] [--out DIR]`. Casings of data/scenes/chance that touch
their blade run for 100 turns as `casingfem chance` with `runs` does: with their own basis, blade, clearance, friction
and shape of the rim. The first ones are dangerous at some speed and run at their worst one; the speeds of all others
are these speeds in turn. The time contains the bases, the steps and the verdicts.

Without flags 96 casings run, and the time of 10,000 is extrapolated. --whole runs 10,000. --quick takes a smaller
casing, 32 draws and 4 runs.
"""

import shutil
import time
from pathlib import Path

import numpy as np

import casingfem as cf
from casingfem.chance.evaluate import Drawing, dangerous
from casingfem.chance.load import load_chance
from casingfem.chance.rubs import GROUP, group_of
from casingfem.io.arrays import FloatArray
from reports.tables import Row, command_line, show, write
from reports.verification.robustness.chance_kills import prepared

TURNS = 100
WHOLE = 10_000
STEPS = 512  # draws examined at once for casings that touch


def main(out: Path, quick: bool = False, whole: bool = False) -> list[Row]:
    """Print and write the row."""
    draws, most = (32, 4) if quick else (2_048, WHOLE if whole else 3 * GROUP)
    folder = (out / "chance_rubs").resolve()
    shutil.rmtree(folder, ignore_errors=True)
    prepared(folder, draws, quick)
    scene = folder / "scene.toml"
    scene.write_text(
        scene.read_text(encoding="utf-8").replace("[chance]\n", f"[chance]\nturns = {TURNS}\n"), encoding="utf-8"
    )
    own = Drawing.of(load_chance(scene))
    lot = own.lot(cf.chance.points(own.given.table.seed, range(draws), own.dimension))
    first = np.flatnonzero(dangerous(lot, own.floor).any(axis=1))[:most].tolist() or list(range(most))
    chosen = [*first, *touching(own, first[-1] + 1, most - len(first))]
    growth = lot["growth"][np.resize(first, most)]
    group_of(own, chosen[:GROUP], growth[:GROUP])  # compiles
    began, rows = time.process_time(), []
    for at in range(0, most, GROUP):
        rows += group_of(own, chosen[at : at + GROUP], growth[at : at + GROUP])
        if whole:
            print(f"{len(rows)} of {most} runs, {time.process_time() - began:.0f} s", flush=True)
    seconds = time.process_time() - began
    steps = float(np.mean([row["seconds"] for row in rows])) / float(own.given.scene.dt or np.nan)
    row: Row = {
        "runs": len(rows), "turns": TURNS, "mean steps": steps, "s a run": seconds / len(rows),
        "minutes of a core": seconds / 60.0, "10,000 runs, minutes of a core": seconds / len(rows) * WHOLE / 60.0,
        "unstable": sum(row["verdict"] == "unstable" for row in rows),
    }  # fmt: skip
    show("Rubs of random casings", [row])
    write(out / "chance_rubs.csv", [row])
    return [row]


def touching(own: Drawing, first: int, count: int) -> list[int]:
    """The next draws from `first` on whose rim touches the blade."""
    found = list[int]()
    start = first - first % STEPS
    while len(found) < count:
        u = cf.chance.points(own.given.table.seed, range(start, start + STEPS), own.dimension)
        found += [draw for draw in (start + np.flatnonzero(gaps(own, u) <= 0.0)).tolist() if draw >= first]
        start += STEPS
    return found[:count]


def gaps(own: Drawing, u: FloatArray) -> FloatArray:
    """Smallest clearance of each point of u [m]."""
    return own.gap(own.inputs(u), own.series(u))


if __name__ == "__main__":
    command_line(__doc__, main, whole="run 10,000 casings")
