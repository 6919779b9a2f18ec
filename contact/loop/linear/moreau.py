"""Compiled steps of the schemes with an impact law on velocities over each step.

Moreau-Jean: M dv = h F_theta + Q^T P, du = h (v_n + theta dv). Nonsmooth generalised-alpha: smooth accelerations
as in `loop.alpha` without contact, and a jump w = M^-1 Q^T P in v, h w/2 in u. Where the contact is predicted
closed: Q v_{n+1} + e Q v_n >= 0, P >= 0, complementary; force = P/h over the step. Projected: smooth motion, then nu
for gaps, P for rates.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from contact.base.arrays import Array
from contact.jit.compiled import jit, jit_entry
from contact.loop.linear.alpha import Weights, free_acceleration, note_works, take_step
from contact.loop.linear.linear import (
    Parts,
    State,
    add_product,
    add_response,
    along,
    dot,
    gap_of,
    internal_force,
    solve_in_place,
)
from contact.loop.tally import note_step, store, store_state
from contact.record.record import Samples, Tally
from contact.solver.unilateral.complementarity import LawNumbers, contact_forces

ROUNDS = 50  # of gaps and rates by turns, where damping couples them: their coupling is of the order of h^2
SETTLED = 1e-15  # of the largest impulse


@jit
def note_impulses(
    p: Parts, s: State, e: float, du: Array, dv: Array, sums: Tally, out: Samples, begin: float, h: float
) -> None:
    """Record work, gaps and events; s.force contains impulses on entry and forces on return."""
    for k in range(s.force.size):
        was, speed, rise = gap_of(p, k, s.u), along(p, k, s.v), along(p, k, du)
        rate = speed + along(p, k, dv) + e * speed
        slack = h * abs(min(s.force[k] * p.W[k, k], rate)) if s.free[k] < math.inf else 0.0
        s.force[k] /= h
        s.gap[k] = was + rise
        sums.work[k] += s.force[k] * rise
        note_step(sums, out, k, h, s.force[k], s.gap[k], slack, begin, was, was + h * speed, begin)


@jit_entry
def advance_moreau(
    p: Parts, s: State, sums: Tally, out: Samples, amplitudes: Array, h: float, first: int, steps: int,
    law: LawNumbers, theta: float, e: float,
) -> int:  # fmt: skip
    """Moreau-Jean steps; A = M + h theta C + h^2 theta^2 K, W = Q A^-1 Q^T."""
    n, contacts = s.u.size, s.force.size
    dv, du, net, dnet, spare, rate = s.spare[0], s.spare[1], s.spare[2], s.spare[3], s.spare[4], s.spare[5]
    internal_force(p, s.u, s.v, amplitudes[0], net, s.work)
    for step in range(first, first + steps):
        begin = step * h
        load, next_load = amplitudes[step - first], amplitudes[step - first + 1]
        store_state(sums, out, step, begin, s.u)
        for i in range(n):
            du[i] = s.u[i] + h * theta * s.v[i]
        internal_force(p, du, s.v, load, dv, s.work)
        for j in range(load.size):
            for i in range(n):
                dv[i] += theta * (next_load[j] - load[j]) * p.shapes[j, i]
        for i in range(n):
            dv[i] *= h
        solve_in_place(p.A, dv)
        for k in range(contacts):
            speed = along(p, k, s.v)
            open_ = gap_of(p, k, s.u) + 0.5 * h * speed > 0.0
            s.free[k] = math.inf if open_ else (1.0 + e) * speed + along(p, k, dv)
        if not contact_forces(p.W, law, s.free, s.force, s.closed, s.square, s.shifted):
            return step
        add_response(p, 1.0, s.force, dv)
        for i in range(n):
            du[i] = h * (s.v[i] + theta * dv[i])
        note_impulses(p, s, e, du, dv, sums, out, begin, h)
        note_works(p, s, du, dv, load, next_load, sums, rate, spare)
        for i in range(n):
            s.u[i] += du[i]
            s.v[i] += dv[i]
        if theta != 0.5:  # the scheme's own gain: s = h (theta - 1/2) dv, delta = (theta - 1/2) dnet
            internal_force(p, s.u, s.v, next_load, dnet, s.work)
            for i in range(n):
                force = dnet[i]
                dnet[i], net[i] = force - net[i], force
            spare[:] = 0.0
            add_product(p.M, 1.0, dv, spare, s.work)
            sums.algorithmic[0] += (theta - 0.5) * (dot(du, dnet) - dot(dv, spare))
        store(sums, out, step, begin + 0.5 * h, s.force, s.gap)
    return -1


@jit_entry
def advance_nonsmooth(
    p: Parts, s: State, sums: Tally, out: Samples, amplitudes: Array, h: float, first: int, steps: int,
    law: LawNumbers, w: Weights, jump: Array, e: float,
) -> int:  # fmt: skip
    """Nonsmooth generalised-alpha steps; `jump` = M^-1 Q^T as rows, p.response = the smooth da/dP."""
    n, contacts = s.u.size, s.force.size
    a, u, v, net, dnet = s.spare[0], s.spare[1], s.spare[2], s.spare[3], s.spare[4]
    spare, rate = s.spare[5], s.spare[6]
    internal_force(p, s.u, s.v, amplitudes[0], net, s.work)
    for step in range(first, first + steps):
        begin = step * h
        load, next_load = amplitudes[step - first], amplitudes[step - first + 1]
        store_state(sums, out, step, begin, s.u)
        free_acceleration(p, s, w, net, u, v, next_load, h, a, spare)
        for k in range(contacts):
            speed = along(p, k, s.v)
            open_ = gap_of(p, k, u) + w.beta * h * h * along(p, k, a) > 0.0
            s.free[k] = math.inf if open_ else along(p, k, v) + w.gamma * h * along(p, k, a) + e * speed
        if not contact_forces(p.W, law, s.free, s.force, s.closed, s.square, s.shifted):
            return step
        add_response(p, 1.0, s.force, a)
        for i in range(n):
            u[i] += w.beta * h * h * a[i] - s.u[i]
            v[i] += w.gamma * h * a[i] - s.v[i]
        for k in range(contacts):
            for i in range(n):
                u[i] += 0.5 * h * s.force[k] * jump[k, i]
                v[i] += s.force[k] * jump[k, i]
        note_impulses(p, s, e, u, v, sums, out, begin, h)
        note_works(p, s, u, v, load, next_load, sums, rate, spare)
        sums.algorithmic[0] += take_step(p, s, w, u, v, a, net, dnet, next_load, s.shifted, h, spare)
        store(sums, out, step, begin + 0.5 * h, s.force, s.gap)
    return -1


class Corrections(NamedTuple):
    """Work data of the two corrections.

    `jump` = M^-1 Q^T, changes of a by unit nu and P as rows (k, N), of gaps and rates (k, k).
    """

    jump: Array
    of_nu: Array
    of_impulse: Array
    gap_nu: Array
    gap_impulse: Array
    rate_nu: Array
    rate_impulse: Array
    nu: Array
    impulse: Array
    rate: Array
    given: Array
    last: Array


@jit
def add_pulled(c: Corrections, matrix: Array, force: Array) -> None:
    """Add matrix force to `given`, without contacts that have no bound."""
    for i in range(force.size):
        if c.given[i] < math.inf:
            for j in range(force.size):
                c.given[i] += matrix[i, j] * force[j]


@jit
def corrected(s: State, c: Corrections, law: LawNumbers, damped: bool) -> bool:
    """Fill nu and P for the free gaps s.free and rates c.rate; returns False if the two have no common solution."""
    k = s.free.size
    c.impulse[:] = 0.0
    for _ in range(ROUNDS):
        for i in range(k):
            c.given[i] = s.free[i]
            c.last[i] = c.impulse[i]
        if damped:
            add_pulled(c, c.gap_impulse, c.impulse)
        if not contact_forces(c.gap_nu, law, c.given, c.nu, s.closed, s.square, s.shifted):
            return False
        for i in range(k):
            c.given[i] = c.rate[i] if c.nu[i] > 0.0 else math.inf
        add_pulled(c, c.rate_nu, c.nu)
        if not contact_forces(c.rate_impulse, law, c.given, c.impulse, s.closed, s.square, s.shifted):
            return False
        change, size = 0.0, 0.0
        for i in range(k):
            change, size = max(change, abs(c.impulse[i] - c.last[i])), max(size, abs(c.impulse[i]))
        if not damped or change <= SETTLED * size:
            return True
    return False


@jit
def note_contacts(
    p: Parts,
    s: State,
    c: Corrections,
    e: float,
    du: Array,
    dv: Array,
    sums: Tally,
    out: Samples,
    begin: float,
    h: float,
) -> None:
    """Record work, the gain by nu, gaps and events; the slack is that of both levels."""
    for k in range(s.force.size):
        was, speed, rise, jump = gap_of(p, k, s.u), along(p, k, s.v), along(p, k, du), along(p, k, dv)
        s.gap[k], s.force[k] = was + rise, c.impulse[k] / h
        slack = abs(min(c.nu[k] * c.gap_nu[k, k], s.gap[k]))
        if c.nu[k] > 0.0:
            slack = max(slack, h * abs(min(c.impulse[k] * c.rate_impulse[k, k], (1.0 + e) * speed + jump)))
        sums.work[k] += s.force[k] * rise
        sums.algorithmic[0] -= jump * (c.nu[k] - 0.5 * h * c.impulse[k]) / h
        note_step(sums, out, k, h, s.force[k], s.gap[k], slack, begin, was, was + h * speed, begin)


@jit_entry
def advance_projected(
    p: Parts, s: State, sums: Tally, out: Samples, amplitudes: Array, h: float, first: int, steps: int,
    law: LawNumbers, w: Weights, c: Corrections, e: float,
) -> int:  # fmt: skip
    """Take steps first .. first + steps - 1; returns -1, or the step that failed."""
    n, contacts = s.u.size, s.force.size
    a, u, v, net, dnet = s.spare[0], s.spare[1], s.spare[2], s.spare[3], s.spare[4]
    spare, rate = s.spare[5], s.spare[6]
    internal_force(p, s.u, s.v, amplitudes[0], net, s.work)
    for step in range(first, first + steps):
        begin = step * h
        load, next_load = amplitudes[step - first], amplitudes[step - first + 1]
        store_state(sums, out, step, begin, s.u)
        free_acceleration(p, s, w, net, u, v, next_load, h, a, spare)
        for k in range(contacts):
            s.free[k] = gap_of(p, k, u) + w.beta * h * h * along(p, k, a)
            c.rate[k] = along(p, k, v) + w.gamma * h * along(p, k, a) + e * along(p, k, s.v)
        if not corrected(s, c, law, p.damped):
            return step
        for k in range(contacts):
            if c.nu[k] > 0.0:
                for i in range(n):
                    a[i] += c.nu[k] * c.of_nu[k, i] + c.impulse[k] * c.of_impulse[k, i]
        for i in range(n):
            u[i] += w.beta * h * h * a[i] - s.u[i]
            v[i] += w.gamma * h * a[i] - s.v[i]
        for k in range(contacts):
            if c.nu[k] > 0.0:
                for i in range(n):
                    u[i] += c.nu[k] * c.jump[k, i]
                    v[i] += c.impulse[k] * c.jump[k, i]
        note_contacts(p, s, c, e, u, v, sums, out, begin, h)
        note_works(p, s, u, v, load, next_load, sums, rate, spare)
        sums.algorithmic[0] += take_step(p, s, w, u, v, a, net, dnet, next_load, s.shifted, h, spare)
        store(sums, out, step, begin + 0.5 * h, s.force, s.gap)
    return -1
