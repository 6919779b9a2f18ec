"""Compiled step loop of a rub on coatings: as `rub`, but each tip presses into the bars under it, which flow."""

from __future__ import annotations

import math

import numpy as np

from contact.compiled import jit_allocating, jit_entry_allocating
from contact.record import Samples, Tally
from contact.scheme.loop.patch import ROUGH
from contact.scheme.loop.rub_book import book, keep_strain, note, settle
from contact.scheme.loop.rub_look import look, propagate
from contact.scheme.loop.rub_rows import RubLaws, RubRows, blade_dot, dot, hermite, polynomial, turn, turned
from contact.scheme.loop.rub_solve import drawn_in, gather, push, relax, soften
from contact.scheme.loop.rub_state import RubState, Work, work_space
from contact.scheme.loop.tally import due, store, store_state
from contact.solver.abradable import first_bar, machined, surface, wear
from contact.solver.abradable_tips import Coats, coating_of, crush_tips


@jit_entry_allocating
def advance_coated(s: RubState, laws: RubLaws, rows: RubRows, coats: Coats, dim: int, averaged: bool, sums: Tally,
                   out: Samples, h: float, first: int, steps: int) -> int:  # fmt: skip
    """Whole steps: bars and force at phi_n, gap at phi_{n+1}, slip over the step."""
    w = work_space(s, rows)
    share, pressed = 0.25 if averaged else 1.0, True
    before, _ = turned(laws.speed, (first - 1) * h)
    angle, omega = turned(laws.speed, first * h)
    for step in range(first, first + steps):
        t = step * h
        ahead, omega_ahead = turned(laws.speed, t + h)
        propagate(s, laws, t, angle, omega)
        every = due(step, out.every, out.at, sums.filled[0])
        closing = look(s, laws, rows, w, dim, share, every, t, h, before, angle, ahead)
        closing -= stand(s, laws, rows, coats, dim, angle)
        s.contact[:] = 0.0
        count = 0
        while closing > 0:
            count = gather(s, rows, w, dim, share, angle)
            soften(rows, w, count, dim, before, angle)
            if not press(s, rows, w, coats, count, dim, share, omega * h):
                return step
            if not drawn_in(s, rows, w, count, dim, share):
                break
        if closing > 0:
            flow(s, w, coats, count, dim)
            push(s, rows, w, count, dim)
            relax(s, rows, w, count, dim)
            book(s, rows, w, count, dim, omega * h, sums)
            s.counts[2] += 1.0
        if closing > 0 or pressed:
            keep_strain(s, rows, w, count, dim)
        pressed = closing > 0
        s.seen[: s.q.size], s.seen[s.q.size :] = s.q, s.lam
        store_state(sums, out, step, t, s.seen)
        settle(s, sums)
        note(s, rows, w, dim, sums, out, h, t)
        store(sums, out, step, t, s.force, s.gap)
        before, angle, omega = angle, ahead, omega_ahead
    return -1


@jit_allocating
def stand(s: RubState, laws: RubLaws, rows: RubRows, coats: Coats, dim: int, angle: float) -> int:
    """Bars under the tips that are near; their gaps become those of the surface. How many no longer close."""
    apart = 0
    for j in range(s.mu.size):
        coats.memory[j, 1] = 0.0
        if s.inside[j] == 0:
            continue
        tip, phi, cut = coating_of(coats, j), rows.angle[j] - angle, 0.0
        if tip.round > -math.inf:
            turn(rows.waves, phi)
            cut = machined(tip, polynomial(laws.terms, rows.waves) + hermite(laws.table, phi))
        coats.first[j], coats.cut[j] = first_bar(tip, phi / (2.0 * math.pi)), cut
        s.skin[j] = surface(tip, coats.first[j], cut)
        s.test[j] += s.skin[j]
        s.motion[j * dim] = s.test[j]
        if s.inside[j] == 2 and s.test[j] >= 0.0 and not s.lam[j * dim] > 0.0:
            s.inside[j] = 1
            apart += 1
    return apart


@jit_allocating
def press(s: RubState, rows: RubRows, w: Work, coats: Coats, count: int, dim: int, share: float, slid: float) -> bool:
    """Forces of the chosen tips into `lam`, gaps from the pressed surface into `motion`; `slid` = Omega h."""
    size = count * dim
    W = np.dot(w.tests[:size], w.rows[:size].T)
    b, lam, mu, depth = np.zeros(size), np.zeros(size), np.zeros(count), np.zeros(count)
    for a in range(size):
        j, i = w.chosen[a // dim], a % dim
        row = j * dim + i
        for k in range(size):
            other = w.chosen[k // dim] * dim + k % dim
            W[a, k] += (share if i == 0 else 1.0) * rows.fixed[row, other] + w.S[row, other]
        lam[a] = s.lam[row]
        if i == 0:
            b[a], mu[a // dim], s.scale[j] = s.test[j] - s.skin[j], s.mu[j], W[a, a]
            continue
        b[a] = dot(w.rows[a], s.d) + blade_dot(rows, row, j, s.d) - s.strain[row]
        if i == 1:
            b[a] += rows.radius[j] * slid
    if not crush_tips(coats, w.chosen[:count], W, b, mu, dim, lam, depth):
        s.counts[3] = ROUGH
        return False
    w.pushed[:] = np.dot(lam, w.rows[:size])
    motion = np.dot(W, lam) + b
    for a in range(count):
        coats.memory[w.chosen[a], 2] = depth[a]
        motion[a * dim] += depth[a]
    for a in range(size):
        row = w.chosen[a // dim] * dim + a % dim
        s.lam[row], s.motion[row] = lam[a], motion[a]
    return True


@jit_allocating
def flow(s: RubState, w: Work, coats: Coats, count: int, dim: int) -> None:
    """Let the bars under the chosen tips flow, each to the depth that was found."""
    for a in range(count):
        j = w.chosen[a]
        if s.lam[j * dim] > 0.0:
            wear(coating_of(coats, j), coats.first[j], coats.cut[j], coats.memory[j, 2])
