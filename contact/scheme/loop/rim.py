"""Compiled step loop of the exact-modal scheme on a rotating rim: rows turn with the contact point."""

from __future__ import annotations

import math
from typing import NamedTuple

from contact.compiled import jit, jit_inside
from contact.model.arrays import Array, Indices
from contact.record import Samples, Tally
from contact.scheme.loop.leap import FOREVER, PAUSE, Leap, discrete_energy, leap_ahead
from contact.scheme.loop.modal import ModalState, add_force, damping_work, free_gap, move
from contact.scheme.loop.rows import RowBlocks, Series, fill, product, rotate, value, weighted
from contact.scheme.loop.tally import note_contact, store, store_state
from contact.solver.abradable import Coating, crush, first_bar, machined, surface
from contact.solver.scalar import JAMMED, scalar_force


class Terms(NamedTuple):
    """A trigonometric polynomial of the contact angle."""

    harmonic: Indices
    cos: Array
    sin: Array


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
def dot(a: Array, b: Array) -> float:
    """Sum of products."""
    total = 0.0
    for i in range(a.size):
        total += a[i] * b[i]
    return total


class RimRows(NamedTuple):
    """Rows of the modes, polynomials of clearance and compliance, the speeds of the rim, and work space."""

    normal: RowBlocks
    tangent: RowBlocks
    clearance: Series
    S_nn: Series
    S_nt: Series
    S_turns: bool  # S depends on the angle
    angle: float
    speed: float
    surface: float  # R Omega
    mu: float
    waves: Array  # (2, harmonics): cos n phi, sin n phi, n = 0, 1, ..., whole vectors of them
    waves_next: Array
    found: Array  # (6,), what `push` finds besides the force


@jit_inside
def untouched(out: Samples, sums: Tally, step: int) -> int:
    """Steps from `step` to the next that is stored; none when it is one."""
    if out.every == 0:
        row = max(sums.filled[0], sums.filled[1])
        return int(out.at[row] - step) if row < out.at.size else FOREVER
    every = out.every  # state_every is a multiple
    return int(-step % every)


@jit
def leap_rim(
    s: ModalState, rows: RimRows, leap: Leap, Q: Array, d: Array, damped: bool, sums: Tally, h: float, step: int,
    room: int,
) -> int:  # fmt: skip
    """Leap from `step` over steps without contact; sets `memory` and `waves` where it lands. Negative: wait."""
    before = discrete_energy(s.q, d, s.be, s.c) if damped else 0.0
    steps = leap_ahead(leap, s.q, d, rows.angle - rows.speed * (step + 1) * h, -rows.speed * h, room)
    if steps <= 0:
        return steps
    if damped:
        sums.damping[0] += discrete_energy(s.q, d, s.be, s.c) - before
    rotate(rows.waves_next, rows.angle - rows.speed * (step + steps - 1) * h)
    fill(rows.normal, rows.waves_next, Q)
    s.memory[1] = value(rows.clearance, rows.waves_next) + product(Q, s.q) - product(Q, d)
    s.memory[4] = value(rows.S_nn, rows.waves_next)
    rotate(rows.waves, rows.angle - rows.speed * (step + steps) * h)
    fill(rows.normal, rows.waves, Q)
    s.memory[0] = value(rows.clearance, rows.waves) + product(Q, s.q)
    return steps


@jit_inside
def push(
    s: ModalState, rows: RimRows, coating: Coating, bar: int, cut: float, Q: Array, Q_next: Array, T: Array,
    waves: Array, old: Array, new: Array, h: float, averaged: bool, S_nn: float, S_nt: float, test: float, found: Array,
) -> float:  # fmt: skip
    """Force that closes a gap `test`, or what a coating bears, added to D; JAMMED where there is none.

    `found` = H, scale, pull (mu with the sign of the slip), Q (D_n + D_{n+1}), T (D_n + D_{n+1}), slip.
    """
    rubs = rows.mu > 0.0
    H, pull, slide = weighted(Q_next, s.c, Q), 0.0, 0.0
    if rubs:
        fill(rows.tangent, waves, T)
        slide = rows.surface + product(T, old) / h
        pull = rows.mu if slide > 0.0 else (-rows.mu if slide < 0.0 else 0.0)
        H -= pull * weighted(Q_next, s.c, T)
    scale = (0.25 * H if averaged else H) + S_nn - pull * S_nt
    force = crush(coating, bar, cut, scale, test) if coating.worn.size > 0 else scalar_force(scale, test)
    found[0], found[1], found[2], found[5] = H, scale, pull, slide
    if not force >= 0.0:
        return JAMMED
    add_force(s, Q, force, new)
    if rubs:
        add_force(s, T, -pull * force, new)
        found[4] = product(T, old) + product(T, new)
    found[3] = product(Q, old) + product(Q, new)
    return force


@jit
def advance_rim(
    s: ModalState, rows: RimRows, leap: Leap, coating: Coating, Q: Array, Q_next: Array, T: Array, averaged: bool,
    damped: bool,
    sums: Tally, out: Samples, h: float, first: int, steps: int,
) -> int:  # fmt: skip
    """Exact-modal steps at the moving point phi = phi_0 - Omega t: force at phi_n, gap at phi_{n+1}.

    Contact-free time is leapt over to the next step that is stored; what a coating has lost only widens the gap.
    """
    old, new = s.old, s.d
    m = s.q.size
    coated = coating.worn.size > 0
    bar, cut, skin = 0, 0.0, 0.0  # first bar under the tip, depths there of the cut and of the surface
    end, step, taken, retry = first + steps, first, 0, first if leap.powers.shape[0] else first + steps
    waves, ahead = rows.waves, rows.waves_next
    rotate(waves, rows.angle - rows.speed * first * h)
    fill(rows.normal, waves, Q)
    S_nn, S_nt = value(rows.S_nn, waves), value(rows.S_nt, waves)
    now, last, S_last = s.memory[0], s.memory[1], s.memory[4]
    while step < end:
        if step >= retry and now > 0.0 and last > 0.0 and sums.closed[0] == 0:
            room = min(end - step, untouched(out, sums, step))
            leapt = leap_rim(s, rows, leap, Q, new, damped, sums, h, step, room) if room > 0 else -1
            retry = step - leapt
            if leapt > 0:
                step += leapt
                retry = step
                now, last, S_last = s.memory[0], s.memory[1], s.memory[4]
                s.memory[2], s.memory[3] = 0.0, 0.0
                waves, ahead = rows.waves, rows.waves_next
                S_nn, S_nt = value(rows.S_nn, waves), value(rows.S_nt, waves)
                continue
        store_state(sums, out, step, step * h, s.q)
        old, new = new, old
        rotate(ahead, rows.angle - rows.speed * (step + 1) * h)
        fill(rows.normal, ahead, Q_next)
        free = value(rows.clearance, ahead) + free_gap(s, Q_next, old, new)
        test = 0.25 * (free + 2.0 * now + last) if averaged else free
        force, scale, pull, H = 0.0, 1.0, 0.0, 0.0
        if coated:
            bar = first_bar(coating, (rows.angle - rows.speed * step * h) / (2.0 * math.pi))
            cut = machined(coating, value(rows.clearance, waves))
            skin = surface(coating, bar, cut)
            coating.memory[1], coating.memory[2] = 0.0, skin
        if not test + skin >= 0.0:
            force = push(
                s, rows, coating, bar, cut, Q, Q_next, T, waves, old, new, h, averaged, S_nn, S_nt, test, rows.found
            )
            H, scale, pull, normal = rows.found[0], rows.found[1], rows.found[2], rows.found[3]
            if not force >= 0.0:
                s.memory[2], s.memory[3] = H, scale
                return step
            if rows.found[5] * rows.surface < 0.0:
                sums.reversals[0] += 1
            work = 0.5 * force * (free + H * force - last)
            if rows.S_turns:  # what S(phi) stores changes because the point moves, not because force does
                work += 0.5 * force * force * (S_nn - pull * S_nt - S_last)
            sums.work[0] += work
            sums.rotation[0] += 0.5 * force * normal - work
            sums.friction[0] -= 0.5 * force * pull * rows.found[4]
            retry = max(retry, step + PAUSE)
        if damped:
            sums.damping[0] += damping_work(s, old, new)
        s.gap[0] = test + scale * force
        if coated:
            s.gap[0] += coating.memory[2]  # from the surface as it is worn and pressed
        s.force[0] = force
        s.memory[2] = force
        s.memory[3] = pull
        note_contact(sums, out, 0, h, step * h, force, s.gap[0], scale, now + skin, free + skin)
        move(s, new)
        last, now = now, free + H * force
        store(sums, out, step, step * h, s.force, s.gap)
        Q, Q_next = Q_next, Q
        waves, ahead = ahead, waves
        if rows.S_turns:
            S_last = S_nn - pull * S_nt
            S_nn, S_nt = value(rows.S_nn, waves), value(rows.S_nt, waves)
        step += 1
        taken += 1
    s.memory[0], s.memory[1], s.memory[4] = now, last, S_last
    if taken % 2 == 1:  # the two buffers changed places an odd number of times
        for i in range(m):
            s.d[i] = s.old[i]
    return -1
