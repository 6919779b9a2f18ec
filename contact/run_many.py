"""Many runs at once: rotating rims of one size share eight slots of one compiled loop; other problems run singly."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import cast

from contact.base.errors import DivergedError, InputError, NumericsError
from contact.ended import budget_of, finished, runs_away
from contact.half_step import MARKS, Mark, mark
from contact.io.threads import with_one_thread
from contact.prepared import Prepared, Scene, prepared
from contact.record.energy import EnergyBudget
from contact.record.record import Record, Samples
from contact.result import Result
from contact.run import LEDGER, completed
from contact.scheme.modal.batch import WIDTH, Events, Job, Shape, batch, shape_of
from contact.scheme.modal.rub_stepper import RubStepper

Outcome = Result | InputError | NumericsError
Ended = Callable[[int, Outcome], None]
Longer = Callable[[int, Outcome], int]
MOST_BYTES = 200_000_000  # what the slots of one group may store; longer records run singly


@with_one_thread
def run_many(
    scenes: Sequence[Scene], *, record: Callable[[int], Record] | None = None, ended: Ended | None = None,
    longer: Longer | None = None,
) -> list[Outcome]:  # fmt: skip
    """Run scenes, with the results of `run` up to round-off; failures are returned, not raised.

    Rotating rims with one contact (`RotatingRim`, no coating) run eight at a time in one compiled loop, runs with
    arrays of equal shapes together: speed, clearance, friction, lean, blade, casing, step and length may differ. A
    run's numbers do not depend on which others are given, nor on their order. `record` gives the default record for a
    number of steps; `ended` is called with index and outcome of each run as it ends. Before that, `longer` is called
    with both: a run goes on to the number of steps that it returns. It continues from its last state; one of the eight
    in a loop is repeated from its start.

    >>> from contact.model.bodies.body import Rod, Wall
    >>> rod = Rod(length=10.0, area=1.0, E=900.0, rho=1.0, elements=20, x=5.0, velocity=-10.0)
    >>> good = Scene(what=[rod, Wall()], t_end=2.0, courant=0.9)
    >>> first, second = run_many([good, Scene(what=[rod, Wall()], courant=0.9)])
    >>> first.steps, str(second)
    (134, 't_end: found none, expected the end of the run in seconds')
    """
    found: list[Outcome | None] = [None] * len(scenes)
    groups: dict[Shape, list[tuple[int, Prepared]]] = {}

    def alone(i: int, ready: Prepared) -> None:
        outcome = _alone(ready, None if longer is None else partial(_to_steps, scenes[i], partial(longer, i)))
        found[i] = _note(i, outcome, ended)

    def begin(i: int, count: int | None = None) -> None:
        try:
            ready = _prepared(scenes[i], record, count)
        except InputError as error:
            if longer is not None:
                longer(i, error)
            found[i] = _note(i, error, ended)
            return
        if (shape := _fits(ready)) is not None:
            groups.setdefault(shape, []).append((i, ready))
        else:
            alone(i, ready)

    for i in range(len(scenes)):
        begin(i)
    while groups:
        _, group = groups.popitem()
        again: dict[int, int] = {}
        for i, outcome in together(group):
            if outcome is None:  # a failed run is repeated singly: its result is then complete up to that step
                alone(i, _prepared(scenes[i], record))
            elif longer is not None and (count := _to_steps(scenes[i], partial(longer, i), outcome)):
                again[i] = count
            else:
                found[i] = _note(i, outcome, ended)
        for i, count in again.items():
            begin(i, count)
    return [outcome for outcome in found if outcome is not None]


def _to_steps(scene: Scene, longer: Callable[[Outcome], int], outcome: Outcome) -> int:
    """Number of steps to which a run goes on; 0 if it ends, or would have more steps than its scene allows."""
    count = longer(outcome)
    return count if count <= scene.most_steps else 0


def first_step(scene: Scene, record: Callable[[int], Record]) -> None:
    """Take one step as `run_many` would, so that its code is loaded or compiled now.

    Raises InputError for an invalid scene.
    """
    ready = replace(_prepared(scene, record), count=1)
    if _fits(ready) is not None:
        list(together([(0, ready)]))
    else:
        _alone(ready)


def runs_alone(scene: Scene, record: Callable[[int], Record]) -> bool:
    """Whether a scene runs by itself, and not with others in one loop; False if it is invalid."""
    try:
        return _fits(_prepared(scene, record)) is None
    except InputError:
        return False


def _note(i: int, outcome: Outcome, ended: Ended | None) -> Outcome:
    if ended is not None:
        ended(i, outcome)
    return outcome


def _prepared(scene: Scene, record: Callable[[int], Record] | None, count: int | None = None) -> Prepared:
    """A run of `count` steps, those of its scene if left out."""
    ready = prepared(scene)
    ready = ready if count is None else replace(ready, count=count)
    return ready if record is None or scene.record is not None else replace(ready, record=record(ready.count))


def _alone(ready: Prepared, longer: Callable[[Outcome], int] | None = None) -> Outcome:
    try:
        return completed(ready, longer=longer)
    except (InputError, NumericsError) as error:
        if longer is not None:
            longer(error)
        return error


def _fits(ready: Prepared) -> Shape | None:
    """Shape of the arrays of this run in the slots; None if it runs singly."""
    stepper, record = ready.stepper, ready.record
    if not isinstance(stepper, RubStepper) or record.at is not None or record.channels is not None:
        return None
    stored = 4.0 * ready.count / record.every
    stored += ready.count / record.state_every * stepper.size if record.state_every else 0.0
    return shape_of(stepper) if 8.0 * WIDTH * stored <= MOST_BYTES else None


def together(group: Sequence[tuple[int, Prepared]]) -> Iterator[tuple[int, Outcome | None]]:
    """Outcomes of prepared runs of one shape in the order in which they end; None for runs without a solution.

    Energies are computed as often as in a single run; None also if contact adds too much energy. Marks are kept as in a
    single run (`contact.half_step`).
    """
    jobs = [Job(run=cast(RubStepper, one.stepper), steps=one.count, record=one.record) for _, one in group]
    shared = batch(jobs)
    waiting = list(range(len(jobs)))[::-1]
    slots: dict[int, int] = {}
    events: dict[int, list[Events]] = {}
    calm: dict[int, EnergyBudget] = {}  # of each slot after its first LEDGER steps
    marks: dict[int, list[Mark]] = {}
    began, steps = time.perf_counter(), sum(job.steps for job in jobs)
    while waiting or slots:
        for k in range(WIDTH):
            if k not in slots and waiting:
                slots[k] = waiting.pop()
                events[k] = []
                marks[k] = []
                shared.load(k, jobs[slots[k]], _until(group[slots[k]][1], 0))
                calm.pop(k, None)
        happened = shared.advance()
        for k, own in happened.items():
            events[k].append(own)
        for k, number in list(slots.items()):
            failed, ended = int(shared.slots.failed[k]), shared.slots.step[k] == shared.slots.end[k]
            if failed or ended:
                job, (i, ready), taken = jobs[number], group[number], int(shared.slots.step[k])
                if not failed and taken < job.steps:
                    shared.read(k, job)
                    if ready.marked:
                        marks[k].append(mark(job.run, taken))
                    if taken % LEDGER or not runs_away(ready, now := budget_of(ready), calm.setdefault(k, now)):
                        shared.go_on(k, job, _until(ready, taken))
                        continue
                    failed = 1  # its slot: alone it ends here
                kept = shared.unload(k, job, events.pop(k))
                del slots[k]
                seconds = (time.perf_counter() - began) * job.steps / steps
                ended_at = taken if failed else -1
                yield i, None if failed == 1 else _result(ready, kept, taken, seconds, ended_at, calm.get(k), marks[k])


def _until(ready: Prepared, taken: int) -> int:
    """Number of steps to the next mark or energy."""
    most = max(1, ready.count // MARKS) if ready.marked else LEDGER
    return min(most, LEDGER - taken % LEDGER)


def _result(
    ready: Prepared, kept: Samples, taken: int, seconds: float, failed: int, calm: EnergyBudget | None,
    marks: Sequence[Mark],
) -> Outcome | None:  # fmt: skip
    try:
        return finished(ready, [kept], taken, seconds, failed, calm, marks)
    except DivergedError as error:  # alone, a run whose energy grows ends where its energy is next computed
        return error if error.result.divergence.limit in ("wall", "radius") else None
    except NumericsError:
        return None
