"""Compiled step loop of the discrete gradient law on exact, undamped modal propagation."""

from __future__ import annotations

import math
from typing import NamedTuple

from contact.base.arrays import Array
from contact.jit.compiled import jit, jit_entry
from contact.loop.tally import note_contact, store, store_state
from contact.record.record import Samples, Tally


class EnergyState(NamedTuple):
    """q and v at t_n (m,), cos and sin terms of one step, `memory` = (elastic gap, force)."""

    q: Array
    v: Array
    cos: Array
    drift: Array  # sin(omega h)/omega
    pull: Array  # -omega sin(omega h)
    lift: Array  # (1 - cos(omega h))/omega^2: displacement by a constant unit force
    load: Array
    memory: Array
    force: Array
    gap: Array


@jit
def next_gap(b: float, S: float, now: float, free: float) -> float:
    """Elastic gap x after the step: (x - free)/b = -(phi(x) - phi(now))/(x - now), phi = <-g>^2/(2 S)."""
    if now < 0.0:
        x = (free / b - 0.5 * now / S) / (1.0 / b + 0.5 / S)
        if x < 0.0:
            return x
        half = 0.5 * (free + now)
        return half + math.sqrt(max(half * half - free * now + 0.5 * b * now * now / S, 0.0))
    a, p = 2.0 * S + b, S * (free + now)
    return (p - math.sqrt(max(p * p - 2.0 * a * S * free * now, 0.0))) / a


@jit_entry
def advance_energy(
    s: EnergyState, Q: Array, clearance: float, S: float, b: float,
    sums: Tally, out: Samples, h: float, first: int, steps: int,
) -> int:  # fmt: skip
    """Steps with a force constant over each step; work of contact = -(phi_{n+1} - phi_n), exactly."""
    now = s.memory[0]
    for step in range(first, first + steps):
        store_state(sums, out, step, step * h, s.q)
        free = clearance
        for i in range(Q.size):
            q, v = s.q[i], s.v[i]
            s.q[i] = s.cos[i] * q + s.drift[i] * v + s.lift[i] * s.load[i]
            s.v[i] = s.pull[i] * q + s.cos[i] * v + s.drift[i] * s.load[i]
            free += Q[i] * s.q[i]
        force, after = 0.0, free
        if free != free:
            return step
        if free < 0.0 or now < 0.0:
            after = next_gap(b, S, now, free)
            force = max((after - free) / b, 0.0)
            for i in range(Q.size):
                s.q[i] += s.lift[i] * Q[i] * force
                s.v[i] += s.drift[i] * Q[i] * force
        sums.work[0] += force * (after - now)
        s.gap[0] = 0.5 * (after + now) + S * force
        s.force[0] = force
        note_contact(sums, out, 0, h, step * h, force, s.gap[0], b + S, now, after)
        now = after
        store(sums, out, step, (step + 0.5) * h, s.force, s.gap)
    s.memory[0] = now
    return -1
