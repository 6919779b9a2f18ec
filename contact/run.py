"""The only time loop: `steps` yields chunks of compiled steps, `run` collects them into a Result."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from contact.base.checkpoint import Checkpoint
from contact.ended import budget_of, finished, runs_away
from contact.half_step import MARKS, mark
from contact.io.notebook import notebook_progress
from contact.io.progress import tell
from contact.io.threads import with_one_thread
from contact.model.law import Law
from contact.prepared import OnLimit, Prepared, Scene, prepared
from contact.problem import What
from contact.record.record import Record, Samples, samples
from contact.result import Result
from contact.resumed import Moment, asked, moment, restored
from contact.scheme.modal.rub_stepper import RubStepper
from contact.scheme.protocol import Scheme, Stepper

CHUNK = 20_000  # steps per compiled call at most; calls end at every LEDGER-th step
WORK = 100_000_000  # steps times coordinates times contacts of a call at most: about a second, for progress and Ctrl-C
LEDGER = 20_000  # steps between two checks of the energy

Progress = Callable[[float], None]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Chunk:
    """Samples of one compiled call, cut to the filled part; `done` is the finished fraction of the run."""

    samples: Samples
    steps: int
    failed: int
    done: float


def steps(
    stepper: Stepper, count: int, *, record: Record, first: int = 0, most: int | None = None
) -> Iterator[Chunk]:  # fmt: skip
    """Yield the chunks of a run of `count` steps from step `first`; ends early after a chunk with `failed` >= 0.

    `most` limits the steps of a chunk.
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


@with_one_thread
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

    `what`: bodies on one axis (Rod, PointMass, Wall), a LinearBody, a PointGap, a RotatingRim, a BeamInCircle, a Patch,
    a Rub, a problem of your own with a `linear_form` or a `modal_form`, or a Scene read from a file, whose own settings
    these arguments override. `scheme` defaults to CentralDifference for bodies (PenaltyDifference for a Penalty law)
    and ExactModal for modal problems; `dt` [s] or `courant` sets the step; `gravity` [m/s^2] pulls bodies towards -x;
    `progress` is called with the finished fraction; notebooks show it by default. `record` defaults to every step, or
    to as many as make 1,000,000 samples. `on_limit` as in `Scene`. `checkpoint` names a file that a run of more than
    two seconds writes from time to time. If it exists, the run continues from it; the result is identical except for
    the elapsed seconds.

    A run of more than `most_steps` steps, 1e8 by default, is refused with an estimate of its time.

    Raises InputError and LimitError (also for a step that does not resolve what was asked for) before the first step,
    NumericsError (with the result so far) at the step that failed, or for a flag with `failed`,
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


def completed(
    ready: Prepared, progress: Progress | None = None, checkpoint: str | Path | None = None,
    longer: Callable[[Result], int] | None = None,
) -> Result:  # fmt: skip
    """Run a prepared run to its end, from the start or a checkpoint; raises InputError for a wrong checkpoint.

    `longer` is called with the result at the end. If it returns a larger number of steps, the run goes on to these.
    """
    stepper, record = ready.stepper, ready.record
    stepper.advance(samples(record, 0, stepper.sums.closed.size, stepper.size), 0, 0)  # compiles, takes no step
    decisive = ready.problem, record, ready.law.mu, ready.law.coating is not None, ready.on_limit, ready.count
    digest = "" if checkpoint is None else asked(stepper, *decisive)
    file = None if checkpoint is None else Checkpoint(checkpoint, digest, Moment)
    at = (file and file.found) or Moment(asked=digest, taken=0, seconds=0.0, memory=(), samples=(), calm=None)
    if at.taken:
        restored(stepper, at)
    marks = list(at.marks)
    began, parts, taken = time.perf_counter() - at.seconds, list(at.samples), at.taken
    calm = at.calm  # of the first call, which may begin with bodies that overlap
    progress = progress or partial(tell, "a run")
    while True:
        failed, most = -1, max(1, ready.count // MARKS) if ready.marked else CHUNK
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
        result = finished(ready, parts, taken, time.perf_counter() - began, failed, calm, marks)
        count = 0 if longer is None else longer(result)
        if failed >= 0 or count <= taken:
            return result
        ready = replace(ready, count=count)
