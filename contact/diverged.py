"""Why a run outgrew its model: the limit it passed, how fast it grew, who fed it, what theory says of that speed."""

from __future__ import annotations

import math

import numpy as np

from contact.base.arrays import Array
from contact.base.errors import InputError
from contact.growth.closed_contact import floor_of, growth
from contact.growth.split_casing import mean_contact
from contact.model.gaps.limits import WALL
from contact.model.gaps.permanent import ClosedContact
from contact.model.gaps.rub import Rub, rub_of
from contact.record.energy import Divergence, EnergyBudget
from contact.result import Result
from contact.scheme.protocol import Problem

PARTS, LEAST, ENOUGH = 24, 12, 6  # windows of time, samples in each, and how many must show the rise
FADED, RIPPLE = 0.05, 1.5  # of the last level, where reading begins; of the next one, what a window may exceed
IN_REALITY = (
    "In reality a coating that wears ([coating]), a blade that gives way backwards (less friction, lean_deg towards or "
    'below 0), damping or a stop ends such a motion, and none of them does here. on_limit = "flag" in [scene] runs on '
    "to a tenth of the radius and ends without an error."
)
SUDDEN, UNTOLD = 500, "How fast it grew, the samples stored do not tell."
AT_ONCE = "The numbers given move it at once: check clearance, units, friction and start."


def divergence(problem: Problem, mu: float, result: Result, limit: tuple[str, float, float]) -> Divergence:
    """Put a passed limit of a run in numbers and words."""
    name, reached, allowed = limit
    time = result.steps * result.dt
    rate, span = recent_growth(result.time, result.force.sum(axis=1))
    rate = math.nan if rate is None else rate
    theory, said = theory_of(problem, mu, time)
    words = [_limit_words(name, reached, allowed)]
    if math.isfinite(rate):
        words.append(f"It grew by {rate:.3g} 1/s over the last {span:.3g} s.")
    elif name in ("wall", "radius"):
        words.append(AT_ONCE if result.steps < SUDDEN else UNTOLD)
    words += [said, _fed_words(result.energy), IN_REALITY if name in ("wall", "radius") else ""]
    return Divergence(
        limit=name, step=result.steps, time=time, reached=reached, allowed=allowed, growth=rate, theory=theory,
        words=" ".join(filter(None, words)),
    )  # fmt: skip


def _limit_words(name: str, reached: float, allowed: float) -> str:
    if name == "wall":
        return f"diverged: the rim moved {reached:.3g} m, {WALL:g} of its wall is {allowed:.3g} m."
    if name == "radius":
        return f"diverged: rim and tip moved {reached:.3g} m, a tenth of the radius is {allowed:.3g} m."
    if name == "gap":
        return f"diverged: a gap moved {reached:.3g} m, a million times what start and load could do."
    if name == "energy":
        return f"diverged: contact and scheme have made {reached:.3g} J, at most {allowed:.3g} J was allowed."
    return "diverged: the energy is not a finite number, the motion has outgrown the arithmetic."


def _fed_words(energy: EnergyBudget) -> str:
    """Who put energy in, the largest part first."""
    contact = -energy.lost_in_contact
    parts = {
        "friction": energy.friction, "the turning rim": energy.rotation, "gravity and whirl": energy.body_force,
        "varying loads": energy.external, "the contact law": contact,
    }  # fmt: skip
    given = sorted(((value, part) for part, value in parts.items() if value > 0.0), reverse=True)
    if not given:
        return ""
    named = [f"{part} ({value:.3g} J)" for value, part in given if value > 0.01 * given[0][0]]
    text = f"Energy came from {', '.join(named)}."
    if given[0][1] == "the contact law":
        text += " Contact only pushes overlapping bodies apart: if none do, reduce dt or take the forward law."
    return text


def recent_growth(time: Array, values: Array) -> tuple[float | None, float]:
    """Growth [1/s] of the variation of `values` up to the end, and the span [s] it was read from; None: too few.

    >>> t = np.linspace(0.0, 1.0, 20001)
    >>> rate, _ = recent_growth(t, 5.0 + np.exp(8.0 * t) * np.sin(2000.0 * t))
    >>> round(rate, 1)
    8.0
    """
    first = 0
    while values.size - first >= PARTS * LEAST:
        parts = np.array_split(np.arange(first, values.size), PARTS)
        level = np.array([np.std(values[part]) for part in parts])
        begin = _rise(level)
        if PARTS - begin >= ENOUGH and level[-1] > level[begin]:
            middle = np.array([float(time[part].mean()) for part in parts])
            rate = np.polyfit(middle[begin:], np.log(level[begin:]), 1)[0]
            return float(rate), float(time[-1] - time[parts[begin][0]])
        first = int(parts[min(max(begin - 1, 1), PARTS - 2)][0])  # the rise alone, in finer windows
    return None, 0.0


def _rise(level: Array) -> int:
    """First of the last windows in which the level rises, but for ripples, and is no less than FADED of the last."""
    begin = level.size - 1
    while begin > 0 and FADED * level[-1] < level[begin - 1] < RIPPLE * level[begin]:
        begin -= 1
    return begin


def theory_of(problem: Problem, mu: float, time: float) -> tuple[float, str]:
    """Growth [1/s] of all contacts closed at the speed of an instant, nan where unknown, and what it says."""
    try:
        found = _closed(problem, mu, time)
    except InputError as error:
        return math.nan, f"Theory says nothing of it ({error})."
    if found is None:
        return math.nan, ""
    contact, hz, mean = found
    rate = float(growth(contact, np.array([hz]))[0])
    by = "By theory (its pairs' mean)" if mean else "By theory"
    if rate > floor_of(contact):
        return rate, f"{by} a contact that stays closed diverges at {hz:.4g} Hz, by {rate:.3g} 1/s."
    return rate, (
        f"{by} a contact that stays closed does not diverge at {hz:.4g} Hz ({rate:.3g} 1/s): impacts, or "
        "numerics, make it grow."
    )


def _closed(problem: Problem, mu: float, time: float) -> tuple[ClosedContact, float, bool] | None:
    """All contacts closed, the speed [Hz], whether split pairs were averaged; None of what does not turn."""
    rub: Rub | None = rub_of(problem)
    if rub is None:
        return None
    contact, mean = mean_contact(rub, mu=mu)
    return contact, rub.speed.omega(time) / (2.0 * math.pi), mean
