"""What is noted of a lane at a step: events, samples, states, and whether its rim has moved too far."""

from __future__ import annotations

from contact.jit.compiled import jit_inside
from contact.loop.batch.state import DRAG, FORCE, FREE, GAP, PULL, BatchSamples, BatchState
from contact.loop.modal.stick import INSIDE
from contact.loop.tally import closing, note_event, note_stick
from contact.model.gaps.limits import REACHED, RIM, TIP
from contact.record.record import Samples, Tally


@jit_inside
def note_lane(s: BatchState, sums: Tally, out: Samples, kept: BatchSamples, before: float, k: int) -> None:
    """Events and samples of one step of lane k; the gap was `before`."""
    force, h, step = s.work[FORCE, k], s.h[k], s.step[k]
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
def rim_too_far(s: BatchState, k: int) -> bool:
    """Note the rim's deflection in lane k, as `rim_amplitude`; whether that or the tip's motion passes its limit."""
    limits, total = s.limits, 0.0
    for i in range(s.q.shape[0]):
        total += (s.reach[i, k] * s.q[i, k]) ** 2
    limits[REACHED + RIM, k] = max(limits[REACHED + RIM, k], total**0.5)
    return not (limits[REACHED + RIM, k] <= limits[RIM, k] and limits[REACHED + TIP, k] <= limits[TIP, k])


@jit_inside
def keep_state(s: BatchState, kept: BatchSamples, k: int) -> None:
    """Store the displacements of lane k at the start of a step that is due, and the forces of that step."""
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
