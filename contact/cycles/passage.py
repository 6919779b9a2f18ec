"""One period of a motion that contacts switch, with its derivative: exact between events, which are located.

At an opening, and at the closing of a contact that gives way, the forces are continuous and so is the derivative. A
rigid contact's impact x+ = j(x-, t) multiplies it by d_x j + (f+ - d_x j f- - d_t j) grad(gap)/gap' (saltation,
Leine and Nijmeijer, Dynamics and Bifurcations of Non-Smooth Mechanical Systems, 2004, 7.3).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from contact.base.arrays import Array
from contact.base.errors import NumericsError
from contact.cycles.switched import Complex, Drive, DrivenPhase, Phase, Plant, driven_phase, phase_of

if TYPE_CHECKING:
    from contact.loop.phase import PhaseWork

Closed = tuple[int, ...]
EVENTS = 4000  # in one period: more are chatter
PIVOTS = 200
INSIDE = 1e-9  # of what adds up to a gap: less penetration is none
TOUCH = 1e-7  # of the velocities that add up to the gap's: a slower hit is the end of a series, or none


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


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Passage:
    """End of a period: state, derivative (n, n) if requested, events, closed contacts at `first` and at the end.

    Over the period: least gap and largest force of each contact (k,), `amplitude` max |u| of what is shown (o,).
    """

    start: float
    x: Array
    M: Array | None
    events: tuple[Event, ...]
    gap: Array
    force: Array
    amplitude: Array
    first: Closed
    last: Closed


class Extremes(NamedTuple):
    """Over the period so far: least gaps, largest forces (k,), largest and least outputs (o,)."""

    gap: Array
    force: Array
    most: Array
    least: Array

    def after(self, phase: Phase, work: PhaseWork) -> Extremes:
        """Extremes of this phase and another one together."""
        k, shut = self.gap.size, list(phase.closed)
        gap, force = work.least[:k].copy(), self.force.copy()
        gap[shut], force[shut] = np.minimum(self.gap[shut], 0.0), work.most[shut]
        return Extremes(gap, force, work.most[k:].copy(), work.least[k:].copy())


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Motion:
    """A plant under a drive; its phases are computed when first needed, those of the plant once for all drives."""

    plant: Plant
    drive: Drive
    step: float
    phases: dict[Closed, Phase]
    driven: dict[Closed, DrivenPhase] = field(default_factory=dict)

    def phase(self, closed: Closed) -> DrivenPhase:
        """The phase with these contacts closed."""
        if closed not in self.driven:
            if closed not in self.phases:
                self.phases[closed] = phase_of(self.plant, closed)
            self.driven[closed] = driven_phase(self.plant, self.phases[closed], self.drive)
        return self.driven[closed]

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
        plant, moved = self.plant, self.drive.c.at(self.angle(time))
        gap, size = plant.C @ x + moved, np.abs(plant.C) @ np.abs(x) + np.abs(moved)
        if np.any((gap < -INSIDE * size)[plant.rigid]):
            raise NumericsError("a rigid contact is closed where the period begins: choose another start, or give it S")
        force = pressing(plant.soft_S, gap[plant.soft])
        return tuple(int(i) for i in plant.soft[force > 0.0])


def pressing(W: Array, g: Array) -> Array:
    """Forces lam >= 0 with W lam + g >= 0, complementary, by principal pivoting (after some steps by least index)."""
    closed = g < 0.0
    if not closed.any():
        return np.zeros(g.size)
    for pivot in range(PIVOTS):
        lam = np.zeros(g.size)
        chosen = np.flatnonzero(closed)
        lam[chosen] = np.linalg.solve(W[np.ix_(chosen, chosen)], -g[chosen])
        wrong = np.flatnonzero((lam < 0.0) | (~closed & (W @ lam + g < -1e-14 * np.abs(g).max(initial=0.0))))
        if not wrong.size:
            return lam
        closed[wrong if pivot < 10 else wrong[:1]] ^= True
    raise NumericsError("the set of closed contacts was not found: contacts press against each other")


def passage(
    motion: Motion, x: Array, start: float, period: float, *, tangent: bool = True, extremes: bool = True
) -> Passage:
    """Follow the state x from time `start` over `period` [s].

    Without `extremes`, gap, force and amplitude are not computed.

    Raises NumericsError for chatter.
    """
    from contact.loop.phase import pass_phase

    plant, k = motion.plant, len(motion.plant.C)
    closed = first = motion.closed_at(x, start)
    M = np.eye(x.size) if tangent else None
    time, end, events = start, start + period, list[Event]()
    none, o = np.inf if extremes else -np.inf, len(plant.D)  # what begins beyond all values is not searched for
    reached = Extremes(gap=np.full(k, none), force=np.full(k, 0.0 if extremes else np.inf), most=np.full(o, -none),
                       least=np.full(o, none))  # fmt: skip
    while True:
        driven = motion.phase(closed)
        phase, before = driven.phase, time
        forced = (driven.X @ np.exp(1j * motion.angle(time))).real
        work = _begun(plant, driven, phase.U @ (x - forced), reached)
        hit = pass_phase(*driven.bundles, k, time, end, motion.step)
        time = float(work.at[0])
        forced = (driven.X @ np.exp(1j * motion.angle(time))).real
        x = (phase.V @ (work.y[0] + 1j * work.y[1])).real + forced
        if not np.all(np.isfinite(x)):
            raise NumericsError(f"the motion is not a number after {time:.4g} s")
        if M is not None:
            M = phase.flow(time - before, M)
        reached = reached.after(phase, work)
        for contact, row in plant.slips:
            if contact in closed and not work.least[k + row] > 0.0:
                raise NumericsError(
                    f"the slip of contact {contact + 1} turns before {time:.6g} s: it would stick, which long runs "
                    "follow (ct.run), not periodic motions"
                )
        if hit < 0:
            break
        x, M, closed, event = _switched(motion, x, M, closed, hit, time)
        events.append(event)
        if len(events) > EVENTS:
            raise NumericsError(
                f"found over {EVENTS} openings and closings in {time - start:.4g} s: the contact chatters"
            )
    shown = slice(0, len(plant.D) - plant.hidden)
    return Passage(
        start=start, x=x, M=M, events=tuple(events), gap=reached.gap, force=reached.force,
        amplitude=np.maximum(reached.most, -reached.least)[shown], first=first, last=closed,
    )  # fmt: skip


def _switched(motion: Motion, x: Array, M: Array | None, closed: Closed, hit: int, time: float) -> After:
    """State, derivative and closed contacts after an event."""
    if hit in closed:
        return x, M, tuple(i for i in closed if i != hit), Event(time, hit, False, False, 0.0)
    if not motion.plant.rigid[hit]:
        return x, M, tuple(sorted((*closed, hit))), Event(time, hit, True, True, 0.0)
    return _impact(motion, x, M, closed, hit, time)


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
    if M is not None:  # all these motions end with the gap at rest: what they differed by in it is gone
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


def _begun(plant: Plant, driven: DrivenPhase, y: Complex, reached: Extremes) -> PhaseWork:
    """Work arrays of a phase that starts at state y."""
    work, phase, k = driven.work, driven.phase, reached.gap.size
    work.y[0], work.y[1] = y.real, y.imag
    most, least = work.most, work.least
    most[:k], least[:k] = np.inf, reached.gap  # of an open contact the least gap counts, of a closed one the force
    shut = list(phase.closed)
    most[shut], least[shut] = reached.force[shut], -np.inf
    most[k:], least[k:] = reached.most, reached.least
    for contact, row in plant.slips:  # of this phase alone
        most[k + row], least[k + row] = np.inf, np.inf if contact in phase.closed else -np.inf
    return work
