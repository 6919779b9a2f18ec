"""Results of others beside ours: published values, measurements, other programs, in one table.

`python -m reports.verification.outside [--quick] [--calculix] [--out DIR]` prints and writes outside.csv: kind of
source, case, source, its value, ours, difference and allowed difference in per cent, the verdict (pass, or the reason
why not), and what the source leaves open. `reports.verification` has the rows of closed forms and of standards.
--calculix runs `ccx` where it is installed and writes branching_calculix.csv into DIR; --quick takes coarse meshes.
"""

import shutil
from collections import Counter
from pathlib import Path

from reports.tables import Row, show, write
from reports.verification.outside import blades, code_aster, shells, swept_strip, two_masses
from reports.verification.outside.columns import row
from reports.verification.schemes.cycles import published


def driven(out: Path) -> list[Row]:
    """Periodic motions of a bar before an obstacle: the published rows of `reports.verification.schemes.cycles`."""
    return [
        row("published", f"bar before an obstacle: {one['case']}", "Vadcard, Batailly, Thouverez 2022",
            float(str(one["reference"])), float(str(one["computed"])), float(str(one["allowed %"])))
        for one in published(out, quick=True)
        if str(one["source"]).startswith("Vadcard")
    ]  # fmt: skip


def main(out: Path, quick: bool = False, calculix: bool = False) -> list[Row]:
    """Print the table and the count of verdicts, and write it."""
    if calculix:
        if shutil.which("ccx") is None:
            raise SystemExit(
                f"ccx: found no such program, expected CalculiX on the path; {shells.TABLE.name} has its table"
            )
        shells.run_calculix(out)
    rows = [*shells.rows(quick), *blades.rows(quick), *swept_strip.rows(), *two_masses.rows(), *code_aster.rows()]
    rows += driven(out)
    show("Results of others", [{name: one[name] for name in list(one)[:8]} for one in rows])
    counts = Counter(
        "pass" if one["verdict"] == "pass" else "fail" if one["verdict"] == "FAIL" else "reason" for one in rows
    )
    print(f"{len(rows)} rows: {counts['pass']} pass, {counts['reason']} have a reason, {counts['fail']} fail")
    write(out / "outside.csv", rows)
    return rows
