"""Compiled steps of the two schemes with an impact law on velocities over each step.

Moreau-Jean: M dv = h F_theta + Q^T P, du = h (v_n + theta dv). Nonsmooth generalised-alpha: smooth accelerations
as in `loop.alpha` without contact, and a jump w = M^-1 Q^T P in v, h w/2 in u. Where the contact is predicted
closed: Q v_{n+1} + e Q v_n >= 0, P >= 0, complementary; force = P/h over the step.
"""

from __future__ import annotations

import math

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


@jit
def note_impulses(
    p: Parts, s: State, e: float, du: Array, dv: Array, sums: Tally, out: Samples, begin: float, h: float
) -> None:
    """Work, gaps and events; s.force holds impulses on entry and forces on return."""
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
