"""End of a run: energies, limits and flags, growth; the result, or an error that contains it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from contact.base.errors import DivergedError, NumericsError
from contact.collect import collect
from contact.half_step import Mark, states, with_half_step, with_limit_at_half_step
from contact.io.trust import OF_LIMITS, Flag
from contact.judged import judged, once, too_much
from contact.model.gaps.limits import passed
from contact.model.gaps.rub import rub_of
from contact.model.rotor.rotor import Rotor
from contact.on_rotor import rotor_orbit
from contact.prepared import Prepared, allow_far
from contact.record.energy import EnergyBudget
from contact.record.record import Samples
from contact.result import Result, coordinates_and_forces

LONGER = 4  # times its steps, at most: length to which a run that passed a limit continues to fit its growth
ADDED = 3.0  # times all other energy since the first call: contact that adds more feeds on itself


def budget_of(ready: Prepared) -> EnergyBudget:
    """Energies up to the current step."""
    sums = ready.stepper.sums
    with np.errstate(over="ignore", invalid="ignore"):  # a run that overflowed is read too
        return EnergyBudget(
            start=ready.start, end=ready.stepper.stored(), contact=float(np.sum(sums.work)),
            rotation=float(np.sum(sums.rotation)),
            friction=float(np.sum(sums.friction)), damping=float(sums.damping[0]),
            external=float(sums.external[0]), body_force=float(sums.body_force[0]),
            algorithmic=float(sums.algorithmic[0]), load_step=ready.load_step,
            overlap=ready.overlap * float(np.sum(sums.peak)),
        )  # fmt: skip


def runs_away(ready: Prepared, now: EnergyBudget, calm: EnergyBudget) -> bool:
    """Whether the energy is not a number, or contact has added more energy than all other sources since `calm`.

    With a coating this is no fault: the rotating rim presses further bars against the tip, and the work of its drive
    counts as that of the contact.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        since = now.since(calm)
    added = -since.lost_in_contact > ADDED * since.others
    return not math.isfinite(now.unaccounted) or (added and ready.law.coating is None)


def finished(
    ready: Prepared, parts: Sequence[Samples], taken: int, seconds: float, failed: int = -1,
    calm: EnergyBudget | None = None, marks: Sequence[Mark] | None = None,
) -> Result:  # fmt: skip
    """Result of a run after `taken` steps. Raises NumericsError with the result if step `failed` >= 0 failed.

    `calm`: energies early in the run, after which contact may not add energy. `marks`: states from which the last part
    of a growing run is repeated at half the step; None: it is not repeated.
    """
    stepper, energy = ready.stepper, budget_of(ready)
    limit = None if failed < 0 else _passed(ready)
    if not math.isfinite(energy.unaccounted):
        limit = limit or ("overflow", math.nan, math.nan)
        parts = [_finite(part) for part in parts]
    elif failed < 0 and calm is not None and runs_away(ready, energy, calm):
        since = energy.since(calm)
        limit = "energy", -since.lost_in_contact, ADDED * since.others
    with np.errstate(over="ignore", invalid="ignore"):
        result = collect(stepper, parts, energy, taken, seconds, ready.source, ready.record)
        checked = () if limit is None and failed >= 0 else judged(ready.problem, ready.law, result)
        flags = (*ready.flags, *result.flags, *checked)
        made = too_much(ready.law, result)
    if limit is None and failed < 0 and made is not None:
        limit = "energy", *made
    at = failed if failed >= 0 else taken - 1
    place, kind = f"step {at} (t = {at * stepper.dt:.6g} s): ", NumericsError
    if limit is not None:
        from contact.diverged import divergence

        result = with_growth(ready, result, marks, limit)
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            result = replace(result, divergence=divergence(ready.problem, ready.law.mu, result, limit))
        assert result.divergence is not None
        asked = ready.on_limit == "flag" and limit[0] in ("wall", "radius", "rotor")
        flags, kind = (*flags, Flag(result.divergence.words, OF_LIMITS[limit[0]], failed=not asked)), DivergedError
    else:
        result = with_growth(ready, result, marks)
        flags = (*flags, stepper.why()) if failed >= 0 else flags
    flags = (*flags, *(() if result.growth is None else result.growth.flags))
    seen = result.notes.orbit or rotor_orbit(ready.problem, result)
    result = replace(result, notes=replace(result.notes, flags=once(flags), orbit=seen))
    failures = [flag for flag in result.flags if flag.failed]
    if not failures or (ready.on_limit == "flag" and failed < 0 and (limit is None or limit[0] != "overflow")):
        return result
    error = kind((place if limit is not None or failed >= 0 else "") + failures[-1])
    error.result = result
    raise error


def _passed(ready: Prepared) -> tuple[str, float, float] | None:
    """The limit that a run passed and the name of the motion; None within all limits."""
    found = passed(ready.stepper.limits)
    return ("rotor", *found[1:]) if found is not None and isinstance(ready.problem, Rotor) else found


def with_growth(
    ready: Prepared, result: Result, marks: Sequence[Mark] | None, limit: tuple[str, float, float] | None = None
) -> Result:
    """The result of a rim, rub or disk with the growth of its motion; where it grows, checked at half the step.

    Where `marks` are given, a run that passed a limit before its growth can be fitted is repeated with denser states.
    The repeated run continues until the motion reaches a tenth of the radius, for at most LONGER times the steps. A
    motion that reaches this limit grows.
    """
    from contact.stability.of_run import of_rotor_run, of_run

    if limit is not None and limit[0] == "rotor":
        assert isinstance(ready.problem, Rotor)
        found = of_rotor_run(ready.problem, result)
        return result if found is None or found.state != "grows" else replace(result, growth=found)
    with np.errstate(all="ignore"):
        growth, far = of_run(ready.problem, result), limit is not None and limit[0] == "radius"
        early = limit is not None and limit[0] in ("wall", "radius") and marks is not None
        if early and rub_of(ready.problem) is not None and (growth is None or growth.state != "grows"):
            again = ready.scheme.prepare(ready.problem, ready.law, dt=result.dt, courant=None)
            allow_far(again)
            time, state = states(again, 0, min(LONGER * result.steps, ready.count))
            stored = coordinates_and_forces(state, again.blocks, whole=True)
            more = replace(result, state_time=time, channels=result.channels[:0], **stored)
            growth, far = of_run(ready.problem, more) or growth, passed(again.limits) is not None
    if growth is None:
        return result
    if far and growth.state == "undecided" and growth.rate > 0.0:
        growth = replace(growth, state="grows")
    if limit is not None and limit[0] == "wall":
        growth = replace(growth, time_to_half_wall=result.steps * result.dt)
    if not ready.marked or marks is None:
        return replace(result, growth=growth)
    stopped = limit is not None and limit[0] in ("wall", "radius")
    same = ready.problem, ready.law, ready.scheme, result.dt, result.steps
    if growth.state == "grows":
        growth = with_half_step(*same, marks, growth, ready.count, stopped=stopped)
    elif stopped:
        growth = with_limit_at_half_step(*same, growth, ready.count)
    return replace(result, growth=growth)


def _finite(part: Samples) -> Samples:
    """Samples before the first non-finite one."""
    bad = np.flatnonzero(~np.isfinite(part.force + part.gap).all(axis=1))
    if not bad.size:
        return part
    n = int(bad[0])
    states = int(np.searchsorted(part.state_time, part.time[n]))
    return part._replace(
        time=part.time[:n], force=part.force[:n], gap=part.gap[:n], impulse=part.impulse[:n],
        state_time=part.state_time[:states], state=part.state[:states],
    )  # fmt: skip
