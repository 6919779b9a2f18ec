"""Safe and dangerous speeds in words, from the table of dangerous speeds, in rpm and Hz; forces in N and kN."""

from collections.abc import Sequence
from typing import Any

from markupsafe import Markup

NAMED = 4  # ranges that a sentence lists
OF_SPEED = {
    "interactions": "Top: Campbell diagram at the blade; marks: motions that closed contact can drive, with their n. "
    "Middle: growth of closed contact (line) and of the runs. Bottom: rim deflection. Unstable speeds are shaded.",
    "map": "Interaction map at one speed. Where a triangle lies on a line of the blade, casing and blade interact.",
}
OF_ROTOR = (
    "Top: whirl frequencies over speed; marks: motions that grow without contact. Middle: growth without contact "
    "(line) and of the runs. Bottom: distance of the disk. Unstable speeds are shaded."
)
VERDICTS = {"unstable": "Unstable", "not decided": "Not decided", "resonance": "Resonance"}
LEAST = 0.6  # per cent of the strip: a narrower range is drawn so wide


def with_rpm(hz: float) -> str:
    """A speed in rpm and Hz.

    >>> with_rpm(5.0), with_rpm(0.05), with_rpm(203.7)
    ('300 rpm (5 Hz)', '3 rpm (0.05 Hz)', '12,222 rpm (203.7 Hz)')
    """
    return f"{short(60.0 * hz)} rpm ({short(hz)} Hz)"


def short(number: float) -> str:
    """A number with four digits; from a thousand on, a whole number.

    >>> short(28.2963), short(6074.34)
    ('28.3', '6,074')
    """
    return f"{number:,.0f}" if abs(number) >= 1e3 else f"{number:.4g}"


def force_size(force: float) -> str:
    """A force in N or kN.

    >>> force_size(45.5), force_size(66840.0)
    ('45.5 N', '66.84 kN')
    """
    return f"{force:.4g} N" if force < 1e4 else f"{1e-3 * force:.4g} kN"


def range_words(low: float, high: float) -> str:
    """A range of speeds in rpm and Hz; one speed if both ends read the same.

    >>> range_words(3.0, 3.5), range_words(3.0, 3.00001)
    ('180 to 210 rpm (3 to 3.5 Hz)', '180 rpm (3 Hz)')
    """
    if with_rpm(low) == with_rpm(high):
        return with_rpm(low)
    return f"{short(60.0 * low)} to {short(60.0 * high)} rpm ({short(low)} to {short(high)} Hz)"


def joined(ranges: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """Ranges in ascending order, with touching or overlapping ones joined.

    >>> joined([(4.0, 5.0), (1.0, 2.0), (2.0, 3.0), (1.5, 1.7)])
    [(1.0, 3.0), (4.0, 5.0)]
    """
    found = list[tuple[float, float]]()
    for low, high in sorted(ranges):
        if found and low <= found[-1][1]:
            found[-1] = (found[-1][0], max(found[-1][1], high))
        else:
            found.append((low, high))
    return found


def listed(ranges: Sequence[tuple[float, float]]) -> str:
    """The widest ranges by speed, with touching ones joined, and the number of further ones.

    >>> listed([(k**2, k**2 + k) for k in range(1, 6)]).split("; ")[0], listed([(k, k + 0.5) for k in range(5)])[-20:]
    ('240 to 360 rpm (4 to 6 Hz)', 'and 1 narrower range')
    """
    ranges = joined(ranges)
    widest = sorted(sorted(ranges, key=lambda one: one[0] - one[1])[:NAMED])
    words = "; ".join(range_words(low, high) for low, high in widest)
    more = len(ranges) - len(widest)
    return words + (f"; and {more} narrower range{'s' * (more > 1)}" if more else "")


def safe_ranges(found: Any) -> list[tuple[float, float]]:
    """The speeds outside all rows, or in safe rows; `found` is the result of `contact.interactions`."""
    low, high = (float(hz) for hz in found.peaks.map.speed_hz[[0, -1]])
    ranges, start = list[tuple[float, float]](), low
    for begin, end in sorted((row.from_hz, row.to_hz) for row in found.rows if row.at.verdict != "safe"):
        if begin > start:
            ranges.append((start, begin))
        start = max(start, end)
    return ranges + ([(start, high)] if start < high else [])


def undecided_words(found: Any) -> str:
    """Sentence on the widest range that is not decided, if its run states a reason."""
    rows = [row for row in found.rows if row.at.verdict == "not decided" and row.at.why]
    if not rows:
        return ""
    why = max(rows, key=lambda row: float(row.to_hz - row.from_hz)).at.why
    return f" {why[0].upper()}{why[1:]}."


def speed_words(found: Any, why: str = "") -> tuple[str, ...]:
    """Dangerous and safe speeds from `contact.interactions`; `why`: the reason if there are none."""
    if found is None:
        return (f"There is no table of dangerous speeds: {why}",) if why else ()
    words = []
    for verdict, name in VERDICTS.items():
        ranges = sorted((row.from_hz, row.to_hz) for row in found.rows if row.at.verdict == verdict)
        words += (
            [f"{name}: {listed(ranges)}.{undecided_words(found) if verdict == 'not decided' else ''}"] if ranges else []
        )
    safe = safe_ranges(found)
    return (*words, f"Safe: {listed(safe)}." if safe else "No speed of the range is safe.")


def strip_parts(found: Any) -> list[tuple[float, str]]:
    """Starts of the parts of the strip in per cent, ascending from 0, and the worst verdict of each.

    Each part is drawn to the end of the strip, and the next one covers it: no gap between two parts shows a colour that
    neither has. A range is at least LEAST wide.
    """
    low, high = (float(hz) for hz in found.peaks.map.speed_hz[[0, -1]])
    order, spans = list(VERDICTS), list[tuple[float, float, int]]()
    for row in found.rows:
        if row.at.verdict in VERDICTS:
            left, right = (100.0 * (hz - low) / (high - low) for hz in (row.from_hz, row.to_hz))
            left = min(left, 100.0 - LEAST)
            spans.append((left, max(right, left + LEAST), order.index(row.at.verdict)))
    parts = list[tuple[float, str]]()
    for start in sorted({0.0, *(edge for left, right, _ in spans for edge in (left, right) if edge < 100.0)}):
        inside = [rank for left, right, rank in spans if left <= start < right]
        verdict = order[min(inside)] if inside else "safe"
        if not parts or parts[-1][1] != verdict:
            parts.append((start, verdict))
    return parts


def speed_strip(found: Any, speed_hz: float = 0.0) -> Markup:
    """The speed range as an HTML strip coloured by verdict, with a mark at `speed_hz` if it is inside.

    `found` is the result of `contact.interactions`; None gives an empty strip.
    """
    if found is None:
        return Markup("")
    low, high = (float(hz) for hz in found.peaks.map.speed_hz[[0, -1]])
    if not high > low:
        return Markup("")
    parts = Markup("").join(
        Markup('<i class="{}" style="left:{:.2f}%"></i>').format(verdict.replace(" ", "-"), start)
        for start, verdict in strip_parts(found)
    )
    place = 100.0 * (speed_hz - low) / (high - low)
    mark = "" if not 0.0 <= place <= 100.0 or not speed_hz else Markup(
        '<div class="here" style="{}:{:.2f}%">{}</div>'
    ).format(*(("left", place, "▼ this run") if place < 50.0 else ("right", 100.0 - place, "this run ▼")))  # fmt: skip
    kinds = [name for name in VERDICTS if any(row.at.verdict == name for row in found.rows)]
    key = Markup(" ").join(
        Markup('<span><i class="{}"></i> {}</span>').format(name.replace(" ", "-"), name) for name in [*kinds, "safe"]
    )
    return Markup(
        '<div class="speeds" role="img" aria-label="{}">{}<div class="strip">{}</div>'
        '<div class="ends"><span>{}</span><span class="key">{}</span><span>{}</span></div></div>'
    ).format(" ".join(speed_words(found)), mark, parts, with_rpm(low), key, with_rpm(high))
