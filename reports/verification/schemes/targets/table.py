"""Targets of the contact part, line by line: the target, the result, and the verdict.

`python -m reports.verification.schemes.targets [--quick] [--out DIR]` prints and writes contact_targets.csv. The lines
come from the functions in `LINES`; each returns rows made by `target`. Missed lines are marked. --quick leaves out the
long runs.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from reports.tables import Row, show, write
from reports.verification.schemes.targets import beam, modal, points, rods, schemes, study

LINES: tuple[Callable[[bool], list[Row]], ...] = (
    rods.rows, schemes.rows, modal.rows, points.rows, beam.rows, study.rows,
)  # fmt: skip


def summary(verdicts: list[str]) -> Row:
    """Numbers of targets met (with statements of the study), of known misses, and of times."""
    return {
        "targets": len(verdicts),
        "met": sum(word in ("pass", study.CONFIRMED) for word in verdicts),
        "known": sum(word.startswith("known") for word in verdicts),
    }


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the table and the count of verdicts, and write it."""
    rows = [row for lines in LINES for row in lines(quick)]
    show("Contact targets", rows)
    verdicts = [row["verdict"] for row in rows]
    print(f"\n{len(rows)} targets: " + ", ".join(f"{verdicts.count(word)} {word}" for word in dict.fromkeys(verdicts)))
    write(out / "contact_targets.csv", rows)
    write(out / "contact_targets_summary.csv", [summary([str(verdict) for verdict in verdicts])])
    return rows
