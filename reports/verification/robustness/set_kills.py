"""Commands killed at each operation on their files: a reader finds the old set or the new one, never a mixture.

`python -m reports.verification.robustness.set_kills [--quick] [--out DIR]`. A process runs a command with `--out`, into
a folder that is not there and into one that holds another set, and gets kill -9 just before its first, second, ...
opening, renaming or removal of a file there, up to the last; and where half of its first, second, ... text or picture
is written. Commands that draw many pictures are killed at one in three or four of these moments. The folder is then
examined without changes, through a reader of the program, after `casingfem recover`, and again after the command has
run once more. Needs fork (Linux, macOS).
"""

import json
import os
import shutil
import signal
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from pathlib import Path

import numpy as np

from contact.io.infiles import read_bytes
from contact.io.publication.manifest import MANIFEST
from contact.io.publication.recovery import recover
from reports.tables import Row, command_line, show, write
from reports.verification.robustness.kill_targets import SEED, Target, targets

WATCHED = ("open", "os.link", "os.rename", "os.remove", "os.mkdir", "os.rmdir", "shutil.rmtree")
TABLES = (".csv", ".toml")  # with no time of day in them: the same to the last bit
COUNTS = (
    "kills", "amid a file", "mixed as it lies", "mixed as read", "torn", "unreadable", "other tables", "left over"
)  # fmt: skip
ENDS = {".png": b"IEND\xaeB`\x82", ".html": b"</html>", ".vtu": b"</VTKFile>"}


def killed(target: Target, out: Path, at: int, half: bool = False) -> tuple[bool, tuple[int, int]]:
    """Whether the command was killed before its operation `at` (from 0), in a process of its own; how many it did.

    With `half` it is killed amid its `at`-th writing of a text or of bytes; the second count is that of these.
    """
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        done = [0, 0]
        whole = Path.write_bytes

        def counted(kind: int, before: Callable[[], object] = lambda: None) -> None:
            if done[kind] == at and half == bool(kind):
                before()
                os.kill(os.getpid(), signal.SIGKILL)
            done[kind] += 1

        def watch(event: str, arguments: tuple[object, ...]) -> None:
            if event in WATCHED and str(arguments[0]).startswith(str(out.parent)):
                counted(0)

        def write_bytes(path: Path, data: bytes) -> int:
            if str(path).startswith(str(out.parent)):
                counted(1, lambda: whole(path, data[: len(data) // 2]))
            return whole(path, data)

        sys.addaudithook(watch)
        Path.write_bytes = write_bytes  # type: ignore[method-assign,assignment]
        try:
            target.run(target.new, out)
            os.write(writing, json.dumps(done).encode())
        finally:
            os._exit(0)
    os.close(writing)
    with os.fdopen(reading) as stream:
        said = stream.read()
    status = os.waitpid(child, 0)[1]
    if not os.WIFSIGNALED(status) and not said:
        raise RuntimeError(f"{target.arguments[0]} failed on {target.new}")
    operations, writings = json.loads(said or "[0, 0]")
    return os.WIFSIGNALED(status), (operations, writings)


def contents(out: Path) -> dict[str, bytes]:
    """The set in a folder, without hidden files and the store of a sweep."""
    paths = (path.relative_to(out) for path in out.rglob("*") if path.is_file())
    return {
        str(path): (out / path).read_bytes()
        for path in paths if not any(part.startswith(".") for part in path.parts) and path.parts[0] != "store"
    }  # fmt: skip


def as_read(out: Path, names: Iterable[str]) -> dict[str, bytes]:
    """Files of a set that a reader can read."""
    read = {}
    for name in names:
        with suppress(OSError):
            read[name] = read_bytes(out / name)
    return read


def snapshot(folder: Path) -> list[tuple[str, int, int]]:
    """Names, sizes and times of all files in a folder."""
    return sorted((str(path), (at := path.lstat()).st_size, at.st_mtime_ns) for path in folder.rglob("*"))


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
    row: Row = dict.fromkeys(COUNTS, 0)
    for out, at, half in moments(target, folder, over, quick):
        if over:
            shutil.copytree(folder / "old", out)
        if not killed(target, out, at, half)[0]:
            continue
        lying = {name: data for name, data in contents(out).items() if name not in alike}
        of_old = {name for name, data in lying.items() if data == states["old"].get(name)}
        before = snapshot(folder)
        read = {name: data for name, data in as_read(out, states["new"]).items() if name not in alike}
        read_of_old = {name for name, data in read.items() if data == states["old"].get(name)}
        changed = snapshot(folder) != before
        if out.is_dir():
            recover(out)
        found = contents(out)
        is_old = found == (states["old"] if over else {})
        is_new = found.keys() == states["new"].keys() and all(
            (found[name] == states["old"][name]) == (name in alike) for name in found
        )
        target.run(target.new, out)
        again = contents(out)
        tables = [name for name in states["new"] if name.endswith(TABLES)]
        left = [*folder.rglob("*.part"), *folder.rglob(MANIFEST)]
        counts = {
            "kills": 1, "amid a file": half, "mixed as it lies": 0 < len(of_old) < len(lying),
            "mixed as read": changed or 0 < len(read_of_old) < len(read), "torn": not (is_old or is_new),
            "unreadable": sum(not is_whole(*file) for file in found.items()),
            "other tables": sum(again[name] != states["new"][name] for name in tables), "left over": len(left),
        }  # fmt: skip
        row = {name: int(str(row[name])) + int(count) for name, count in counts.items()}
    return row


def moments(target: Target, folder: Path, over: bool, quick: bool) -> Iterator[tuple[Path, int, bool]]:
    """A folder for each kill, and before which operation, or amid which writing, it comes."""
    first = folder / "counted"
    if over:
        shutil.copytree(folder / "old", first)
    for half, count in enumerate(killed(target, first, -1)[1]):
        most = 2 if half else 4
        some = np.random.default_rng(SEED).choice(count, min(count, most), replace=False)
        for at in sorted(some) if quick else range(0, count, target.every):
            yield folder / f"out{half}_{at}", int(at), bool(half)


def main(out: Path, quick: bool = False) -> Sequence[Row]:
    """Kill, examine, run again, print."""
    folder = (out / "set_kills").resolve()
    shutil.rmtree(folder, ignore_errors=True)
    rows: list[Row] = []
    for name, target in targets(folder).items():
        for over in (False, True):
            found = tried(target, folder / f"{name}_{'over' if over else 'fresh'}", over, quick)
            clean = not any(found[fault] for fault in list(found)[2:])
            rows.append({"command": name, "into": "an older set" if over else "a new folder", **found,
                         "verdict": "pass" if clean else "FAIL"})  # fmt: skip
            shutil.rmtree(folder / f"{name}_{'over' if over else 'fresh'}")
    show("Commands under kill -9, before each operation on a file", rows)
    print(f"\n{sum(int(str(row['kills'])) for row in rows)} kills")
    write(out / "set_kills.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
