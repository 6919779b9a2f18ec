"""Compiled step loop of eight rotating rims at once: `advance_rim` with the runs, lanes, as innermost index.

Lanes do not wait for each other: each has its own step, skips alone, and ends alone. No sum runs across lanes, so that
a run's numbers do not depend on its neighbours.
"""

from __future__ import annotations

from contact.jit.compiled import jit_vectors
from contact.jit.vector import WIDTH, load, put, same
from contact.loop.batch.note import keep_state, note_lane, rim_too_far
from contact.loop.batch.state import (
    BEFORE,
    DRAG,
    FORCE,
    H_,
    PULL,
    SCALE,
    SLIDE,
    T_N,
    T_T,
    BatchFreeFlight,
    BatchSamples,
    BatchState,
)
from contact.loop.batch.step import add_up, fly, move_lanes, touch
from contact.loop.batch.waves import land, rotate_lanes, skip_in_batch
from contact.model.gaps.limits import LOOK
from contact.record.record import Samples, Tally


@jit_vectors
def advance_batch(
    s: BatchState, flights: BatchFreeFlight, sums: Tally, out: Samples, kept: BatchSamples, rubs: bool, budget: int
) -> None:
    """Step all live lanes, until one is at its end or has failed, or `budget` steps are taken."""
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
                    s.retry[k] = s.step[k] + max(1, -skipped)  # not twice at a step, should the loop be left here
                stop = stop or s.step[k] == s.end[k]
        if landed > 0:
            land(s, Q, Q_next, waves, ahead, new, landed)
            landed = 0
        if stop:
            break
        old, new, swapped = new, old, not swapped
        rotate_lanes(s, ahead, 1)
        touching = fly(s, Q_next, ahead, old, new)
        for row in (FORCE, PULL, DRAG, H_, SLIDE, T_N, T_T):
            put(s.work, row * WIDTH, same(0.0))
        put(s.work, SCALE * WIDTH, same(1.0))
        if touching:
            touch(s, Q, Q_next, waves, new, rubs)
        for k in range(s.step.size):
            if s.live[k] == 1:
                keep_state(s, kept, k)
        move_lanes(s, Q, old, new, touching, rubs)
        put(s.work, BEFORE * WIDTH, load(s.memory, 0))
        far = add_up(s, sums, Q, Q_next)
        for k in range(s.step.size):
            if s.live[k] == 1 and s.failed[k] == 0:
                note_lane(s, sums, out, kept, s.work[BEFORE, k], k)
                if (far or s.step[k] % LOOK == 0) and rim_too_far(s, k):
                    s.failed[k] = 2
                s.step[k] += 1
            stop = stop or (s.live[k] == 1 and (s.failed[k] > 0 or s.step[k] == s.end[k]))
        Q, Q_next, waves, ahead = Q_next, Q, ahead, waves
        if stop:
            break
    if swapped:  # the buffers changed places an odd number of times; nothing is computed anew, not to change a bit
        for i in range(s.q.shape[0]):
            put(s.d, i * WIDTH, load(s.old, i * WIDTH))
        for i in range(s.Q.shape[0]):
            put(s.Q, i * WIDTH, load(s.Q_next, i * WIDTH))
        for n in range(2 * s.waves.shape[0]):
            put(s.waves, n * WIDTH, load(s.waves_next, n * WIDTH))
