"""Commands killed at each operation on their files: a reader finds the old set or the new one, never a mixture.

`python -m reports.robustness.set_kills [--quick] [--out DIR]`. A process runs a command with `--out`, into a folder
that is not there and into one that holds another set, and gets kill -9 just before its first, second, ... opening,
renaming or removal of a file there, up to the last. Then what lies there is looked at as it is, as a command of the
program finds it, and once more after the command has run again. Needs fork (Linux, macOS).
"""

import json
import os
import shutil
import signal
import sys
from collections.abc import Iterator, Sequence
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from typing import NamedTuple

import numpy as np

from casingfem.cli import main as casingfem
from contact.io.outfiles import settle
from reports.tables import Row, command_line, show, write

SEED = 20261
WATCHED = ("open", "os.rename", "os.remove", "os.mkdir", "os.rmdir", "shutil.rmtree")
TABLES = (".csv", ".toml")  # with no time of day in them: the same to the last bit
ENDS = {".png": b"IEND\xaeB`\x82", ".html": b"</html>", ".vtu": b"</VTKFile>", ".pvd": b"</VTKFile>"}
STUDY = """[material]
E = 2e11
nu = 0.3
rho = 7800.0
[chart]
kind = "cylinder"
radius = 0.2
height = 0.2
[shell]
thickness = {t}
[[imperfection]]
of = "radius"
harmonics = [{{p = 4, cos = 1e-3}}]
[support.base]
kind = "clamped"
[modes]
count = 4
[mesh]
order = 5
rows = 1
around = 9
[update]
table = "table.csv"
[[update.parameter]]
name = "material.E"
lower = 1e11
upper = 3e11
"""
SWEEP = """[scene]
kind = "rods"
t_end = 1e-4
[[mass]]
mass = 1.0
x = 0.0
velocity = 1.0
stiffness = {k}
[wall]
x = 1e-5
[scheme]
kind = "forward-lagrange"
dt = 1e-6
[sweep]
[[sweep.vary]]
key = "mass[1].velocity"
values = [0.1, 0.2, 0.4]
"""


class Target(NamedTuple):
    """A command, with the files of an old state and a new one."""

    arguments: tuple[str, ...]
    old: Path
    new: Path

    def run(self, file: Path, out: Path) -> None:
        """The command on one of its files, in this process."""
        arguments = [self.arguments[0], str(file), *self.arguments[1:], "--out", str(out)]
        with redirect_stdout(StringIO()), redirect_stderr(StringIO()):
            casingfem(arguments, standalone_mode=False)


def targets(folder: Path) -> dict[str, Target]:
    """Commands that write sets, or single files."""
    folder.mkdir(parents=True, exist_ok=True)
    files = {}
    for name, text in {"study": STUDY, "sweep": SWEEP}.items():
        for state, value in {"old": 1.0, "new": 1.1}.items():
            files[name, state] = folder / f"{name}_{state}" / f"{name}.toml"
            files[name, state].parent.mkdir()
            files[name, state].write_text(text.format(t=2e-3 * value, k=1e4 * value), encoding="utf-8")
    for state in ("old", "new"):
        table = files["study", state].parent / "table.csv"
        table.write_text("# SYNTHETIC\nmode,n,freq_hz,sigma_hz\n1,,1300,20\n2,,1400,20\n", encoding="utf-8")
    study, sweep = ((files[name, "old"], files[name, "new"]) for name in ("study", "sweep"))
    return {
        "modes": Target(("modes", "--vtu", "--modes", "1,2"), *study), "update": Target(("update",), *study),
        "report": Target(("report",), *study), "sweep": Target(("sweep", "--jobs", "1"), *sweep),
    }  # fmt: skip


def killed(target: Target, out: Path, at: int) -> tuple[bool, int]:
    """Whether the command was killed before its operation `at` (from 0), in a process of its own; how many it did."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        done = 0

        def watch(event: str, arguments: tuple[object, ...]) -> None:
            nonlocal done
            if event in WATCHED and str(arguments[0]).startswith(str(out.parent)):
                if done == at:
                    os.kill(os.getpid(), signal.SIGKILL)
                done += 1

        sys.addaudithook(watch)
        try:
            target.run(target.new, out)
            os.write(writing, str(done).encode())
        finally:
            os._exit(0)
    os.close(writing)
    with os.fdopen(reading) as stream:
        said = stream.read()
    status = os.waitpid(child, 0)[1]
    if not os.WIFSIGNALED(status) and not said:
        raise RuntimeError(f"{target.arguments[0]} failed on {target.new}")
    return os.WIFSIGNALED(status), int(said or 0)


def contents(out: Path) -> dict[str, bytes]:
    """The set in a folder: all that is not hidden, and no store of a sweep."""
    paths = (path.relative_to(out) for path in out.rglob("*") if path.is_file())
    return {
        str(path): (out / path).read_bytes()
        for path in paths if not any(part.startswith(".") for part in path.parts) and path.parts[0] != "store"
    }  # fmt: skip


def is_whole(name: str, data: bytes) -> bool:
    """Whether a file ends as one of its kind does."""
    if name.endswith(".json"):
        try:
            return bool(json.loads(data))
        except ValueError:
            return False
    return data.rstrip(b"\n").endswith(ENDS.get(Path(name).suffix, b"")) and bool(data)


def tried(target: Target, folder: Path, over: bool, quick: bool) -> Row:
    """Kill a command at all its operations, or at a few of them drawn at random."""
    states = {}
    for state in ("old", "new"):
        target.run(getattr(target, state), folder / state)
        states[state] = contents(folder / state)
    alike = {name for name, data in states["old"].items() if data == states["new"].get(name)}
    row: Row = {"kills": 0, "mixed as it lies": 0, "torn": 0, "unreadable": 0, "other tables": 0, "left over": 0}
    for out, at in moments(target, folder, over, quick):
        if over:
            shutil.copytree(folder / "old", out)
        if not killed(target, out, at)[0]:
            continue
        lying = {name: data for name, data in contents(out).items() if name not in alike}
        of_old = {name for name, data in lying.items() if data == states["old"].get(name)}
        settle(out)
        found = contents(out)
        is_old = found == (states["old"] if over else {})
        is_new = found.keys() == states["new"].keys() and all(
            (found[name] == states["old"][name]) == (name in alike) for name in found
        )
        target.run(target.new, out)
        again = contents(out)
        tables = [name for name in states["new"] if name.endswith(TABLES)]
        left = [*folder.rglob("*.part"), *folder.rglob(".new")]
        counts = {
            "kills": 1, "mixed as it lies": 0 < len(of_old) < len(lying), "torn": not (is_old or is_new),
            "unreadable": sum(not is_whole(*file) for file in found.items()),
            "other tables": sum(again[name] != states["new"][name] for name in tables), "left over": len(left),
        }  # fmt: skip
        row = {name: int(str(row[name])) + int(count) for name, count in counts.items()}
    return row


def moments(target: Target, folder: Path, over: bool, quick: bool) -> Iterator[tuple[Path, int]]:
    """A folder for each kill, and the operation before which it comes."""
    first = folder / "counted"
    if over:
        shutil.copytree(folder / "old", first)
    count = killed(target, first, -1)[1]
    some = np.random.default_rng(SEED).choice(count, min(count, 6), replace=False)
    for at in sorted(some) if quick else range(count):
        yield folder / f"out{at}", int(at)


def main(out: Path, quick: bool = False) -> Sequence[Row]:
    """Kill, look, run again, print."""
    folder = (out / "set_kills").resolve()
    shutil.rmtree(folder, ignore_errors=True)
    rows: list[Row] = []
    for name, target in targets(folder).items():
        for over in (False, True):
            found = tried(target, folder / f"{name}_{'over' if over else 'fresh'}", over, quick)
            clean = not any(found[fault] for fault in list(found)[1:])
            rows.append({"command": name, "into": "an older set" if over else "a new folder", **found,
                         "verdict": "pass" if clean else "FAIL"})  # fmt: skip
            shutil.rmtree(folder / f"{name}_{'over' if over else 'fresh'}")
    show("Commands under kill -9, before each operation on a file", rows)
    print(f"\n{sum(int(str(row['kills'])) for row in rows)} kills")
    write(out / "set_kills.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
