"""Compiled step loop of the exact-modal scheme at a fixed contact point."""

from __future__ import annotations

from typing import NamedTuple

from contact.base.arrays import Array
from contact.jit.compiled import jit_entry, jit_inside
from contact.jit.vector import WIDTH, load, put, same, total
from contact.loop.tally import note_contact, store, store_state
from contact.record.record import Samples, Tally
from contact.solver.unilateral.scalar import scalar_force


class ModalState(NamedTuple):
    """q_n, D = q_n - q_{n-1} (m,), coefficients, `memory` = (g_n, g_{n-1} of q, force), more on a rim."""

    q: Array
    d: Array
    old: Array
    al: Array
    be: Array
    c: Array
    kick: Array  # c load
    weight: Array  # (1 - al)/(2 c), for the work of damping
    memory: Array
    force: Array
    gap: Array


@jit_inside
def free_gap(s: ModalState, Q: Array, old: Array, new: Array) -> float:
    """D* = al D - be q + c f into `new`; returns Q (q + D*)."""
    whole = s.q.size - s.q.size % WIDTH
    part = same(0.0)
    for i in range(0, whole, WIDTH):
        q = load(s.q, i)
        step = load(s.al, i) * load(old, i) - load(s.be, i) * q + load(s.kick, i)
        put(new, i, step)
        part = part + load(Q, i) * (q + step)
    result: float = total(part)
    for i in range(whole, s.q.size):
        new[i] = s.al[i] * old[i] - s.be[i] * s.q[i] + s.kick[i]
        result += Q[i] * (s.q[i] + new[i])
    return result


@jit_inside
def damping_work(s: ModalState, old: Array, new: Array) -> float:
    """Work of modal damping over one step, -sum (1 - al) D_n (D_n + D_{n+1})/(2 c)."""
    whole = s.q.size - s.q.size % WIDTH
    part = same(0.0)
    for i in range(0, whole, WIDTH):
        d = load(old, i)
        part = part + load(s.weight, i) * d * (d + load(new, i))
    result: float = -total(part)
    for i in range(whole, s.q.size):
        result -= s.weight[i] * old[i] * (old[i] + new[i])
    return result


@jit_inside
def add_force(s: ModalState, Q: Array, force: float, new: Array) -> None:
    """Add c Q force to D."""
    whole = s.q.size - s.q.size % WIDTH
    push = same(force)
    for i in range(0, whole, WIDTH):
        put(new, i, load(new, i) + load(s.c, i) * load(Q, i) * push)
    for i in range(whole, s.q.size):
        new[i] += s.c[i] * Q[i] * force


@jit_inside
def move(s: ModalState, new: Array) -> None:
    """Add D to q."""
    whole = s.q.size - s.q.size % WIDTH
    for i in range(0, whole, WIDTH):
        put(s.q, i, load(s.q, i) + load(new, i))
    for i in range(whole, s.q.size):
        s.q[i] += new[i]


@jit_entry
def advance_modal(
    s: ModalState, Q: Array, clearance: float, S: float, averaged: bool, damped: bool,
    sums: Tally, out: Samples, h: float, first: int, steps: int,
) -> int:  # fmt: skip
    """Exact-modal steps with constant rows Q: forward law, or the averaged one."""
    old, new = s.old, s.d
    H = 0.0
    for i in range(Q.size):
        H += s.c[i] * Q[i] * Q[i]
    now, last = s.memory[0], s.memory[1]
    scale = 0.25 * H + S if averaged else H + S
    for step in range(first, first + steps):
        store_state(sums, out, step, step * h, s.q)
        old, new = new, old
        free = clearance + free_gap(s, Q, old, new)
        test = 0.25 * (free + 2.0 * now + last) if averaged else free
        force = 0.0
        if not test >= 0.0:
            force = scalar_force(scale, test)
            if not force >= 0.0:
                return step
            add_force(s, Q, force, new)
        after = free + H * force
        sums.work[0] += 0.5 * force * (after - last)
        if damped:
            sums.damping[0] += damping_work(s, old, new)
        s.gap[0] = test + scale * force
        s.force[0] = force
        s.memory[2] = force
        note_contact(sums, out, 0, h, step * h, force, s.gap[0], scale, now, free)
        move(s, new)
        last, now = now, after
        store(sums, out, step, step * h, s.force, s.gap)
    s.memory[0], s.memory[1] = now, last
    if steps % 2 == 1:  # the two buffers changed places an odd number of times
        for i in range(Q.size):
            s.d[i] = s.old[i]
    return -1
