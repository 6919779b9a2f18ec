"""Microseconds a step of tips by modes and physics, beside another checkout of this repository, in turns.

`python -m reports.benchmarks.tips_beside --beside CHECKOUT [--quick] [--out DIR]`. A rim with one tip is a
`RotatingRim` in both; more tips are a `Rub` of one blade each, evenly around. The casing of `reports.benchmarks.sweeps`
with its blade of two modes, at 5 Hz, out-of-roundness of two and three lobes. Both are run by this Python, in two
processes that take turns, so that what others do on the machine meets both: the least processor time of the loop alone,
and the median ratio of neighbours in time. A first run of each compiles and is not counted. 64 tips and more with
friction are left out where all touch at once: the search for their forces takes minutes.
"""

import json
import os
import subprocess
import sys
from pathlib import Path
from statistics import median
from typing import Any

from reports.benchmarks.sweeps import bodies
from reports.tables import ROOT, Row, command_line, show, write

MODES, TIPS = (42, 102, 328), (1, 16, 64, 256)
CASES = (("free", 1e-3, 0.0), ("frictionless", -1e-4, 0.0), ("friction", -1e-4, 0.3))  # clearance [m], mu
MOST_WITH_FRICTION = 64
STEPS = {1: 100_000, 16: 10_000, 64: 1_000, 256: 200}  # of 42 modes
RUNS = Path(__file__).with_name("runs_of_tips.py")


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
    other: "subprocess.Popen[str]", this: "subprocess.Popen[str]", asked: dict[str, object], repeats: int
) -> Row:  # fmt: skip
    """One case in both, in turns."""
    pairs = []
    for k in range(repeats + 1):
        before, now = answer(other, asked), answer(this, asked)
        if k:
            pairs.append((before["us/step"], now["us/step"]))
    ones, others = zip(*pairs, strict=True)
    return {
        "closed": now["closed"], "other us/step": min(ones), "us/step": min(others),
        "ratio": median(b / a for a, b in pairs),
        "impulse differs by": abs(now["impulse"] - before["impulse"]) / max(before["impulse"], 1e-300),
    }  # fmt: skip


def main(out: Path, quick: bool = False, beside: Path = ROOT) -> list[Row]:
    """Print and write the table."""
    rows: list[Row] = []
    folder = (out / "tips_beside").resolve()
    with runner(beside) as other, runner(ROOT) as this:
        for modes in MODES[:1] if quick else MODES:
            bodies(folder, modes)
            for tips in TIPS[:2] if quick else TIPS:
                for name, clearance, mu in CASES:
                    if mu and tips > MOST_WITH_FRICTION:
                        continue
                    steps = max(100, STEPS[tips] * MODES[0] // modes // (20 if quick else 1))
                    asked: dict[str, object] = {
                        "folder": str(folder), "bodies": [f"casing_{modes}", "blade"], "clearance": clearance,
                        "mu": mu, "steps": steps, "tips": tips,
                    }  # fmt: skip
                    found = row(other, this, asked, 2 if quick else 11 if tips == 1 else 5)
                    rows.append({"modes": modes, "tips": tips, "case": name, **found})
                    print(rows[-1], flush=True)
    show("Steps of tips, beside another checkout", rows)
    write(out / "speed_tips_beside.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main, beside=(ROOT, "checkout beside which this one is timed"))
