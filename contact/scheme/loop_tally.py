"""Compiled bookkeeping shared by every step loop: sums, events and samples of one contact."""

from __future__ import annotations

from contact.compiled import jit
from contact.model.arrays import Array
from contact.record import Samples, Tally


@jit
def note_contact(sums: Tally, out: Samples, k: int, h: float, time: float, force: float, gap: float,
                 scale: float, before: float, predicted: float) -> None:  # fmt: skip
    """Add one step of contact k: force at `time`, the law's gap, and `scale` = Delassus number.

    A contact closes where the line from gap `before` to `predicted` crosses zero, and opens half a step after
    the last force.
    """
    sums.penetration[k] = max(sums.penetration[k], -gap)
    sums.residual[k] = max(sums.residual[k], abs(min(force * scale, gap)))
    if force > 0.0:
        sums.impulse[k] += force * h
        sums.peak[k] = max(sums.peak[k], force)
        sums.contact_steps[k] += 1
        if sums.closed[k] == 0:
            part = before / (before - predicted) if before > 0.0 and before > predicted else 0.0
            note_event(sums, out, k, 1, time + part * h)
    elif sums.closed[k] == 1:
        note_event(sums, out, k, 0, time - 0.5 * h)


@jit
def note_event(sums: Tally, out: Samples, k: int, kind: int, time: float) -> None:
    """Append a closing (1) or an opening (0)."""
    sums.closed[k] = kind
    row = sums.filled[2]
    out.event_contact[row] = k
    out.event_kind[row] = kind
    out.event_time[row] = time
    sums.filled[2] = row + 1


@jit
def store(sums: Tally, out: Samples, step: int, time: float, force: Array, gap: Array) -> None:
    """Store force, gap and impulse when this step is to be recorded."""
    if step % out.every == 0:
        row = sums.filled[0]
        out.time[row] = time
        for k in range(force.size):
            out.force[row, k] = force[k]
            out.gap[row, k] = gap[k]
            out.impulse[row, k] = sums.impulse[k]
        sums.filled[0] = row + 1


@jit
def store_state(sums: Tally, out: Samples, step: int, time: float, state: Array) -> None:
    """Store the displacements at the start of this step when they are to be recorded."""
    if out.state_every > 0 and step % out.state_every == 0:
        row = sums.filled[1]
        out.state_time[row] = time
        for i in range(state.size):
            out.state[row, i] = state[i]
        sums.filled[1] = row + 1
