"""A chance calculation killed repeatedly: it ends after resuming, with the table of an undisturbed one.

`python -m reports.verification.robustness.chance_kills [--quick] [--out DIR]`. `casingfem chance` of data/scenes/chance
with two worker processes, once undisturbed and once with kill -9 at random moments: 20,000 draws, 10 times a worker and
5 times the command, which is then started again. --quick takes a smaller casing, 2,048 draws, 2 kills of workers and 1
of the command. Needs /proc (Linux).
"""

import os
import shutil
import signal
import subprocess
import time
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

import numpy as np

from reports.tables import DATA, Row, command_line, show, write
from reports.verification.robustness.sweep_kills import DEADLINE, SEED, kill, start

TABLES = ("chance.csv", "chance_pairs.csv", "chance_speeds.csv")
SMALLER = (
    ("p_max = 24", "p_max = 8"),
    ("scale = 0.35", "scale = 0.1"),
    ("n_max = 20", "n_max = 8"),
    ("modes = 40", "modes = 8"),
)


def prepared(folder: Path, draws: int, quick: bool) -> None:
    """The shipped example with another number of draws, and its bases."""
    folder.mkdir(parents=True)
    for name in ("casing.toml", "blade.toml", "scene.toml"):
        text = (DATA / "scenes" / "chance" / name).read_text(encoding="utf-8")
        for old, new in (("draws = 2048", f"draws = {draws}"), ("worst = 3", "worst = 0"), *(SMALLER if quick else ())):
            text = text.replace(old, new)
        (folder / name).write_text(text, encoding="utf-8")
    for name in ("casing.toml", "blade.toml"):
        if command(folder, "reduce", name, "--out", ".").wait() != 0:
            raise RuntimeError(f"reduce failed: see the log in {folder}")


def command(folder: Path, *arguments: str) -> subprocess.Popen[bytes]:
    """A process of casingfem in the folder."""
    return start(folder, arguments[0], "-m", "casingfem", *arguments)


def chance(folder: Path, out: str) -> subprocess.Popen[bytes]:
    """A process of `casingfem chance` with two workers."""
    return command(folder, "chance", "scene.toml", "--processes", "2", "--out", out)


def workers(parent: int) -> list[int]:
    """Numbers of the worker processes of a command; those that multiprocessing has for itself are not among them."""
    found = []
    try:
        children = [int(word) for word in Path(f"/proc/{parent}/task/{parent}/children").read_text().split()]
        for child in children:
            if b"resource_tracker" not in Path(f"/proc/{child}/cmdline").read_bytes():
                found.append(child)
    except OSError:  # one of them has ended
        return []
    return found


def disturb(folder: Path, out: str, parts: int, kills: tuple[int, int]) -> tuple[int, int]:
    """Let the command finish, killing at random numbers of finished parts: kills of workers, of the command."""
    rng = np.random.default_rng(SEED)
    kinds = rng.permutation(["worker"] * kills[0] + ["command"] * kills[1])
    moments = np.sort(rng.uniform(0.0, 0.9, kinds.size)) * parts
    began, done, running = time.monotonic(), 0, chance(folder, out)
    try:
        while running.poll() is None:
            if time.monotonic() - began > DEADLINE:
                raise RuntimeError(f"not done after {DEADLINE:.0f} s: see the logs in {folder}")
            finished = sum(1 for _ in (folder / out / "draws").glob("d*.npz"))
            there = workers(running.pid)
            if done < kinds.size and there and finished >= moments[done]:
                if kinds[done] == "worker":
                    kill_number(int(rng.choice(there)))
                else:
                    kill(running)
                    running = chance(folder, out)
                done += 1
            time.sleep(0.2)
    finally:
        kill(running)
    if running.returncode != 0:
        raise RuntimeError(f"the command failed: see the logs in {folder}")
    return int(sum(kinds[:done] == "worker")), int(sum(kinds[:done] == "command"))


def kill_number(number: int) -> None:
    """Kill -9 a process by its number, if it is still there."""
    with suppress(ProcessLookupError):
        os.kill(number, signal.SIGKILL)


def compared(folder: Path) -> bool:
    """Whether the tables of both runs are the same to the last byte."""
    return all((folder / "killed" / name).read_bytes() == (folder / "alone" / name).read_bytes() for name in TABLES)


def main(out: Path, quick: bool = False) -> Sequence[Row]:
    """Run, kill, compare, print."""
    draws, kills = (2_048, (2, 1)) if quick else (20_000, (10, 5))
    folder = (out / "chance_kills").resolve()
    shutil.rmtree(folder, ignore_errors=True)
    prepared(folder, draws, quick)
    began = time.monotonic()
    if chance(folder, "alone").wait() != 0:
        raise RuntimeError(f"the command failed: see the log in {folder}")
    alone = time.monotonic() - began
    parts = sum(1 for _ in (folder / "alone" / "draws").glob("d*.npz"))
    began = time.monotonic()
    killed = disturb(folder, "killed", parts, kills)
    row: Row = {
        "draws": draws, "workers killed": killed[0], "commands killed": killed[1], "s undisturbed": alone,
        "s with kills": time.monotonic() - began, "tables identical": compared(folder),
    }  # fmt: skip
    row["verdict"] = "pass" if row["tables identical"] and killed == kills else "FAIL"
    show("A chance calculation under kill -9", [{"what": name, "value": value} for name, value in row.items()])
    write(out / "chance_kills.csv", [row])
    return [row]


if __name__ == "__main__":
    command_line(__doc__, main)
