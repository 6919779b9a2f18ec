"""The page on a sweep: what was varied, what became of the runs, and where they grow."""

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from casingfem.plot.page import Cell, Picture, Section, Table, Verdict, origin, render_page, written
from casingfem.plot.style import Drawn

SHOWN = {
    "contact_fraction": "contact, part of the time", "impulse_N_s": "impulse [N s]",
    "peak_force_N": "largest force [N]", "amplitude_m": "amplitude [m]", "growth_1_s": "growth [1/s]",
    "dominant_n": "dominant n", "unaccounted_rel": "energy not accounted for", "flags": "flags", "why": "why",
}  # fmt: skip
CAPTION = (
    "What was measured over what was varied. Diverged runs are triangles, refused or failed ones crosses; the colours "
    "of a map span all but the outermost values."
)


def sweep_page(
    name: str, keys: Sequence[str], rows: Sequence[Mapping[str, Any]], source: Mapping[str, Any],
    drawn: Drawn | None, words: str,
) -> str:  # fmt: skip
    """HTML of the page on a sweep over these keys; `drawn` is its picture, where keys are numbers.

    `rows` hold the varied values and what was measured; `words` is what the command prints.
    """
    figures = () if drawn is None else (Picture.of(drawn, CAPTION),)
    sections = [
        Section("Over what was varied", figures=figures, preformatted=words),
        Section("Runs", tables=(runs_table(keys, rows),)),
    ]
    return render_page(f"Sweep of {name}", sections, verdict=sweep_verdict(keys, rows), source=origin(source))


def sweep_verdict(keys: Sequence[str], rows: Sequence[Mapping[str, Any]]) -> Verdict:
    """What became of the runs, where they grow most, what is left to look at."""
    count = Counter(str(row["status"]) for row in rows)
    became = ", ".join(f"{number} {status}" for status, number in count.most_common())
    found = f"{len(rows)} runs over {', '.join(keys)}: {became}."
    growing = [row for row in rows if row.get("growth_1_s")]
    if growing:
        most = max(growing, key=lambda row: float(row["growth_1_s"]))
        at = ", ".join(f"{key} = {short(most[key])}" for key in keys)
        found += f" The largest growth is {float(most['growth_1_s']):.3g} 1/s, at {at}."
    left = [abs(float(row["unaccounted_rel"])) for row in rows if row.get("unaccounted_rel") is not None]
    flagged = sum(bool(row.get("flags")) for row in rows)
    sure = f"Energy not accounted for is at most {written(100.0 * max(left), 1)} % in any run." if left else ""
    sure += f" {flagged} runs have flags." if flagged else ""
    broken = count["refused"] + count["failed"]
    if broken:
        further = "Read why runs were refused or failed: the last column of the table."
    elif count["diverged"]:
        further = "Where runs diverged closed contact grows: casingfem interactions says by which coincidence."
    else:
        further = "Vary more finely around the largest values; half the step says how far to believe them."
    return Verdict(found=found, sure=sure.strip() or "Nothing was measured of these runs.", further=further)


def runs_table(keys: Sequence[str], rows: Sequence[Mapping[str, Any]]) -> Table:
    """Every run: what was varied, what became of it; columns that are empty throughout are left out."""
    names = [name for name in SHOWN if any(row.get(name) not in (None, "") for row in rows)]
    cells: list[tuple[Cell, ...]] = [
        (*(short(row[key]) for key in keys), str(row["status"]), *(cell(row.get(name)) for name in names))
        for row in rows
    ]
    columns = (*keys, "status", *(SHOWN[name] for name in names))
    return Table(f"The {len(rows)} runs; sweep.csv has more columns.", columns, tuple(cells), folded=len(rows) > 20)


def cell(value: Any) -> Cell:
    """A measured value in four digits, a dash for none."""
    if value in (None, ""):
        return None
    return float(f"{value:.4g}") if isinstance(value, float) else value if isinstance(value, int) else str(value)


def short(value: Any) -> Cell:
    """A varied value: a number as it is, the name of a file, else its words."""
    return value if isinstance(value, int | float) else str(value)
