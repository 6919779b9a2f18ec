"""Targets of the contact part, line by line: what is asked, what is reached, and whether that passes.

`python -m reports.contact_targets [--quick] [--out DIR]` prints and writes contact_targets.csv. The lines come from the
functions in `LINES`; each returns rows made by `target`. Missed lines say so. --quick leaves out the long runs.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from reports import (
    contact_targets_beam,
    contact_targets_modal,
    contact_targets_points,
    contact_targets_rods,
    contact_targets_schemes,
    contact_targets_study,
)
from reports.tables import Row, command_line, show, write

LINES: tuple[Callable[[bool], list[Row]], ...] = (
    contact_targets_rods.rows,
    contact_targets_schemes.rows,
    contact_targets_modal.rows,
    contact_targets_points.rows,
    contact_targets_beam.rows,
    contact_targets_study.rows,
)


def summary(verdicts: list[str]) -> Row:
    """How many targets are met, statements of the study counted, how many are known misses, how many times."""
    return {
        "targets": len(verdicts),
        "met": sum(word in ("pass", contact_targets_study.CONFIRMED) for word in verdicts),
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


if __name__ == "__main__":
    command_line(__doc__, main)
