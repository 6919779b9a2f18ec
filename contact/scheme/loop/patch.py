"""Compiled step loop of the exact-modal scheme with several contacts: active set, or friction by Newton."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from contact.compiled import jit_allocating, jit_entry_allocating
from contact.model.arrays import Array, Indices
from contact.record import Samples, Tally
from contact.scheme.loop.stick import Sticking, note_sticking
from contact.scheme.loop.tally import note_contact, store, store_state
from contact.solver.active_set import SOLVED, project
from contact.solver.coulomb import friction_forces
from contact.solver.friction_newton import TOLERANCE

JAMMED, ROUGH = 1.0, 2.0  # `fault`: no motion opens all gaps; friction not solved


class PatchState(NamedTuple):
    """Modes (m,) and contacts: k, or d k entries, normal first."""

    q: Array
    d: Array
    al: Array
    be: Array
    c: Array
    kick: Array
    weight: Array
    rows: Array  # (d k, m)
    S: Array  # (d k, d k), empty when zero
    W: Array  # rows c rows^T + S, empty without friction
    roots: Array  # A with A A^T = W, empty with friction
    own: Array  # W of each normal with itself (k,)
    mu: Array  # (k,)
    slide: Array  # (d k,), motion of the ground in one step
    lam: Array  # (d k,)
    moved: Array  # rows D of the last step (d k,)
    place: Array  # clearance + rows q, normal (k,)
    force: Array
    gap: Array
    past: Sticking
    counts: Array  # most iterations of one step, sum of iterations, steps with contact, fault


@jit_allocating
def frictionless(s: PatchState, b: Array) -> bool:
    """Forces of the active set method into `lam`; False when the gaps cannot all open."""
    s.lam[:] = 0.0
    status, changes = project(s.roots, b, s.lam, np.zeros(s.roots.shape[1]))
    note_iterations(s, changes)
    if status != SOLVED:
        s.counts[3] = JAMMED
    return bool(status == SOLVED)


@jit_allocating
def note_iterations(s: PatchState, iterations: int) -> None:
    """Keep the largest and the sum."""
    s.counts[0] = max(s.counts[0], float(iterations))
    s.counts[1] += float(iterations)
    s.counts[2] += 1.0


@jit_allocating
def frictional(s: PatchState, b: Array, dim: int, inside: Indices) -> bool:
    """Forces with friction into `lam`: contacts that close alone or pressed before, and those they draw in."""
    k = s.mu.size
    for i in range(k):
        inside[i] = 1 if b[i * dim] < 0.0 or s.lam[i * dim] > 0.0 else 0
        if inside[i] == 0:
            s.lam[i * dim : (i + 1) * dim] = 0.0
    spent = 0
    while True:
        count = int(inside.sum())
        chosen, mu = np.zeros(count * dim, dtype=np.int64), np.zeros(count)
        at = 0
        for i in range(k):
            if inside[i] == 1:
                mu[at] = s.mu[i]
                for j in range(dim):
                    chosen[at * dim + j] = i * dim + j
                at += 1
        W, short, lam = np.zeros((count * dim, count * dim)), np.zeros(count * dim), np.zeros(count * dim)
        for i in range(count * dim):
            short[i], lam[i] = b[chosen[i]], s.lam[chosen[i]]
            for j in range(count * dim):
                W[i, j] = s.W[chosen[i], chosen[j]]
        iterations, residual = friction_forces(W, short, mu, dim, lam)
        spent += iterations
        if not residual <= TOLERANCE:
            s.counts[3] = ROUGH
            note_iterations(s, spent)
            return False
        for i in range(count * dim):
            s.lam[chosen[i]] = lam[i]
        grown = False
        for i in range(k):
            if inside[i] == 0 and b[i * dim] + np.dot(s.W[i * dim], s.lam) < 0.0:
                inside[i], grown = 1, True
        if not grown:
            note_iterations(s, spent)
            return True


@jit_entry_allocating
def advance_patch(
    s: PatchState, rough: bool, sums: Tally, out: Samples, h: float, first: int, steps: int
) -> int:  # fmt: skip
    """Exact-modal steps, forward law in every contact."""
    k = s.mu.size
    dim = s.lam.size // k
    inside, old, b = np.zeros(k, dtype=np.int64), np.zeros(s.q.size), np.zeros(k * dim)
    for step in range(first, first + steps):
        store_state(sums, out, step, step * h, s.q)
        for i in range(s.q.size):
            old[i] = s.d[i]
            s.d[i] = s.al[i] * s.d[i] - s.be[i] * s.q[i] + s.kick[i]
        np.dot(s.rows, s.d, b)
        if not math.isfinite(b[0]):
            return step
        soft = s.S.size > 0
        if rough:
            for row in range(b.size):
                b[row] -= s.slide[row]
            if soft:
                rest = np.dot(s.S, s.lam)
                for row in range(b.size):
                    b[row] -= rest[row]  # the slip of a step is the change of T q + S lam ...
        touches = False
        for i in range(k):
            if rough and soft:
                b[i * dim] += np.dot(s.S[i * dim], s.lam)  # ... the gap its value
            b[i * dim] += s.place[i]
            touches |= not b[i * dim] >= 0.0
        if touches:
            if not (frictional(s, b, dim, inside) if rough else frictionless(s, b)):
                return step
            push(s, rough, dim, old, sums)
        else:
            s.lam[:] = 0.0
            np.dot(s.rows, s.d, s.moved)
        total = 0.0
        for i in range(s.q.size):
            total -= s.weight[i] * old[i] * (old[i] + s.d[i])
            s.q[i] += s.d[i]
        sums.damping[0] += total
        for i in range(k):
            row = i * dim
            before = s.place[i]
            s.place[i] += s.moved[row]
            s.force[i] = s.lam[row]
            s.gap[i] = 0.0
            if s.force[i] == 0.0:
                s.gap[i] = s.place[i] + (np.dot(s.S[row], s.lam) if soft else 0.0)
            note_contact(sums, out, i, h, step * h, s.force[i], s.gap[i], s.own[i], before, b[row])
            if rough:
                note_sticking(s.past, sums, out, i, step * h, h, s.mu[i], s.W, s.lam, b)
        store(sums, out, step, step * h, s.force, s.gap)
    return -1


@jit_allocating
def push(s: PatchState, rough: bool, dim: int, old: Array, sums: Tally) -> None:
    """Add the contact forces to the increments, and their work along (D_n + D_{n+1})/2 to the sums."""
    pushed = np.dot(s.lam, s.rows)
    for i in range(s.q.size):
        s.d[i] += s.c[i] * pushed[i]
    after = np.dot(s.rows, s.d)
    for i in range(s.mu.size):
        row = i * dim
        sums.work[i] += 0.5 * s.lam[row] * (s.moved[row] + after[row])
        if rough:
            for j in range(row + 1, row + dim):
                sums.friction[i] += 0.5 * s.lam[j] * (s.moved[j] + after[j])
    for row in range(after.size):
        s.moved[row] = after[row]
