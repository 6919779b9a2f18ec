"""Compiled leapfrog steps on a linear problem: A (D_{n+1} - D_n) = f - K u_n - C D_n/h + Q^T force.

A = M/h^2 + C/(2 h); one loop, four contact rules, and a loop for contact coordinates without mass. Energy
D^T M D/(2 h^2) + u_{n-1}^T K u_n/2 changes by the work of the forces along (D_n + D_{n+1})/2, exactly.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from contact.base.arrays import Array, Indices
from contact.jit.compiled import jit, jit_entry
from contact.loop.linear.linear import (
    Parts,
    State,
    add_product,
    add_response,
    add_varying,
    along,
    damping_work,
    gap_of,
    solve_in_place,
    varying_work,
)
from contact.loop.tally import note_step, store, store_state
from contact.record.record import Samples, Tally
from contact.solver.unilateral.complementarity import LawNumbers, contact_forces

FORWARD, IMPULSE, AVERAGED, SPRING = 0, 1, 2, 3


@jit
def free_increment(p: Parts, s: State, h: float, amplitudes: Array, d: Array, work: Array) -> None:
    """Overwrite d by A^-1 (f - K u - C D/h); A is lumped unless damping couples coordinates."""
    for i in range(d.size):
        d[i] = p.load[i]
    add_varying(p, 1.0, amplitudes, d)
    add_product(p.K, -1.0, s.u, d, work)
    if p.damped:
        add_product(p.C, -1.0 / h, s.v, d, work)
    solve_in_place(p.A, d)


@jit
def law_gap(rule: int, e: float, now: float, was: float, will: float) -> float:
    """Quantity [m] that the contact rule keeps nonnegative.

    `was` and `will` are the last and next increments of the gap.
    """
    if rule == FORWARD:
        return now + will
    if rule == AVERAGED:
        return now + (will - e * was) / (1.0 + e)
    if rule == IMPULSE:
        return math.inf if now > 0.0 else will + e * was
    return now


@jit_entry
def advance_leapfrog(
    p: Parts, s: State, sums: Tally, out: Samples, amplitudes: Array, h: float, first: int, steps: int,
    law: LawNumbers, rule: int, e: float,
) -> int:  # fmt: skip
    """Take steps first .. first + steps - 1; returns -1, or the step that failed."""
    n, contacts = s.u.size, s.force.size
    d, rate, spare, mean, work = s.spare[0], s.spare[1], s.spare[2], s.spare[3], s.work
    g, shifted = s.free, s.shifted
    share = 1.0 / (1.0 + e) if rule == AVERAGED else 1.0  # of the force's opening that the rule counts
    for step in range(first, first + steps):
        load = amplitudes[step - first]
        store_state(sums, out, step, step * h, s.u)
        free_increment(p, s, h, load, d, work)
        for k in range(contacts):
            was = along(p, k, s.v)
            g[k] = law_gap(rule, e, gap_of(p, k, s.u), was, was + along(p, k, d)) / share
        if rule == SPRING:
            for k in range(contacts):
                if g[k] != g[k]:
                    return step
                s.force[k] = law.stiffness * max(-g[k], 0.0)
        elif not contact_forces(p.W, law, g, s.force, s.closed, s.square, shifted):
            return step
        for k in range(contacts):
            shifted[k] = along(p, k, d)
        add_response(p, 1.0, s.force, d)
        note_leapfrog(p, s, law, rule, e, share, shifted, d, sums, out, step * h, h)
        if p.damped or load.size > 0:
            for i in range(n):
                mean[i] = s.v[i] + 0.5 * d[i]
                rate[i] = mean[i] / h
            sums.damping[0] += damping_work(p, mean, rate, spare, work)
            sums.external[0] += varying_work(p, load, load, mean, spare)
        for i in range(n):
            s.v[i] += d[i]
            s.u[i] += s.v[i]
        store(sums, out, step, step * h, s.force, s.gap)
    return -1


@jit
def note_leapfrog(
    p: Parts, s: State, law: LawNumbers, rule: int, e: float, share: float, free: Array, d: Array, sums: Tally,
    out: Samples, time: float, h: float,
) -> None:  # fmt: skip
    """Record work, gaps and events of the contacts; `free` = increments of D along the gaps without contact force."""
    early = rule == IMPULSE or rule == SPRING  # these read the gap at t_n, the others a step ahead
    for k in range(s.force.size):
        now, was = gap_of(p, k, s.u), along(p, k, s.v)
        will = was + along(p, k, d)
        sums.work[k] += 0.5 * s.force[k] * (was + will)
        held = law_gap(rule, e, now, was, will)
        scale = 1.0 / law.stiffness if rule == SPRING else share * p.W[k, k]
        slack = abs(min(s.force[k] * scale, held))
        s.gap[k] = now if early else held
        if early:
            note_step(sums, out, k, h, s.force[k], now, slack, time - h, now - was, now, time - 0.5 * h)
        else:
            ahead = now + was + free[k]
            note_step(sums, out, k, h, s.force[k], now + will, slack, time, now, ahead, time - 0.5 * h)


class Massless(NamedTuple):
    """The m massless coordinates: their indices, rows of K as short lists, compliance and lift."""

    place: Indices  # (m,)
    near: Indices  # (m, w), columns of K other than the diagonal
    stiff: Array  # (m, w)
    ground: Array  # (m,), row sums
    flex: Array  # (m, m), K_cc^-1
    lift: Array  # (k, m), Q_c K_cc^-1
    S: Array  # (k, k), Q_c K_cc^-1 Q_c^T
    residual: Array  # (m,), scratch
    force: Array  # (k,), scratch


@jit_entry
def settle(p: Parts, c: Massless, s: State, law: LawNumbers, amplitudes: Array) -> bool:
    """Move the massless coordinates to static equilibrium under loads, springs and contact.

    S.force is the contact force.
    """
    for m in range(c.place.size):
        i = c.place[m]
        total = p.load[i] - c.ground[m] * s.u[i]
        for j in range(amplitudes.size):
            total += amplitudes[j] * p.shapes[j, i]
        for j in range(c.near.shape[1]):
            total -= c.stiff[m, j] * (s.u[c.near[m, j]] - s.u[i])
        c.residual[m] = total
    for m in range(c.place.size):
        for j in range(c.place.size):
            s.u[c.place[m]] += c.flex[m, j] * c.residual[j]
    for k in range(s.force.size):
        s.free[k] = gap_of(p, k, s.u)
    if not contact_forces(c.S, law, s.free, s.force, s.closed, s.square, s.shifted):
        return False
    for k in range(s.force.size):
        for m in range(c.place.size):
            s.u[c.place[m]] += c.lift[k, m] * s.force[k]
    for k in range(s.force.size):  # all forces move it
        s.gap[k] = gap_of(p, k, s.u)
    return True


@jit_entry
def advance_massless(
    p: Parts, s: State, sums: Tally, out: Samples, amplitudes: Array, h: float, first: int, steps: int,
    law: LawNumbers, c: Massless,
) -> int:  # fmt: skip
    """Steps whose contact coordinates have no mass: they follow the other coordinates statically, with the contact.

    Others: M (D_{n+1} - D_n)/h^2 = f - K u_n + Q^T force_n; then K_cc u_c = f_c - K_cm u_m + Q_c^T force_{n+1} with
    g_{n+1} >= 0. The force stored at t_n belongs to the gap at t_n.
    """
    n, contacts = s.u.size, s.force.size
    d, mean, rate, spare, old = s.spare[0], s.spare[1], s.spare[2], s.spare[3], s.spare[4]
    for step in range(first, first + steps):
        load = amplitudes[step - first]
        store_state(sums, out, step, step * h, s.u)
        for k in range(contacts):
            before = s.gap[k] - along(p, k, s.v)
            slack = abs(min(s.force[k] * c.S[k, k], s.gap[k]))
            note_step(sums, out, k, h, s.force[k], s.gap[k], slack, step * h - h, before, s.free[k], step * h - 0.5 * h)
            c.force[k] = s.force[k]
        store(sums, out, step, step * h, s.force, s.gap)
        free_increment(p, s, h, load, d, s.work)
        add_response(p, 1.0, s.force, d)
        for m in range(c.place.size):
            d[c.place[m]] = 0.0
        for i in range(n):
            old[i] = s.u[i]
            s.u[i] += s.v[i] + d[i]
        if not settle(p, c, s, law, amplitudes[step - first + 1]):
            return step
        for i in range(n):
            d[i] = s.u[i] - old[i]
            mean[i] = 0.5 * (s.v[i] + d[i])
            rate[i] = mean[i] / h
            s.v[i] = d[i]
        for k in range(contacts):
            sums.work[k] += c.force[k] * along(p, k, mean)
        sums.damping[0] += damping_work(p, mean, rate, spare, s.work)
        sums.external[0] += varying_work(p, load, load, mean, spare)
    return -1
