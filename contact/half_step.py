"""A part of a run once more: its last stretch at half the step, or from the start with denser states."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from contact.base.arrays import Array, readonly
from contact.base.errors import InputError
from contact.growth.envelope import envelope, slope_of
from contact.model.gaps.gap import RotatingRim
from contact.model.gaps.limits import RIM, TIP
from contact.model.gaps.rub import Rub, rub_of
from contact.model.law import Law
from contact.record.growth import RunGrowth
from contact.record.record import Record, samples
from contact.scheme.modal.rub_stepper import RubStepper
from contact.scheme.protocol import Problem, Scheme, Stepper

MARKS = 16  # of a run, from which a part of it can be repeated
STATES = 400  # stored of what is repeated
CHUNK = 5_000  # steps per compiled call
LONG = 0.25  # of the run: a longer stretch is cut to it where FOLDS e-folds remain
FOLDS = 1.5
COARSE = 1.5  # omega h from which a mode's velocity is the difference over the step


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Mark:
    """A run after `taken` steps: modal coordinates q and their last increments d."""

    taken: int
    q: Array
    d: Array


def mark(stepper: RubStepper, taken: int) -> Mark:
    """Copy where the modes of a rub are."""
    return Mark(taken=taken, q=readonly(stepper.state.q.copy()), d=readonly(stepper.state.d.copy()))


def states(stepper: Stepper, first: int, count: int) -> tuple[Array, Array]:
    """Instants and coordinates of about STATES states of `count` steps from step `first`."""
    record = Record(every=(every := max(1, count // STATES)), state_every=every)
    K, size = stepper.sums.closed.size, stepper.size
    parts, at, failed = [], first, -1
    while at < first + count and failed < 0:
        some = min(max(CHUNK // every, 1) * every, first + count - at)
        out = samples(record, some + every, K, size)
        stepper.sums.filled[:] = 0
        failed = stepper.advance(out, at, some)
        n = int(stepper.sums.filled[1])
        parts.append((out.state_time[:n], out.state[:n]))
        at += some
    time, state = (np.concatenate(part) for part in zip(*parts, strict=True))
    return time, state


def with_half_step(
    problem: Problem, law: Law, scheme: Scheme, dt: float, taken: int, marks: Sequence[Mark], growth: RunGrowth
) -> RunGrowth:
    """The growth of a run with that of its last stretch at half the step, begun at a mark of the run.

    The stretch is that of the fit, but no more than LONG of the run where the motion grows by e^FOLDS in that. Where
    the growth differs the stretch is repeated at the same step too: its start differs from the run's by the round-off
    of velocities read from a mark, after which an irregular motion takes another course.
    """
    end = taken * dt
    begin = max(growth.since, end - max(LONG * end, FOLDS / growth.rate))
    before = [one for one in marks if one.taken * dt <= begin]
    at = before[-1] if before else None
    share = 1.0 - (0 if at is None else at.taken) / taken
    try:
        fine = _again(problem, law, scheme, dt, 2, at, taken, begin)
        found = growth.checked(*fine, 2.0 * share)
        if found.converged is not False or at is None:
            return found
        return replace(
            found, same_step=_again(problem, law, scheme, dt, 1, at, taken, begin)[0], check_share=3.0 * share
        )
    except InputError:
        return growth


def _again(
    problem: Problem, law: Law, scheme: Scheme, dt: float, parts: int, at: Mark | None, taken: int, begin: float
) -> tuple[float, float]:
    """Growth from `begin` [s] to the end of a run whose steps are divided into parts, and half its interval [1/s]."""
    starting, clock = (problem, 0) if at is None else _starting_at(problem, at, dt)
    first = 0 if at is None else at.taken
    stepper = scheme.prepare(starting, law, dt=dt / parts, courant=None)
    if stepper.limits is not None:
        stepper.limits[RIM] = stepper.limits[TIP] = math.inf
    with np.errstate(all="ignore"):
        time, state = states(stepper, parts * clock, parts * (taken - first))
        return _growth(rub_of(problem), time + dt * (first - clock), state, begin, taken * dt)


def _growth(rub: Rub, time: Array, state: Array, begin: float, end: float) -> tuple[float, float]:
    """Slope of the whole stretch [1/s] and the half width of its interval; nan of too few states."""
    late = time >= begin
    omega = np.concatenate([body.omega for body in rub.bodies])
    speed = rub.speed.omega(end)
    turn = 2.0 * math.pi / abs(speed) if speed else math.inf
    found = envelope(time[late], state[late, : omega.size], omega, np.zeros(omega.size, dtype=np.int64), turn)
    if found is None or not (np.isfinite(found.energy).all() and found.energy.min() > 0.0):
        return math.nan, math.nan
    rate, low, high = slope_of(found.time, 0.5 * np.log(found.energy[:, 0]))
    return rate, 0.5 * (high - low)


def _starting_at(problem: Problem, at: Mark, dt: float) -> tuple[Problem, int]:
    """The rub that starts in the motion of a mark, and the number of steps that its clock has passed."""
    if isinstance(problem, RotatingRim):
        return _rim_at(problem, at, dt), 0
    rub: Rub = rub_of(problem)
    sizes = np.cumsum([body.omega.size for body in rub.bodies])[:-1]
    velocity = _velocity(rub, at, dt)
    casing, *blades = (
        replace(start, displacement=readonly(q), velocity=readonly(v))
        for start, q, v in zip(rub.starts, np.split(at.q, sizes), np.split(velocity, sizes), strict=True)
    )
    return replace(rub, casing_start=casing, blade_starts=tuple(blades)), at.taken


def _rim_at(problem: RotatingRim, at: Mark, dt: float) -> RotatingRim:
    """A rim that turns evenly begins at t = 0, at the angle that it has reached."""
    m, velocity = problem.casing.omega.size, _velocity(rub_of(problem), at, dt)
    return replace(
        problem, angle_deg=problem.angle_deg - math.degrees(math.remainder(problem.speed * at.taken * dt, math.tau)),
        casing_displacement=at.q[:m], blade_displacement=at.q[m:],
        casing_velocity=velocity[:m], blade_velocity=velocity[m:],
    )  # fmt: skip


def _velocity(rub: Rub, at: Mark, dt: float) -> Array:
    """Velocities as of free modes that moved by d in the last step."""
    turned = np.concatenate([body.omega for body in rub.bodies]) * dt
    fine = (turned > 0.0) & (turned < COARSE)
    velocity, w = at.d / dt, turned[fine]
    velocity[fine] = (at.q[fine] * np.cos(w) - (at.q - at.d)[fine]) * w / (dt * np.sin(w))
    return np.asarray(velocity)
