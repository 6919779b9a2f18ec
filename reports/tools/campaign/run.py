"""Run every report in full, each in a process of its own, and record when each was last run.

`python -m reports.tools.campaign [NAME ...]` runs the named ones, or all; it goes on after a failure and ends with 1 if
one failed. Of each it writes command, commit, date, verdict and seconds to reports/campaigns.csv, and the figures that
pages quote to docs/figures.csv and into the pages. A "+" behind a commit: what it tested was not committed as it was.
`--last` runs nothing: it prints the last run of each, and how many commits have changed its subject since.
"""

import argparse
import csv
import shutil
import subprocess
import sys
import time
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path

from reports.tables import OUT, ROOT, Row, show, write
from reports.tools.campaign.campaigns import CAMPAIGNS, Campaign
from reports.tools.campaign.figures import adopt
from reports.tools.campaign.quoted import figures

RECORD = Path("reports", "campaigns.csv")
COLUMNS = ("name", "command", "commit", "date", "verdict", "seconds")
LIMIT = 6 * 3600.0  # seconds: what takes longer hangs
PASS = "pass"
KEPT = {  # tables that docs keep whole
    "verification": ("verification.csv",),
    "verification.outside": ("outside.csv",),
    "benchmarks.work_precision": ("work_precision_winners.csv",),
}


def git(*words: str) -> str:
    """Output of git; empty if git fails, as outside a repository or for an unknown commit."""
    done = subprocess.run(("git", *words), cwd=ROOT, capture_output=True, text=True, check=False)
    return done.stdout.strip() if done.returncode == 0 else ""


def commit_of(subject: Sequence[str]) -> str:
    """The current commit, with "+" if a path of the subject differs from it."""
    changed = git("status", "--porcelain", "--", *subject, "reports/*.py")
    return git("rev-parse", "--short=10", "HEAD") + ("+" if changed else "")


def since(commit: str, subject: Sequence[str]) -> str:
    """Number of commits after it that changed the subject, as text of the table."""
    known = commit.rstrip("+")
    count = git("rev-list", "--count", f"{known}..HEAD", "--", *subject) if known else ""
    return count or ("commit unknown here" if known else "never run")


def run(campaign: Campaign, out: Path) -> Row:
    """One report in its process; its figures, if it ended well, go to the pages."""
    folder = out / "campaign" / campaign.name
    shutil.rmtree(folder, ignore_errors=True)
    print(f"\n=== {campaign.command}", flush=True)
    commit, started = commit_of(campaign.subject), time.perf_counter()
    words = [sys.executable, "-m", f"reports.{campaign.name}", *campaign.flags, "--out", str(folder)]
    try:
        code = subprocess.run(words, cwd=ROOT, timeout=LIMIT, check=False).returncode
        verdict = PASS if code == 0 else f"FAIL: exit code {code}"
    except subprocess.TimeoutExpired:
        verdict = f"FAIL: not done in {LIMIT:.0f} s"
    seconds = time.perf_counter() - started
    if verdict == PASS:
        try:
            quoted = figures(campaign.name, folder)
            for name in KEPT.get(campaign.name, ()):
                keep_table(folder / name)
            if quoted:
                print("pages changed:", ", ".join(adopt(campaign.name, quoted)) or "none")
        except (KeyError, OSError, ValueError) as error:
            verdict = f"FAIL: figures of pages: {error}"
    return {
        "name": campaign.name, "command": campaign.command, "commit": commit,
        "date": datetime.now(UTC).date().isoformat(), "verdict": verdict, "seconds": f"{seconds:.0f}",
    }  # fmt: skip


def keep_table(file: Path, folder: Path = ROOT / "docs") -> None:
    """A table of a run, its numbers at six digits, for the pages."""
    with file.open(newline="", encoding="utf-8") as stream:
        rows = [{name: _short(cell) for name, cell in line.items()} for line in csv.DictReader(stream)]
    write(folder / file.name, rows)


def _short(cell: str) -> str:
    try:
        return f"{float(cell):.6g}"
    except ValueError:
        return cell


def read_record(root: Path = ROOT) -> dict[str, Row]:
    """The last run of each campaign that has one."""
    if not (root / RECORD).is_file():
        return {}
    with (root / RECORD).open(newline="", encoding="utf-8") as stream:
        return {line["name"]: dict(line) for line in csv.DictReader(stream)}


def keep(row: Row, root: Path = ROOT) -> None:
    """Put a run into the record, which is kept in the order of the list."""
    record = read_record(root) | {str(row["name"]): row}
    places = {campaign.name: place for place, campaign in enumerate(CAMPAIGNS)}
    write(root / RECORD, [record[name] for name in sorted(record, key=lambda name: places.get(name, len(places)))])


def last() -> list[Row]:
    """The last run of every campaign, and how many commits have changed its subject since."""
    record = read_record()
    never: Row = dict.fromkeys(COLUMNS, "")
    return [
        {"campaign": campaign.name, "proves": campaign.proves}
        | {name: record.get(campaign.name, never)[name] for name in COLUMNS[2:]}
        | {"changes since": since(str(record.get(campaign.name, never)["commit"]), campaign.subject)}
        for campaign in CAMPAIGNS
    ]


def main(chosen: Sequence[Campaign], out: Path = OUT, root: Path = ROOT) -> list[Row]:
    """Run campaigns one after another, whatever becomes of each; returns a row of each."""
    rows = []
    for campaign in chosen:
        rows.append(run(campaign, out))
        keep(rows[-1], root)
    show("Campaigns", rows)
    return rows


def command_line(arguments: Sequence[str] | None = None) -> int:
    """Run what a command line asks for; its exit code."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    known = [campaign.name for campaign in CAMPAIGNS]
    parser.add_argument("names", nargs="*", metavar="NAME", help="reports to run; all if none is named")
    parser.add_argument("--last", action="store_true", help="run nothing, print when each was last run")
    parser.add_argument("--out", type=Path, default=OUT, help="folder of the results")
    asked = parser.parse_args(arguments)
    strange = sorted(set(asked.names) - set(known))
    if strange:
        parser.error(f"found {', '.join(strange)}, expected names of {', '.join(known)}")
    if asked.last:
        show("Campaigns: the last run of each", last())
        return 0
    chosen = [campaign for campaign in CAMPAIGNS if not asked.names or campaign.name in asked.names]
    return int(any(row["verdict"] != PASS for row in main(chosen, asked.out)))
