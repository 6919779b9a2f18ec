"""Compiled leapfrog steps whose contact coordinates have no mass: they follow the others statically, with the contact.

Others: M (D_{n+1} - D_n)/h^2 = f - K u_n + Q^T force_n; then K_cc u_c = f_c - K_cm u_m + Q_c^T force_{n+1} with
g_{n+1} >= 0. Energies and their balance are those of `leapfrog`.
"""

from __future__ import annotations

from typing import NamedTuple

from contact.base.arrays import Array, Indices
from contact.jit.compiled import jit_entry
from contact.loop.linear.leapfrog import free_increment
from contact.loop.linear.linear import Parts, State, add_response, along, damping_work, gap_of, varying_work
from contact.loop.tally import note_step, store, store_state
from contact.record.record import Samples, Tally
from contact.solver.unilateral.complementarity import LawNumbers, contact_forces


class Massless(NamedTuple):
    """m coordinates without mass: their places, rows of K as short lists, compliance and lift."""

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
    """Move the massless coordinates to rest under loads, springs and contact; s.force is the contact's."""
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
    """Steps first .. first + steps - 1; the force stored at t_n is the one that holds the gap at t_n."""
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
