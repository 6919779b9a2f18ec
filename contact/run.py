"""The only time loop: `steps` yields chunks of compiled steps, `run` collects them into a Result."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Literal

import numpy as np

from contact.base.arrays import require_positive
from contact.base.checkpoint import Checkpoint
from contact.base.errors import DivergedError, InputError, NumericsError
from contact.collect import collect
from contact.half_step import MARKS, Mark, mark, states, with_half_step
from contact.io.brief import brief
from contact.io.notebook import notebook_progress
from contact.io.progress import tell
from contact.io.trust import OF_LIMITS, Flag
from contact.judged import judged, once, too_much
from contact.model.gaps.limits import RIM, TIP, passed
from contact.model.gaps.rub import rub_of
from contact.model.law import Law, Unilateral
from contact.problem import What, default_scheme, problem_of
from contact.record.energy import EnergyBudget, Stored
from contact.record.record import Record, Samples, samples, sparse
from contact.resolved import MOST_STEPS, count_of, require_steps, resolved
from contact.result import Result
from contact.resumed import Moment, asked, moment, restored
from contact.scheme.modal.rub_stepper import RubStepper
from contact.scheme.protocol import Loaded, Problem, Scheme, Stepper

CHUNK = 20_000  # steps per compiled call at most; calls end at every LEDGER-th step
WORK = 8_000_000  # steps times coordinates times contacts of a call at most: about a second, for progress and Ctrl-C
LEDGER = 20_000  # steps between looks at the energy
LONGER = 4  # times its steps, at most: how far a run that passed a limit goes on to fit its growth
ADDED = 3.0  # times all other energy since the first call: contact that adds more feeds on itself

Progress = Callable[[float], None]
OnLimit = Literal["stop", "flag"]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Scene:
    """What to run and how, as a scene file says it; every setting may be left out or overridden in `run`.

    `on_limit` "stop": a run whose rim moves beyond half its wall, or whose numbers are no solution (a flag that
    `failed`), is an error that keeps the result so far. "flag": it goes on to a tenth of the radius, and ends without
    an error; `flags` of the result say what failed. A run of more than `most_steps` steps is refused.
    """

    what: What
    law: Law | None = None
    scheme: Scheme | None = None
    t_end: float | None = None
    dt: float | None = None
    courant: float | None = None
    gravity: float = 0.0
    record: Record | None = None
    source: dict[str, str] = field(default_factory=dict)
    on_limit: OnLimit = "stop"
    most_steps: int = MOST_STEPS

    __repr__ = brief


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Chunk:
    """Samples of one compiled call, cut to what was filled; `done` is the fraction of the run."""

    samples: Samples
    steps: int
    failed: int
    done: float


def steps(
    stepper: Stepper, count: int, *, record: Record, first: int = 0, most: int | None = None
) -> Iterator[Chunk]:  # fmt: skip
    """Yield the chunks of a run of `count` steps from step `first`; ends early after a chunk whose `failed` >= 0.

    `most` steps in a chunk, where that is fewer than otherwise.
    """
    contacts, at = stepper.sums.closed.size, record.steps(dt=stepper.dt, count=count)
    work = max(1, WORK // max(1, stepper.size * contacts))
    most = min(CHUNK if most is None else min(most, CHUNK), work, record.chunk(contacts, stepper.size))
    while first < count:
        size = min(most, count - first, LEDGER - first % LEDGER)
        here = at[np.searchsorted(at, first) : np.searchsorted(at, first + size)]
        out = samples(record, size, contacts, stepper.size, here)
        stepper.sums.filled[:] = 0
        failed = stepper.advance(out, first, size)
        n, states, events = (int(value) for value in stepper.sums.filled)
        # events are copied: a view would keep the whole buffer, room for every step's
        filled = out._replace(
            time=out.time[:n], force=out.force[:n], gap=out.gap[:n], impulse=out.impulse[:n],
            state_time=out.state_time[:states], state=out.state[:states],
            event_time=out.event_time[:events].copy(), event_kind=out.event_kind[:events].copy(),
            event_contact=out.event_contact[:events].copy(),
        )  # fmt: skip
        taken = size if failed < 0 else failed - first
        first += taken
        yield Chunk(samples=filled, steps=taken, failed=failed, done=first / count)
        if failed >= 0:
            return


def run(
    what: What | Scene,
    *,
    law: Law | None = None,
    scheme: Scheme | None = None,
    t_end: float | None = None,
    dt: float | None = None,
    courant: float | None = None,
    gravity: float | None = None,
    record: Record | None = None,
    progress: Progress | None = None,
    on_limit: OnLimit | None = None,
    checkpoint: str | Path | None = None,
    most_steps: int | None = None,
) -> Result:
    """Run a scene from t = 0 to the first step at or after `t_end` [s].

    `what`: bodies on one axis (Rod, PointMass, Wall), a LinearBody, a PointGap, a RotatingRim, a BeamInCircle, a
    Patch, a Rub, a problem of one's own with a `linear_form` or a `modal_form`, or a Scene read from a file, whose own
    settings these arguments override. `scheme` defaults to
    CentralDifference for bodies (PenaltyDifference for a Penalty law) and ExactModal for what is modal; `dt` [s] or
    `courant` sets the step;
    `gravity` [m/s^2] pulls bodies towards -x; `progress` is called with the fraction done, which a notebook shows
    by itself.
    `record` defaults to every step, or to as many as make 1,000,000 samples. `on_limit` as in `Scene`.
    `checkpoint` names a file that a run of more than two seconds writes from time to time. Where it exists, the run
    goes on from there and gives the same result to the last bit, but for the seconds.

    A run of more than `most_steps` steps, 1e8 where it is left out, is refused with an estimate of the time it takes.

    Raises InputError and LimitError (also for a step that does not resolve what was asked for) before the first step,
    NumericsError (which carries the result so far) at the step that failed or where a flag of the result `failed`,
    DivergedError (one of these) at the step that passed a limit.

    >>> from contact.model.bodies.body import Rod, Wall
    >>> rod = Rod(length=10.0, area=1.0, E=900.0, rho=1.0, elements=20, x=5.0, velocity=-10.0)
    >>> result = run([rod, Wall(x=0.0)], t_end=2.0, courant=0.9)
    >>> result.steps, round(float(result.impulse[0]))
    (134, 197)
    """
    settings = what if isinstance(what, Scene) else Scene(what=what)
    settings = replace(
        settings, law=law or settings.law, scheme=scheme or settings.scheme, record=record or settings.record,
        on_limit=on_limit or settings.on_limit, t_end=settings.t_end if t_end is None else t_end,
        gravity=settings.gravity if gravity is None else gravity,
        most_steps=settings.most_steps if most_steps is None else most_steps,
    )  # fmt: skip
    if dt is not None or courant is not None:
        settings = replace(settings, dt=dt, courant=courant)
    return completed(prepared(settings), progress or notebook_progress("run", "{:.0%}".format), checkpoint)


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Prepared:
    """A run at t = 0: how many steps it takes, what it stores; `start` is its energy."""

    problem: Problem
    law: Law
    on_limit: OnLimit
    scheme: Scheme
    stepper: Stepper
    count: int
    record: Record
    source: dict[str, str]
    load_step: float
    overlap: float  # deepest at t = 0 [m]
    start: Stored
    flags: tuple[Flag, ...] = ()  # known before the first step
    marked: bool = False  # whether marks are kept, from which a part of the run can be repeated


def prepared(scene: Scene) -> Prepared:
    """Check a scene and bring it to its start; raises InputError, LimitError."""
    problem = problem_of(scene.what, scene.gravity)
    law = scene.law or Unilateral()
    scheme = scene.scheme or default_scheme(problem, law)
    if scene.t_end is None:
        raise InputError("t_end: found none, expected the end of the run in seconds")
    require_positive(t_end=scene.t_end)
    require_steps(scene.most_steps)
    if scene.dt is not None and scene.dt > 0.0:
        count_of(scene.t_end, scene.dt, scene.most_steps)
    stepper = scheme.prepare(problem, law, dt=scene.dt, courant=scene.courant)
    if scene.on_limit not in ("stop", "flag"):
        raise InputError(f"on_limit: found {scene.on_limit!r}, expected 'stop' or 'flag'")
    if scene.on_limit == "flag":
        allow_far(stepper)
    count = count_of(scene.t_end, stepper.dt, scene.most_steps, stepper.size)
    given = "" if scene.courant is None else f"courant = {scene.courant:g}"
    flags = resolved(problem, law, stepper, scene.t_end, given)
    marked = isinstance(stepper, RubStepper) and law.coating is None
    record = scene.record or sparse(count, stepper.size if rub_of(problem) is not None else 0)
    record.steps(dt=stepper.dt, count=count)  # raises before the first step, as the buffers do for channels
    return Prepared(
        problem=problem, law=law, on_limit=scene.on_limit, scheme=scheme, stepper=stepper,
        count=count, record=record, source=scene.source,
        load_step=stepper.dt**2 * (problem.load_response if isinstance(problem, Loaded) else 0.0),
        overlap=stepper.overlap, start=stepper.start,
        flags=flags, marked=marked,
    )  # fmt: skip


def allow_far(stepper: Stepper) -> None:
    """Let a rim deflect as far as a tip may move, a tenth of the radius, in place of half its wall."""
    limits = stepper.limits
    if limits is not None and math.isfinite(limits[TIP]):
        limits[RIM] = limits[TIP]


def completed(ready: Prepared, progress: Progress | None = None, checkpoint: str | Path | None = None) -> Result:
    """Run what is prepared to its end, from the start or from where a checkpoint is; raises InputError as that."""
    stepper, record = ready.stepper, ready.record
    stepper.advance(samples(record, 0, stepper.sums.closed.size, stepper.size), 0, 0)  # compiles, takes no step
    decisive = ready.problem, record, ready.law.mu, ready.law.coating is not None, ready.on_limit, ready.count
    digest = "" if checkpoint is None else asked(stepper, *decisive)
    file = None if checkpoint is None else Checkpoint(checkpoint, digest, Moment)
    at = (file and file.found) or Moment(asked=digest, taken=0, seconds=0.0, memory=(), samples=(), calm=None)
    if at.taken:
        restored(stepper, at)
    marks = list(at.marks)
    most = max(1, ready.count // MARKS) if ready.marked else CHUNK
    began, parts, taken, failed = time.perf_counter() - at.seconds, list(at.samples), at.taken, -1
    calm = at.calm  # of the first call, which may begin with bodies that overlap
    progress = progress or partial(tell, "a run")
    progress(taken / ready.count)
    for chunk in steps(stepper, ready.count, record=record, first=taken, most=most):
        parts.append(chunk.samples)
        taken, failed = taken + chunk.steps, chunk.failed
        if ready.marked and isinstance(stepper, RubStepper) and failed < 0 and taken < ready.count:
            marks.append(mark(stepper, taken))
        progress(chunk.done)
        if failed < 0 and taken % LEDGER == 0:
            now = budget_of(ready)
            if runs_away(ready, now, calm or now):
                break
            calm = calm or now
        if file is not None and failed < 0:
            here = partial(moment, stepper, digest, parts, taken, time.perf_counter() - began, calm, marks)
            file.keep(here)
    return finished(ready, parts, taken, time.perf_counter() - began, failed, calm, marks)


def budget_of(ready: Prepared) -> EnergyBudget:
    """Energies up to now."""
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
    """Whether the energy is no number any more, or contact has added more than all else since `calm`.

    A coating may: a rim that turns presses other bars against the tip, and its drive's work is booked as the contact's.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        since = now.since(calm)
    added = -since.lost_in_contact > ADDED * since.others
    return not math.isfinite(now.unaccounted) or (added and ready.law.coating is None)


def finished(
    ready: Prepared, parts: Sequence[Samples], taken: int, seconds: float, failed: int = -1,
    calm: EnergyBudget | None = None, marks: Sequence[Mark] | None = None,
) -> Result:  # fmt: skip
    """Result of a run after `taken` steps; raises NumericsError, which carries it, where step `failed` >= 0 failed.

    `calm`: energies early on, from where contact may not add any. `marks` of the run, from which its last stretch is
    repeated at half the step where it grows; None: it is not.
    """
    stepper, energy = ready.stepper, budget_of(ready)
    limit = None if failed < 0 else passed(stepper.limits)
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
        asked = ready.on_limit == "flag" and limit[0] in ("wall", "radius")
        flags, kind = (*flags, Flag(result.divergence.words, OF_LIMITS[limit[0]], failed=not asked)), DivergedError
    else:
        result = with_growth(ready, result, marks)
        flags = (*flags, stepper.why()) if failed >= 0 else flags
    flags = (*flags, *(() if result.growth is None else result.growth.flags))
    result = replace(result, notes=replace(result.notes, flags=once(flags)))
    failures = [flag for flag in result.flags if flag.failed]
    if not failures or (ready.on_limit == "flag" and failed < 0 and (limit is None or limit[0] != "overflow")):
        return result
    error = kind((place if limit is not None or failed >= 0 else "") + failures[-1])
    error.result = result
    raise error


def with_growth(
    ready: Prepared, result: Result, marks: Sequence[Mark] | None, limit: tuple[str, float, float] | None = None
) -> Result:
    """The result of a rim, a rub or a disk with the growth of its motion, checked at half the step where it grows.

    Where `marks` are given, a run that passed a limit before its growth can be fitted is repeated with denser states.
    It goes on to a tenth of the radius, for LONGER times its steps at most. A motion that reaches this grows.
    """
    from contact.growth.of_run import of_run

    with np.errstate(all="ignore"):
        growth, far = of_run(ready.problem, result), limit is not None and limit[0] == "radius"
        early = limit is not None and limit[0] in ("wall", "radius") and marks is not None
        if early and rub_of(ready.problem) is not None and (growth is None or growth.state != "grows"):
            again = ready.scheme.prepare(ready.problem, ready.law, dt=result.dt, courant=None)
            allow_far(again)
            time, state = states(again, 0, min(LONGER * result.steps, ready.count))
            more = replace(result, state_time=time, state=state, channels=result.channels[:0])
            growth, far = of_run(ready.problem, more) or growth, passed(again.limits) is not None
    if growth is None:
        return result
    if far and growth.state == "undecided" and growth.rate > 0.0:
        growth = replace(growth, state="grows")
    if limit is not None and limit[0] == "wall":
        growth = replace(growth, time_to_half_wall=result.steps * result.dt)
    if growth.state == "grows" and ready.marked and marks is not None:
        growth = with_half_step(
            ready.problem, ready.law, ready.scheme, result.dt, result.steps, marks, growth, ready.count
        )
    return replace(result, growth=growth)


def _finite(part: Samples) -> Samples:
    """Samples up to the first that is not a number."""
    bad = np.flatnonzero(~np.isfinite(part.force + part.gap).all(axis=1))
    if not bad.size:
        return part
    n = int(bad[0])
    states = int(np.searchsorted(part.state_time, part.time[n]))
    return part._replace(
        time=part.time[:n], force=part.force[:n], gap=part.gap[:n], impulse=part.impulse[:n],
        state_time=part.state_time[:states], state=part.state[:states],
    )  # fmt: skip
