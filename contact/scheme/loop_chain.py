"""Compiled step loops of the lumped chain: rigid contact by Lagrange multiplier, or penalty."""

from __future__ import annotations

from typing import NamedTuple

from contact.compiled import jit
from contact.model.arrays import Array, Indices
from contact.record import Samples, Tally
from contact.scheme.loop_tally import note_contact, store, store_state
from contact.solver.scalar import scalar_force


class ChainState(NamedTuple):
    """u_n, D = u_n - u_{n-1}, and what a step needs: K contacts, N nodes, N + 1 spring forces."""

    u: Array
    d: Array
    spring: Array
    stiffness: Array
    rate: Array  # h^2/m, zero where held
    load: Array
    left: Indices
    clearance: Array
    force: Array
    gap: Array
    before: Array


@jit
def free_step(s: ChainState) -> None:
    """D <- D + h^2 M^-1 (f - K u), two contiguous passes."""
    n = s.u.size
    for i in range(n - 1):
        s.spring[i + 1] = s.stiffness[i] * (s.u[i + 1] - s.u[i])
    for i in range(n):
        s.d[i] += s.rate[i] * (s.load[i] + s.spring[i + 1] - s.spring[i])


@jit
def advance_lagrange(s: ChainState, sums: Tally, out: Samples, h: float, first: int, steps: int) -> int:
    """Forward increment Lagrange multipliers: the force at t_n closes no gap at t_{n+1}."""
    for step in range(first, first + steps):
        store_state(sums, out, step, step * h, s.u)
        for k in range(s.left.size):
            a = s.left[k]
            s.before[k] = s.d[a + 1] - s.d[a]
        free_step(s)
        for k in range(s.left.size):
            a = s.left[k]
            old = s.clearance[k] + (s.u[a + 1] - s.u[a])
            gap = s.clearance[k] + ((s.u[a + 1] + s.d[a + 1]) - (s.u[a] + s.d[a]))
            H = s.rate[a] + s.rate[a + 1]
            force = 0.0
            if not gap >= 0.0:
                force = scalar_force(H, gap)
                if not force >= 0.0:
                    return step
            s.d[a] -= s.rate[a] * force
            s.d[a + 1] += s.rate[a + 1] * force
            after = s.clearance[k] + ((s.u[a + 1] + s.d[a + 1]) - (s.u[a] + s.d[a]))
            sums.work[k] += 0.5 * force * (s.before[k] + s.d[a + 1] - s.d[a])
            note_contact(sums, out, k, h, step * h, force, after, H, old, gap)
            s.force[k] = force
            s.gap[k] = after
        for i in range(s.u.size):
            s.u[i] += s.d[i]
        store(sums, out, step, step * h, s.force, s.gap)
    return -1


@jit
def advance_penalty(
    s: ChainState, sums: Tally, out: Samples, h: float, first: int, steps: int, stiffness: float
) -> int:
    """Explicit penalty: the force at t_n is stiffness <-g_n>."""
    for step in range(first, first + steps):
        store_state(sums, out, step, step * h, s.u)
        for k in range(s.left.size):
            a = s.left[k]
            s.before[k] = s.d[a + 1] - s.d[a]
            s.gap[k] = s.clearance[k] + (s.u[a + 1] - s.u[a])
            if s.gap[k] != s.gap[k]:
                return step
        free_step(s)
        for k in range(s.left.size):
            a = s.left[k]
            force = stiffness * max(-s.gap[k], 0.0)
            s.d[a] -= s.rate[a] * force
            s.d[a + 1] += s.rate[a + 1] * force
            sums.work[k] += 0.5 * force * (s.before[k] + s.d[a + 1] - s.d[a])
            note_contact(sums, out, k, h, step * h, force, s.gap[k], 1.0 / stiffness, s.gap[k] - s.before[k], s.gap[k])
            s.force[k] = force
        for i in range(s.u.size):
            s.u[i] += s.d[i]
        store(sums, out, step, step * h, s.force, s.gap)
    return -1
