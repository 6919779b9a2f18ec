"""Compiled run from event to event: openings and closings that `contact.loop.certified` finds, samples on a grid."""

from __future__ import annotations

import math

from contact.jit.compiled import jit, jit_entry
from contact.loop.certified import (
    COUNT,
    EVENTS,
    HIT,
    INSIDE,
    PHASE,
    STEP,
    EventWork,
    Phases,
    bounds,
    damped,
    displaced,
    move,
    near,
    primitive,
    travel,
)
from contact.loop.phase import number_of
from contact.loop.tally import due, note_event, state_due, store, store_state
from contact.record.record import Samples, Tally

DONE, UNKNOWN, IMPACT, CHATTER, LOST = range(5)
MOST_EVENTS = 1000  # in a step


@jit
def leave(p: Phases, w: EventWork, sums: Tally, phase: int) -> None:
    """End the phase here: state, impulse of the closed contacts, work of damping."""
    displaced(p, w, phase)
    pressed(p, w, phase)
    if p.loss.shape[2] > 0:
        sums.damping[0] += damped(p, w, phase)
    w.at[0] += w.at[1]
    w.at[1] = 0.0


@jit
def enter(p: Phases, w: EventWork, phase: int) -> None:
    """Begin a phase with the present state."""
    n, T = w.q.size, 0.0
    for i in range(w.z.shape[1]):
        re, im = 0.0, 0.0
        for j in range(n):
            x = w.q[j] - p.rest[phase, j]
            re += p.U[phase, 0, i, j] * x + p.U[phase, 0, i, n + j] * w.v[j]
            im += p.U[phase, 1, i, j] * x + p.U[phase, 1, i, n + j] * w.v[j]
        w.start[0, i], w.start[1, i] = re, im
    for i in range(p.R.shape[2]):
        w.s[0, i], w.s[1, i] = 0.0, 0.0
        for j in range(n):
            w.s[0, i] += p.R[phase, j, i] * (w.q[j] - p.rest[phase, j])
            w.s[1, i] += p.R[phase, j, i] * w.v[j]
    for row in range(w.closed.size):
        a, b, c = p.level[phase, row], 0.0, 0.0
        for i in range(p.R.shape[2]):
            moved = p.moved[phase, row, i]
            a += moved * w.s[0, i]
            b += moved * w.s[1, i]
            c += moved * p.pull[phase, i]
        w.poly[0, row], w.poly[1, row], w.poly[2, row] = a, b, c
    w.where[COUNT] = 0
    move(p, w, phase, T)
    bounds(p, w, phase)
    for row in range(w.closed.size):
        w.before[row] = primitive(p.rows[phase], w.poly, w.z, T, row) if w.closed[row] else 0.0


@jit
def pressed(p: Phases, w: EventWork, phase: int) -> None:
    """Add the impulses of the closed contacts since the last call."""
    for row in range(w.closed.size):
        if w.closed[row]:
            reached = primitive(p.rows[phase], w.poly, w.z, w.at[1], row)
            w.push[row] += reached - w.before[row]
            w.before[row] = reached


@jit
def note_changes(w: EventWork, sums: Tally, out: Samples) -> None:
    """Store the openings and closings of a step: at most the first and the last of each contact."""
    for k in range(w.changes.size):
        if w.changes[k] > 0:
            if w.changes[k] % 2 == 0:
                note_event(sums, out, k, 1 - sums.closed[k], w.change[0, k])
            note_event(sums, out, k, 1 - sums.closed[k], w.change[1, k])
            w.changes[k] = 0


@jit
def close_step(w: EventWork, sums: Tally, out: Samples, step: int, h: float) -> None:
    """Mean force and last gap of a step, its sums and events, its sample."""
    for k in range(w.closed.size):
        force = w.push[k] / h
        gap = 0.0 if w.closed[k] else w.now[0, k]
        w.force[k], w.gap[k], w.push[k] = force, gap, 0.0
        sums.penetration[k] = max(sums.penetration[k], -gap)
        sums.residual[k] = max(sums.residual[k], -gap)
        if force > 0.0:
            sums.impulse[k] += force * h
            sums.peak[k] = max(sums.peak[k], force)
            sums.contact_steps[k] += 1
    note_changes(w, sums, out)
    store(sums, out, step, (step + 0.5) * h, w.force, w.gap)


@jit
def changed(w: EventWork, k: int) -> None:
    """Note that contact k opens or closes at the start of the present phase."""
    if w.changes[k] == 0:
        w.change[0, k] = w.at[0]
    w.change[1, k] = w.at[0]
    w.changes[k] += 1


@jit_entry
def advance_events(p: Phases, w: EventWork, sums: Tally, out: Samples, h: float, end: int) -> int:
    """Go on to step `end`; returns DONE, a task for the caller (UNKNOWN phase, IMPACT of `where`) or an error."""
    while w.where[STEP] < end:
        step, phase = w.where[STEP], w.where[PHASE]
        if phase < 0:
            phase = number_of(p.known, p.closed, w.closed)
            if phase < 0:
                return UNKNOWN
            w.where[PHASE] = phase
            enter(p, w, phase)
        if not w.where[INSIDE]:
            if state_due(sums, out, step):
                if not near(w, step * h - w.at[0]):
                    move(p, w, phase, step * h - w.at[0])
                displaced(p, w, phase)
                store_state(sums, out, step, step * h, w.q)
            w.where[INSIDE], w.where[EVENTS] = 1, 0
        until = (step + 1) * h - w.at[0]
        quiet = until <= w.at[2] and w.where[EVENTS] == 0 and step + 1 < end
        if quiet and not due(step, out.every, out.at, sums.filled[0]):
            w.where[STEP], w.where[INSIDE] = step + 1, 0
            continue
        hit = travel(p, w, phase, until, h)
        if hit == -2:
            return LOST
        if hit < 0:
            if not w.now[0, 0] < math.inf:
                return LOST
            pressed(p, w, phase)
            close_step(w, sums, out, step, h)
            w.where[STEP], w.where[INSIDE] = step + 1, 0
            continue
        leave(p, w, sums, phase)
        w.where[EVENTS] += 1
        if w.where[EVENTS] > MOST_EVENTS:
            return CHATTER
        w.where[PHASE] = -1
        if w.rigid[hit] and not w.closed[hit]:
            w.where[HIT] = hit
            return IMPACT
        changed(w, hit)
        w.closed[hit] = 1 - w.closed[hit]
    if w.where[PHASE] >= 0:
        leave(p, w, sums, w.where[PHASE])
        w.where[PHASE] = -1
        w.push[:] = 0.0
    return DONE
