"""Print a table and write it as CSV; read the command line every report shares."""

import argparse
import csv
from collections.abc import Callable, Sequence
from pathlib import Path

Row = dict[str, object]
OUT = Path(__file__).parent / "out"
DATA = Path(__file__).parent.parent / "data"


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

    "pass" within `allowed`; the `reason` why not up to `gap`, a bound of its own, so that a known gap cannot grow
    unseen; else "FAIL". Where the reference is zero, the error is the computed value in per cent.
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
        "verdict": verdict,
    }


def write(path: Path, rows: Sequence[Row]) -> None:
    """Write rows as CSV."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, fieldnames=list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)


def command_line(description: str | None, main: Callable[..., object], **flags: str) -> None:
    """Run a report's `main(out, quick)` with --out, --quick and flags of its own, name -> help."""
    parser = argparse.ArgumentParser(description=(description or "").partition("\n")[0])
    parser.add_argument("--quick", action="store_true", help="leave out what takes long")
    for name, words in flags.items():
        parser.add_argument(f"--{name}", action="store_true", help=words)
    parser.add_argument("--out", type=Path, default=OUT, help="folder of the results")
    arguments = parser.parse_args()
    main(arguments.out, arguments.quick, **{name: getattr(arguments, name) for name in flags})
