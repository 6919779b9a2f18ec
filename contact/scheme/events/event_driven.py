"""Exact modal motion between located events; see `contact.loop.certified` for the search that misses none."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from contact.base.arrays import Array, require_positive
from contact.base.errors import InputError
from contact.io.trust import Flag
from contact.model.law import Law, kind
from contact.model.laws.force_law import spring
from contact.record.energy import Stored
from contact.record.record import Samples, Tally, tally
from contact.scheme.events.impact import impact
from contact.scheme.events.system import EventSystem, event_system
from contact.scheme.events.table import Known
from contact.scheme.modal.modal_run import rigid_motions
from contact.scheme.modal.propagator import step_of
from contact.scheme.protocol import Block, Motion, PlainStepper, Problem, Stepper, window
from contact.solver.unilateral.pivoting import pressing

if TYPE_CHECKING:
    from contact.loop.certified import EventWork


@dataclass(frozen=True, slots=True, kw_only=True)
class EventDriven:
    """Event-driven scheme: exact modal motion between openings and closings that are located to round-off.

    For modal bodies (PointGap, Patch), for rods by their first `modes` modes, and for masses; frictionless contact,
    rigid or with a linear spring (`Penalty`). A contact with compliance (the S of a modal body, or the spring) closes
    and opens without an impact. A contact without compliance has impacts with Newton's `restitution`; a series of
    impacts ends when one is slower than 1e-5 of the contact's fastest, and a contact at rest stays closed while its
    force is positive. dt is only the interval of the samples: the motion does not depend on it. A sample is the mean
    force of a step, and the gap at its end; openings and closings within one step are joined to the first and the last.
    More than 1000 events in a step end the run. Raises InputError for friction, coatings, other springs and other
    problems.

    >>> import contact as ct
    >>> ball = ct.PointMass(mass=1.0, x=5.0)
    >>> scheme = ct.scheme.EventDriven(restitution=0.5)
    >>> result = ct.run([ct.Wall(), ball], scheme=scheme, gravity=10.0, t_end=1.5, dt=0.5)
    >>> [round(t, 12) for t in result.intervals[0][0]], round(float(result.impulse[0]), 12)
    ([1.0, 1.0], 15.0)
    """

    modes: int = 50
    restitution: float = 0.0

    def __post_init__(self) -> None:
        require_positive(modes=self.modes)
        if not 0.0 <= self.restitution <= 1.0:
            raise InputError(f"restitution: found {self.restitution!r}, expected 0 to 1")

    def prepare(self, problem: Problem, law: Law, *, dt: float | None, courant: float | None) -> Stepper:
        """Matrices and closed contacts at t = 0; raises InputError."""
        system = event_system(problem, self.modes, _stiffness(law))
        h = step_of(float(system.omega.max(initial=0.0)), dt, courant)
        return event_stepper(system, h, self.restitution, law.words)


def _stiffness(law: Law) -> float:
    """Stiffness of the spring in a contact [N/m], 0 of a rigid one; raises InputError for any other law."""
    if law.mu == 0.0 and kind(law) in ("Unilateral", "Coulomb"):
        return 0.0
    if law.mu == 0.0 and law.response is not None and law.response.function is spring:
        stiffness, damping = np.asarray(law.response.values)
        if damping == 0.0:
            return float(stiffness)
    found = f"{law.words} with friction {law.mu:g}" if law.mu > 0.0 else law.words
    expected = "Unilateral(), or a spring without dashpot such as Penalty(stiffness=...), for EventDriven"
    raise InputError(f"law: found {found}, expected {expected}")


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class EventStepper(PlainStepper):
    """State of a run: `known` phases, arrays of the loop, fastest impact of each contact (k,), energy in S (k,).

    `thrown` (n,): velocities after the impacts at t = 0, with which the first step begins.
    """

    system: EventSystem
    dt: float
    restitution: float
    label: str
    sums: Tally
    known: Known
    work: list[EventWork]  # one entry: replaced where a phase has more poles than all before it
    fastest: Array
    squeezed: Array
    thrown: Array

    @property
    def window(self) -> float:
        """Period of the highest mode [s]."""
        return window(float(self.system.omega.max(initial=0.0)), self.dt)

    @property
    def size(self) -> int:
        """Number of modes."""
        return self.system.omega.size

    @property
    def blocks(self) -> tuple[Block, ...]:
        """Name, first mode and one past the last mode of each body."""
        return self.system.blocks

    @property
    def memory(self) -> tuple[Any, ...]:
        """Arrays that a step changes."""
        w = self.work[0]
        kept = w.q, w.v, w.closed, w.size, w.push, w.changes, w.at, w.where
        return kept, self.sums, self.fastest, self.squeezed

    def advance(self, out: Samples, first: int, steps: int) -> int:
        """Advance by whole steps; returns -1, or the step that failed."""
        from contact.jit.bundle import bundled
        from contact.loop.certified import STEP
        from contact.loop.events import CHATTER, DONE, IMPACT, LOST, UNKNOWN, advance_events

        if first == 0:
            self.work[0].v[:] = self.thrown
        sums, samples = bundled(self.sums), bundled(out)
        phases, work, why = bundled(self.known.arrays), bundled(self.work[0]), IMPACT
        while why != DONE:
            w = self.work[0]
            why = advance_events(phases, work, sums, samples, self.dt, first + steps)
            if why == UNKNOWN:
                if self.known.add(w.closed):
                    self.work[0] = _wider(self.known, w)
                phases, work = bundled(self.known.arrays), bundled(self.work[0])
            elif why == IMPACT:
                self._hit(w)
            elif why in (CHATTER, LOST):
                return int(w.where[STEP])
        if steps:
            self._settle_work()
        return -1

    def _hit(self, w: EventWork) -> None:
        """Impact of rigid contacts, written into the state."""
        from contact.loop.certified import HIT

        hit, closed = np.zeros(w.closed.size, dtype=bool), w.closed.astype(bool)
        hit[w.where[HIT]] = True
        after, impulse, still = impact(self.system, w.q, w.v, closed, hit, self.restitution, self.fastest)
        self.sums.work[:] += 0.5 * impulse * (self.system.N @ (w.v + after))
        w.push[:] += impulse
        w.v[:], w.closed[:] = after, still
        for k in np.flatnonzero((impulse > 0.0) | (closed != still)):
            if w.changes[k] == 0:
                w.change[0, k] = w.at[0]
            w.change[1, k] = w.at[0]
            w.changes[k] += 1 if closed[k] != still[k] else 0 if closed[k] else 2

    def _settle_work(self) -> None:
        """Work of the compliant contacts since the last call: what their compliance has released."""
        now = self._in_compliance()
        self.sums.work[:] += self.squeezed - now
        self.squeezed[:] = now

    def _in_compliance(self) -> Array:
        """Energy stored in the compliance, each contact's share (k,) [J]."""
        w, S = self.work[0], self.system.S
        lam, soft = np.zeros(w.closed.size), np.flatnonzero((w.closed > 0) & ~self.system.rigid)
        if soft.size:
            lam[soft] = -np.linalg.solve(S[np.ix_(soft, soft)], (self.system.clearance + self.system.N @ w.q)[soft])
        return np.asarray(0.5 * lam * (S @ lam))

    def why(self) -> Flag:
        """Explain a failed step."""
        from contact.loop.certified import EVENTS
        from contact.loop.events import MOST_EVENTS

        w = self.work[0]
        if w.where[EVENTS] > MOST_EVENTS:
            words = f"a contact opened and closed over {MOST_EVENTS} times in a step of {self.dt:.4g} s: give it a "
            return Flag(words + "compliance (Penalty), or take a time-stepping scheme", "unconverged", failed=True)
        if not (np.isfinite(w.q).all() and np.isfinite(w.v).all()):
            return Flag("the motion is not finite", "motion-overflow", failed=True)
        return Flag("the time of an opening or closing was not found: take another scheme", "unconverged", failed=True)

    def stored(self) -> Stored:
        """Energy now; that in S and in springs counts as residual."""
        q, v, s = self.work[0].q, self.work[0].v, self.system
        kinetic, strain, potential = 0.5 * float(v @ v), 0.5 * float(q @ s.K @ q), s.potential - float(s.load @ q)
        return Stored(
            kinetic=kinetic, strain=strain, potential=potential, residual=float(self._in_compliance().sum()),
            discrete=kinetic + strain + potential,
        )  # fmt: skip

    def motions(self) -> tuple[Motion, ...]:
        """Mean velocity and momentum of each body from its mode of frequency zero; NaN without one."""
        return rigid_motions(self.system.blocks, self.system.masses, self.system.omega, self.work[0].v)


def event_stepper(system: EventSystem, h: float, restitution: float, words: str) -> EventStepper:
    """Stepper at t = 0: contacts that press are closed; raises InputError for rigid bodies that overlap."""
    gap = system.clearance + system.N @ system.q
    rigid, k = system.rigid, gap.size
    if np.any(gap[rigid] < -1e-9 * np.abs(system.clearance[rigid]).max(initial=0.0)):
        raise InputError(f"clearance: found {gap[rigid].min():g} m at a rigid contact, expected >= 0")
    soft, closed, fastest = np.flatnonzero(~rigid), np.zeros(k, dtype=bool), np.zeros(k)
    closed[soft] = pressing(system.S[np.ix_(soft, soft)], gap[soft]) > 0.0
    v, impulse = np.array(system.v), np.zeros(k)
    if np.any(touching := rigid & (gap <= 0.0)):
        v, impulse, closed = impact(system, system.q, v, closed, touching, restitution, fastest)
    known = Known(system, h)
    work = _work(known, system)
    work.q[:], work.v[:], work.closed[:], work.push[:] = system.q, system.v, closed, impulse
    sums = tally(k)
    sums.work[:] = 0.5 * impulse * (system.N @ (system.v + v))
    work.changes[:] = closed
    of = [f"impacts with e = {restitution:g}"] if rigid.any() else []
    of += [] if rigid.all() else ["compliant contacts"]
    stepper = EventStepper(
        system=system, dt=h, restitution=restitution, label=f"event-driven, {words}, {' and '.join(of)}", sums=sums,
        known=known, work=[work], fastest=fastest, squeezed=np.zeros(k), thrown=v,
    )  # fmt: skip
    stepper.squeezed[:] = stepper._in_compliance()
    return stepper


def _work(known: Known, system: EventSystem) -> EventWork:
    """Arrays of the loop."""
    from contact.loop.certified import PHASE, EventWork

    (k, n), m, r = system.N.shape, known.arrays.lam.shape[2], known.arrays.R.shape[2]
    none: Any = {name: np.zeros(k, int) for name in ("closed", "changes")}
    none |= {name: np.zeros(n) for name in ("q", "v")} | {name: np.zeros((2, m)) for name in ("z", "new", "start")}
    none |= {name: np.zeros(k) for name in ("before", "push", "force", "gap")}
    none |= {name: np.zeros((2, k)) for name in ("size", "now", "then", "change")}
    none |= {name: np.zeros((3, k)) for name in ("poly", "bound")}
    work = EventWork(rigid=system.rigid.astype(int), s=np.zeros((2, r)), at=np.zeros(3), where=np.zeros(6, int), **none)
    work.where[PHASE] = -1
    return work


def _wider(known: Known, w: EventWork) -> EventWork:
    """The same state with space for more poles."""
    m = known.arrays.lam.shape[2]
    return w._replace(z=np.zeros((2, m)), new=np.zeros((2, m)), start=np.zeros((2, m)))
