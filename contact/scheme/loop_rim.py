"""Compiled step loop of the exact-modal scheme on a rotating rim: rows turn with the contact point."""

from __future__ import annotations

import math
from typing import NamedTuple

from contact.compiled import jit
from contact.model.arrays import Array, Indices
from contact.record import Samples, Tally
from contact.scheme.loop_modal import ModalState, damping_work, free_gap
from contact.scheme.loop_tally import note_contact, store, store_state
from contact.solver.abradable import Coating, crush, first_bar, machined, surface
from contact.solver.scalar import scalar_force


class Terms(NamedTuple):
    """A trigonometric polynomial of the contact angle."""

    harmonic: Indices
    cos: Array
    sin: Array


class RowEntries(NamedTuple):
    """Rows of all modes: mode-major entries (`start`, `harmonic`, `cos`, `sin`), or full tables by harmonic.

    `cos_table`, `sin_table` (harmonics, m) are empty when few entries matter (a nearly perfect casing); when
    they are given they are used instead, because the loop over modes is then contiguous.
    """

    start: Indices
    harmonic: Indices
    cos: Array
    sin: Array
    cos_table: Array
    sin_table: Array


class RimRows(NamedTuple):
    """Rows of the modes, polynomials of clearance and compliance, the speeds of the rim, and work space."""

    normal: RowEntries
    tangent: RowEntries
    clearance: Terms
    S_nn: Terms
    S_nt: Terms
    S_turns: bool  # S depends on the angle
    angle: float
    speed: float
    surface: float  # R Omega
    mu: float
    waves: Array  # (2, highest harmonic + 1): cos n phi, sin n phi
    waves_next: Array


@jit
def turn(waves: Array, phi: float) -> None:
    """Cos n phi and sin n phi from one sine and cosine by the addition theorem: no drift over steps."""
    c, s = math.cos(phi), math.sin(phi)
    waves[0, 0], waves[1, 0] = 1.0, 0.0
    for n in range(1, waves.shape[1]):
        waves[0, n] = c * waves[0, n - 1] - s * waves[1, n - 1]
        waves[1, n] = s * waves[0, n - 1] + c * waves[1, n - 1]


@jit
def polynomial(terms: Terms, waves: Array) -> float:
    """Value at the angle of `waves`."""
    total = 0.0
    for j in range(terms.harmonic.size):
        n = terms.harmonic[j]
        total += terms.cos[j] * waves[0, n] + terms.sin[j] * waves[1, n]
    return total


@jit
def fill(entries: RowEntries, waves: Array, row: Array) -> None:
    """Rows of all modes at the angle of `waves`."""
    if entries.cos_table.size > 0:
        row[:] = 0.0
        for n in range(entries.cos_table.shape[0]):
            c, s = waves[0, n], waves[1, n]
            cos, sin = entries.cos_table[n], entries.sin_table[n]
            for i in range(row.size):
                row[i] += c * cos[i] + s * sin[i]
        return
    for i in range(row.size):
        total = 0.0
        for j in range(entries.start[i], entries.start[i + 1]):
            n = entries.harmonic[j]
            total += entries.cos[j] * waves[0, n] + entries.sin[j] * waves[1, n]
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
    s: ModalState, rows: RimRows, coating: Coating, Q: Array, Q_next: Array, T: Array, averaged: bool, damped: bool,
    sums: Tally, out: Samples, h: float, first: int, steps: int,
) -> int:  # fmt: skip
    """Exact-modal steps at the moving point phi = phi_0 - Omega t: force at phi_n, gap at phi_{n+1}."""
    old, new = s.old, s.d
    m = s.q.size
    rubs, coated = rows.mu > 0.0, coating.worn.size > 0
    bar, cut, skin = 0, 0.0, 0.0  # first bar under the tip, depths there of the cut and of the surface
    now, last = s.memory[0], s.memory[1]
    waves, ahead = rows.waves, rows.waves_next
    turn(waves, rows.angle - rows.speed * first * h)
    fill(rows.normal, waves, Q)
    S_nn, S_nt = polynomial(rows.S_nn, waves), polynomial(rows.S_nt, waves)
    S_last = s.memory[4]
    for step in range(first, first + steps):
        store_state(sums, out, step, step * h, s.q)
        old, new = new, old
        turn(ahead, rows.angle - rows.speed * (step + 1) * h)
        fill(rows.normal, ahead, Q_next)
        free = polynomial(rows.clearance, ahead) + free_gap(s, Q_next, old, new)
        test = 0.25 * (free + 2.0 * now + last) if averaged else free
        force, scale, pull, H = 0.0, 1.0, 0.0, 0.0
        if coated:
            bar = first_bar(coating, (rows.angle - rows.speed * step * h) / (2.0 * math.pi))
            cut = machined(coating, polynomial(rows.clearance, waves))
            skin = surface(coating, bar, cut)
            coating.memory[1], coating.memory[2] = 0.0, skin
        if not test + skin >= 0.0:
            if rubs:
                fill(rows.tangent, waves, T)
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
            force = crush(coating, bar, cut, scale, test) if coated else scalar_force(scale, test)
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
        if coated:
            s.gap[0] += coating.memory[2]  # from the surface as it is worn and pressed
        s.force[0] = force
        s.memory[2] = force
        s.memory[3] = pull
        note_contact(sums, out, 0, h, step * h, force, s.gap[0], scale, now + skin, free + skin)
        for i in range(m):
            s.q[i] += new[i]
        last, now = now, free + H * force
        store(sums, out, step, step * h, s.force, s.gap)
        Q, Q_next = Q_next, Q
        waves, ahead = ahead, waves
        if rows.S_turns:
            S_last = S_nn - pull * S_nt
            S_nn, S_nt = polynomial(rows.S_nn, waves), polynomial(rows.S_nt, waves)
    s.memory[0], s.memory[1], s.memory[4] = now, last, S_last
    if steps % 2 == 1:  # the two buffers changed places an odd number of times
        for i in range(m):
            s.d[i] = s.old[i]
    return -1
