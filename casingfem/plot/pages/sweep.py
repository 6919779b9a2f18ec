"""The page on a sweep: safe values, contact forces, confidence, and every run."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from casingfem.plot.page import Cell, Picture, Section, Table, Verdict, origin, render_page, written
from casingfem.plot.pages.scene import ROUND_OFF
from casingfem.plot.pages.speeds import listed, with_rpm
from casingfem.plot.style import Drawn
from casingfem.plot.sweep import beyond, column, named, stretches, undecided, unsafe
from contact.io.columns import Columns

Rows = Sequence[Mapping[str, Any]]
CAPTION = "Results of the runs over the varied keys."
OF_CURVES = (
    " Bars: 95 % interval of the growth. Shaded: values at which the motion grows, the run diverged, or the rim "
    "deflects by more than half of its wall."
)
OF_MAPS = " The most extreme values lie outside the colour scale."
FOLDED = 20  # runs from which their table is folded
NAMED = 4  # ranges or codes in a sentence


def sweep_page(
    name: str, labels: Sequence[str], keys: Sequence[str], rows: Rows, source: Mapping[str, Any],
    drawn: Drawn | None, columns: Columns,
) -> str:  # fmt: skip
    """HTML of the page on a sweep over these keys; `drawn` is its picture, if keys are numbers.

    `rows` contain the varied values by key and the results in `columns`; `labels` are the keys with their units.
    """
    caption = CAPTION + (OF_MAPS if len(keys) > 1 else OF_CURVES if any(row.get("motion") for row in rows) else "")
    figures = () if drawn is None else (Picture.of(drawn, caption),)
    sections = [
        Section("Results over the varied keys", figures=figures),
        Section("Runs", tables=(runs_table(labels, keys, rows, columns),)),
    ]
    return render_page(f"Sweep of {name}", sections, verdict=sweep_verdict(labels, keys, rows), source=origin(source))


def sweep_verdict(labels: Sequence[str], keys: Sequence[str], rows: Rows) -> Verdict:
    """Summary of a sweep: unsafe runs, largest force and amplitude, safe and unsafe values, warnings, next steps."""
    state, sentence = outcome(rows)
    rms = " rms in the last quarter of the run" if any(row.get("motion") for row in rows) else ""
    facts = [
        ("Force", largest_words(labels, keys, rows, "peak_force_N", "N")),
        ("Amplitude", largest_words(labels, keys, rows, "amplitude_m", f"mm{rms}", 1e3)),
        ("Growth", growth_words(labels, keys, rows)),
        *range_facts(keys, rows),
        ("Warnings", warning_words(rows)),
        ("Not run", lost_words(rows)),
    ]
    return Verdict(
        found=sentence, sure=sure_words(rows), further=further_words(rows), state=state,
        facts=tuple(fact for fact in facts if fact[1]),
    )  # fmt: skip


def outcome(rows: Rows) -> tuple[str, str]:
    """The state (good, bad or open), and the first sentence."""
    count = Counter(str(row["status"]) for row in rows)
    bad, broken = int(unsafe(rows).sum()), count["refused"] + count["failed"]
    large, open_ = int(beyond(rows).sum()), open_words(rows)
    if broken == len(rows):
        return "bad", f"No result: all {len(rows)} runs were refused or failed."
    if bad:
        return "bad", f"Unsafe: the motion grows or diverges in {bad} of {counted(len(rows), 'run')}."
    if large:
        words = f"Unsafe: the rim deflects by more than half of its wall in {large} of {counted(len(rows), 'run')}."
        return "bad", f"{words} {open_}".rstrip()
    if open_:
        return "open", f"Not decided: {open_}"
    if any(row.get("motion") for row in rows):
        return "good", f"Bounded: the motion grows in none of {counted(len(rows), 'run')}."
    return "", f"{count['done']} of {counted(len(rows), 'run')} ended, over {' and '.join(keys_of(rows))}."


def open_words(rows: Rows) -> str:
    """Number of runs that do not decide whether the motion grows, and why; empty if all do."""
    numerical = sum(row.get("motion") == "numerical" for row in rows)
    short, of = int(undecided(rows).sum()) - numerical, f"of {counted(len(rows), 'run')}"
    words = []
    if short:
        words.append(f"{short} {of} {'is' if short == 1 else 'are'} too short to show growth.")
    if numerical:
        words.append(f"The growth in {numerical} {of} is an effect of the time step.")
    return " ".join(words)


def keys_of(rows: Rows) -> list[str]:
    """The varied keys: those before the outcome."""
    names = list(rows[0])
    return names[: names.index("status")]


def counted(number: int, name: str) -> str:
    """A number with its noun, in singular or plural.

    >>> counted(1, "run"), counted(27, "run")
    ('1 run', '27 runs')
    """
    return f"{number:,} {name}{'s' * (number != 1)}"


def at_words(labels: Sequence[str], keys: Sequence[str], row: Mapping[str, Any]) -> str:
    """The varied values of a run, with the units of their labels.

    >>> at_words(["rod[1].velocity [m/s]", "rod[2].elements"], ["v", "n"], {"v": 6.4, "n": 50})
    'v = 6.4 m/s and n = 50'
    """
    units = (label.partition(" [")[2].removesuffix("]") for label in labels)
    return " and ".join(
        with_rpm(row[key]) if key == "speed.hz" else f"{key} = {written(short(row[key]))} {unit}".rstrip()
        for key, unit in zip(keys, units, strict=True)
    )


def largest_words(
    labels: Sequence[str], keys: Sequence[str], rows: Rows, name: str, unit: str, scale: float = 1.0
) -> str:
    """Range of a result, and the run with its largest value; empty if no run has it."""
    values = scale * column(rows, name)
    if not np.isfinite(values).any():
        return ""
    low, high, k = float(np.nanmin(values)), float(np.nanmax(values)), int(np.nanargmax(values))
    if unit == "N" and high >= 1e4:
        low, high, unit = 1e-3 * low, 1e-3 * high, "kN"
    at = at_words(labels, keys, rows[k])
    return f"From {written(low, 4)} to {written(high, 4)} {unit}. The largest is at {at}."


def growth_words(labels: Sequence[str], keys: Sequence[str], rows: Rows) -> str:
    """The fastest growth with its interval, its wave and its source; empty if no motion grows."""
    growing = [row for row in rows if row.get("motion") == "grows"]
    if not growing:
        return ""
    row = max(growing, key=lambda one: float(one["growth_1_s"]))
    words = f"At most {float(row['growth_1_s']):.4g} 1/s"
    if row.get("growth_low_1_s") is not None:
        words += f" (95 %: {row['growth_low_1_s']:,.4g} to {row['growth_high_1_s']:,.4g})"
    words += f", at {at_words(labels, keys, row)}"
    if row.get("body"):
        words += f": {'the ' if row.get('n') is None else 'n = {n} of the '.format(n=row['n'])}{row['body']}"
        words += f", with energy from {row['source']}" if row.get("source") else ""
    wall = row.get("half_wall_at_s")
    return words + (f". The rim reaches half of its wall after {wall:.3g} s." if wall is not None else ".")


def range_facts(keys: Sequence[str], rows: Rows) -> list[tuple[str, str]]:
    """Unsafe and safe values of one varied number, for a speed in rpm and Hz; empty for several keys."""
    if len(keys) != 1 or not any(row.get("motion") for row in rows):
        return []
    values = [row[keys[0]] for row in rows]
    if not all(isinstance(value, int | float) for value in values):
        return []
    x, bad, large = np.array(values, dtype=float), unsafe(rows), beyond(rows)
    decided = np.array([row["status"] == "done" for row in rows]) & ~undecided(rows)
    words = []
    for name, chosen in (("Unsafe", bad), ("Beyond half the wall", large), ("Safe", decided & ~bad & ~large)):
        ranges = stretches(x, chosen)
        if ranges:
            text = listed(ranges) if keys[0] == "speed.hz" else plain_ranges(ranges)
            words.append(
                (name, f"The runs at {text}." if keys[0] == "speed.hz" else f"The runs at {keys[0]} = {text}.")
            )
    return words


def plain_ranges(ranges: Sequence[tuple[float, float]]) -> str:
    """Ranges of a number, and the number of further ones.

    >>> plain_ranges([(0.1, 0.2), (0.5, 0.5)])
    '0.1 to 0.2; 0.5'
    """
    words = "; ".join(f"{low:.4g} to {high:.4g}" if high > low else f"{low:.4g}" for low, high in ranges[:NAMED])
    return words + (f"; and {len(ranges) - NAMED} more" if len(ranges) > NAMED else "")


def warning_words(rows: Rows) -> str:
    """Codes of warnings with the number of runs that have each."""
    count = Counter(code for row in rows for code in str(row.get("flags") or "").split("; ") if code)
    if not count:
        return ""
    words = ", ".join(f"{code} in {counted(number, 'run')}" for code, number in count.most_common(NAMED))
    return f"{words}. `casingfem explain CODE` gives the cause and the remedy."


def lost_words(rows: Rows) -> str:
    """Number of refused or failed runs, and the reason of the first."""
    parts = []
    for status in ("refused", "failed"):
        reasons = [str(row.get("why") or "") for row in rows if row["status"] == status]
        parts += [f"{counted(len(reasons), 'run')} {status}, the first: {reasons[0].rstrip('.')}."] if reasons else []
    return " ".join(parts)


def sure_words(rows: Rows) -> str:
    """Results of the runs' own checks, and effects that the checks do not cover."""
    left = [abs(float(row["unaccounted_rel"])) for row in rows if row.get("unaccounted_rel") is not None]
    if not left:
        return "No run has results."
    words = f"At most {written(100.0 * max(left), 1)} % of the energy of a run is unaccounted for."
    if max(left) < ROUND_OFF[1]:
        words = "The balance of energy is satisfied to rounding in every run."
    return f"{words} The time step and the number of modes were not checked, unless the sweep varies them."


def further_words(rows: Rows) -> str:
    """Recommended next steps."""
    if any(row["status"] in ("refused", "failed") for row in rows):
        return "Correct the runs that were refused or failed: the last column of the table gives the reason."
    if any(row.get("motion") == "grows" for row in rows):
        return (
            "Leave the unsafe values, or add damping or reduce friction. `casingfem interactions` lists the dangerous "
            "speeds between these runs."
        )
    if unsafe(rows).any():
        return (
            "Run one scene that diverged: `casingfem rub` repeats its last stretch at half the step and states whether "
            "the growth is converged."
        )
    if beyond(rows).any():
        return (
            "Enlarge the clearance, reduce friction or add a coating. `casingfem interactions` lists the dangerous "
            "speeds between these runs."
        )
    if any(row.get("motion") == "numerical" for row in rows):
        return "Reduce scheme.dt, then sweep again."
    if undecided(rows).any():
        return "Lengthen t_end, then sweep again."
    return "Vary more finely around the largest values, and vary scheme.dt to see what the step changes."


def runs_table(labels: Sequence[str], keys: Sequence[str], rows: Rows, columns: Columns) -> Table:
    """Every run: the varied values, then its results; empty columns are omitted."""
    used = [one for one in columns if any(row.get(one.name) not in (None, "") for row in rows)]
    measured = Table.of(f"The {len(rows)} runs; sweep.csv has more columns.", used, rows, folded=len(rows) > FOLDED)
    cells = tuple(
        (*(short(row[key]) for key in keys), *(cell or None for cell in found))
        for row, found in zip(rows, measured.rows, strict=True)
    )
    varied = tuple("Value of a varied key of the scene." for _ in keys)
    return replace(
        measured, columns=(*map(named, labels), *measured.columns), rows=cells, meanings=(*varied, *measured.meanings)
    )


def short(value: Any) -> Cell:
    """A varied value: a number unchanged, a file by its name, else its text."""
    return value if isinstance(value, int | float) else str(value)
