"""Check of the speeds at which `interactions` runs a scene: random rubs are compared with runs at 481 speeds.

`python -m reports.verification.rubs.speeds_between [--count 40] [--first 0] [--quick] [--out DIR]` draws the rubs of
`run_growth`. The verdicts at 481 speeds evenly over the range count as true. At each of these speeds the table of
`ct.interactions` states a verdict, from some runs evenly over the range and others midway between runs that disagree;
61 runs evenly, without others, state that of the nearest run. A table has the share of the range with another verdict,
the share that is not safe and is called safe, and the length of all runs over that of one.

The table fails if one of its shares is larger than that of the even runs.

A motion counts as large by the median of the even runs, of each set by its own, so that verdicts differ a little also
at the same speed.
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

import contact as ct
from casingfem.io.arrays import FloatArray
from contact.interacting import Interactions
from contact.speed_verdict import SpeedRun, decided
from reports.tables import Row, command_line, show, text, write
from reports.verification.rubs.run_growth import END, STEP, drawn

MANY, QUICK, EVERY = 481, 49, 8  # runs that count as true; of these every eighth
TABLE, EVEN = "ct.interactions", "even"


def verdicts(found: Interactions, speeds: FloatArray) -> list[str]:
    """The verdict that a table states at speeds [turns/s]."""
    rows = [[row.at.verdict for row in found.rows if row.from_hz <= hz <= row.to_hz] for hz in speeds.tolist()]
    return [row[0] if row else "safe" for row in rows]


def of_nearest(runs: Sequence[SpeedRun], speeds: FloatArray) -> list[str]:
    """The verdict of the nearest run at speeds [turns/s]."""
    at = np.array([run.speed_hz for run in runs])
    return [runs[k].verdict for k in np.searchsorted(0.5 * (at[1:] + at[:-1]), speeds).tolist()]


def by_own_median(runs: Sequence[SpeedRun]) -> tuple[SpeedRun, ...]:
    """Verdicts of some runs as if there were no others."""
    calm = [replace(run, verdict="resonance") if run.verdict == "safe" else run for run in runs]
    return decided(calm, calm)


def shares(true: Sequence[str], found: Sequence[str]) -> tuple[float, float]:
    """Percent of speeds with another verdict, and of those that are not safe and are called safe."""
    pairs = list(zip(true, found, strict=True))
    other, missed = (sum(one != two for one, two in pairs), sum(one != "safe" == two for one, two in pairs))
    return 100.0 * other / len(pairs), 100.0 * missed / len(pairs)


def compared(seed: int, fine: int) -> list[Row]:
    """Shares of one rub, by the table and by the nearest of some even runs; every EVERY-th of the `fine` ones."""
    what, mu = drawn(seed)
    scene = ct.Scene(what=what, law=ct.Coulomb(mu=mu) if mu else ct.Unilateral(), t_end=END, dt=STEP)
    many, table = ct.interactions(scene, runs=fine), ct.interactions(scene)
    speeds = np.linspace(many.runs[0].speed_hz, many.runs[-1].speed_hz, fine)
    at = {run.speed_hz: run for run in many.runs}
    even = [at[hz] for hz in speeds.tolist()]
    true = [run.verdict for run in even]
    few = by_own_median(even[::EVERY])
    rows: list[Row] = []
    for name, found, runs in (
        (TABLE, verdicts(table, speeds), table.runs),
        (EVEN, of_nearest(few, speeds), few),
    ):
        wrong, missed = shares(true, found)
        length = sum(max(run.seconds, END) for run in runs) / END
        rows.append({"speeds": name, "seed": seed, "other verdict [%]": wrong, "unsafe called safe [%]": missed,
                     "runs": len(runs), "length": length})  # fmt: skip
    return rows


def main(out: Path, quick: bool = False, count: int = 40, first: int = 0) -> list[Row]:
    """Print the means over the draws; write two rows for each."""
    rows: list[Row] = []
    for seed in range(first, first + (min(count, 2) if quick else count)):
        rows += compared(seed, QUICK if quick else MANY)
        for row in rows[-2:]:
            print(", ".join(f"{name} {text(value)}" for name, value in row.items()), flush=True)
        write(out / "speeds_between.csv", rows)
    table: list[Row] = []
    for name in (TABLE, EVEN):
        own = [row for row in rows if row["speeds"] == name]
        means = {key: float(np.mean([float(str(row[key])) for row in own])) for key in list(own[0])[2:]}
        table.append({"speeds": name, "draws": len(own), **means})
    worse = any(float(str(table[0][key])) > float(str(table[1][key])) for key in list(table[0])[2:4])
    table[0]["verdict"] = "FAIL" if worse and not quick else "pass"
    show("Verdicts over speed, against many more runs", table)
    return table


if __name__ == "__main__":
    command_line(__doc__, main, count=(40, "how many draws"), first=(0, "seed of the first"))
