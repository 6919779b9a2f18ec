"""The page on a scene: verdict, film, pictures, dangerous speeds, numbers, the scene itself."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from casingfem.plot.history import time_unit
from casingfem.plot.page import Cell, Page, Picture, Section, Table, Verdict, capital, origin, written
from casingfem.plot.pages.interactions import speeds_section
from casingfem.plot.pages.speeds import force_size, short, speed_strip, speed_words, with_rpm
from contact.io.columns import Columns
from contact.io.decision import decision

SLIDES = 1.0  # per cent of the time: below it a contact only just touches
ROUND_OFF = 1e-12, 1e-9  # violation of the law of contact [m] and part of the energy that rounding explains
CAPTIONS = {
    "run": "Force averaged over the model's shortest period, gap, and motion; bands span the lowest and highest value "
    "of each stretch of time. Right: close-up of the yellow stretch, about the largest force.",
    "rotor": "Left: speed of the rotor, distance of disk and casing from their places, forces of all bearings on the "
    "rotor and of all mounts on the casing, at the stored states. Right: orbits of disk and casing.",
    "angle": "Largest contact force over the place on the casing and time; each row is a whole number of turns.",
    "spectrum": "Spectrum of the contact force.",
    "spectrum_tip": "Top: spectrum of the tip's motion along the contact's normal. Bottom: spectrogram.",
    "waves": "Full spectrum: waves of the rim by nodal diameter and frequency in the second half of the run. Right: "
    "their amplitude in both directions.",
    "orbit": "Orbits of the first tip and of the rim under it in the plane of the contact.",
    "section": "Poincaré section: the first tip once a revolution in the second half of the run. A motion with a "
    "period of k revolutions gives k points, a chaotic motion a cloud of points.",
    "energy": "Energy into the bodies by source.",
}
OF_RUBS = {
    "spectrum": " Lines mark the frequencies of blade and casing alone; numbers above them are the nodal diameters n "
    "of the casing's modes.",
    "energy": " Bottom: strain energy of each body over time.",
}
OF_RODS = {"spectrum": " Bottom: spectrogram."}


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Ran:
    """Numbers of a run, all contacts together, in SI units.

    `window` [s] is the model's shortest period; `growth` a `contact.record.growth.RunGrowth`, `rim` a
    `contact.recovery.around_rim.RimMotion`, `rotor` a `contact.on_rotor.RotorHistory`, `tracks` the wear of coatings,
    each None or empty if a run has none; `speed_hz` is 0 if the speed varies or nothing rotates.
    """

    rubs: bool
    steps: int
    dt: float
    span: float
    window: float
    contacts: Sequence[Mapping[str, Any]]
    contact_columns: Columns
    force: float
    impulse: float
    closed: float
    closings: int
    least_gap: float
    residual: float
    unaccounted: float
    flags: tuple[Any, ...]
    divergence: Any
    growth: Any
    rim: Any
    speed_hz: float
    tracks: tuple[Any, ...]
    scheme: str
    seconds: float
    rotor: Any = None


def motion_pictures(figures: Mapping[str, Figure], *, rubs: bool) -> list[Picture]:
    """The figures of a run in the order of a page, with their captions."""
    more = OF_RUBS if rubs else OF_RODS
    return [Picture.of(figures[key], CAPTIONS[key] + more.get(key, "")) for key in CAPTIONS if key in figures]


def scene_page(
    name: str, scene: str, ran: Ran, motion: Sequence[Picture], *, speeds: Mapping[str, Figure] | None = None,
    found: Any = None, why: str = "", lead: str = "", source: Mapping[str, Any],
) -> Page:  # fmt: skip
    """The page; `motion` are the pictures of the run, `speeds` figures over speed.

    `found` is the result of `contact.interactions`, or `why` the reason if there is none; `lead` is a sentence on the
    scene below the title.
    """
    sections = []
    if ran.rubs:
        words = speed_words(None, why) if found is None else (found.words,)
        sections.append(speeds_section(found, speeds or {}, words))
    sections.append(Section("Motion", figures=tuple(motion)))
    sections.append(Section("Numbers", tuple(map(str, ran.flags)), tables=(*contacts_tables(ran), numbers_table(ran))))
    sections.append(Section("The scene", preformatted=scene))
    notice = str(ran.flags[0]) if ran.flags else ""
    verdict = scene_verdict(ran, found)
    return Page(
        title=f"Scene {name}", sections=sections, lead=lead, notice=notice, verdict=verdict, source=origin(source)
    )  # fmt: skip


def scene_verdict(ran: Ran, found: Any = None) -> Verdict:
    """Summary of a run: outcome, force, deflection, motion, speeds and wear, confidence, next steps."""
    own = None if found is None else own_run(ran, found.runs)
    state, sentence = outcome(ran, own)
    facts = [("Force", force_words(ran))] if ran.contacts else []
    if ran.rim is not None:
        facts.append(("Deflection", deflection_words(ran)))
    if ran.rotor is not None and ran.contacts:
        facts.append(("Rotor", capital(rotor_words(ran.rotor))))
    if ran.growth is not None:
        facts.append(("Motion", ran.growth.words))
    if found is not None:
        facts.append(("Ranges", " ".join(speed_words(found))))
    facts += [("Wear", wear_words(ran))] if ran.tracks else []
    return Verdict(
        found=sentence, sure=sure_words(ran), further=further_words(ran, own), facts=tuple(facts), state=state,
        strips=(("Speeds", speed_strip(found, ran.speed_hz)),),
    )  # fmt: skip


def own_run(ran: Ran, runs: Sequence[Any]) -> Any:
    """The run at the scene's speed in the table of dangerous speeds, if it says otherwise than this run.

    A longer run that does not decide, or one that hides the growth of closed contact, questions a calm motion only.
    """
    own = next((run for run in runs if math.isclose(run.speed_hz, ran.speed_hz, rel_tol=1e-9)), None)
    if own is None or not ran.closings:
        return None
    motion = None if ran.growth is None else ran.growth.outcome
    grows = decision(motion, passed=ran.divergence is not None)
    if own.verdict == "not decided":
        return own if grows is False else None
    return own if (own.verdict == "unstable") != grows else None


def outcome(ran: Ran, own: Any = None) -> tuple[str, str]:
    """The state (good, bad or open), and the first sentence; `own` is a run at constant speed that says otherwise."""
    at = f" at {with_rpm(ran.speed_hz)}" if ran.speed_hz else ""
    motion = None if ran.growth is None else ran.growth.outcome
    grows = decision(motion, passed=ran.divergence is not None)
    if any(flag.failed for flag in ran.flags):
        return "bad", f"Not usable{at}: the numbers are no solution of the model."
    if motion == "numerical":
        return "open", f"Not decided{at}: the growth of the motion is an effect of the time step."
    if ran.divergence is not None:
        return "bad", f"Unsafe{at}: the motion passed a limit of the model after {ran.divergence.time:.4g} s."
    if ran.rim is not None and ran.rim.largest > ran.rim.allowed:
        return "bad", f"Outside the linear model{at}: the rim deflects by more than half of its wall."
    if own is not None:
        return constant_speed_words(own, at, grows=bool(grows))
    if grows:
        return "bad", f"Unsafe{at}: the motion grows."
    if not ran.contacts:
        return "", f"The scene has no contact{at}: {rotor_words(ran.rotor)}" if ran.rotor else f"No contact{at}."
    if not ran.closings:
        return "good", f"Nothing touches{at}: the least gap is {1e3 * ran.least_gap:.4g} mm."
    if grows is None:
        return "open", f"Not decided{at}: the run is too short to decide whether the motion grows."
    if motion is not None:
        how = {"decays": " and the motion decays", "at rest": " and nothing moves"}.get(motion, "")
        return "good", f"Bounded{at}: {touch_words(ran)}{how}."
    share = 100.0 * ran.closed / ran.span if ran.span else 0.0
    return "", (
        f"The contact closes {times(ran.closings)}, for {share:.3g} % of {duration(ran.span)}, with "
        f"{force_size(ran.force)} at most."
    )


def constant_speed_words(own: Any, at: str, *, grows: bool) -> tuple[str, str]:
    """State and first sentence where a run at constant speed decides otherwise than this run, which may be shorter."""
    length = f"in a run of {duration(own.seconds)} at this constant speed"
    if own.verdict == "not decided":
        return "open", f"Not decided{at} {length}: {own.why}."
    if own.slow:
        return "bad", f"Unsafe{at}: {own.why}."
    if own.verdict == "unstable":
        return "bad", f"Unsafe{at}: the motion grows {length}."
    state = "good" if own.verdict == "safe" else "open"
    if grows:
        return "open", f"The motion grows in this run{at}. It does not grow {length}: {own.verdict}."
    return state, f"{capital(own.verdict)}{at}: the motion does not grow {length}. This run is too short to decide."


def duration(time: float) -> str:
    """A time with a suitable unit.

    >>> duration(0.4), duration(2.5019e-4)
    ('0.4 s', '0.2502 ms')
    """
    scale, unit = time_unit(time)
    return f"{scale * time:.4g} {unit}"


def touch_words(ran: Ran) -> str:
    """Sentence on the contact that is closed longest."""
    share = 100.0 * ran.closed / ran.span if ran.span else 0.0
    return "the contact just touches" if share < SLIDES else f"the contact is closed {share:.3g} % of the time"


def counted(number: int, name: str) -> str:
    """A number with its noun, in singular or plural.

    >>> counted(1, "interval"), counted(1200, "interval")
    ('1 interval', '1,200 intervals')
    """
    return f"{number:,} {name}{'s' * (number != 1)}"


def times(number: int) -> str:
    """A count in words: once, twice, n times.

    >>> times(1), times(1200)
    ('once', '1,200 times')
    """
    return "once" if number == 1 else f"{number:,} times"


def force_words(ran: Ran) -> str:
    """Largest force with its averaging time, and the impulse."""
    if not ran.closings:
        return "None."
    several = f" over {len(ran.contacts)} contacts" if len(ran.contacts) > 1 else ""
    return (
        f"At most {force_size(ran.force)}, averaged over {1e3 * ran.window:.3g} ms (the model's shortest period); "
        f"impulse {ran.impulse:.4g} N s{several}."
    )


def deflection_words(ran: Ran) -> str:
    """Largest deflection of the rim compared with the limit of the linear model."""
    words = f"The rim moves {1e3 * ran.rim.largest:.3g} mm at most"
    if not math.isfinite(ran.rim.wall):
        return f"{words}. The limit is not known: give the wall thickness in [casing]."
    part, limit = 100.0 * ran.rim.largest / ran.rim.wall, 1e3 * ran.rim.allowed
    return f"{words}, {part:.2g} % of its wall. The limit is {limit:.3g} mm (50 %): above it, the linear model fails."


def rotor_words(rotor: Any) -> str:
    """Largest motion of the disk, and largest forces of bearings and mounts."""
    words = f"the disk moves {1e3 * length(rotor.disk):.3g} mm at most"
    held = {"bearings": rotor.bearings, "mounts": rotor.mounts}
    forces = [f"{force_size(length(force))} in the {name}" for name, force in held.items() if force is not None]
    return f"{words}{'; the largest forces are ' if forces else ''}{' and '.join(forces)}."


def length(vectors: Any) -> float:
    """Length of the longest of the vectors (ns, 2)."""
    return float(np.hypot(*vectors.T).max())


def wear_words(ran: Ran) -> str:
    """Depth and volume of the coatings' wear."""
    deepest = max(float(track.worn.max(initial=0.0)) for track in ran.tracks)
    volume = sum(float(track.volume) for track in ran.tracks)
    bare = sum(int(track.bare) for track in ran.tracks)
    through = f" The coating is worn through in {counted(bare, 'place')}." if bare else ""
    return f"At most {1e6 * deepest:.3g} µm deep, {short(1e9 * volume)} mm³ in all.{through}"


def sure_words(ran: Ran) -> str:
    """Results of the run's own checks, and effects that the checks do not cover."""
    failed = [flag for flag in ran.flags if flag.failed]
    if failed:
        return str(failed[-1])
    if ran.residual < ROUND_OFF[0] and ran.unaccounted < ROUND_OFF[1]:
        words = "The law of contact and the balance of energy are satisfied to rounding."
    else:
        words = (
            f"The law of contact is violated by {written(ran.residual, 1)} m at most; "
            f"{written(100.0 * ran.unaccounted, 1)} % of the energy is unaccounted for."
        )
    checked = None if ran.growth is None else ran.growth.converged
    left = "The number of modes was" if checked else "The time step and the number of modes were"
    return f"{words} {left} not checked."


def further_words(ran: Ran, own: Any = None) -> str:
    """Recommended next steps; `own` is a run at constant speed that says otherwise than this run."""
    if any(flag.failed for flag in ran.flags):
        return "Correct what the message names, then run the scene again."
    motion = None if ran.growth is None else ran.growth.outcome
    if motion == "numerical" or (own is not None and own.check == "numerical"):
        return "Reduce dt, then run the scene again."
    if own is not None and own.verdict != "unstable":
        return "Lengthen t_end, to see how the motion ends."
    if own is not None or decision(motion, passed=ran.divergence is not None):
        return "Leave the unsafe speeds, add damping or reduce friction; then run the scene again."
    if ran.flags:
        return "Read the warnings above: beyond their limits the model does not describe the machine."
    if motion == "undecided":
        return "Lengthen t_end."
    if not ran.contacts:
        return (
            "`casingfem campbell` lists the critical speeds. A casing with its clearance shows whether the rotor rubs."
        )
    return "Halve dt and add modes, and compare the impulse: `casingfem sweep` does both."


def contacts_tables(ran: Ran) -> tuple[Table, ...]:
    """One row for each contact; no table without contacts."""
    if not ran.contacts:
        return ()
    caption = "Contacts, summed over the run. The peak force depends on the time step."
    return (Table.of(caption, ran.contact_columns, ran.contacts, folded=len(ran.contacts) > 12),)


def numbers_table(ran: Ran) -> Table:
    """Table of the settings of the run and its checks."""
    rows: tuple[tuple[Cell, ...], ...] = (
        ("speed", with_rpm(ran.speed_hz) if ran.speed_hz else None),
        ("time simulated [s]", float(f"{ran.span:.6g}")),
        ("time step [s]", float(f"{ran.dt:.4g}")),
        ("steps", f"{ran.steps:,}"),
        ("scheme", ran.scheme),
        ("violation of the contact law [m]", float(f"{ran.residual:.2g}")),
        ("energy unaccounted for, part of the largest", float(f"{ran.unaccounted:.2g}")),
        ("time of the run [s]", float(f"{ran.seconds:.3g}")),
        *growth_rows(ran.growth),
    )
    return Table("The run.", ("quantity", "value"), tuple(row for row in rows if row[1] is not None))


def growth_rows(growth: Any) -> tuple[tuple[Cell, ...], ...]:
    """Growth with its interval, deflection at the end, time to half the wall; nan values are omitted."""
    if growth is None:
        return ()
    named = {
        "growth [1/s]": growth.rate, "growth, lower end of 95 % [1/s]": growth.low,
        "growth, upper end of 95 % [1/s]": growth.high, "rim deflection in the last stretch [m]": growth.amplitude,
        "half the wall reached at [s]": growth.time_to_half_wall, "growth at half the step [1/s]": growth.half_step,
    }  # fmt: skip
    return tuple((name, float(f"{value:.3g}")) for name, value in named.items() if math.isfinite(value))
