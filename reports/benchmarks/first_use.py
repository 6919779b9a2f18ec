"""Time of the first run of each shipped scene, with nothing compiled, and of the next run.

`python -m reports.benchmarks.first_use [--quick] [--out DIR] [--beside CHECKOUT]`. Each time is user and system seconds
of the whole command, with an empty cache of machine code and then with the full one. The difference is the time of
compiling. If a limit is set, the smaller of two times counts, since the machine may be busy. Bases of a scene are made
before and are not timed. Scenes that differ in numbers only use the same loops, so one scene of section_44 and one of
abradable are run. A checkout beside is run in turns with this one, by the same Python.
"""

import os
import resource
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from casingfem.examples import Example, examples
from reports.tables import ROOT, Row, command_line, show, write

QUICK = ("two_rods",)
LIKE_OTHERS = ("section_44/", "abradable/", "interaction_map/", "two_rods_sweep")  # many runs, or the same loops
OF_THEM = ("section_44/half_hz", "abradable/wear_in", "abradable/as_made")
LOADED = "import casingfem.cli, contact.jit.compiled, pandas, scipy.sparse.linalg"  # once: their bytecode
# processor seconds that a first run may take
WANTED = {"two_rods": 5.0} | dict.fromkeys(
    ("coulomb_oscillator", "bladed_disk", "rub/five_nodes", "abradable/wear_in"), 15.0
)
CACHE = "machine-code"
RODS = 6.0  # every other scene of rods


def wanted(scene: Example) -> float | None:
    """Limit of the processor seconds of the first run of a scene; None without a limit."""
    return WANTED.get(scene.name, RODS if scene.tables["scene"]["kind"] == "rods" else None)


def scenes(quick: bool) -> list[Example]:
    """The scenes of the table."""
    known = [e for e in examples().values() if isinstance(e, Example) and "scene" in e.tables]
    if quick:
        return [e for e in known if e.name in QUICK]
    return [e for e in known if e.name in OF_THEM or not e.name.startswith(LIKE_OTHERS)]


def seconds(command: str, folder: Path, checkout: Path) -> float:
    """User and system seconds of a command of a checkout's casingfem and its child processes, run in `folder`."""
    return spent(command, folder, checkout)[0]


def spent(command: str, folder: Path, checkout: Path) -> tuple[float, float]:
    """User and system seconds, and seconds by the clock."""
    words = [sys.executable, "-m", *shlex.split(command)]
    there = {
        **os.environ, "PYTHONPATH": str(checkout), "NUMBA_CACHE_DIR": str(folder / CACHE),
        "OPENBLAS_NUM_THREADS": "1", "PYTHONDONTWRITEBYTECODE": "",
    }  # fmt: skip
    started, before = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(words, cwd=folder, env=there, capture_output=True, text=True, check=False)
    after, clock = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter() - started
    if done.returncode:
        raise RuntimeError(f"{command}: exit code {done.returncode}: {done.stderr.strip()[-300:]}")
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, clock


def prepared(scene: Example, folder: Path, checkout: Path) -> str:
    """The command that runs a scene from `folder`, after its scene file and bases are put there."""
    folder.mkdir(parents=True)
    seconds(f"casingfem example {scene.name}", folder, checkout)
    *before, run = scene.commands(Path("data"))
    for command in before:
        seconds(command, folder, checkout)
    return f"{run} --json"


def row_of(scene: Example, folder: Path, checkouts: Sequence[Path]) -> Row:
    """First and next run of one scene by this checkout, and by the other one."""
    limit = wanted(scene)
    folders = [folder / str(k) for k in range(len(checkouts))]
    runs = [prepared(scene, *where) for where in zip(folders, checkouts, strict=True)]
    least = np.full((len(checkouts), 2), np.inf)
    for _ in range(1 if limit is None else 2):
        for k, (run, *where) in enumerate(zip(runs, folders, checkouts, strict=True)):
            shutil.rmtree(folders[k] / CACHE, ignore_errors=True)
            least[k] = np.minimum(least[k], [seconds(run, *where), seconds(run, *where)])
    first, following = map(float, least[0])
    row: Row = {
        "scene": scene.name, "first [s]": first, "next [s]": following, "compiling [s]": first - following,
        "wanted [s]": limit, "verdict": None if limit is None else "met" if first <= limit else "MISSED",
    }  # fmt: skip
    for other in least[1:]:
        row |= {"first, beside [s]": float(other[0]), "next, beside [s]": float(other[1])}
    return row


def main(out: Path, quick: bool = False, beside: Path = ROOT) -> list[Row]:
    """Print and write the table; returns its rows."""
    rows = []
    checkouts = tuple(dict.fromkeys((ROOT, beside.resolve())))
    for checkout in checkouts:
        there = {**os.environ, "PYTHONPATH": str(checkout), "PYTHONDONTWRITEBYTECODE": ""}
        subprocess.run([sys.executable, "-c", LOADED], check=True, env=there, cwd=checkout)
    with tempfile.TemporaryDirectory() as folder:
        for scene in scenes(quick):
            row = row_of(scene, Path(folder) / scene.name.replace("/", "-"), checkouts)
            rows.append(row)
            print(scene.name, *(f"{name} {row[name]:.1f}" for name in row if "[s]" in name and row[name]), flush=True)
    show("User and system seconds of a scene's first run and of the next", rows)
    write(out / "first_use.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main, beside=(ROOT, "checkout to run in turns with this one"))
