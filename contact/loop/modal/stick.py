"""Compiled: when a contact begins to stick and when it slips again, located within the step.

Slips u_n of the step after t_n are velocities at t_n + h/2, forces act at t_n. Sticking begins where the slip velocity
of the last two steps, continued, is zero. It ends where the force that would hold the slip as it is,
force_T - W_TT^-1 (u_n - u_{n-1}) with the other contacts' forces as they are, crosses the cone mu force_N.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from contact.base.arrays import Array
from contact.jit.compiled import jit
from contact.loop.tally import note_stick
from contact.record.record import Samples, Tally

INSIDE = 1e-9  # of the cone's radius: a force nearer to the edge slips
RANK_ONE = 1e-12


class Sticking(NamedTuple):
    """What the last steps leave: slips (2, d k), the later first; holding force over the cone's radius; instants."""

    slip: Array
    hold: Array  # (k,)
    pressed: Array  # (k,), normal force
    since: Array  # (k,), when the contact began to stick


@jit
def note_sticking(past: Sticking, sums: Tally, out: Samples, i: int, time: float, h: float, mu: float, W: Array,
                  lam: Array, b: Array) -> None:  # fmt: skip
    """Note where contact i changes between stick and slip in the step of `time`, and keep what the next one needs.

    W (d k, d k), forces lam and free slips b of this step; slide is in b.
    """
    dim = lam.size // past.hold.size
    row = i * dim
    before, last = past.slip[1], past.slip[0]
    radius, pull, speed, older = mu * lam[row], 0.0, 0.0, 0.0
    for j in range(row + 1, row + dim):
        pull += lam[j] * lam[j]
        speed += last[j] * last[j]
        older += before[j] * last[j]
        total = b[j]
        for m in range(lam.size):
            total += W[j, m] * lam[m]
        before[j] = total  # the slip of this step, from here
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
    """|force_T - W_TT^-1 (slip - last)|."""
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
