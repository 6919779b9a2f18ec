"""One period of a motion that contacts switch, with its derivative: exact between events, which are located.

At an opening, and at the closing of a contact that gives way, the forces are continuous and so is the derivative. A
rigid contact's impact x+ = j(x-, t) multiplies it by d_x j + (f+ - d_x j f- - d_t j) grad(gap)/gap' (saltation,
Leine and Nijmeijer, Dynamics and Bifurcations of Non-Smooth Mechanical Systems, 2004, 7.3).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from contact.base.arrays import Array, Indices
from contact.base.errors import NumericsError
from contact.cycles.known import EVENTS, Closed, DrivenPhase, Known, resonance
from contact.cycles.switched import Drive, Plant
from contact.solver.unilateral.pivoting import pressing

TOUCH = 1e-7  # of the velocities that add up to the gap's: a slower hit ends a series, or is no hit


class Event(NamedTuple):
    """A closing or an opening.

    `speed` [m/s] is the impact speed of a rigid contact, `stays` whether it then remains closed.

    `rests`: the event ends a series of ever smaller impacts.
    """

    time: float
    contact: int
    closes: bool
    stays: bool
    speed: float
    rests: bool = False


After = tuple[Array, Array | None, Closed, Event]  # state, derivative and closed contacts after an event, and the event


class Stretches(NamedTuple):
    """Phases of a passage one after another, by their numbers in `known`, and how long each lasts [s]."""

    phase: Indices
    time: Array
    known: Known


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Passage:
    """End of a period: state, derivative (n, n) if requested, events, closed contacts at `first` and at the end.

    Over the period: least gap and largest force of each contact (k,), `amplitude` max |u| of what is shown (o,).
    """

    start: float
    x: Array
    M: Array | None
    events: tuple[Event, ...]
    stretches: Stretches
    gap: Array
    force: Array
    amplitude: Array
    first: Closed
    last: Closed


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Motion:
    """A plant under a drive; phases of the plant are shared over all drives in `known`."""

    plant: Plant
    drive: Drive
    step: float
    known: Known

    def phase(self, closed: Closed) -> DrivenPhase:
        """The phase with these contacts closed."""
        return self.known.driven(closed, self.drive)

    def angle(self, time: float) -> Array:
        """Angles of the harmonics [rad]."""
        return np.asarray(self.drive.w * time * self.drive.harmonics)

    def gap_velocity(self, x: Array, time: float) -> tuple[Array, Array, Array]:
        """Velocity of each gap: the part due to the state x, and the part due to time alone."""
        plant, w, rows = self.plant, self.drive.w * self.drive.harmonics, self.plant.gap_rates
        moving = self.drive.c.rate(w).plus(self.drive.b.seen(plant.C))
        angle = self.angle(time)
        return rows @ x + moving.at(angle), rows, moving.rate(w).at(angle)

    def velocity(self, closed: Closed, x: Array, time: float) -> Array:
        """Rate of the state in a phase."""
        driven = self.phase(closed)
        return np.asarray(driven.phase.A @ x + driven.b.at(self.angle(time)))

    def closed_at(self, x: Array, time: float) -> Closed:
        """Contacts that press at a state; rigid contacts count as open, and must not be penetrated."""
        from contact.loop.period import contacts_at

        bundle = self.known.under(self.drive)
        self.known.arrays.work.x[:] = x
        return self.pressed(contacts_at(bundle, time), time)

    def pressed(self, found: int, time: float) -> Closed:
        """Contacts closed at the state in the work space, from the answer of the compiled search."""
        from contact.loop.period import INSIDE, TOGETHER

        work, plant = self.known.arrays.work, self.plant
        if found == INSIDE:
            raise NumericsError(
                "found a rigid contact that is closed at the start of the period, expected an open one: choose another "
                "start, or give the contact a compliance"
            )
        if found == TOGETHER:
            gap = plant.C @ work.x + self.drive.c.at(self.angle(time))
            work.closed[:] = 0
            work.closed[plant.soft[pressing(plant.soft_S, gap[plant.soft]) > 0.0]] = 1
        return closed_of(work.closed)


def closed_of(closed: Indices) -> Closed:
    """Numbers of the contacts that are closed."""
    return tuple([i for i, shut in enumerate(closed.tolist()) if shut])


def passage(
    motion: Motion, x: Array, start: float, period: float, *, tangent: bool = True, extremes: bool = True
) -> Passage:
    """Follow the state x from time `start` over `period` [s].

    Without `extremes`, gap, force and amplitude are not computed.

    Raises NumericsError for chatter.
    """
    from contact.loop.period import CLOSED, DONE, IMPACT, INSIDE, ON, START, TOGETHER, UNKNOWN, pass_period

    plant, known = motion.plant, motion.known
    bundle, work, stage = known.under(motion.drive), known.arrays.work, START
    work.x[:], work.at[0] = x, start
    hits: dict[int, Event] = {}
    while True:
        why = pass_period(bundle, stage, start + period, motion.step, extremes, tangent)
        if why == DONE:
            break
        stage = ON
        if why in (INSIDE, TOGETHER):
            motion.pressed(why, start)
            stage = CLOSED
        elif why == UNKNOWN:
            known.number(closed_of(work.closed))
        elif why == IMPACT:
            _hit(motion, work, hits, tangent)
        else:
            raise _refused(why, work, start)
        bundle, work = known.bundle, known.arrays.work
    events = _events(work, hits)
    shown, stretches = slice(0, len(plant.D) - plant.hidden), int(work.where[3])
    return Passage(
        start=start, x=work.x.copy(), M=work.M.copy() if tangent else None, events=events, gap=work.gap.copy(),
        force=work.force.copy(), amplitude=np.maximum(work.most, -work.least)[shown],
        first=closed_of(work.first), last=closed_of(work.closed),
        stretches=Stretches(work.stretch[:stretches].copy(), work.stretch_time[:stretches].copy(), known),
    )  # fmt: skip


def beside(motion: Motion, found: Passage, x: Array, start: float, scale: float) -> Array | None:
    """State after the phases of another passage, each `scale` times as long; None where a rigid contact was hit.

    If forces are continuous at the events, a shift of the events changes the state at the end only to second order. For
    a drive close to that of `found`, the result is therefore the state after a period, with an error of second order in
    the difference of the drives.
    """
    from contact.loop.period import DONE, pass_beside

    if any(event.closes and motion.plant.rigid[event.contact] for event in found.events):
        return None
    known, (phase, time, of) = motion.known, found.stretches
    if of is not known:
        new = {number: known.number(of.closed_of(number)) for number in dict.fromkeys(phase.tolist())}
        phase = np.array([new[number] for number in phase.tolist()])
    bundle = known.under(motion.drive)
    known.arrays.work.x[:] = x
    if pass_beside(bundle, start, phase, time, scale) != DONE:
        raise resonance()
    return np.array(known.arrays.work.x)


def _refused(why: int, work: Any, start: float) -> NumericsError:
    """Error of a passage that has no end."""
    from contact.loop.period import CHATTER, RESONANCE, SLIP

    time = float(work.at[0])
    if why == RESONANCE:
        return resonance()
    if why == CHATTER:
        return NumericsError(f"found over {EVENTS} openings and closings in {time - start:.4g} s: the contact chatters")
    if why == SLIP:
        return NumericsError(
            f"found contact {work.where[1] + 1} at the change from slip to stick before {time:.6g} s, expected slip in "
            "one direction: simulate with ct.run, which computes sticking"
        )
    return NumericsError(f"found a motion that is not finite after {time:.4g} s")


def _events(work: Any, hits: dict[int, Event]) -> tuple[Event, ...]:
    """Events of a passage in their order."""
    count = int(work.where[2])
    return tuple(
        hits[k] if k in hits else Event(time, at if at >= 0 else -1 - at, at >= 0, at >= 0, 0.0)
        for k, (time, at) in enumerate(zip(work.event_time[:count].tolist(), work.event[:count].tolist(), strict=True))
    )


def _hit(motion: Motion, work: Any, hits: dict[int, Event], tangent: bool) -> None:
    """A rigid contact's impact, written into the work space."""
    x, M, time = work.x.copy(), work.M.copy() if tangent else None, float(work.at[0])
    x, M, now, event = _impact(motion, x, M, closed_of(work.closed), int(work.where[1]), time)
    work = motion.known.arrays.work
    work.x[:] = x
    if M is not None:
        work.M[:] = M
    work.closed[:] = 0
    work.closed[list(now)] = 1
    hits[int(work.where[2])] = event
    work.event_time[work.where[2]] = time
    work.where[2] += 1


def _impact(motion: Motion, x: Array, M: Array | None, closed: Closed, hit: int, time: float) -> After:
    """Newton's impact at one rigid contact; rigid contacts that are already closed take their share of the impulse."""
    plant, H = motion.plant, motion.plant.impulse
    velocity, rows, faster = motion.gap_velocity(x, time)
    speed, e = -float(velocity[hit]), float(plant.restitution[hit])
    still = TOUCH * (np.abs(rows) @ np.abs(x) + np.abs(velocity - rows @ x))
    if not speed > still[hit]:
        return _at_rest(motion, x, M, closed, hit, time, still)
    met = sorted((*(i for i in closed if plant.rigid[i]), hit))
    wanted = np.where(np.array(met) == hit, 1.0, 0.0)
    share = pressing(H[np.ix_(met, met)], -wanted)  # impulse for a unit change of the gap's velocity
    struck = [i for i, part in zip(met, share, strict=True) if part > 0.0]
    push = (1.0 + e) * plant.B[:, met] @ share
    after = x - push * velocity[hit]
    now = _kept(motion, after, closed, [i for i in struck if e == 0.0 or i != hit], time)
    if M is not None:
        before_rate, after_rate = motion.velocity(closed, x, time), motion.velocity(now, after, time)
        J = np.eye(x.size) - np.outer(push, rows[hit])
        jump = after_rate - J @ before_rate + push * faster[hit]
        M = J @ M - np.outer(jump, plant.C[hit] @ M) / speed
    return after, M, now, Event(time, hit, True, hit in now, speed)


def _at_rest(motion: Motion, x: Array, M: Array | None, closed: Closed, hit: int, time: float, still: Array) -> After:
    """The end of a series of ever smaller impacts: all rigid contacts that touch come to rest together."""
    plant = motion.plant
    velocity, _, _ = motion.gap_velocity(x, time)
    gap = plant.C @ x + motion.drive.c.at(motion.angle(time))
    near = (gap <= TOUCH * (np.abs(plant.C) @ np.abs(x) + np.abs(gap))) & (np.abs(velocity) <= still)
    met = [int(i) for i in np.flatnonzero(plant.rigid) if near[i] or i in closed or i == hit]
    away = plant.B[:, met] @ np.linalg.pinv(plant.impulse[np.ix_(met, met)])
    after = x - away @ velocity[met]
    if M is not None:  # all these motions end with the gap at rest: their differences in it are zero afterwards
        M = M - np.linalg.pinv(plant.C[met]) @ (plant.C[met] @ M)
        M = M - away @ (plant.C[met] @ plant.A @ M)
    now = _kept(motion, after, closed, met, time)
    return after, M, now, Event(time, hit, True, hit in now, 0.0, True)


def _kept(motion: Motion, x: Array, closed: Closed, stays: list[int], time: float) -> Closed:
    """Contacts that are closed after an impact: compliant ones as before it, rigid ones if they press."""
    plant = motion.plant
    soft = tuple(i for i in closed if not plant.rigid[i])
    if not stays:
        return soft
    trial = tuple(sorted((*soft, *stays)))
    driven = motion.phase(trial)
    lam = driven.phase.K @ x + driven.watched.at(motion.angle(time))[list(trial)]
    place = [trial.index(i) for i in stays]
    W = plant.impulse[np.ix_(stays, stays)]
    pressed = pressing(W, -W @ lam[place])  # accelerations with these contacts free are -W lam
    return tuple(sorted((*soft, *(i for i, force in zip(stays, pressed, strict=True) if force > 0.0))))
