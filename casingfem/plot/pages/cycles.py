"""The page on periodic motions: their stability, their amplitude, and where a machine jumps."""

from collections.abc import Mapping, Sequence
from typing import Any

from casingfem.plot.cycles import LABELS, figure_cycles, figure_multipliers, figure_orbits
from casingfem.plot.page import Cell, Picture, Section, Table, Verdict, capital, origin, raised, render_page
from casingfem.plot.pages.speeds import with_rpm

Rows = Sequence[Mapping[str, Any]]
BRANCHES = (
    "Amplitude of every channel over the parameter: stable motions solid, unstable ones dashed, one colour a branch."
)
STROKES = " Short lines: values at which a contact starts or stops closing."
BASINS = " Discs: motions reached from random initial states at that value, with the share of these states."
MULTIPLIERS = (
    "Left: the largest Floquet multipliers of every orbit and the unit circle. An orbit is stable where all lie "
    "inside. Right: the largest magnitude over the parameter, one colour a branch."
)
ORBITS = "Some orbits over one period, and their velocity over their displacement; unstable ones are dashed."
ORDINARY = "grazing"  # a change that ends nothing
MEANS = {
    "fold": "the motion jumps to another one",
    "flip": "the period of the motion doubles",
    "Neimark-Sacker": "the motion becomes quasi-periodic",
    "branch point": "another motion branches off",
}
NAMED = 4


def cycles_page(
    name: str, found: Any, source: Mapping[str, Any], traces: Sequence[Any] = (), reached: Rows = (), checked: str = ""
) -> str:
    """HTML of the page on branches, `found` of class `contact.cycles.Cycles`.

    `traces` are orbits over their period, `contact.cycles.Trace`; `reached` are the motions on which random starts
    settle, with their share. `checked` is the sentence of a comparison with harmonic balance.
    """
    rows, marks = found.records(), found.marks()
    strokes = any(mark["kind"] == ORDINARY for mark in marks)
    words = BRANCHES + STROKES * strokes + BASINS * bool(reached)
    pictures = [Picture.of(figure_cycles(rows, marks, reached), words)]
    pictures.append(Picture.of(figure_multipliers(found), MULTIPLIERS))
    pictures += [Picture.of(figure_orbits(traces), ORBITS)] if traces else []
    tables = [stretches_table(found), marks_table(found, marks)]
    tables += [reached_table(found, reached)] if reached else []
    orbits = Table.of(f"All {len(rows)} orbits", found.described(), rows, folded=True)
    sections = [
        Section("Branches", figures=tuple(pictures), tables=tuple(table for table in tables if table.rows)),
        Section("Orbits", tables=(orbits,)),
    ]
    return render_page(f"Cycles of {name}", sections, verdict=cycles_verdict(found, checked), source=origin(source))


def cycles_verdict(found: Any, checked: str = "") -> Verdict:
    """Summary of a continuation: jumps, stable and unstable ranges, amplitude, force, confidence, next steps."""
    points = [point for branch in found.branches for point in branch.points]
    jumps = [one for branch in found.branches for one in branch.specials if one.kind != ORDINARY]
    state, sentence = outcome(found.name, points, jumps)
    facts = [("Changes", jump_words(found.name, jumps))] if jumps else []
    for kept, name in ((True, "Stable"), (False, "Unstable")):
        parts = [(a, b, k) for k, branch in enumerate(found.branches, 1) for s, a, b in branch.stretches if s is kept]
        if parts:
            facts.append((name, stretch_words(found.name, parts, len(found.branches))))
    facts.append(("Amplitude", amplitude_words(found.name, points)))
    force = max(points, key=lambda point: float(point.force.max(initial=0.0)))
    size = float(force.force.max(initial=0.0))
    if size > 0.0:
        facts.append(("Force", f"At most {raised(f'{size:.4g}')} N, at {valued(found.name, force.value)}."))
    facts += [("Second opinion", f"{capital(checked)}.")] if checked else []
    sure = (
        f"{counted(len(points), 'periodic motion')} were computed. Floquet multipliers decide whether each is stable. "
        "Branches that are not connected with these are not found."
    )
    return Verdict(found=sentence, sure=sure, further=further_words(found, jumps), facts=tuple(facts), state=state)


def outcome(name: str, points: Sequence[Any], jumps: Sequence[Any]) -> tuple[str, str]:
    """The state (good, bad or open), and the first sentence: the first change, else the stability."""
    lost = sum(not point.stable for point in points)
    low, high = min(point.value for point in points), max(point.value for point in points)
    between = f"from {valued(name, low)} to {valued(name, high)}"
    some = f"The motion is stable in a part of the range {between} and unstable in the rest."
    if jumps:
        first = min(jumps, key=lambda one: float(one.orbit.value))
        return "open", f"At {valued(name, first.orbit.value)} {MEANS[first.kind]} ({first.kind})." + f" {some}" * bool(
            lost
        )
    if not lost:
        return "good", f"The motion is stable {between}: {counted(len(points), 'orbit')}."
    return (
        ("bad", f"No motion is stable {between}: {counted(lost, 'orbit')}.") if lost == len(points) else ("open", some)
    )


def counted(number: int, name: str) -> str:
    """A number with its noun, in singular or plural.

    >>> counted(1, "motion"), counted(95, "motion")
    ('1 motion', '95 motions')
    """
    return f"{number:,} {name}{'s' * (number != 1)}"


def valued(name: str, value: float) -> str:
    """A value of the parameter with its unit; a speed in rpm and Hz.

    >>> valued("amplitude", 14.978142), valued("speed_hz", 5.0), valued("freq_hz", 10163.4), valued("friction", 0.1)
    ('14.978 N', '300 rpm (5 Hz)', '10,163 Hz', '0.1')
    """
    if name == "speed_hz":
        return with_rpm(value)
    unit = LABELS.get(name, "").partition("[")[2].rstrip("]").replace("-", "")
    return f"{raised(f'{value:,.5g}')} {unit}".rstrip()


def jump_words(name: str, jumps: Sequence[Any]) -> str:
    """Kinds of the special points with their values."""
    words = "; ".join(f"{one.kind} at {valued(name, one.orbit.value)}" for one in jumps[:NAMED])
    return capital(words) + (f"; and {len(jumps) - NAMED} more" if len(jumps) > NAMED else "") + "."


def stretch_words(name: str, parts: Sequence[tuple[float, float, int]], branches: int) -> str:
    """Ranges of the parameter, with the number of the branch if there are several."""
    words = "; ".join(
        f"{valued(name, min(a, b))} to {valued(name, max(a, b))}" + (f" (branch {k})" if branches > 1 else "")
        for a, b, k in parts[:NAMED]
    )
    return words + (f"; and {len(parts) - NAMED} more" if len(parts) > NAMED else "") + "."


def amplitude_words(name: str, points: Sequence[Any]) -> str:
    """Largest amplitude of the first channel over the stable motions, over all if none is stable."""
    chosen = [point for point in points if point.stable] or list(points)
    channel = next(iter(points[0].amplitude))
    most = max(chosen, key=lambda point: float(point.amplitude[channel]))
    kind = "stable" if most.stable else "unstable"
    size = raised(f"{1e3 * most.amplitude[channel]:.4g}")
    return f"The largest {kind} motion moves {channel} by {size} mm, at {valued(name, most.value)}."


def further_words(found: Any, jumps: Sequence[Any]) -> str:
    """Recommended next steps."""
    broken = [branch.end for branch in found.branches if branch.end]
    if broken:
        return f"A branch ended inside the range: {broken[0].rstrip('.')}."
    if jumps:
        return "The motion jumps at a fold, or where it becomes unstable: run the scene on both sides of that value."
    return "The motion does not jump in this range: widen it, or raise the force."


def stretches_table(found: Any) -> Table:
    """Intervals of equal stability: branch, period, from, to, amplitude."""
    label = LABELS.get(found.name, found.name)
    channels = tuple(found.branches[0].points[0].amplitude)
    rows: list[tuple[Cell, ...]] = []
    for number, branch in enumerate(found.branches, 1):
        start = 0
        for kept, low, high in branch.stretches:
            stop = start
            while stop < len(branch.points) and branch.points[stop].stable is kept:
                stop += 1
            part = branch.points[start:stop]
            sizes = (raised(f"{max(point.amplitude[channel] for point in part):.4g}") for channel in channels)
            rows.append((number, part[0].periods, "stable" if kept else "unstable", *ends(low, high), *sizes))
            start = stop
    heads = (
        "branch",
        "periods",
        "stability",
        f"from: {label}",
        f"to: {label}",
        *(f"largest {one} [m]" for one in channels),
    )
    return Table("Stable and unstable stretches of the branches.", heads, tuple(rows), folded=len(rows) > 12)


def ends(low: float, high: float) -> tuple[Cell, Cell]:
    """Both ends of an interval, in the direction of the branch."""
    return raised(f"{low:.7g}"), raised(f"{high:.7g}")


def marks_table(found: Any, marks: Rows) -> Table:
    """Special points: kind, branch, parameter and amplitudes."""
    columns = {one.name: one for one in found.described()}
    names = [key for key in (marks[0] if marks else {}) if key not in ("kind", "branch")]
    rows: list[tuple[Cell, ...]] = [
        (str(mark["kind"]), int(mark["branch"]), *(raised(f"{mark[name]:.6g}") for name in names)) for mark in marks
    ]
    heads = ("kind", "branch", *(columns[name].header for name in names))
    return Table("Special points.", heads, tuple(rows), folded=len(rows) > 12)


def reached_table(found: Any, reached: Rows) -> Table:
    """Motions that random starts reach: share of the starts, periods, amplitudes."""
    sizes = [key for key in reached[0] if key.startswith("amplitude_")]
    rows: list[tuple[Cell, ...]] = [
        (
            f"{100.0 * one['share']:.3g} %",
            one["periods"],
            *(None if one[key] is None else raised(f"{one[key]:.4g}") for key in sizes),
        )
        for one in reached
    ]
    heads = (
        "share of the initial states",
        "periods",
        *(f"{key.removeprefix('amplitude_').removesuffix('_m')} [m]" for key in sizes),
    )
    at = valued(found.name, float(reached[0][found.name]))
    return Table(f"Motions reached from random initial states at {at}.", heads, tuple(rows))
