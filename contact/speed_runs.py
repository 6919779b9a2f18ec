"""Runs of one scene at many constant speeds, and the verdict of each (`contact.speed_verdict`).

Where two neighbouring runs disagree, in their verdict or in the size of the motion, the scene is run midway too, and so
on HALVED times: a boundary is known to an eighth of the spacing, and few runs are spent where nothing changes
(`python -m reports.verification.rubs.speeds_between`).

A run that is too short to decide is continued to twice its length, again and again up to LONGEST times t_end. A run
that grows with contact that opens, and has passed no limit, is continued to four times its length: such a growth may
end in a bounded motion, or pause where the contact begins to open. A motion that does not grow is run four times as
long too if its contact opens and closed contact would grow: the contact may close later. The last part of a growing run
is repeated with half the step (`contact.half_step`).
"""

from __future__ import annotations

import math
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple, cast

import numpy as np

from contact.base.arrays import Array
from contact.base.errors import InputError
from contact.io.progress import as_part, quietly, tell
from contact.io.workers import KilledWorkersError, forks, in_processes
from contact.model.gaps.gap import RotatingRim
from contact.model.gaps.rub import Rub, rub_of
from contact.model.rotor.rotor import Rotor
from contact.model.rotor.rotor_rub import at_constant_speed, rotor_of
from contact.model.rotor.whirl import modes_at
from contact.model.speed import Speed
from contact.prepared import Scene
from contact.record.record import STATES, Record, prime_stride
from contact.result import Result
from contact.run_many import Outcome, run_many, runs_alone
from contact.speed_verdict import CALM, SpeedRun, at_end_of_band, at_half_step, decided, disagree, judged, times_longer

WORTH, COPIES = 4.0, 0.3  # s: two processes start in less, fresh ones or copies of this one
TOGETHER = 16  # scenes of a lot if several run in one loop
LONGEST = 16  # times t_end: length to which runs are continued
HALVED = 3  # times that the spacing of runs is halved where neighbours disagree
TURN = 0.299  # radians of the highest harmonic in a step, below the scheme's limit of 0.3
DENSE, PAIRS = 12.0, 3  # states in a period of the fastest whirl that is looked at, and pairs of modes that are


class Lot(NamedTuple):
    """Scenes at constant speeds [Hz] that are run and judged together: arguments of `_judged`."""

    scenes: Sequence[Scene]
    speed_hz: Array
    poles: Array
    longest: int
    exact: bool | None


def speed_runs(
    scene: Scene, speed_hz: Array, poles: Callable[[Array], Array], *, even: Array | None = None,
    bands_hz: Sequence[tuple[float, float]] = (), exact: bool | None = None, processes: int = 1,
) -> tuple[SpeedRun, ...]:  # fmt: skip
    """Run a scene at speeds [turns/s] above 0 and midway between neighbours that disagree, and judge each run.

    `poles` gives the growth rates of closed contact at speeds. They decide where all contacts stay closed: `exact` if
    they hold for the scene itself, not `exact` if for its average over time; such a growth must show in a long run.
    None: they do not hold for this scene. `even`: the speeds whose motions tell which motion is large, all if left out.
    No run is added at the end of one of the `bands_hz` of closed contact that grows, if the run in it is unstable.
    `processes` share the runs if these take longer than starting processes; the result is the same.

    >>> from contact.model.gaps.bladed_disk import BladedDisk, pair_rim
    >>> from contact.model.gaps.permanent import ModalPair
    >>> disk = BladedDisk(blades=9, freq_hz=115.0, modal_mass=0.1, compliance=5e-5)
    >>> rim = pair_rim(ModalPair(n=3, freq_hz=290.0, modal_mass=2.0), radius=0.5)
    >>> scene = Scene(what=Rub(rim, (disk.body(),), disk.tips(), clearance=1e-3), t_end=0.1, dt=1e-4)
    >>> found = speed_runs(scene, np.array([20.0, 30.0]), np.zeros_like)
    >>> [(run.speed_hz, run.verdict, run.amplitude_m) for run in found]  # nothing touches
    [(20.0, 'safe', 0.0), (30.0, 'safe', 0.0)]
    """
    known: dict[float, SpeedRun] = {}
    chosen, own = np.unique(speed_hz), np.unique(speed_hz if even is None else even).tolist()
    for _ in range(HALVED + 1):
        lot = Lot([at_speed(scene, hz) for hz in chosen.tolist()], chosen, poles(chosen), LONGEST, exact)
        known |= zip(chosen.tolist(), _shared(lot, processes, len(known)), strict=True)
        speeds = sorted(known)
        found = decided([known[hz] for hz in speeds], [known[hz] for hz in own])
        apart = [pair for pair in pairwise(found) if disagree(*pair) and not at_end_of_band(*pair, bands_hz)]
        chosen = np.array([0.5 * (one.speed_hz + other.speed_hz) for one, other in apart])
        if not chosen.size:
            break
    return found


def runs_at_speeds(scenes: Sequence[Scene], speed_hz: Array, poles: Array) -> tuple[SpeedRun, ...]:
    """Run scenes, each at its own speed [turns/s] above 0, and judge each run separately.

    A motion that does not grow is a resonance if it exceeds the allowed deflection of the rim. A run that is too short
    to decide is not continued.

    >>> from contact.model.gaps.bladed_disk import BladedDisk, pair_rim
    >>> from contact.model.gaps.permanent import ModalPair
    >>> disk = BladedDisk(blades=9, freq_hz=115.0, modal_mass=0.1, compliance=5e-5)
    >>> rim = pair_rim(ModalPair(n=3, freq_hz=290.0, modal_mass=2.0), radius=0.5)
    >>> scene = Scene(what=Rub(rim, (disk.body(),), disk.tips(), clearance=1e-3), t_end=0.1, dt=1e-4)
    >>> [run.verdict for run in runs_at_speeds([scene, scene], np.array([20.0, 30.0]), np.zeros(2))]
    ['safe', 'safe']
    """
    own = [at_speed(scene, hz) for scene, hz in zip(scenes, speed_hz.tolist(), strict=True)]
    found = []
    for run in _shared(Lot(own, speed_hz, poles, 1, None), 1, 0):
        small = run.verdict == "resonance" and not run.amplitude_m > run.allowed_m
        found.append(replace(run, verdict="safe") if small else run)
    return tuple(found)


def _shared(lot: Lot, processes: int, before: int) -> list[SpeedRun]:
    """The verdict of each scene of a lot after `before` others, by several processes if that takes less time."""
    size = 1 if processes > 1 and runs_alone(lot.scenes[0], _record) else TOGETHER if processes > 1 else len(lot.scenes)
    numbers = range(0, len(lot.scenes), size)
    lots = [lot._replace(**{name: getattr(lot, name)[k : k + size] for name in Lot._fields[:3]}) for k in numbers]
    worth = math.inf if processes < 2 else COPIES if forks() else WORTH
    found: dict[int, list[SpeedRun]] = {}
    ended = 0

    def whole(done: float) -> tuple[str, float]:
        runs = f"{before + ended} of {before + len(lot.scenes)} runs ended"
        return runs, min((before + ended + done) / (before + len(lot.scenes)), 1.0)

    def note() -> None:
        nonlocal ended
        ended += 1
        tell("", 0.0)

    with as_part(whole):
        tell("", 0.0)
        while len(found) < len(lots):
            k, began = len(found), time.perf_counter()
            found[k] = _judged(lots[k], note)
            seconds = (time.perf_counter() - began) * (len(lots) - k - 1)
            if k > 0 and seconds > worth:  # the first lot loads the code of the loop
                for j, runs in _by_processes(lots[k + 1 :], processes):
                    found[k + 1 + j] = runs
                    ended += len(runs)
                    tell("", 0.0)
    return [run for k in range(len(lots)) for run in found[k]]


def _by_processes(lots: Sequence[Lot], processes: int) -> Iterator[tuple[int, list[SpeedRun]]]:
    """Number and verdicts of each lot, as they end."""
    try:
        yield from in_processes(list(enumerate(lots)), _numbered, processes)
    except KilledWorkersError as error:
        raise InputError(str(error)) from error


def _numbered(task: tuple[int, Lot]) -> tuple[int, list[SpeedRun]]:
    """A lot's number and verdicts; warnings were shown with the first lot."""
    with quietly(), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return task[0], _judged(task[1], lambda: None)


def _judged(lot: Lot, ended: Callable[[], None]) -> list[SpeedRun]:
    """Scenes at constant speeds, with the verdict of each; runs that do not decide go on to `longest` times t_end.

    Every motion that does not grow counts as a resonance until all runs are known.
    """
    scenes = lot.scenes
    found: list[list[SpeedRun]] = [[] for _ in scenes]  # verdicts of each scene, from its shortest run on
    steps = [scene.dt for scene in scenes]

    def of(i: int, outcome: Outcome) -> SpeedRun:
        return judged(scenes[i].what, outcome, float(lot.speed_hz[i]), float(lot.poles[i]), lot.exact)

    def longer(i: int, outcome: Outcome) -> int:
        run = of(i, outcome)
        found[i].append(run)
        if not isinstance(outcome, Result):
            return 0
        steps[i] = outcome.dt
        times = times_longer(run, first := found[i][0].seconds, exact=lot.exact)
        return times * outcome.steps if times * run.seconds <= lot.longest * first else 0

    run_many(scenes, record=_record, ended=lambda _, __: ended(), longer=longer)
    settled = [_settled(runs) for runs in found]
    for i, run in enumerate(settled):
        if run.hides and (dt := steps[i]):
            (fine,) = run_many([replace(scenes[i], dt=0.5 * dt, t_end=run.seconds)], record=_record)
            settled[i] = at_half_step(run, of(i, fine))
    return settled


def _settled(runs: Sequence[SpeedRun]) -> SpeedRun:
    """Verdict of one motion from runs of increasing length.

    The longest run decides. A growth remains unless a longer run decides that the motion does not grow.
    """
    last = runs[0]
    for run in runs[1:]:
        if run.verdict in CALM or (run.seconds > 0.0 and last.verdict != "unstable"):
            last = run
    return last


def _record(steps: int) -> Record:
    """The record that `contact.run` uses for such a scene, so that the table agrees with single runs."""
    stride = prime_stride(steps, STATES)
    return Record(every=stride, state_every=stride)


def at_speed(scene: Scene, speed_hz: float) -> Scene:
    """The same scene at one constant speed [turns/s], with a smaller step if the scene's is too long for it.

    >>> from contact.model.gaps.bladed_disk import BladedDisk, pair_rim
    >>> from contact.model.gaps.permanent import ModalPair
    >>> disk = BladedDisk(blades=9, freq_hz=115.0, modal_mass=0.1, compliance=5e-5)
    >>> rim = pair_rim(ModalPair(n=3, freq_hz=290.0, modal_mass=2.0), radius=0.5)
    >>> scene = Scene(what=Rub(rim, (disk.body(),), disk.tips(), clearance=1e-4), t_end=1.0, dt=1e-3)
    >>> fast = at_speed(scene, 100.0)
    >>> fast.what.speed.hz.tolist(), round(fast.dt * 3 * 2 * np.pi * 100.0, 3)
    ([100.0], 0.299)
    """
    if rotor_of(scene.what) is not None:
        return _rotor_at(scene, speed_hz)
    return replace(scene, what=_turned(scene.what, speed_hz), dt=_step_at(scene, speed_hz), record=None)


def _step_at(scene: Scene, speed_hz: float) -> float | None:
    """The scene's step, or a smaller one if the highest harmonic of its rim would turn too far in it."""
    rub: Rub = rub_of(scene.what)
    highest = max([rub.casing.n_max, *(p for p, _, _ in rub.profile.terms)])
    if scene.dt is None or not highest:
        return scene.dt
    return min(scene.dt, TURN / (2.0 * math.pi * highest * abs(speed_hz)))


def _rotor_at(scene: Scene, speed_hz: float) -> Scene:
    """A rotor's scene at one constant speed, which stores enough states for its whirl."""
    what = scene.what
    turned: Rotor | Rub
    if isinstance(what, Rotor):
        turned = replace(what, speed=Speed.constant(speed_hz))
    else:
        turned = at_constant_speed(cast(Rub, what), speed_hz)
    every, dt = 1, scene.dt if isinstance(what, Rotor) else _step_at(scene, speed_hz)
    if dt:
        rates = np.abs(modes_at(cast(Rotor, rotor_of(turned)), 2.0 * math.pi * speed_hz)[0].imag)
        fastest = max(2.0 * math.pi * speed_hz, float(np.sort(rates)[: 2 * PAIRS].max(initial=0.0)))
        every = max(1, int(2.0 * math.pi / (DENSE * fastest * dt)))
    return replace(scene, what=turned, dt=dt, record=Record(every=every, state_every=every))


def _turned(what: object, speed_hz: float) -> RotatingRim | Rub:
    """A rim or a rub at another constant speed."""
    if isinstance(what, RotatingRim):
        return replace(what, speed_hz=speed_hz)
    if isinstance(what, Rub):
        return replace(what, speed=Speed.constant(speed_hz))
    raise InputError(f"scene: found {type(what).__name__}, expected a RotatingRim or a Rub")
