"""The pages on many runs: a sweep, and branches of periodic motions."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from casingfem.plot.page import Cell, Picture, Section, Table, Verdict, origin, raised, render_page, written
from casingfem.plot.style import Drawn
from casingfem.plot.sweep import LABELS, figure_cycles
from contact.io.columns import Columns

Rows = Sequence[Mapping[str, Any]]
CAPTION = (
    "What was measured over what was varied. Diverged runs are triangles, refused or failed ones crosses; the colours "
    "of a map span all but the outermost values."
)
BRANCHES = (
    "Amplitude of every channel over the parameter: kept motions full, others dashed, one colour a branch; marks "
    "are folds, flips, Neimark-Sacker and branch points, small strokes where a contact begins or ceases to close."
)
BASINS = " Discs: what random starts at that value end on, and how many of them."
ORDINARY = "grazing"  # a change that ends nothing


def sweep_page(
    name: str, keys: Sequence[str], rows: Rows, source: Mapping[str, Any],
    drawn: Drawn | None, words: str, columns: Columns,
) -> str:  # fmt: skip
    """HTML of the page on a sweep over these keys; `drawn` is its picture, where keys are numbers.

    `rows` hold the varied values and what was measured, in `columns`; `words` is what the command prints.
    """
    figures = () if drawn is None else (Picture.of(drawn, CAPTION),)
    sections = [
        Section("Over what was varied", figures=figures, preformatted=words),
        Section("Runs", tables=(runs_table(keys, rows, columns),)),
    ]
    return render_page(f"Sweep of {name}", sections, verdict=sweep_verdict(keys, rows), source=origin(source))


def sweep_verdict(keys: Sequence[str], rows: Rows) -> Verdict:
    """What became of the runs, where they grow most, what is left to look at."""
    count = Counter(str(row["status"]) for row in rows)
    became = ", ".join(f"{number} {status}" for status, number in count.most_common())
    found = f"{len(rows)} runs over {', '.join(keys)}: {became}."
    motions = Counter(str(row["motion"]) for row in rows if row.get("motion"))
    if motions:
        found += f" Motion: {', '.join(f'{number} {state}' for state, number in motions.most_common())}."
    growing = [row for row in rows if row.get("motion") == "grows"]
    if growing:
        most = max(growing, key=lambda row: float(row["growth_1_s"]))
        at = ", ".join(f"{key} = {short(most[key])}" for key in keys)
        found += f" The fastest growth is {float(most['growth_1_s']):.3g} 1/s, at {at}."
    left = [abs(float(row["unaccounted_rel"])) for row in rows if row.get("unaccounted_rel") is not None]
    flagged = sum(bool(row.get("flags")) for row in rows)
    sure = f"Energy not accounted for is at most {written(100.0 * max(left), 1)} % in any run." if left else ""
    sure += f" {flagged} runs have flags." if flagged else ""
    broken = count["refused"] + count["failed"]
    if broken:
        further = "Read why runs were refused or failed: the last column of the table."
    elif count["diverged"]:
        further = (
            "Run one scene that diverged by itself: casingfem rub repeats its last stretch at half the step and says "
            "whether the growth is converged."
        )
    else:
        further = "Vary more finely around the largest values; half the step says how far to believe them."
    return Verdict(found=found, sure=sure.strip() or "Nothing was measured of these runs.", further=further)


def runs_table(keys: Sequence[str], rows: Rows, columns: Columns) -> Table:
    """Every run: what was varied, what became of it; columns that are empty throughout are left out."""
    used = [column for column in columns if any(row.get(column.name) not in (None, "") for row in rows)]
    measured = Table.of(f"The {len(rows)} runs; sweep.csv has more columns.", used, rows, folded=len(rows) > 20)
    cells = tuple(
        (*(short(row[key]) for key in keys), *(cell or None for cell in found))
        for row, found in zip(rows, measured.rows, strict=True)
    )
    varied = tuple("Value of a varied key of the scene." for _ in keys)
    return replace(measured, columns=(*keys, *measured.columns), rows=cells, meanings=(*varied, *measured.meanings))


def short(value: Any) -> Cell:
    """A varied value: a number as it is, the name of a file, else its words."""
    return value if isinstance(value, int | float) else str(value)


def cycles_page(
    name: str, rows: Rows, marks: Rows, ends: Sequence[str],
    source: Mapping[str, Any], words: str, reached: Rows = (),
) -> str:  # fmt: skip
    """HTML of the page on branches: rows of the table, special points, why branches ended inside the range.

    `reached` are the motions that random starts end on, with their share.
    """
    picture = Picture.of(figure_cycles(rows, marks, reached), BRANCHES + BASINS * bool(reached))
    sections = [
        Section("Branches", figures=(picture,), tables=(marks_table(marks),), preformatted=words),
        Section("Orbits", tables=(orbits_table(rows),)),
    ]  # fmt: skip
    return render_page(f"Cycles of {name}", sections, verdict=cycles_verdict(rows, marks, ends), source=origin(source))


def cycles_verdict(rows: Rows, marks: Rows, ends: Sequence[str]) -> Verdict:
    """How many motions, how many are kept, what makes them jump."""
    parameter = list(rows[0])[1]
    values = [float(row[parameter]) for row in rows]
    kept = sum(bool(row["stable"]) for row in rows)
    branches, named = len({row["branch"] for row in rows}), LABELS.get(parameter, parameter)
    told = [mark for mark in marks if mark["kind"] != ORDINARY]
    found = (
        f"{len(rows)} periodic motions on {branches} branch{'es' * (branches > 1)} over {named} from "
        f"{min(values):.6g} to {max(values):.6g}; {kept} are kept, {len(rows) - kept} are not. "
    )
    found += "; ".join(f"{mark['kind']} at {mark[parameter]:.6g}" for mark in told[:4])
    found += f" and {len(told) - 4} more special points" if len(told) > 4 else ""
    sure = (
        "Every motion closes on itself after its period and is judged by its Floquet multipliers. Motions on branches "
        "that are not connected with these are not found."
    )
    broken = [end for end in ends if end]
    if broken:
        further = f"A branch ended inside the range: {broken[0].rstrip('.')}."
    elif told:
        further = "Where a branch folds or loses its stability a machine jumps: run the scene on both sides of it."
    else:
        further = "Nothing jumps in this range: widen it, or raise the force."
    return Verdict(found=found.rstrip(" ;") + ("" if found.endswith(". ") else "."), sure=sure, further=further)


def marks_table(marks: Rows) -> Table:
    """Special points."""
    names = [key for key in (marks[0] if marks else {}) if key not in ("kind", "branch")]
    rows: list[tuple[Cell, ...]] = [
        (str(mark["kind"]), int(mark["branch"]), *(f"{mark[name]:.6g}" for name in names)) for mark in marks
    ]
    columns = ("kind", "branch", *(heading(name) for name in names))
    return Table("Special points.", columns, tuple(rows), folded=len(rows) > 12)


def orbits_table(rows: Rows) -> Table:
    """All orbits, folded."""
    names = [key for key in rows[0] if key != "branch"]
    cells: list[tuple[Cell, ...]] = [(int(row["branch"]), *(orbit_cell(row[name]) for name in names)) for row in rows]
    return Table(f"All {len(rows)} orbits", ("branch", *map(heading, names)), tuple(cells), folded=True)


def heading(name: str) -> str:
    """A column's name in words."""
    if name.startswith("amplitude_"):
        return f"{name.removeprefix('amplitude_')} [m]"
    return {"gap": "least gap [m]", "force": "largest force [N]"}.get(name, LABELS.get(name, name))


def orbit_cell(value: Any) -> Cell:
    """A number as text, whether it is kept as a word."""
    if isinstance(value, bool):
        return "kept" if value else "not kept"
    return value if isinstance(value, int) else raised(f"{float(value):.5g}")
