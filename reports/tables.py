"""Print a table and write it as CSV; parse the command line that all reports share."""

import argparse
import csv
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

Row = dict[str, object]
ROOT = Path(__file__).parents[1]
OUT = ROOT / "reports" / "out"
DATA = ROOT / "data"
MARGIN = 1.6  # a bound over what is seen
ROUNDING = 1e-6  # per cent
STATISTICAL = ("Cramer-Rao bound", "Widrow & Kollar 2008")  # bounds of draws: a few standard errors
BAD_VERDICTS = ("FAIL", "MISSED", "NOT", "expected")
BAD_COUNTS = ("faults", "failed", "unnamed", "unjudged", "SILENT", "BAD MESSAGE", "SLOW")


def text(value: object) -> str:
    """A cell: floats to four significant digits, None as a dash."""
    if value is None:
        return "-"
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def show(title: str, rows: Sequence[Row]) -> None:
    """Print rows under their column names, numbers to the right."""
    names = list(rows[0])
    cells = [names, *([text(row.get(name)) for name in names] for row in rows)]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    left = [isinstance(rows[0][name], str) for name in names]
    print(f"\n{title}")
    for line in cells:
        print(
            "  ".join(
                cell.ljust(width) if to_left else cell.rjust(width)
                for cell, width, to_left in zip(line, widths, left, strict=True)
            ).rstrip()
        )


def check(
    case: str, source: str, reference: float, computed: float, allowed: float, *, gap: float = 0.0, reason: str = ""
) -> Row:
    """A row of a verification: error and allowed error in per cent, and the verdict.

    The verdict is "pass" up to `allowed`, the `reason` up to `gap`, and "FAIL" above. The bound `gap` detects when a
    known difference grows. If the reference is zero, the error is the computed value in per cent. "bound %" is the
    larger of the two if there is a reason, else `allowed`; `loose` compares it with the error.
    """
    error = 100.0 * (computed / reference - 1.0 if reference else computed)
    verdict = "pass" if abs(error) <= allowed else reason if reason and abs(error) <= gap else "FAIL"
    return {
        "case": case,
        "source": source,
        "reference": float(reference),
        "computed": float(computed),
        "error %": float(error),
        "allowed %": float(allowed),
        "bound %": float(gap if reason and abs(error) > allowed else allowed),
        "verdict": verdict,
    }


def loose(rows: Sequence[Row], most: float = MARGIN) -> list[str]:
    """Bounds larger than `most` times the error: of each row with a reason, and of similar rows by their largest error.

    Rows are similar if they have the same source and bound. Bounds at rounding level, 1e-6 % and less, are ignored.
    """
    seen: dict[tuple[str, float], float] = {}
    found = []
    for row in rows:
        error, bound = abs(float(str(row["error %"]))), float(str(row["bound %"]))
        if row["verdict"] == "pass":
            key = (str(row["source"]), bound)
            seen[key] = max(seen.get(key, 0.0), error)
        elif bound > most * error:
            found.append(f"{row['case']}: {bound:g} % bound, {error:.3g} % seen")
    return found + [
        f"{source}: {bound:g} % allowed, {error:.3g} % seen at most"
        for (source, bound), error in seen.items()
        if bound > max(most * error, ROUNDING) and source not in STATISTICAL
    ]


def failures(rows: object) -> int:
    """Number of rows of a report that state a failure, by their verdict or by a count of faults."""
    if not isinstance(rows, Sequence):
        return 0
    tables = [row for row in rows if isinstance(row, dict)]
    return sum(
        str(row.get("verdict", "")).startswith(BAD_VERDICTS) or any(row.get(name) for name in BAD_COUNTS)
        for row in tables
    )


def write(path: Path, rows: Sequence[Row]) -> None:
    """Write rows as CSV."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, fieldnames=list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def show_all(out: Path, prefix: str, tables: Mapping[str, tuple[str, Sequence[Row]]]) -> list[Row]:
    """Print and write tables (title, rows) by the names of their files; returns the rows of all."""
    for name, (title, rows) in tables.items():
        show(title, rows)
        write(out / f"{prefix}{name}.csv", rows)
    return [row for _, rows in tables.values() for row in rows]


def unread(flag: str, value: object) -> str:
    """Why a report cannot read the folder of a flag; "" if it can, or if the flag names no folder.

    >>> unread("folder", ROOT / "nowhere").replace(str(ROOT), "")
    "found no folder '/nowhere', expected one that exists"
    >>> unread("beside", ROOT / "docs").replace(str(ROOT), "")
    "found no casingfem/ in '/docs', expected a checkout of this repository"
    """
    if not isinstance(value, Path):
        return ""
    if not value.is_dir():
        return f"found no folder '{value}', expected one that exists"
    if flag == "beside" and not (value / "casingfem").is_dir():
        return f"found no casingfem/ in '{value}', expected a checkout of this repository"
    return ""


def command_line(
    description: str | None, main: Callable[..., object], **flags: str | tuple[int | str | Path, str]
) -> None:
    """Run a report's `main(out, quick)` with --out, --quick and flags of its own, name -> help, or value and help.

    A flag whose value is a path names a folder that the report reads; "beside" names another checkout. The exit code is
    2 if such a folder is missing, and 1 if returned rows report an error.
    """
    parser = argparse.ArgumentParser(description=(description or "").partition("\n")[0])
    parser.add_argument("--quick", action="store_true", help="leave out what takes long")
    for name, words in flags.items():
        if isinstance(words, str):
            parser.add_argument(f"--{name}", action="store_true", help=words)
        else:
            default, words = words
            parser.add_argument(f"--{name}", type=type(default), default=default, help=f"{words}; {default} by default")
    parser.add_argument("--out", type=Path, default=OUT, help="folder of the results")
    arguments = parser.parse_args()
    for name in flags:
        missing = unread(name, getattr(arguments, name))
        if missing:
            parser.error(f"--{name}: {missing}")
    rows = main(arguments.out, arguments.quick, **{name: getattr(arguments, name) for name in flags})
    wrong = failures(rows)
    if wrong:
        sys.exit(f"{wrong} rows say that something is wrong")
