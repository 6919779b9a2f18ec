"""Compiled steps of the contact-stabilised Newmark scheme (beta = 1/4, gamma = 1/2, contact at the end)."""

from __future__ import annotations

from contact.base.arrays import Array
from contact.jit.compiled import jit, jit_entry
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


@jit
def project(p: Parts, s: State, h: float, law: LawNumbers, jump: Array, opening: Array, shift: Array) -> bool:
    """Shift of u_n + h v_n that keeps it from penetrating, smallest in the metric of M."""
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
    """Steps with p.response = h A^-1 Q^T, p.W = h/2 Q response, A = M + h C/2 + h^2 K/4."""
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
