"""For `reports.tools.mutants`: the tables of verdicts and of survivors with their notes, and the shares."""

import csv
from collections.abc import Iterable
from pathlib import Path

from reports.tables import Row, show, write
from reports.tools.mutants.draw import Mutant
from reports.tools.mutants.judge import Verdict


def row_of(mutant: Mutant, found: Verdict) -> Row:
    """A mutant and its verdict, a row of the table."""
    return {
        "mutant": f"{mutant.file}:{mutant.line}", "function": mutant.function, "before": mutant.before,
        "after": mutant.after, "killed": found.killed, "killed by": found.by, "how": found.how.partition("\n")[0],
        "tests": len(found.ran), "left out": found.left_out,
        "files": " ".join(dict.fromkeys(test.partition("::")[0] for test in found.ran)),
    }  # fmt: skip


def notes(path: Path) -> dict[tuple[str, str], str]:
    """Notes on survivors, by place and change."""
    if not path.exists():
        return {}
    with path.open(newline="", encoding="utf-8") as stream:
        return {(row["mutant"], row["after"]): row["note"] for row in csv.DictReader(stream)}


def report(out: Path, seed: int, verdicts: dict[Mutant, Verdict], broken: Iterable[str]) -> list[Row]:
    """Print and write the tables."""
    rows = [row_of(mutant, found) for mutant, found in verdicts.items()]
    write(out / "mutants.csv", rows)
    path = out / "mutants_survivors.csv"
    noted = notes(path)
    survivors: list[Row] = [
        {name: row[name] for name in ("mutant", "before", "after", "tests", "left out", "files")}
        | {"note": noted.get((str(row["mutant"]), str(row["after"])), "")}
        for row in rows
        if not row["killed"]
    ]
    path.unlink(missing_ok=True)
    if survivors:
        write(path, survivors)
        shown = ("mutant", "before", "after", "tests", "note")
        show("Mutants that no test killed", [{name: row[name] for name in shown} for row in survivors])
    for test in broken:
        print(f"left out, since it fails without a mutant: {test}")
    killed = len(rows) - len(survivors)
    print(f"\nseed {seed}: {killed} of {len(rows)} mutants killed, {100.0 * killed / len(rows):.1f} %")
    others = len(rows) - sum(str(row["note"]).startswith("equivalent") for row in survivors)
    if others < len(rows):
        print(f"of the {others} that are not noted as equivalent: {100.0 * killed / others:.1f} %")
    return rows
