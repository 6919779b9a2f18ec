"""The page on periodic motions: branches, which of them are kept, where they jump."""

from collections.abc import Mapping, Sequence
from typing import Any

from casingfem.plot.page import Cell, Picture, Section, Table, Verdict, origin, raised, render_page
from casingfem.plot.sweep import LABELS, figure_cycles

CAPTION = (
    "Amplitude of every channel over the parameter: kept motions full, others dashed, one colour a branch; marks "
    "are folds, flips, Neimark-Sacker and branch points, small strokes where a contact begins or ceases to close."
)
BASINS = " Discs: what random starts at that value end on, and how many of them."
ORDINARY = "grazing"  # a change that ends nothing
Rows = Sequence[Mapping[str, Any]]


def cycles_page(
    name: str, rows: Rows, marks: Rows, ends: Sequence[str],
    source: Mapping[str, Any], words: str, reached: Rows = (),
) -> str:  # fmt: skip
    """HTML of the page on branches: rows of the table, special points, why branches ended inside the range.

    `reached` are the motions that random starts end on, with their share.
    """
    picture = Picture.of(figure_cycles(rows, marks, reached), CAPTION + BASINS * bool(reached))
    sections = [
        Section("Branches", figures=(picture,), tables=(marks_table(marks),), preformatted=words),
        Section("Orbits", tables=(orbits_table(rows),)),
    ]  # fmt: skip
    return render_page(f"Cycles of {name}", sections, verdict=cycles_verdict(rows, marks, ends), source=origin(source))


def cycles_verdict(
    rows: Sequence[Mapping[str, Any]], marks: Sequence[Mapping[str, Any]], ends: Sequence[str]
) -> Verdict:
    """How many motions, how many are kept, what makes them jump."""
    parameter = list(rows[0])[1]
    values = [float(row[parameter]) for row in rows]
    kept = sum(bool(row["stable"]) for row in rows)
    branches = len({row["branch"] for row in rows})
    told = [mark for mark in marks if mark["kind"] != ORDINARY]
    found = (
        f"{len(rows)} periodic motions on {branches} branch{'es' * (branches > 1)} over {label(parameter)} from "
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


def label(parameter: str) -> str:
    """The parameter in words."""
    return LABELS.get(parameter, parameter)


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
    cells: list[tuple[Cell, ...]] = [(int(row["branch"]), *(cell(row[name]) for name in names)) for row in rows]
    return Table(f"All {len(rows)} orbits", ("branch", *map(heading, names)), tuple(cells), folded=True)


def heading(name: str) -> str:
    """A column's name in words."""
    if name.startswith("amplitude_"):
        return f"{name.removeprefix('amplitude_')} [m]"
    return {"gap": "least gap [m]", "force": "largest force [N]"}.get(name, LABELS.get(name, name))


def cell(value: Any) -> Cell:
    """A number as text, whether it is kept as a word."""
    if isinstance(value, bool):
        return "kept" if value else "not kept"
    return value if isinstance(value, int) else raised(f"{float(value):.5g}")
