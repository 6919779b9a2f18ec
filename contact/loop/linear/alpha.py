"""Compiled generalised-alpha steps with contact enforced at the end of the step: Newmark, HHT, stabilised Newmark.

(1 - am) M a_{n+1} + am M a_n = (1 - af) F_{n+1} + af F_n + Q^T force_{n+1}, F = f - C v - K u,
u_{n+1} = u_n + h v_n + h^2 ((1/2 - b) a_n + b a_{n+1}),  v_{n+1} = v_n + h ((1 - c) a_n + c a_{n+1}).
"""

from __future__ import annotations

from typing import NamedTuple

from contact.base.arrays import Array
from contact.jit.compiled import jit, jit_entry, jit_inside
from contact.loop.linear.linear import (
    Parts,
    State,
    add_product,
    add_response,
    add_varying,
    along,
    damping_work,
    dot,
    gap_of,
    internal_force,
    solve_in_place,
    varying_work,
)
from contact.loop.tally import note_step, store, store_state
from contact.record.record import Samples, Tally
from contact.solver.unilateral.complementarity import LawNumbers, contact_forces


class Weights(NamedTuple):
    """Weights am, af, beta, gamma of the generalised-alpha family."""

    am: float
    af: float
    beta: float
    gamma: float


@jit
def free_acceleration(
    p: Parts, s: State, w: Weights, net: Array, u: Array, v: Array, amplitudes: Array, h: float, a: Array, spare: Array
) -> None:
    """Predict u and v, and overwrite a with the acceleration at the end of the step without contact."""
    for i in range(u.size):
        u[i] = s.u[i] + h * s.v[i] + h * h * (0.5 - w.beta) * s.a[i]
        v[i] = s.v[i] + h * (1.0 - w.gamma) * s.a[i]
    internal_force(p, u, v, amplitudes, a, s.work)
    for i in range(u.size):
        a[i] *= 1.0 - w.af
    if w.af != 0.0:
        for i in range(u.size):
            a[i] += w.af * net[i]
    if w.am != 0.0:
        add_product(p.M, -w.am, s.a, a, s.work)
    solve_in_place(p.A, a)


@jit
def own_gain(
    p: Parts, s: State, w: Weights, du: Array, dv: Array, da: Array, dnet: Array, dforce: Array, h: float, out: Array
) -> float:
    """Energy that the scheme adds over a step (contract 5).

    s = h^2 (b - c/2) da, delta = (1/2 - af) dnet + (c - 1 + am) M da + Q^T dforce/2.
    """
    out[:] = 0.0
    add_product(p.M, w.gamma - 1.0 + w.am, da, out, s.work)
    for i in range(du.size):
        out[i] += (0.5 - w.af) * dnet[i]
    gain = dot(out, du)
    for k in range(dforce.size):
        gain += 0.5 * dforce[k] * along(p, k, du)
    out[:] = 0.0
    add_product(p.M, 1.0 / h, dv, out, s.work)
    return gain - h * h * (w.beta - 0.5 * w.gamma) * dot(da, out)


@jit_inside
def note_works(
    p: Parts, s: State, du: Array, dv: Array, load: Array, next_load: Array, sums: Tally, rate: Array, spare: Array
) -> None:
    """Record the work of damping and of varying loads over the step."""
    if p.damped:
        for i in range(du.size):
            rate[i] = s.v[i] + 0.5 * dv[i]
        sums.damping[0] += damping_work(p, du, rate, spare, s.work)
    sums.external[0] += varying_work(p, load, next_load, du, spare)


@jit
def take_step(
    p: Parts, s: State, w: Weights, du: Array, dv: Array, a: Array, net: Array, dnet: Array, load: Array,
    dforce: Array, h: float, spare: Array,
) -> float:  # fmt: skip
    """Move the state by du and dv to the acceleration a, which is overwritten by da.

    Returns the energy that the scheme adds.
    """
    for i in range(du.size):
        s.u[i] += du[i]
        s.v[i] += dv[i]
        a[i] -= s.a[i]
        s.a[i] += a[i]
    internal_force(p, s.u, s.v, load, dnet, s.work)
    for i in range(du.size):
        force = dnet[i]
        dnet[i], net[i] = force - net[i], force  # not net + dnet, which is rounded: runs may be split anywhere
    return own_gain(p, s, w, du, dv, a, dnet, dforce, h, spare)


@jit_entry
def advance_alpha(
    p: Parts, s: State, sums: Tally, out: Samples, amplitudes: Array, h: float, first: int, steps: int,
    law: LawNumbers, w: Weights,
) -> int:  # fmt: skip
    """Take steps first .. first + steps - 1; returns -1, or the step that failed."""
    n, contacts = s.u.size, s.force.size
    a, u, v, net, dnet, spare = s.spare[0], s.spare[1], s.spare[2], s.spare[3], s.spare[4], s.spare[5]
    internal_force(p, s.u, s.v, amplitudes[0], net, s.work)
    for step in range(first, first + steps):
        begin = step * h
        load, next_load = amplitudes[step - first], amplitudes[step - first + 1]
        store_state(sums, out, step, begin, s.u)
        free_acceleration(p, s, w, net, u, v, next_load, h, a, spare)
        for k in range(contacts):
            s.free[k] = gap_of(p, k, u) + w.beta * h * h * along(p, k, a)
            s.gap[k] = s.force[k]  # the last force, for a moment
        if not contact_forces(p.W, law, s.free, s.force, s.closed, s.square, s.shifted):
            return step
        add_response(p, 1.0, s.force, a)
        for i in range(n):
            u[i] += w.beta * h * h * a[i] - s.u[i]  # the increments, from here
            v[i] += w.gamma * h * a[i] - s.v[i]
        for k in range(contacts):
            last, was = s.gap[k], gap_of(p, k, s.u)
            rise = along(p, k, u)
            sums.work[k] += 0.5 * (last + s.force[k]) * rise
            s.shifted[k] = s.force[k] - last
            s.gap[k] = was + rise
            scale = p.W[k, k] if law.stiffness == 0.0 or law.updates > 0 else 1.0 / law.stiffness
            slack = abs(min(s.force[k] * scale, s.gap[k]))
            note_step(sums, out, k, h, s.force[k], s.gap[k], slack, begin, was, s.free[k], begin + 0.5 * h)
        note_works(p, s, u, v, load, next_load, sums, spare, dnet)
        sums.algorithmic[0] += take_step(p, s, w, u, v, a, net, dnet, next_load, s.shifted, h, spare)
        store(sums, out, step, begin + h, s.force, s.gap)
    return -1


@jit
def project(p: Parts, s: State, h: float, law: LawNumbers, jump: Array, opening: Array, shift: Array) -> bool:
    """Smallest shift of u_n + h v_n, in the metric of M, that prevents penetration."""
    for k in range(s.force.size):
        s.free[k] = gap_of(p, k, s.u) + h * along(p, k, s.v)
        s.gap[k] = 0.0
    shift[:] = 0.0
    if not contact_forces(opening, law, s.free, s.gap, s.closed, s.square, s.shifted):
        return False
    for k in range(s.force.size):
        for i in range(shift.size):
            shift[i] += s.gap[k] * jump[k, i]
    return True


@jit_entry
def advance_stabilised(
    p: Parts, s: State, sums: Tally, out: Samples, amplitudes: Array, h: float, first: int, steps: int,
    law: LawNumbers, jump: Array, opening: Array,
) -> int:  # fmt: skip
    """Contact-stabilised Newmark: p.response = h A^-1 Q^T, p.W = h/2 Q response, A = M + h C/2 + h^2 K/4."""
    n, contacts = s.u.size, s.force.size
    shift, dv, du, spare, rate = s.spare[0], s.spare[1], s.spare[2], s.spare[3], s.spare[4]
    for step in range(first, first + steps):
        begin = step * h
        load, next_load = amplitudes[step - first], amplitudes[step - first + 1]
        store_state(sums, out, step, begin, s.u)
        if not project(p, s, h, law, jump, opening, shift):
            return step
        for i in range(n):
            du[i] = s.u[i] + 0.5 * (h * s.v[i] + shift[i])
        internal_force(p, du, s.v, load, dv, s.work)
        add_varying(p, -0.5, load, dv)
        add_varying(p, 0.5, next_load, dv)
        for i in range(n):
            dv[i] *= h
        solve_in_place(p.A, dv)
        for k in range(contacts):
            s.free[k] = gap_of(p, k, s.u) + along(p, k, shift) + h * along(p, k, s.v) + 0.5 * h * along(p, k, dv)
        if not contact_forces(p.W, law, s.free, s.force, s.closed, s.square, s.shifted):
            return step
        add_response(p, 1.0, s.force, dv)
        for i in range(n):
            rate[i] = s.v[i] + 0.5 * dv[i]
            du[i] = h * rate[i] + shift[i]
        for k in range(contacts):
            was, rise = gap_of(p, k, s.u), along(p, k, du)
            ahead = was + h * along(p, k, s.v)
            s.gap[k] = was + rise
            sums.work[k] += s.force[k] * rise
            slack = abs(min(s.force[k] * p.W[k, k], s.gap[k]))
            note_step(sums, out, k, h, s.force[k], s.gap[k], slack, begin, was, ahead, begin)
        sums.damping[0] += damping_work(p, du, rate, spare, s.work)
        sums.external[0] += varying_work(p, load, next_load, du, spare)
        spare[:] = 0.0
        add_product(p.M, 1.0 / h, dv, spare, s.work)
        sums.algorithmic[0] -= dot(shift, spare)
        for i in range(n):
            s.u[i] += du[i]
            s.v[i] += dv[i]
        store(sums, out, step, begin + 0.5 * h, s.force, s.gap)
    return -1
