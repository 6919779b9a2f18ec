"""The numbers of two checkouts, compared: every example, every scheme, published values.

`python -m reports.tools.frozen OTHER [--only PATTERN] [--out DIR]`. OTHER is a checkout of another commit (`git
worktree add ../before COMMIT`). Each command runs in both, on this machine and these libraries, and all numbers and
words of its JSON document, or of its CSV table, are compared: equal to the bit, how far apart, or what is missing.
Times, versions and other properties of the machine are left out.
"""

import argparse
import csv
import json
import math
import os
import re
import shlex
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from fnmatch import fnmatch
from pathlib import Path
from typing import Any

from casingfem.examples import examples
from contact.scene.scheme import SCHEMES
from reports.tables import OUT, ROOT, Row, show, write

BY_MACHINE = re.compile(r"second|version|^source$|^us/|\[s\]$|^wall|processor|speed-up|^million|^%")
LEDGER = ".energy"
CLOSE = 1e-13  # of the largest number of a list: sums in another order
LONG = ("interaction_map/map", "two_rods_sweep")  # sweeps: their runs are those of scenes
# table -> its report and flags
REPORTS = {
    "verification": "verification",
    "contact_targets": "verification.schemes.targets --quick",
    "section_44": "studies.section_44 --quick",
    "wear": "studies.wear --quick",
    "rods": "verification.schemes.rods --quick",
}
EXTRAS = {"penalty": "stiffness = 1.75e10", "exact-modal": "modes = 40"}


@dataclass(frozen=True, slots=True)
class Case:
    """Commands typed in a folder that holds `files`; the last one's document counts, or the table it writes."""

    name: str
    commands: tuple[str, ...]
    files: tuple[tuple[str, str], ...] = ()
    table: str = ""


def cases() -> Iterator[Case]:
    """Everything that is compared."""
    for name, example in examples().items():
        if name not in LONG:
            *before, run = example.commands(Path("data"))
            yield Case(name, (f"casingfem example {name}", *before, f"{run} --json"))
    text = examples()["two_rods"].file
    body = (ROOT / "data" / text).read_text(encoding="utf-8").partition("[scheme]")[0]
    for kind in SCHEMES:
        scheme = f'[scheme]\nkind = "{kind}"\ncourant = 0.4\n{EXTRAS.get(kind, "")}\n[record]\nstate_every = 1\n'
        yield Case(f"scheme {kind}", ("casingfem contact rods.toml --json",), (("rods.toml", body + scheme),))
    for name, report in REPORTS.items():
        yield Case(f"report {name}", (f"reports.{report} --out out",), table=f"out/{name}.csv")


def numbers_of(case: Case, tree: Path, folder: Path) -> Any:
    """The document of a case run with the packages of a checkout, or the reason why there is none."""
    folder.mkdir(parents=True)
    for name, content in case.files:
        (folder / name).write_text(content, encoding="utf-8")
    path = os.pathsep.join([str(tree), os.environ.get("PYTHONPATH", "")])
    there = {**os.environ, "PYTHONPATH": path, "OPENBLAS_NUM_THREADS": "1", "MPLBACKEND": "Agg"}
    for command in case.commands:
        module, *arguments = shlex.split(command)
        if module.startswith("reports.") and not runnable(tree, module):
            module = elsewhere(tree, module)
        words = [sys.executable, "-P", "-m", module, *arguments]
        done = subprocess.run(words, cwd=folder, env=there, capture_output=True, text=True, check=False)
        if done.returncode and not case.table:
            return {"exit code": done.returncode, "said": done.stderr.replace(str(tree), "")[-300:]}
    if not case.table:
        return json.loads(done.stdout)
    if not (folder / case.table).exists():
        return {"said": done.stderr[-300:]}
    with (folder / case.table).open(newline="", encoding="utf-8") as stream:
        return [{key: plain(value) for key, value in row.items()} for row in csv.DictReader(stream)]


def runnable(tree: Path, module: str) -> bool:
    """Whether a checkout has a report of this name, a file or a folder with a way in."""
    path = tree.joinpath(*module.split("."))
    return path.with_suffix(".py").exists() or (path / "__main__.py").exists()


def elsewhere(tree: Path, module: str) -> str:
    """A report of the same last name in a checkout that keeps it in another folder; the name itself where none is."""
    last = module.rpartition(".")[2]
    found = [path for path in (tree / "reports").rglob(f"{last}*") if runnable(path.parent, last)]
    return ".".join(found[0].relative_to(tree).with_suffix("").parts) if found else module


def plain(cell: str) -> float | str:
    """A cell of a table as a number where it is one."""
    try:
        return float(cell)
    except ValueError:
        return cell


def flat(document: Any, place: str = "") -> Iterator[tuple[str, Any]]:
    """Every list of numbers, number and word with its place; what the machine decides is left out.

    The terms of an energy balance are one list: what is left of them is round-off of the largest.
    """
    if place.endswith(LEDGER) and all(isinstance(value, float | int | None) for value in document.values()):
        yield place, [document[key] for key in sorted(document)]
    elif isinstance(document, dict):
        for key, value in document.items():
            if not BY_MACHINE.search(str(key)):
                yield from flat(value, f"{place}.{key}")
    elif isinstance(document, list) and document and not all(isinstance(x, float | int | None) for x in document):
        for k, value in enumerate(document):
            yield from flat(value, f"{place}[{k}]")
    else:
        yield place, document


def apart(one: Any, other: Any) -> float:
    """0 where equal to the bit, else the largest difference over the largest number; infinite for other kinds."""
    if one == other or (one != one and other != other):
        return 0.0
    a, b = (x if isinstance(x, list) else [x] for x in (one, other))
    if len(a) != len(b) or not all(isinstance(x, float | int) for x in (*a, *b)):
        return math.inf
    top = max(abs(x) for x in (*a, *b))
    return max(abs(x - y) for x, y in zip(a, b, strict=True)) / top if math.isfinite(top) else math.inf


def row_of(name: str, now: Any, before: Any) -> Row:
    """How far apart two documents are, and where most."""
    here, there = dict(flat(now)), dict(flat(before))
    far = {place: apart(here[place], there[place]) for place in here.keys() & there.keys()}
    place, worst = max(far.items(), key=lambda item: item[1], default=("", 0.0))
    missing = sorted(here.keys() ^ there.keys())
    if ".said" in here.keys() | there.keys():  # two failures are equal, and prove nothing
        missing = [str(here.get(".said", there.get(".said")))]
    equal = "equal to the bit" if worst == 0.0 else "equal to 1e-13" if worst <= CLOSE else "changed"
    return {
        "case": name, "numbers": sum(len(x) if isinstance(x, list) else 1 for x in here.values()),
        "verdict": "changed" if missing else equal, "apart": worst, "where": place if worst else "",
        "only in one": " ".join(missing[:3]),
    }  # fmt: skip


def main(other: Path, only: str = "*", out: Path = OUT) -> list[Row]:
    """Print and write the table; returns its rows."""
    rows = []
    with tempfile.TemporaryDirectory() as temporary:
        for k, case in enumerate(case for case in cases() if fnmatch(case.name, only)):
            now, before = (numbers_of(case, tree, Path(temporary, side, str(k)))
                           for side, tree in (("now", ROOT), ("before", other.resolve())))  # fmt: skip
            rows.append(row_of(case.name, now, before))
            print(f"{case.name}: {rows[-1]['verdict']}", flush=True)
    if not rows:
        raise SystemExit(f"--only: no case is named like {only!r}")
    show(f"Numbers of this checkout and of {other}", rows)
    write(out / "frozen.csv", rows)
    return rows


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("other", type=Path, help="a checkout of another commit")
    parser.add_argument("--only", default="*", help="cases whose names match")
    parser.add_argument("--out", type=Path, default=OUT, help="folder of the table")
    given = parser.parse_args()
    if not (given.other / "casingfem").is_dir():
        parser.error(f"{given.other}: found no casingfem/, expected a checkout")
    changed = [row for row in main(given.other, given.only, given.out) if row["verdict"] == "changed"]
    sys.exit(1 if changed else 0)
