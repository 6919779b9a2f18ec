"""Compiled step loop of a rub: exact-modal coefficients, K turning tips, stick and slip by semi-smooth Newton."""

from __future__ import annotations

from contact.compiled import jit_entry_allocating
from contact.record import Samples, Tally
from contact.scheme.loop.rub_book import book, keep_strain, note, settle
from contact.scheme.loop.rub_look import look, propagate
from contact.scheme.loop.rub_rows import RubLaws, RubRows, turned
from contact.scheme.loop.rub_solve import drawn_in, gather, push, relax, soften, solve
from contact.scheme.loop.rub_state import RubState, work_space
from contact.scheme.loop.tally import due, store, store_state


@jit_entry_allocating
def advance_rub(s: RubState, laws: RubLaws, rows: RubRows, dim: int, averaged: bool, sums: Tally, out: Samples,
                h: float, first: int, steps: int) -> int:  # fmt: skip
    """Whole steps: force at phi_n, gap at phi_{n+1}, slip over the step."""
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
        s.contact[:] = 0.0
        count = 0
        while closing > 0:
            count = gather(s, rows, w, dim, share, angle)
            soften(rows, w, count, dim, before, angle)
            if not solve(s, rows, w, count, dim, share, omega * h):
                return step
            if not drawn_in(s, rows, w, count, dim, share):
                break
        if closing > 0:
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
