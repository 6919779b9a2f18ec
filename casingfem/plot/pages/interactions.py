"""The page on dangerous speeds: safe speeds, growing motions at the others, and their amplitudes."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from matplotlib.figure import Figure

from casingfem.plot.page import Cell, Picture, Section, Table, Verdict, origin, render_page
from casingfem.plot.pages.speeds import (
    OF_ROTOR,
    OF_SPEED,
    VERDICTS,
    force_size,
    listed,
    range_words,
    safe_ranges,
    speed_strip,
    undecided_words,
    with_rpm,
)
from casingfem.plot.style import Drawn

STATES = {"unstable": "bad", "not decided": "open", "resonance": "open"}
FURTHER = {
    "unstable": "Leave the unsafe speeds, add damping, reduce friction or enlarge the clearance; then run this again.",
    "not decided": "Lengthen t_end of the scene; `--runs` adds speeds between these.",
    "numerical": "Reduce dt of the scene; then run this again.",
    "resonance": "Do not dwell at a resonance. `casingfem report` gives force and deflection at one speed.",
    "safe": "Vary clearance, friction and out-of-roundness: `casingfem sweep`.",
}
SENTENCES = {
    "unstable": "Unsafe: the motion grows at",
    "not decided": "Not decided at",
    "resonance": "No motion grows. Resonance at",
}


def interactions_page(name: str, found: Any, figures: Mapping[str, Figure | Drawn], source: Mapping[str, Any]) -> str:
    """HTML of the page on the table of dangerous speeds, `found` of class `contact.interacting.Interactions`."""
    sections = [
        speeds_section(found, figures),
        Section("Runs", tables=(runs_table(found),)) if found.runs else None,
    ]
    return render_page(
        f"Dangerous speeds of {name}", [section for section in sections if section], verdict=speeds_verdict(found),
        source=origin(source),
    )  # fmt: skip


def speeds_section(found: Any, figures: Mapping[str, Figure | Drawn], words: tuple[str, ...] = ()) -> Section:
    """Pictures over speed and the table; `found` is None if there is no table."""
    rotor = found is not None and found.peaks.rotor
    captions = OF_SPEED | ({"interactions": OF_ROTOR} if rotor else {})
    pictures = tuple(Picture.of(figures[key], captions[key]) for key in OF_SPEED if key in figures)
    rows = () if found is None else found.records()
    tables = (Table.of("Dangerous speeds, the worst first.", found.COLUMNS, rows),) if rows else ()
    return Section("Dangerous speeds", words, pictures, tables)


def speeds_verdict(found: Any) -> Verdict:
    """Summary: the worst kind of speed, every kind with its ranges, the worst motion, confidence, next steps."""
    kinds = {
        name: sorted((row.from_hz, row.to_hz) for row in found.rows if row.at.verdict == name) for name in VERDICTS
    }
    worst = next((name for name in VERDICTS if kinds[name]), "")
    safe = safe_ranges(found)
    low, high = (float(hz) for hz in found.peaks.map.speed_hz[[0, -1]])
    if worst:
        reason = undecided_words(found) if worst == "not decided" else ""
        state, sentence = STATES[worst], f"{SENTENCES[worst]} {listed(kinds[worst])}.{reason}"
    else:
        state, sentence = "good", f"Safe: every speed from {range_words(low, high)}."
    facts = [(name.capitalize(), f"{listed(ranges)}.") for name, ranges in kinds.items() if ranges and name != worst]
    if worst:
        facts.insert(0, ("Safe", f"{listed(safe)}." if safe else "No speed of the range is safe."))
        facts.insert(0, ("Worst", row_words(found.rows[0])))
    slow = [row for row in found.rows if row.at.slow and not row.at.hides]
    if slow:
        facts.insert(1, ("Slow", slow_words(slow)))
    if found.runs:
        facts.append(("Force", force_words(found.runs)))
        facts.append(("Deflection", deflection_words(found.runs)))
    numerical = worst == "not decided" and found.rows[0].at.check == "numerical"
    further = FURTHER["numerical" if numerical else worst or "safe"]
    return Verdict(
        found=sentence, sure=found.words, further=further, facts=tuple(facts), state=state,
        strips=(("Speeds", speed_strip(found)),),
    )  # fmt: skip


def slow_words(rows: Sequence[Any]) -> str:
    """Ranges in which closed contact grows more slowly than the runs can show.

    >>> from types import SimpleNamespace as Row
    >>> slow_words([Row(from_hz=2.0, to_hz=50.0, at=Row(closed=0.264, seconds=0.5))]).split(": ")[1][:60]
    'the contact stays closed and the motion grows by at most 0.2'
    """
    ranges = listed(sorted((row.from_hz, row.to_hz) for row in rows))
    rate, length = max(row.at.closed for row in rows), max(row.at.seconds for row in rows)
    return (
        f"{ranges}: the contact stays closed and the motion grows by at most {rate:.2g} 1/s. In a machine that dwells "
        f"there it grows until a contact opens; the runs of {length:.3g} s are too short to show what follows."
    )


def force_words(runs: Sequence[Any]) -> str:
    """Largest contact force of a step, of the runs within the limit of the model and of those that were stopped."""
    known = [run for run in runs if math.isfinite(run.force_n)]
    if not known:
        return "None: no run was completed."
    stopped, whole = ([run for run in known if run.stopped is one] for one in (True, False))
    words = []
    for some, name in ((whole, " in the runs within the limit" if stopped else ""), (stopped, " in the stopped runs")):
        if some:
            largest = max(some, key=lambda run: float(run.force_n))
            words.append(f"{force_size(largest.force_n)}{name}, at {with_rpm(largest.speed_hz)}")
    if not any(run.force_n > 0.0 for run in known):
        return "None: nothing touches."
    return f"At most {'; '.join(words)}. It is the largest force of a time step."


def deflection_words(runs: Sequence[Any]) -> str:
    """Largest deflection of the completed runs, and the number of runs that were stopped at a limit."""
    stopped, whole = (
        [run for run in runs if run.stopped is one and math.isfinite(run.amplitude_m)] for one in (True, False)
    )
    words = []
    if whole:
        largest = max(whole, key=lambda run: float(run.amplitude_m))
        others = " in the others" if stopped else ""
        what = "disk" if largest.body == "rotor" else "rim"
        moved = f"the {what} moves at most {largest.deflection} mm{others}, at {with_rpm(largest.speed_hz)}"
        words.append(f"After the start, {moved}.")
        if not stopped and math.isfinite(largest.allowed_m):
            most = largest.allowed_m
            limit = f"{1e3 * most:.3g} mm" if most < 1.0 else f"{most:.3g} m"
            words.append(f"The linear model is valid up to {limit}.")
    if stopped:
        ran = "run was" if len(stopped) == 1 else "runs were"
        limit = f"the limit of the linear model, {1e3 * stopped[0].limit_m:.3g} mm"
        what = "rotor" if stopped[0].body == "rotor" else "rim"
        words.insert(0, f"{len(stopped)} {ran} stopped where the {what} passed {limit}.")
    return " ".join(words)


def row_words(row: Any) -> str:
    """Sentence on a row of the table: the growing motion, its rate, and its source, a run or closed contact."""
    at = row.at
    moves = f"the {row.mover}" if row.n is None else f"n = {row.n} of the {row.body}"
    travels = {"with": ", travelling with the blades", "against": ", travelling against the blades"}.get(row.wave, "")
    words = f"{range_words(row.from_hz, row.to_hz)}: {moves}{travels}"
    if at.slow:
        words += f", slow growth of closed contact, {at.closed:.3g} 1/s"
    elif math.isfinite(at.growth):
        interval = (
            f" (95 %: {at.low:,.4g} to {at.high:,.4g})" if math.isfinite(at.low) and math.isfinite(at.high) else ""
        )
        words += f", growth {at.growth:,.4g} 1/s{interval}"
    elif math.isfinite(at.closed):
        words += f", growth of closed contact {at.closed:.3g} 1/s"
    reached = (
        f". The rim reaches half of its wall after {at.half_wall_s:.3g} s" if math.isfinite(at.half_wall_s) else ""
    )
    checked = f". At half the step the growth is {at.check}" if at.check else ""
    return f"{words}{reached}{checked}."


def runs_table(found: Any) -> Table:
    """Every run: speed, verdict, growth, deflection."""
    heads = (
        "speed [rpm]", "speed [Hz]", "verdict", "growth [1/s]", "95 % from [1/s]", "to [1/s]", "rim [mm]",
        "force [N]", "n", "wave", "remark",
    )  # fmt: skip
    rows: tuple[tuple[Cell, ...], ...] = tuple(
        (f"{60.0 * run.speed_hz:.5g}", f"{run.speed_hz:.5g}", run.verdict, number(run.growth), number(run.low),
         number(run.high), run.deflection or None, number(run.force_n, 4), run.n, run.wave or None, run.why or None)
        for run in found.runs
    )  # fmt: skip
    return Table(f"The {len(rows)} runs.", heads, rows, folded=len(rows) > 20)


def number(value: float, digits: int = 3) -> str | None:
    """A number with a few digits, empty for nan.

    >>> number(1.23456), number(math.nan)
    ('1.23', None)
    """
    return f"{value:.{digits}g}" if math.isfinite(value) else None
