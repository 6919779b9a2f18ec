"""Compiled step loop of the exact-modal scheme on a rotating rim: rows turn with the contact point."""

from __future__ import annotations

import math
from typing import NamedTuple

from contact.compiled import jit
from contact.model.arrays import Array, Indices
from contact.record import Samples, Tally
from contact.scheme.loop_modal import ModalState, damping_work, free_gap
from contact.scheme.loop_tally import note_contact, store, store_state
from contact.solver.scalar import scalar_force


class Terms(NamedTuple):
    """A trigonometric polynomial of the contact angle."""

    harmonic: Indices
    cos: Array
    sin: Array


class RimRows(NamedTuple):
    """Row table of the modes, polynomials of clearance and compliance, and the speeds of the rim."""

    start: Indices
    harmonic: Indices
    q_cos: Array
    q_sin: Array
    t_cos: Array
    t_sin: Array
    clearance: Terms
    S_nn: Terms
    S_nt: Terms
    S_turns: bool  # S depends on the angle
    angle: float
    speed: float
    surface: float  # R Omega
    mu: float
    cosines: Array  # cos n phi, n = 0 .. highest harmonic in use
    sines: Array


@jit
def turn(rows: RimRows, phi: float) -> None:
    """Cos n phi and sin n phi from one sine and cosine by the addition theorem: no drift over steps."""
    c, s = math.cos(phi), math.sin(phi)
    rows.cosines[0], rows.sines[0] = 1.0, 0.0
    for n in range(1, rows.cosines.size):
        rows.cosines[n] = c * rows.cosines[n - 1] - s * rows.sines[n - 1]
        rows.sines[n] = s * rows.cosines[n - 1] + c * rows.sines[n - 1]


@jit
def polynomial(rows: RimRows, terms: Terms) -> float:
    """Value at the present angle."""
    total = 0.0
    for j in range(terms.harmonic.size):
        n = terms.harmonic[j]
        total += terms.cos[j] * rows.cosines[n] + terms.sin[j] * rows.sines[n]
    return total


@jit
def fill(rows: RimRows, cos: Array, sin: Array, row: Array) -> None:
    """Rows of all modes at the present angle."""
    for i in range(row.size):
        total = 0.0
        for j in range(rows.start[i], rows.start[i + 1]):
            n = rows.harmonic[j]
            total += cos[j] * rows.cosines[n] + sin[j] * rows.sines[n]
        row[i] = total


@jit
def dot(a: Array, b: Array) -> float:
    """Sum of products."""
    total = 0.0
    for i in range(a.size):
        total += a[i] * b[i]
    return total


@jit
def advance_rim(
    s: ModalState, rows: RimRows, Q: Array, Q_next: Array, T: Array, averaged: bool, damped: bool,
    sums: Tally, out: Samples, h: float, first: int, steps: int,
) -> int:  # fmt: skip
    """Exact-modal steps at the moving point phi = phi_0 - Omega t: force at phi_n, gap at phi_{n+1}."""
    old, new = s.old, s.d
    m = s.q.size
    rubs = rows.mu > 0.0
    now, last = s.memory[0], s.memory[1]
    turn(rows, rows.angle - rows.speed * first * h)
    fill(rows, rows.q_cos, rows.q_sin, Q)
    if rubs:
        fill(rows, rows.t_cos, rows.t_sin, T)
    S_nn, S_nt = polynomial(rows, rows.S_nn), polynomial(rows, rows.S_nt)
    S_last = s.memory[4]
    for step in range(first, first + steps):
        store_state(sums, out, step, step * h, s.q)
        old, new = new, old
        turn(rows, rows.angle - rows.speed * (step + 1) * h)
        fill(rows, rows.q_cos, rows.q_sin, Q_next)
        free = polynomial(rows, rows.clearance) + free_gap(s, Q_next, old, new)
        test = 0.25 * (free + 2.0 * now + last) if averaged else free
        force, scale, pull, H = 0.0, 1.0, 0.0, 0.0
        if not test >= 0.0:
            if rubs:
                slide = rows.surface + dot(T, old) / h
                pull = rows.mu if slide > 0.0 else (-rows.mu if slide < 0.0 else 0.0)
                if slide * rows.surface < 0.0:
                    sums.reversals[0] += 1
                for i in range(m):
                    H += Q_next[i] * s.c[i] * (Q[i] - pull * T[i])
            else:
                for i in range(m):
                    H += Q_next[i] * s.c[i] * Q[i]
            scale = (0.25 * H if averaged else H) + S_nn - pull * S_nt
            force = scalar_force(scale, test)
            if not force >= 0.0:
                s.memory[2], s.memory[3] = H, scale
                return step
            normal, tangent = 0.0, 0.0
            for i in range(m):
                new[i] += s.c[i] * Q[i] * force
            if rubs:
                for i in range(m):
                    new[i] -= s.c[i] * pull * T[i] * force
                for i in range(m):
                    tangent += T[i] * (old[i] + new[i])
            for i in range(m):
                normal += Q[i] * (old[i] + new[i])
            work = 0.5 * force * (free + H * force - last)
            if rows.S_turns:  # what S(phi) stores changes because the point moves, not because force does
                work += 0.5 * force * force * (S_nn - pull * S_nt - S_last)
            sums.work[0] += work
            sums.rotation[0] += 0.5 * force * normal - work
            sums.friction[0] -= 0.5 * force * pull * tangent
        if damped:
            sums.damping[0] += damping_work(s, old, new)
        s.gap[0] = test + scale * force
        s.force[0] = force
        s.memory[2] = force
        s.memory[3] = pull
        note_contact(sums, out, 0, h, step * h, force, s.gap[0], scale, now, free)
        for i in range(m):
            s.q[i] += new[i]
        last, now = now, free + H * force
        store(sums, out, step, step * h, s.force, s.gap)
        Q, Q_next = Q_next, Q
        if rubs:
            fill(rows, rows.t_cos, rows.t_sin, T)
        if rows.S_turns:
            S_last = S_nn - pull * S_nt
            S_nn, S_nt = polynomial(rows, rows.S_nn), polynomial(rows, rows.S_nt)
    s.memory[0], s.memory[1], s.memory[4] = now, last, S_last
    if steps % 2 == 1:  # the two buffers changed places an odd number of times
        for i in range(m):
            s.d[i] = s.old[i]
    return -1
