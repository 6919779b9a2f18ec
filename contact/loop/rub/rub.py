"""Compiled step loop of a rub: exact-modal coefficients, K turning tips, stick and slip by semi-smooth Newton.

Two loops come of it: with `coats` None tips meet a rigid surface, else they press into bars of a coating, which flow.
"""

from __future__ import annotations

import math

from contact.jit.compiled import jit, jit_vectors
from contact.loop.modal.rows import rotate
from contact.loop.rub.alone import alone
from contact.loop.rub.compliance import fill_few, strains
from contact.loop.rub.ledger import add_works, advance_modes, note
from contact.loop.rub.predict import find_near, propagate
from contact.loop.rub.rows import AHEAD, BEFORE, NOW, RubLaws, RubRows, hermite, look_at, polynomial, turned
from contact.loop.rub.solve import clear, gather, others_close, push, solve, update_gaps
from contact.loop.rub.state import RubState, Work
from contact.loop.tally import due, outgrown, rim_amplitude, state_due, store, store_state
from contact.model.gaps.limits import LOOK
from contact.record.record import Samples, Tally
from contact.solver.abradable.one_tip import first_bar, machined, surface, wear
from contact.solver.abradable.tips import Coats, coating_of
from contact.solver.dense import assign


@jit
def stand(s: RubState, laws: RubLaws, rows: RubRows, w: Work, coats: Coats, dim: int, angle: float) -> int:
    """Bars under the tips that are near; their gaps become those of the surface. How many no longer close."""
    apart = 0
    for j in range(s.mu.size):
        coats.memory[j, 1] = 0.0
        if s.inside[j] == 0:
            continue
        tip, phi, cut = coating_of(coats, j), rows.angle[j] - angle, 0.0
        if tip.round > -math.inf:
            rotate(w.turn, phi)
            cut = machined(tip, polynomial(laws.terms, w.turn) + hermite(laws.table, phi))
        coats.first[j], coats.cut[j] = first_bar(tip, phi / (2.0 * math.pi)), cut
        s.skin[j] = surface(tip, coats.first[j], cut)
        s.test[j] += s.skin[j]
        s.motion[j * dim] = s.test[j]
        if s.inside[j] == 2 and s.test[j] >= 0.0 and not s.lam[j * dim] > 0.0:
            s.inside[j] = 1
            apart += 1
    return apart


@jit
def flow(s: RubState, w: Work, coats: Coats, count: int, dim: int) -> None:
    """Let the bars under the chosen tips flow, each to the depth that was found."""
    for a in range(count):
        j = w.chosen[a]
        if s.lam[j * dim] > 0.0:
            wear(coating_of(coats, j), coats.first[j], coats.cut[j], coats.memory[j, 2])


@jit_vectors
def advance_rub(s: RubState, laws: RubLaws, rows: RubRows, coats: Coats | None, w: Work, dim: int, averaged: bool,
                sums: Tally, out: Samples, h: float, first: int, steps: int) -> int:  # fmt: skip
    """Whole steps: bars and force at phi_n, gap at phi_{n+1}, slip over the step."""
    share, pressed = 0.25 if averaged else 1.0, True
    before, _ = turned(laws.speed, (first - 1) * h)
    angle, omega = turned(laws.speed, first * h)
    look_at(w.angles, BEFORE, before)
    look_at(w.angles, NOW, angle)
    for step in range(first, first + steps):
        t = step * h
        ahead, omega_ahead = turned(laws.speed, (step + 1) * h)  # not t + h, which is rounded: runs may be split
        look_at(w.angles, AHEAD, ahead)
        propagate(s, laws, t, angle, omega)
        every = due(step, out.every, out.at, sums.filled[0])
        closing = find_near(s, laws, rows, w, dim, share, every, t, h)
        if coats is not None:
            closing -= stand(s, laws, rows, w, coats, dim, angle)
        count = 0
        while closing > 0:
            count = 0
            if coats is None:  # a branch that is left out of the loop with a coating, and not compiled there
                if closing == 1 and alone(s, rows, w, dim, share, omega * h, step):
                    count = 1
            if count == 0:
                count = gather(s, rows, w, dim, share)
                if rows.turns and rows.few:
                    fill_few(rows, w, count, step)
                if not solve(s, rows, w, coats, count, dim, share, omega * h):
                    return step
            if not others_close(s, rows, w, count, dim, share):
                break
            closing = count + 1  # at least
        if closing > 0 or pressed:
            strains(s, rows, w, count, dim)
        if closing > 0:
            if coats is not None:
                flow(s, w, coats, count, dim)
            push(s, rows, w, count, dim)
            update_gaps(s, w, count, dim, share)
            add_works(s, rows, w, count, dim, omega * h, sums)
            s.counts[2] += 1.0
        elif pressed:
            clear(s.contact, 0)
        if closing > 0 or pressed:
            assign(s.strain, w.strain, w.strain.size)
        pressed = closing > 0
        if state_due(sums, out, step):
            modes = s.seen.size - s.lam.size
            assign(s.seen, s.q, modes)
            for i in range(s.lam.size):
                s.seen[modes + i] = s.lam[i]
            store_state(sums, out, step, t, s.seen)
        advance_modes(s, sums)
        note(s, rows, w, dim, sums, out, h, t)
        store(sums, out, step, t, s.force, s.gap)
        angle, omega = ahead, omega_ahead
        for i in range(3):
            w.angles[BEFORE, i], w.angles[NOW, i] = w.angles[NOW, i], w.angles[AHEAD, i]
        w.side[0] = 1 - w.side[0]
        if step % LOOK == 0:
            for line in range(rows.reach.shape[0]):
                rim_amplitude(s.limits, rows.reach[line], s.q)
        if outgrown(s.limits):
            return step + 1
    return -1
