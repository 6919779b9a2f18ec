"""One tip through the loop of many tips, beside the loop of a rim with one: microseconds a step, in turns.

`python -m reports.speed.one_tip [--quick] [--out DIR] [--beside CHECKOUT]`. The general loop (`Rub`) is this
checkout's, the special one (`RotatingRim`) that of the other, by default this one's too; both are run by this Python.
The casing of `reports.speed.sweeps` with its blade of two modes, at 5 Hz. Two processes run in turns, so that what
others do on the machine meets both: medians of processor time, and of the ratios of neighbours in time. A first run of
each compiles and is not counted.
"""

import json
import os
import subprocess
import sys
from pathlib import Path
from statistics import median
from typing import Any

from reports.speed.sweeps import bodies
from reports.tables import ROOT, Row, command_line, show, write

MODES = (42, 102, 328)
CASES = (("free", 1e-3, 0.0), ("frictionless", -1e-4, 0.0), ("friction", -1e-4, 0.3))  # clearance [m], mu
RUNS = Path(__file__).with_name("runs_of_one_tip.py")


def runner(checkout: Path) -> "subprocess.Popen[str]":
    """A process that times runs with the `contact` of a checkout."""
    there = {**os.environ, "PYTHONPATH": str(checkout.resolve()), "OPENBLAS_NUM_THREADS": "1"}
    return subprocess.Popen([sys.executable, str(RUNS)], stdin=-1, stdout=-1, text=True, env=there, cwd=checkout)


def answer(process: "subprocess.Popen[str]", asked: dict[str, object]) -> dict[str, Any]:
    """Its answer to one question."""
    assert process.stdin is not None
    assert process.stdout is not None
    process.stdin.write(json.dumps(asked) + "\n")
    process.stdin.flush()
    found: dict[str, Any] = json.loads(process.stdout.readline())
    return found


def row(
    special: "subprocess.Popen[str]", general: "subprocess.Popen[str]", asked: dict[str, object], repeats: int
) -> Row:
    """Both forms of one case, in turns."""
    pairs = []
    for k in range(repeats + 1):
        one = answer(special, {**asked, "form": "RotatingRim"})
        other = answer(general, {**asked, "form": "Rub"})
        if k:
            pairs.append((one["us/step"], other["us/step"]))
    ones, others = zip(*pairs, strict=True)
    return {
        "closed": one["closed"], "closed, general": other["closed"], "special us/step": median(ones),
        "general us/step": median(others), "ratio": median(b / a for a, b in pairs),
        "of the least": min(others) / min(ones),
    }  # fmt: skip


def main(out: Path, quick: bool = False, beside: Path = ROOT) -> list[Row]:
    """Print and write the table."""
    rows: list[Row] = []
    folder = (out / "one_tip").resolve()
    with runner(beside) as special, runner(ROOT) as general:
        for modes in MODES[:1] if quick else MODES:
            bodies(folder, modes)
            for name, clearance, mu in CASES:
                steps = (3_000 if quick else 100_000) * MODES[0] // modes
                asked: dict[str, object] = {
                    "folder": str(folder), "bodies": [f"casing_{modes}", "blade"], "clearance": clearance, "mu": mu,
                    "steps": steps,
                }  # fmt: skip
                rows.append({"modes": modes, "case": name, **row(special, general, asked, 2 if quick else 15)})
    show("One tip: the loop of many tips beside that of a rim", rows)
    write(out / "speed_one_tip.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main, beside=(ROOT, "checkout whose loop of a rim is taken"))
