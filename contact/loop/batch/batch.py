"""Compiled step loop of eight rotating rims with one tip at once; the runs ("slots") are the innermost index.

Each slot has its own step, skips free flight and ends independently. No sum runs across slots, so that a run's numbers
do not depend on its neighbours.
"""

from __future__ import annotations

from contact.base.arrays import Array
from contact.jit.compiled import jit, jit_inside, jit_vectors
from contact.jit.vector import WIDTH, load, put, same
from contact.loop.batch.step import add_up, fly, move_slots, touch
from contact.loop.batch.waves import (
    BEFORE,
    DRAG,
    FORCE,
    FREE,
    GAP,
    H_,
    PULL,
    SCALE,
    SLIDE,
    T_N,
    T_T,
    BatchFreeFlight,
    BatchSamples,
    BatchState,
    land,
    rotate_slots,
    skip_in_batch,
)
from contact.loop.rub.deflection import add_waves, matters, note_deflection, strained
from contact.loop.tally import INSIDE, closing, note_event, note_stick
from contact.model.gaps.limits import LOOK, REACHED, RIM, TIP
from contact.record.record import Samples, Tally


@jit_inside
def note_slot(s: BatchState, sums: Tally, out: Samples, kept: BatchSamples, before: float, k: int) -> None:
    """Record events and samples of one step of slot k; `before` is the previous gap."""
    force, h, step = s.work[FORCE, k], s.h[k], s.step[k]
    if s.mu[k] > 0.0 and (force > 0.0 or sums.closed[k] == 1):
        along = 0.0
        for i in range(s.casing[k], s.q.shape[0]):
            along += s.T[i, k] * s.q[i, k]
        s.peaks[k] = max(s.peaks[k], abs(along))
    if force > 0.0:
        sums.contact_steps[k] += 1
        if s.mu[k] > 0.0 and s.work[PULL, k] * s.surface[k] < 0.0 and abs(s.work[PULL, k]) == s.mu[k]:
            sums.reversals[k] += 1
        if sums.closed[k] == 0:
            note_event(sums, out, k, 1, closing(h, step * h, before, s.work[FREE, k]))
    elif sums.closed[k] == 1:
        note_event(sums, out, k, 0, step * h - 0.5 * h)
    if s.mu[k] > 0.0:
        stuck = force > 0.0 and abs(s.work[PULL, k]) < s.mu[k] * (1.0 - INSIDE)
        note_stick(sums, out, k, int(stuck), step * h)
    if step == kept.due[0, k]:
        row = kept.filled[0, k]
        kept.time[k, row], kept.force[k, row], kept.gap[k, row] = step * h, force, s.work[GAP, k]
        kept.impulse[k, row] = sums.impulse[k]
        kept.filled[0, k] += 1
        kept.due[0, k] += kept.every[0, k]


@jit_inside
def slot_too_far(limits: Array, k: int) -> bool:
    """Whether the rim's deflection or the tip's motion in slot k exceeds its limit, as in `outgrown`."""
    return not (limits[REACHED + RIM, k] <= limits[RIM, k] and limits[REACHED + TIP, k] <= limits[TIP, k])


@jit_inside
def note_slot_rim(s: BatchState, waves: Array, k: int, ends: bool) -> None:
    """Update the largest deflection of the rim in slot k from q and the forces of this step."""
    normal, tangent, bound = s.work[FORCE, k], -s.work[DRAG, k], 0.0
    for i in range(s.casing[k]):
        bound += s.reach[i, k] * abs(s.q[i, k])
    bound += s.soft[0, k] * abs(normal) + s.soft[1, k] * abs(tangent)
    if matters(s.limits[:, k], bound, ends):
        n = min(1, waves.shape[0] - 1)
        note_slot_line(s, waves[n, 0, k], waves[n, 1, k], normal, tangent, k, ends)


@jit
def note_slot_line(s: BatchState, c: float, t: float, normal: float, tangent: float, k: int,
                   ends: bool) -> None:  # fmt: skip
    """Update the largest deflection in slot k whose tip is at the angle with this cosine and sine."""
    rim, own = s.rim, min(k, s.rim.rows.shape[0] - 1)
    for a in range(rim.z.size):
        part = 0.0
        for i in range(s.casing[k]):
            part += rim.rows[own, a, i] * s.q[i, k]
        rim.z[a] = part
    if rim.S.size > 0:
        rim.force[:] = 0.0
        add_waves(rim.force[0], rim.z.size // 2, normal, c, t)
        if rim.force.shape[0] > 1:
            add_waves(rim.force[1], rim.z.size // 2, tangent, c, t)
        strained(rim, own)
    note_deflection(s.limits[:, k], rim, ends)


@jit_inside
def keep_state(s: BatchState, kept: BatchSamples, k: int) -> None:
    """Store the displacements of slot k at the start of a step at which storage is due, and the forces of that step."""
    if s.step[k] == kept.due[1, k]:
        row = kept.filled[1, k]
        kept.state_time[k, row] = s.step[k] * s.h[k]
        for i in range(s.q.shape[0]):
            kept.state[k, row, i] = s.q[i, k]
        kept.state[k, row, s.q.shape[0]] = s.work[FORCE, k]
        if kept.state.shape[2] > s.q.shape[0] + 1:
            kept.state[k, row, s.q.shape[0] + 1] = -s.work[DRAG, k]
        kept.filled[1, k] += 1
        kept.due[1, k] += kept.every[1, k]


@jit_vectors
def advance_batch(
    s: BatchState, flights: BatchFreeFlight, sums: Tally, out: Samples, kept: BatchSamples, rubs: bool, budget: int
) -> None:
    """Step all active slots until one ends or fails, or `budget` steps are taken."""
    old, new, Q, Q_next, waves, ahead = s.old, s.d, s.Q, s.Q_next, s.waves, s.waves_next
    skips, swapped, landed = flights.powers.shape[1] > 0, False, 0
    for k in range(s.step.size):
        landed |= int(s.live[k] == 1 and s.step[k] == 0) << k
    for _ in range(budget):
        stop = False
        for k in range(s.step.size):
            if s.live[k] == 1:
                if skips and s.step[k] >= s.retry[k] and s.memory[0, k] > 0.0 and s.memory[1, k] > 0.0:
                    room = min(s.end[k], kept.due[0, k], kept.due[1, k]) - s.step[k]
                    skipped = -1 if room <= 0 or sums.closed[k] == 1 else 0
                    if skipped == 0:
                        skipped = skip_in_batch(s, flights, sums, new, k, room)
                        landed |= int(skipped > 0) << k
                    s.retry[k] = s.step[k] + max(1, -skipped)  # not twice at one step if the loop ends here
                stop = stop or s.step[k] == s.end[k]
        if landed > 0:
            land(s, Q, Q_next, waves, ahead, new, landed)
            landed = 0
        if stop:
            break
        old, new, swapped = new, old, not swapped
        rotate_slots(s, ahead, 1)
        touching = fly(s, Q_next, ahead, old, new)
        for row in (FORCE, PULL, DRAG, H_, SLIDE, T_N, T_T):
            put(s.work, row * WIDTH, same(0.0))
        put(s.work, SCALE * WIDTH, same(1.0))
        if touching:
            touch(s, Q, Q_next, waves, new, rubs)
        for k in range(s.step.size):
            if s.live[k] == 1:
                if s.step[k] == kept.due[1, k] or s.step[k] % LOOK == 0:
                    note_slot_rim(s, waves, k, s.step[k] % LOOK == 0)
                keep_state(s, kept, k)
        move_slots(s, Q, old, new, touching, rubs)
        put(s.work, BEFORE * WIDTH, load(s.memory, 0))
        far = add_up(s, sums, Q, Q_next)
        for k in range(s.step.size):
            if s.live[k] == 1 and s.failed[k] == 0:
                note_slot(s, sums, out, kept, s.work[BEFORE, k], k)
                if far and slot_too_far(s.limits, k):
                    s.failed[k] = 2
                s.step[k] += 1
            stop = stop or (s.live[k] == 1 and (s.failed[k] > 0 or s.step[k] == s.end[k]))
        Q, Q_next, waves, ahead = Q_next, Q, ahead, waves
        if stop:
            break
    if swapped:  # the buffers were exchanged an odd number of times; nothing is recomputed, so that no bit changes
        for i in range(s.q.shape[0]):
            put(s.d, i * WIDTH, load(s.old, i * WIDTH))
        for i in range(s.Q.shape[0]):
            put(s.Q, i * WIDTH, load(s.Q_next, i * WIDTH))
        for n in range(2 * s.waves.shape[0]):
            put(s.waves, n * WIDTH, load(s.waves_next, n * WIDTH))
