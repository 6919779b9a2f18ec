"""Repeat part of a run: its last part at half the step, or the whole run with states stored more often."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

import numpy as np

from contact.base.arrays import Array, readonly
from contact.base.errors import InputError
from contact.model.bodies.modal_body import ModalBody
from contact.model.gaps.gap import RotatingRim
from contact.model.gaps.limits import RIM, TIP, passed
from contact.model.gaps.rub import Rub, Start, rub_of
from contact.model.law import Law
from contact.record.growth import RunGrowth
from contact.record.record import Record, samples
from contact.scheme.modal.rub_stepper import RubStepper
from contact.scheme.protocol import Problem, Scheme, Stepper
from contact.stability.envelope import envelope, slope_of

MARKS = 16  # of a run, from which a part of it can be repeated
STATES = 400  # stored of what is repeated
CHUNK = 5_000  # steps per compiled call
SHORT = 0.5  # of its planned steps: a run that ended before is repeated from its start
COPIES, CHANGED = 3, 1e-6  # runs of one step from changed starts, and the relative change of the motion
LONG = 0.25  # of the run: a longer stretch is cut to it where FOLDS e-folds remain
FOLDS = 1.5
COARSE = 1.5  # omega h from which a mode's velocity is the difference over the step


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Mark:
    """State of a run after `taken` steps: modal coordinates q and their last increments d."""

    taken: int
    q: Array
    d: Array


def mark(stepper: RubStepper, taken: int) -> Mark:
    """Copy the state of the modes of a rub."""
    return Mark(taken=taken, q=readonly(stepper.state.q.copy()), d=readonly(stepper.state.d.copy()))


def states(stepper: Stepper, first: int, count: int, share: float = 1.0) -> tuple[Array, Array]:
    """Times and coordinates of `count` steps from step `first`, at about STATES of them."""
    record = Record(every=(every := max(1, int(share * count) // STATES)), state_every=every)
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
    problem: Problem, law: Law, scheme: Scheme, dt: float, taken: int, marks: Sequence[Mark], growth: RunGrowth,
    count: int, *, stopped: bool,
) -> RunGrowth:  # fmt: skip
    """The growth of a run of `count` planned steps, and the growth of its last part repeated at half the step.

    The last part is the interval of the fit. It is limited to LONG of the run if the motion grows by e^FOLDS within
    that. A run that ended early is repeated from its start, since the step may also change which motion it reaches.
    Other runs are repeated from a mark before the interval.

    Where the growth differs, the interval is also repeated at the same step, up to COPIES times, from a state changed
    by a fraction CHANGED. An irregular motion then develops differently.

    If half the step gives less than half of the growth and the run was `stopped` at a limit of its motion, the whole
    run is repeated at half the step, up to its planned end. If it passes a limit there too, it grows at both steps.
    """
    end = taken * dt
    begin = max(growth.since, end - max(LONG * end, FOLDS / growth.rate))
    before = [one for one in marks if one.taken * dt <= begin]
    at = before[-1] if before and taken > SHORT * count else None
    again = partial(_again, law=law, scheme=scheme, taken=taken, begin=begin)
    share = 1.0 - (0 if at is None else at.taken) / taken
    try:
        found = growth.checked(*again(_starting_at(problem, at, dt), dt, 2), 2.0 * share)
        for k in range(1, COPIES + 1 if found.converged is False and before else 1):
            start = _starting_at(problem, at, dt, moved=k * CHANGED * before[-1].q)
            found = replace(found, same_step=again(start, dt, 1)[0], check_share=found.check_share + share)
            if found.irregular:
                break
        if found.numerical and stopped:
            passes, steps = _passes(problem, law, scheme, 0.5 * dt, 2 * count)
            found = replace(found, passes=passes, check_share=found.check_share + steps / taken)
        return found
    except InputError:
        return growth


def with_limit_at_half_step(
    problem: Problem, law: Law, scheme: Scheme, dt: float, taken: int, growth: RunGrowth, count: int
) -> RunGrowth:  # fmt: skip
    """The growth of a run that was stopped at a limit of its motion before its rate is known.

    The whole run of `count` planned steps is repeated at half the step, up to this limit.
    """
    try:
        passes, steps = _passes(problem, law, scheme, 0.5 * dt, 2 * count)
    except InputError:
        return growth
    return replace(growth, passes=passes, check_share=steps / taken)


def _passes(problem: Problem, law: Law, scheme: Scheme, dt: float, count: int) -> tuple[bool, int]:
    """Whether a run of at most `count` steps passes a limit of its motion, and its number of steps."""
    stepper = scheme.prepare(problem, law, dt=dt, courant=None)
    with np.errstate(all="ignore"):
        time, _ = states(stepper, 0, count)
    return passed(stepper.limits) is not None, round(float(time[-1]) / dt)


class _Start(NamedTuple):
    """A problem that starts after `first` steps of a run, `clock` steps after the zero of its clock."""

    problem: Problem
    first: int
    clock: int = 0


def _again(
    start: _Start, dt: float, parts: int, *, law: Law, scheme: Scheme, taken: int, begin: float
) -> tuple[float, float]:  # fmt: skip
    """Growth from `begin` [s] to the end of a run with divided steps, and the half width of its interval [1/s]."""
    problem, first, clock = start
    stepper = scheme.prepare(problem, law, dt=dt / parts, courant=None)
    if stepper.limits is not None:
        stepper.limits[RIM] = stepper.limits[TIP] = math.inf
    with np.errstate(all="ignore"):
        share = (taken * dt - begin) / ((taken - first) * dt)
        time, state = states(stepper, parts * clock, parts * (taken - first), share)
        return _growth(rub_of(problem), time + dt * (first - clock), state, begin, taken * dt)


def _growth(rub: Rub, time: Array, state: Array, begin: float, end: float) -> tuple[float, float]:
    """Slope of log amplitude over the whole interval [1/s] and half width of its confidence interval.

    Nan for too few states.
    """
    late = time >= begin
    omega = np.concatenate([body.omega for body in rub.bodies])
    speed = rub.speed.omega(end)
    turn = 2.0 * math.pi / abs(speed) if speed else math.inf
    one = np.zeros(omega.size, dtype=np.int64)
    found = envelope(time[late], state[late, : omega.size], omega, one, turn, rub.repeats)
    if found is None or not (np.isfinite(found.energy).all() and found.energy.min() > 0.0):
        return math.nan, math.nan
    rate, low, high = slope_of(found.time, 0.5 * np.log(found.energy[:, 0]))
    return rate, 0.5 * (high - low)


def _starting_at(problem: Problem, at: Mark | None, dt: float, moved: Array | None = None) -> _Start:
    """The problem that starts at a mark of its run, or at its start; `moved` (m,) is added to its modal coordinates."""
    rub: Rub = rub_of(problem)
    sizes = np.cumsum([body.omega.size for body in rub.bodies])[:-1]
    if at is None:
        q, v = (np.concatenate(part) for part in zip(*map(_motion, rub.starts, rub.bodies), strict=True))
    else:
        q, v = at.q, _velocity(rub, at, dt)
    q = readonly(q if moved is None else q + moved)
    first = 0 if at is None else at.taken
    if isinstance(problem, RotatingRim):  # turns evenly: it begins at t = 0, at the angle that it has reached
        m, turned = problem.casing.omega.size, math.remainder(problem.speed * first * dt, math.tau)
        return _Start(replace(
            problem, angle_deg=problem.angle_deg - math.degrees(turned), casing_displacement=q[:m],
            blade_displacement=q[m:], casing_velocity=v[:m], blade_velocity=v[m:],
        ), first)  # fmt: skip
    casing, *blades = (
        replace(start, displacement=readonly(one), velocity=readonly(speed))
        for start, one, speed in zip(rub.starts, np.split(q, sizes), np.split(v, sizes), strict=True)
    )
    return _Start(replace(rub, casing_start=casing, blade_starts=tuple(blades)), first, first)


def _motion(start: Start, body: ModalBody) -> tuple[Array, Array]:
    """Modal coordinates and velocities at t = 0."""
    none = np.zeros(body.omega.size)
    parts = (none if part is None else np.asarray(part) for part in (start.displacement, start.velocity))
    q, v = parts
    return q, v


def _velocity(rub: Rub, at: Mark, dt: float) -> Array:
    """Velocities of free modes that moved by d in the last step."""
    turned = np.concatenate([body.omega for body in rub.bodies]) * dt
    fine = (turned > 0.0) & (turned < COARSE)
    velocity, w = at.d / dt, turned[fine]
    velocity[fine] = (at.q[fine] * np.cos(w) - (at.q - at.d)[fine]) * w / (dt * np.sin(w))
    return np.asarray(velocity)
