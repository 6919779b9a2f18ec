"""Reason why a run left the validity of its model: the limit it passed, its growth, the energy source, theory."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from contact.base.errors import InputError
from contact.model.gaps.limits import WALL
from contact.model.gaps.permanent import ClosedContact
from contact.model.gaps.rub import Rub, rub_of
from contact.model.rotor.rotor import Rotor
from contact.model.rotor.rotor_rub import rotor_of
from contact.model.rotor.whirl import growth as growth_of_rotor
from contact.model.rotor.whirl import modes_at, sense_of
from contact.record.energy import Divergence, EnergyBudget
from contact.record.growth import RunGrowth
from contact.result import Result
from contact.scheme.protocol import Problem
from contact.stability.closed_contact import floor_of, growth
from contact.stability.split_casing import mean_contact

IN_REALITY = (
    "In a machine, wear of a coating, a blade that bends away from the rim, damping or a stop limits such a motion; "
    "nothing limits it in this scene. Add a [coating],{} or set lean_deg nearer to 0 or below 0. "
    'With on_limit = "flag" in [scene] the run continues to a tenth of the radius and ends without an error.'
)
OF_ROTOR = {"the turning rim": "the drive of the rotor", "varying loads": "the unbalance"}
SUDDEN = 500  # steps
SHORT = "The motion grew for too short a time to fit a growth rate."
CLOSED = 0.99  # of the time: contact that stays closed
AT_ONCE = "The motion passed its limit in the first steps: check clearance, units, friction and initial state."


def divergence(problem: Problem, mu: float, result: Result, limit: tuple[str, float, float]) -> Divergence:
    """State a passed limit of a run in numbers and words."""
    name, reached, allowed = limit
    time = result.steps * result.dt
    theory, closed = theory_of(problem, mu, time)
    growth = result.growth
    grows = growth is not None and growth.state == "grows"
    words = [_limit_words(name, reached, allowed)]
    if growth is not None and grows:
        words.append(growth.verdict)
    elif name in ("wall", "radius"):
        words.append(AT_ONCE if result.steps < SUDDEN else SHORT)
        words.append(f"It is mostly {growth.cause.words}." if growth is not None and growth.cause is not None else "")
    elif name == "rotor":
        words.append(_forced_words(theory))
    words += [closed, _fed_words(result.energy, OF_ROTOR if name == "rotor" else {})]
    if growth is not None:
        words += [_impact_words(growth, theory) if grows else "", growth.at_half_step]
    numerical = growth is not None and growth.numerical
    if name in ("wall", "radius") and not numerical:
        words.append(IN_REALITY.format(" reduce the friction," if mu > 0.0 else ""))
    return Divergence(
        limit=name, step=result.steps, time=time, reached=reached, allowed=allowed,
        growth=growth.rate if growth is not None and grows else math.nan, theory=theory,
        words=" ".join(filter(None, words)),
    )  # fmt: skip


def _impact_words(growth: RunGrowth, theory: float) -> str:
    """State that opening and closing contact feeds a motion which permanently closed contact does not."""
    cause = growth.cause
    if cause is None or cause.closed > CLOSED or theory > 0.0 or math.isnan(theory) or growth.numerical:
        return ""
    return f"Opening and closing of the contact supplies energy: it is closed {100.0 * cause.closed:.2g} % of the time."


def _limit_words(name: str, reached: float, allowed: float) -> str:
    if name == "wall":
        return (
            f"diverged: the rim deflected by {reached:.3g} m, expected at most {allowed:.3g} m, {WALL:g} of its wall."
        )
    if name == "radius":
        return (
            f"diverged: rim and tip moved by {reached:.3g} m, expected at most {allowed:.3g} m, a tenth of the radius."
        )
    if name == "rotor":
        return f"diverged: the rotor moved by {reached:.3g} m, expected at most {allowed:.3g} m."
    if name == "gap":
        return f"diverged: a gap changed by {reached:.3g} m, a million times what initial state and load can cause."
    if name == "energy":
        return f"diverged: contact and scheme added {reached:.3g} J of energy, expected at most {allowed:.3g} J."
    return "diverged: the motion overflowed, its energy is not a finite number."


def _forced_words(theory: float) -> str:
    """Cause of the motion of a rotor whose growth was not measured."""
    if theory > 0.0:
        return SHORT
    return "The free motion does not grow: the load drives it. Check unbalance, gravity, initial state and units."


def _fed_words(energy: EnergyBudget, named: Mapping[str, str]) -> str:
    """Sources of the energy, the largest first, empty after an overflow; `named` gives other names for some of them."""
    contact = -energy.lost_in_contact
    parts = {
        "friction": energy.friction, "the turning rim": energy.rotation, "gravity and whirl": energy.body_force,
        "varying loads": energy.external, "the contact law": contact,
    }  # fmt: skip
    given = sorted(((value, part) for part, value in parts.items() if value > 0.0), reverse=True)
    if not given or not math.isfinite(given[0][0]):
        return ""
    words = [f"{named.get(part, part)} ({value:.3g} J)" for value, part in given if value > 0.01 * given[0][0]]
    text = f"The energy came from {', '.join(words)}."
    if given[0][1] == "the contact law":
        text += (
            " Contact adds energy only if bodies overlap at the start. If none overlap, reduce dt or use the forward "
            "law."
        )
    return text


def theory_of(problem: Problem, mu: float, time: float) -> tuple[float, str]:
    """Growth [1/s] with all contacts closed at the speed of one instant (nan where unknown), and what it means."""
    if (rotor := rotor_of(problem)) is not None:
        return _of_rotor(rotor, time)
    try:
        found = _closed(problem, mu, time)
    except InputError as error:
        return math.nan, f"The stability analysis does not apply ({error})."
    if found is None:
        return math.nan, ""
    contact, hz, mean = found
    rate = float(growth(contact, np.array([hz]))[0])
    by = "With the contact always closed (mean of each mode pair)," if mean else "With the contact always closed,"
    if rate > floor_of(contact):
        return rate, f"{by} the motion grows at {hz:.4g} Hz by {rate:.3g} 1/s."
    return rate, f"{by} the motion does not grow at {hz:.4g} Hz ({rate:.3g} 1/s)."


def _of_rotor(rotor: Rotor, time: float) -> tuple[float, str]:
    """Growth [1/s] of a rotor without contact at the speed of one instant, and its whirl in words."""
    speed = rotor.speed.omega(time)
    hz = speed / (2.0 * math.pi)
    rate = float(growth_of_rotor(rotor, hz)[0])
    s, shape = modes_at(rotor, speed)
    whirl = ""
    if s.size:
        k = int(s.real.argmax())
        sense = sense_of(rotor, shape[:, k : k + 1], math.copysign(1.0, hz))[0]
        whirl = f", {sense} whirl at {s[k].imag / (2.0 * math.pi):.4g} Hz"
    grows = f"grows at {abs(hz):.4g} Hz by {rate:.3g} 1/s" if rate > 0.0 else f"does not grow at {abs(hz):.4g} Hz"
    return rate, f"Without contact, the rotor's motion {grows}{whirl if rate > 0.0 else f' ({rate:.3g} 1/s)'}."


def _closed(problem: Problem, mu: float, time: float) -> tuple[ClosedContact, float, bool] | None:
    """Bodies with all contacts closed, the speed [Hz], and whether split pairs were averaged; None without rotation."""
    rub: Rub | None = rub_of(problem)
    if rub is None:
        return None
    contact, mean = mean_contact(rub, mu=mu)
    return contact, rub.speed.omega(time) / (2.0 * math.pi), mean
