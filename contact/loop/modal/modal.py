"""Compiled step loops of the exact-modal scheme at a fixed contact point.

With its own laws, and with the discrete gradient.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from contact.base.arrays import Array
from contact.jit.compiled import jit, jit_entry, jit_inside
from contact.jit.vector import WIDTH, load, put, same, total
from contact.loop.formulas import damped, free_step, mean_gap
from contact.loop.tally import note_contact, note_yielding, store, store_state
from contact.record.record import Samples, Tally
from contact.solver.friction.one_contact import scalar_force
from contact.solver.yielding.yields import Yielding, paced, press


class ModalState(NamedTuple):
    """q_n, D = q_n - q_{n-1} (m,), coefficients, `memory` = (g_n, g_{n-1} of q, force)."""

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
        step = free_step(load(s.al, i), load(s.be, i), load(old, i), q) + load(s.kick, i)
        put(new, i, step)
        part = part + load(Q, i) * (q + step)
    result: float = total(part)
    for i in range(whole, s.q.size):
        new[i] = free_step(s.al[i], s.be[i], old[i], s.q[i]) + s.kick[i]
        result += Q[i] * (s.q[i] + new[i])
    return result


@jit_inside
def damping_work(s: ModalState, old: Array, new: Array) -> float:
    """Work of modal damping over one step, -sum (1 - al) D_n (D_n + D_{n+1})/(2 c)."""
    whole = s.q.size - s.q.size % WIDTH
    part = same(0.0)
    for i in range(0, whole, WIDTH):
        part = part + damped(load(s.weight, i), load(old, i), load(new, i))
    result: float = -total(part)
    for i in range(whole, s.q.size):
        result -= damped(s.weight[i], old[i], new[i])
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
    s: ModalState, Q: Array, clearance: float, S: float, averaged: bool, damped: bool, y: Yielding | None,
    sums: Tally, out: Samples, h: float, first: int, steps: int,
) -> int:  # fmt: skip
    """Exact-modal steps with constant rows Q: forward law, or the averaged one; rigid, or with a force-depth law."""
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
        test = mean_gap(0.25, free, now, last) if averaged else free
        force, depth = 0.0, 0.0
        if not test >= 0.0:
            if y is None:
                force = scalar_force(scale, test)
            else:
                paced(y, 0, h)
                depth, force = press(y, 0, scale, test)
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
        if y is None:
            note_contact(sums, out, 0, h, step * h, force, s.gap[0], scale, now, free)
        else:
            note_yielding(sums, out, y, 0, h, step * h, force, s.gap[0], depth, now, free)
        move(s, new)
        last, now = now, after
        store(sums, out, step, step * h, s.force, s.gap)
    s.memory[0], s.memory[1] = now, last
    if steps % 2 == 1:  # the two buffers changed places an odd number of times
        for i in range(Q.size):
            s.d[i] = s.old[i]
    return -1


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
    """Undamped steps with a force constant over each step; work of contact = -(phi_{n+1} - phi_n), exactly."""
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
