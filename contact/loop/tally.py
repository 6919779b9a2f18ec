"""Compiled sums that every step loop updates: energies, events (also of sticking), samples, limits of motion."""

from __future__ import annotations

import math
from typing import NamedTuple

from contact.base.arrays import Array, Indices
from contact.jit.compiled import jit, jit_inside
from contact.record.record import Samples, Tally
from contact.solver.yielding.yields import Yielding, passed

INSIDE = 1e-9  # of the cone's radius: a force nearer to the edge slips
RANK_ONE = 1e-12


@jit_inside
def closing(h: float, began: float, before: float, predicted: float) -> float:
    """Time at which the line from gap `before` at time `began` to `predicted` one step later crosses zero.

    The result is limited to the step of the force, and to the run, which may begin closed.
    """
    part = before / (before - predicted) if before > 0.0 and before > predicted else 0.0
    return max(began + min(part, 1.0) * h, 0.0)


@jit_inside
def note_step(sums: Tally, out: Samples, k: int, h: float, force: float, gap: float, slack: float,
              began: float, before: float, predicted: float, opened: float) -> None:  # fmt: skip
    """Add one step of contact k: its force, its gap, and the violation of the law `slack` [m].

    The closing time is that of `closing`; the opening time is `opened`.
    """
    sums.penetration[k] = max(sums.penetration[k], -gap)
    sums.residual[k] = max(sums.residual[k], slack)
    if force > 0.0:
        sums.impulse[k] += force * h
        sums.peak[k] = max(sums.peak[k], force)
        sums.contact_steps[k] += 1
        if sums.closed[k] == 0:
            note_event(sums, out, k, 1, closing(h, began, before, predicted))
    elif sums.closed[k] == 1:
        note_event(sums, out, k, 0, opened)


@jit_inside
def note_contact(sums: Tally, out: Samples, k: int, h: float, time: float, force: float, gap: float,
                 scale: float, before: float, predicted: float) -> None:  # fmt: skip
    """Add one step whose force acts at `time` on the gap one step later; `scale` = Delassus number.

    The contact opens half a step after the last force.
    """
    slack = abs(min(force * scale, gap))
    note_step(sums, out, k, h, force, gap, slack, time, before, predicted, time - 0.5 * h)


@jit_inside
def note_yielding(sums: Tally, out: Samples, y: Yielding, k: int, h: float, time: float, force: float, gap: float,
                  depth: float, before: float, predicted: float) -> None:  # fmt: skip
    """Like `note_contact`, for a contact whose force depends on its depth: the penetration error is gap + depth."""
    slack = abs(gap + depth) if depth > 0.0 or force > 0.0 else max(-gap, 0.0)
    passed(y, k, -gap)
    note_step(sums, out, k, h, force, gap, slack, time, before, predicted, time - 0.5 * h)


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
def note_stick(sums: Tally, out: Samples, k: int, stuck: int, time: float) -> None:
    """Append the beginning (3) or end (2) of sticking if contact k changes between stick and slip."""
    if sums.stuck[k] != stuck:
        sums.stuck[k] = stuck
        row = sums.filled[2]
        out.event_contact[row], out.event_kind[row], out.event_time[row] = k, 2 + stuck, time
        sums.filled[2] = row + 1


@jit_inside
def due(step: int, every: int, at: Indices, filled: int) -> bool:
    """Whether a step is stored: it is the next of `at`, or every `every`-th."""
    return bool(step % every == 0) if every > 0 else bool(filled < at.size and at[filled] == step)


@jit_inside
def store(sums: Tally, out: Samples, step: int, time: float, force: Array, gap: Array) -> None:
    """Store force, gap and impulse if this step is to be stored."""
    row = sums.filled[0]
    if due(step, out.every, out.at, row):
        out.time[row] = time
        for k in range(force.size):
            out.force[row, k] = force[k]
            out.gap[row, k] = gap[k]
            out.impulse[row, k] = sums.impulse[k]
        sums.filled[0] = row + 1


@jit_inside
def state_due(sums: Tally, out: Samples, step: int) -> bool:
    """Whether the displacements at the start of this step are to be stored."""
    return bool((out.every == 0 or out.state_every > 0) and due(step, out.state_every, out.at, sums.filled[1]))


@jit_inside
def store_state(sums: Tally, out: Samples, step: int, time: float, state: Array) -> None:
    """Store the displacements, or their channels, at the start of this step if they are to be stored."""
    row = sums.filled[1]
    if state_due(sums, out, step):
        out.state_time[row] = time
        if out.rows.shape[0] == 0:
            for i in range(state.size):
                out.state[row, i] = state[i]
        for c in range(out.rows.shape[0]):
            total = 0.0
            for i in range(state.size):
                total += out.rows[c, i] * state[i]
            out.state[row, c] = total
        sums.filled[1] = row + 1


class Sticking(NamedTuple):
    """Data of the last steps for stick-slip events: slips (2, d k), the later first; sticking force over cone radius.

    Times.
    """

    slip: Array
    hold: Array  # (k,)
    pressed: Array  # (k,), normal force
    since: Array  # (k,), when the contact began to stick


@jit
def note_sticking(past: Sticking, sums: Tally, out: Samples, i: int, time: float, h: float, mu: float, W: Array,
                  lam: Array, slip: Array) -> None:  # fmt: skip
    """Record where contact i changes between stick and slip in the step of `time`, and keep data for the next step.

    Slips u_n of the step after t_n are velocities at t_n + h/2, forces act at t_n. Sticking begins where the slip
    velocity of the last two steps, continued, is zero. It ends where the force that would keep the slip velocity
    unchanged, force_T - W_TT^-1 (u_n - u_{n-1}) with the other contacts' forces unchanged, crosses the cone mu
    force_N.

    W (d k, d k), forces lam and slips of this step, relative to the ground.
    """
    dim = lam.size // past.hold.size
    row = i * dim
    before, last = past.slip[1], past.slip[0]
    radius, pull, speed, older = mu * lam[row], 0.0, 0.0, 0.0
    for j in range(row + 1, row + dim):
        pull += lam[j] * lam[j]
        speed += last[j] * last[j]
        older += before[j] * last[j]
        before[j] = slip[j]  # the slip of this step, from here
    stuck = 1 if lam[row] > 0.0 and math.sqrt(pull) < radius * (1.0 - INSIDE) else 0
    hold = holding(W, row, dim, lam, before, last) / radius if lam[row] > 0.0 else math.inf
    when = time
    if stuck == 1 and sums.stuck[i] == 0:
        if past.pressed[i] > 0.0 and older > speed > 0.0:
            when += h * (min(speed / (older - speed), 1.0) - 0.5)
        past.since[i] = when
    elif stuck == 0 and sums.stuck[i] == 1:
        if lam[row] <= 0.0:
            when -= 0.5 * h
        elif past.hold[i] < 1.0:
            when += h * (min((1.0 - past.hold[i]) / (hold - past.hold[i]), 1.0) - 1.0)
        else:  # it turned without a rest
            when = past.since[i]
        when = max(when, past.since[i])
    note_stick(sums, out, i, stuck, when)
    past.hold[i], past.pressed[i] = hold, lam[row]
    for j in range(row + 1, row + dim):
        before[j], last[j] = last[j], before[j]


@jit
def holding(W: Array, row: int, dim: int, lam: Array, slip: Array, last: Array) -> float:
    """Force that keeps the slip velocity unchanged: |force_T - W_TT^-1 (slip - last)|."""
    i = row + 1
    if dim == 2:
        return float(abs(lam[i] - (slip[i] - last[i]) / W[i, i]))
    x, y = slip[i] - last[i], slip[i + 1] - last[i + 1]
    det = W[i, i] * W[i + 1, i + 1] - W[i, i + 1] * W[i + 1, i]
    if det <= RANK_ONE * W[i, i] * W[i + 1, i + 1]:  # motion along one line: the inverse there is 1/trace
        trace = W[i, i] + W[i + 1, i + 1]
        return math.hypot(lam[i] - x / trace, lam[i + 1] - y / trace)
    across = lam[i] - (W[i + 1, i + 1] * x - W[i, i + 1] * y) / det
    return math.hypot(across, lam[i + 1] - (W[i, i] * y - W[i + 1, i] * x) / det)
