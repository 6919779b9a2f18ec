"""Compiled step loop of the exact-modal scheme with several contacts: active set, or friction by Newton."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from contact.base.arrays import Array, Indices
from contact.jit.compiled import jit, jit_entry
from contact.loop.limits import outgrown, tip_motion
from contact.loop.tally import Sticking, note_contact, note_sticking, note_yielding, store, store_state
from contact.record.record import Samples, Tally
from contact.solver.dense import assign, dot
from contact.solver.friction.all_sliding import AllSliding
from contact.solver.friction.coulomb import friction_forces, solver_room
from contact.solver.friction.newton import TOLERANCE
from contact.solver.friction.room import Room
from contact.solver.unilateral.active_set import SOLVED, ActiveSpace, active_space, project
from contact.solver.unilateral.springs import SpringSpace, spring_forces, spring_space
from contact.solver.yielding.several import yielding_forces
from contact.solver.yielding.yields import Yielding, note_slope, paced

JAMMED, ROUGH, UNSETTLED = 1.0, 2.0, 3.0  # `fault`: no motion opens all gaps; friction, springs not solved


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
    W: Array  # rows c rows^T + S where Newton's method solves for the contacts, else empty
    roots: Array  # A with A A^T = W, or rows sqrt(c) where there are springs; empty where W is not
    springs: Array  # diagonal of S (k,) where the contacts are solved as springs, else empty
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
    limits: Array  # as `motion_limits`: of gaps, without a rim


class PatchBlocks(NamedTuple):
    """Coefficients of the coupled modes (b, b), as in `scheme.modal.coupled`, and work space (b,)."""

    modes: Indices  # (b,)
    alpha: Array
    beta: Array
    c: Array
    lost: Array
    false: Array
    odd: Array
    old: Array
    now: Array


class PatchWork(NamedTuple):
    """Work space: free gaps and slips, the contacts that are solved for and their problem."""

    b: Array  # (d k,)
    old: Array  # (m,)
    pushed: Array  # (m,)
    after: Array  # (d k,)
    inside: Indices  # (k,)
    chosen: Indices  # (d k,)
    numbers: Indices  # (k,) of the chosen contacts
    depth: Array  # (k,) of the chosen contacts, where they give way
    deep: Array  # (k,) the same of all contacts
    mu: Array  # (k,)
    W: Array  # (d k, d k), empty without friction
    short: Array  # (d k,)
    lam: Array  # (d k,)
    active: ActiveSpace  # empty with friction and with springs
    soft: SpringSpace  # empty without springs
    all_sliding: AllSliding
    room: Room  # empty without


def patch_work(s: PatchState, rough: bool, slides: bool) -> PatchWork:
    """Work space of a run; `rough` where Newton's method solves for the contacts, `slides` where they give way too."""
    k, n, m = s.mu.size, s.lam.size, s.q.size
    size = n if rough else 0
    columns, springs = s.roots.shape[1], s.springs.size
    return PatchWork(
        b=np.zeros(n), old=np.zeros(m), pushed=np.zeros(m), after=np.zeros(n), inside=np.zeros(k, dtype=np.int64),
        chosen=np.zeros(n, dtype=np.int64), numbers=np.zeros(k, dtype=np.int64), depth=np.zeros(k), deep=np.zeros(k),
        mu=np.zeros(k), W=np.zeros((size, size)), short=np.zeros(n),
        lam=np.zeros(n), active=active_space(k, 0 if springs else columns),
        soft=spring_space(springs, columns if springs else 0), all_sliding=AllSliding(used=slides),
        room=solver_room(size // (n // k), n // k),
    )  # fmt: skip


@jit
def fly_coupled(s: PatchState, blocks: PatchBlocks) -> None:
    """Add alpha D - beta q to the increments of coupled modes, which have none yet but the loads'."""
    for i in range(blocks.modes.size):
        blocks.now[i] = s.q[blocks.modes[i]]
    for i in range(blocks.modes.size):
        moved = dot(blocks.alpha[i], blocks.old, blocks.old.size) - dot(blocks.beta[i], blocks.now, blocks.now.size)
        s.d[blocks.modes[i]] += moved


@jit
def push_coupled(s: PatchState, blocks: PatchBlocks, pushed: Array) -> None:
    """Add c f to the increments of coupled modes."""
    for i in range(blocks.modes.size):
        blocks.now[i] = pushed[blocks.modes[i]]
    for i in range(blocks.modes.size):
        s.d[blocks.modes[i]] += dot(blocks.c[i], blocks.now, blocks.now.size)


@jit
def works_of_coupling(s: PatchState, blocks: PatchBlocks, sums: Tally) -> None:
    """Work of damping and of a skew stiffness on coupled modes, and what the discrete energy errs by; q is at t_n."""
    for i in range(blocks.modes.size):
        blocks.now[i] = s.q[blocks.modes[i]]
    for i in range(blocks.modes.size):
        both = 0.5 * (blocks.old[i] + s.d[blocks.modes[i]])
        sums.damping[0] -= both * dot(blocks.lost[i], blocks.old, blocks.old.size)
        sums.algorithmic[0] -= both * dot(blocks.false[i], blocks.old, blocks.old.size)
        sums.external[0] -= both * dot(blocks.odd[i], blocks.now, blocks.now.size)


@jit
def frictionless(s: PatchState, w: PatchWork) -> bool:
    """Forces of springs or of the active set method into `lam`; False when the gaps cannot all open."""
    if s.springs.size > 0:
        solved, count = spring_forces(s.roots, s.springs, w.b, s.lam, w.soft)
        note_iterations(s, count)
        if not solved:
            s.counts[3] = UNSETTLED
        return solved
    status, changes = project(s.roots, w.b, s.mu.size, s.roots.shape[1], s.lam, w.active)
    note_iterations(s, changes)
    if status != SOLVED:
        s.counts[3] = JAMMED
    return bool(status == SOLVED)


@jit
def note_iterations(s: PatchState, iterations: int) -> None:
    """Keep the largest and the sum."""
    s.counts[0] = max(s.counts[0], float(iterations))
    s.counts[1] += float(iterations)
    s.counts[2] += 1.0


@jit
def chosen_forces(s: PatchState, w: PatchWork, y: Yielding | None, dim: int, h: float) -> bool:
    """Forces into `lam` with friction or a force-depth law: of contacts that close alone or pressed before, and others.

    Others are those that the first draw in.
    """
    k, b, inside = s.mu.size, w.b, w.inside
    for i in range(k):
        inside[i] = 1 if b[i * dim] < 0.0 or s.lam[i * dim] > 0.0 else 0
        if inside[i] == 0:
            for row in range(i * dim, (i + 1) * dim):
                s.lam[row] = 0.0
    if y is not None:
        for i in range(k):
            paced(y, i, h)
    spent = 0
    while True:
        count = gather(s, w, dim)
        if y is None:
            iterations, residual = friction_forces(w.W, w.short, w.mu, dim, count, w.lam, w.room)
            solved = residual <= TOLERANCE
        else:
            iterations = 1
            solved = yielding_forces(
                None, y, w.numbers, w.W, w.short, w.mu, dim, count, w.lam, w.depth, w.all_sliding, w.room
            )
            for i in range(k):
                w.deep[i] = 0.0
            for i in range(count):
                w.deep[w.numbers[i]] = w.depth[i]
        spent += iterations
        if not solved:
            s.counts[3] = ROUGH
            note_iterations(s, spent)
            return False
        for i in range(count * dim):
            s.lam[w.chosen[i]] = w.lam[i]
        grown = False
        for i in range(k):
            if inside[i] == 0 and b[i * dim] + dot(s.W[i * dim], s.lam, s.lam.size) < 0.0:
                inside[i], grown = 1, True
        if not grown:
            note_iterations(s, spent)
            return True


@jit
def gather(s: PatchState, w: PatchWork, dim: int) -> int:
    """Problem of the contacts that are `inside`; returns how many."""
    count = 0
    for i in range(s.mu.size):
        if w.inside[i] == 1:
            w.mu[count], w.numbers[count] = s.mu[i], i
            for j in range(dim):
                w.chosen[count * dim + j] = i * dim + j
            count += 1
    for i in range(count * dim):
        w.short[i], w.lam[i] = w.b[w.chosen[i]], s.lam[w.chosen[i]]
        for j in range(count * dim):
            w.W[i, j] = s.W[w.chosen[i], w.chosen[j]]
    return count


@jit_entry
def advance_patch(
    s: PatchState, w: PatchWork, y: Yielding | None, blocks: PatchBlocks | None, rough: bool, averaged: bool,
    sums: Tally, out: Samples, h: float, first: int, steps: int,
) -> int:  # fmt: skip
    """Exact-modal steps; `averaged` law of contacts that give way, else the forward law. W is that of the law."""
    k = s.mu.size
    dim, soft = s.lam.size // k, s.S.size > 0
    for step in range(first, first + steps):
        store_state(sums, out, step, step * h, s.q)
        for i in range(s.q.size):
            w.old[i] = s.d[i]
            s.d[i] = s.al[i] * s.d[i] - s.be[i] * s.q[i] + s.kick[i]
        if blocks is not None:
            for i in range(blocks.modes.size):
                blocks.old[i] = w.old[blocks.modes[i]]
            fly_coupled(s, blocks)
        touches = look(s, w, rough, averaged, dim, soft)
        if not math.isfinite(w.b[0]):
            return step
        if touches:
            if s.W.size > 0:
                if not chosen_forces(s, w, y, dim, h):
                    return step
            elif not frictionless(s, w):
                return step
            push(s, w, blocks, rough, dim, sums)
        else:
            for row in range(s.lam.size):
                s.lam[row] = 0.0
                s.moved[row] = dot(s.rows[row], s.d, s.q.size)
        if blocks is not None:
            works_of_coupling(s, blocks, sums)
        total = 0.0
        for i in range(s.q.size):
            total -= s.weight[i] * w.old[i] * (w.old[i] + s.d[i])
            s.q[i] += s.d[i]
        sums.damping[0] += total
        for i in range(k):
            row = i * dim
            before = s.place[i]
            s.place[i] += s.moved[row]
            s.force[i] = s.lam[row]
            s.gap[i] = 0.0
            if s.force[i] == 0.0:
                s.gap[i] = s.place[i] + (dot(s.S[row], s.lam, s.lam.size) if soft else 0.0)
            if y is None:
                note_contact(sums, out, i, h, step * h, s.force[i], s.gap[i], s.own[i], before, w.b[row])
            else:
                s.gap[i] = w.b[row] + (dot(s.W[row], s.lam, s.lam.size) if touches else 0.0)
                depth = w.deep[i] if s.force[i] > 0.0 else 0.0
                note_yielding(sums, out, y, i, h, step * h, s.force[i], s.gap[i], depth, before, w.b[row])
                note_slope(y, i, depth)
            if rough:
                note_sticking(s.past, sums, out, i, step * h, h, s.mu[i], s.W, s.lam, w.b)
            tip_motion(s.limits, s.place[i])
        store(sums, out, step, step * h, s.force, s.gap)
        if outgrown(s.limits):
            return step + 1
    return -1


@jit
def look(s: PatchState, w: PatchWork, rough: bool, averaged: bool, dim: int, soft: bool) -> bool:
    """Fill `b` with the free gaps, or their means of three steps, and slips; whether a gap is negative (or NaN)."""
    touches, n = False, s.lam.size
    for row in range(n):
        w.b[row] = dot(s.rows[row], s.d, s.q.size)
        if rough:
            normal = row % dim == 0
            w.b[row] -= s.slide[row]
            if soft and not normal:  # the slip of a step is the change of T q + S lam, the gap its value
                w.b[row] -= dot(s.S[row], s.lam, n)
    for i in range(s.mu.size):
        if averaged:
            w.b[i * dim] = 0.25 * (w.b[i * dim] - s.moved[i * dim])
        w.b[i * dim] += s.place[i]
        touches |= not w.b[i * dim] >= 0.0
    return touches


@jit
def push(s: PatchState, w: PatchWork, blocks: PatchBlocks | None, rough: bool, dim: int, sums: Tally) -> None:
    """Add the contact forces to the increments, and their work along (D_n + D_{n+1})/2 to the sums."""
    for i in range(s.q.size):
        w.pushed[i] = 0.0
    for row in range(s.lam.size):
        if s.lam[row] != 0.0:
            for i in range(s.q.size):
                w.pushed[i] += s.lam[row] * s.rows[row, i]
    for i in range(s.q.size):
        s.d[i] += s.c[i] * w.pushed[i]
    if blocks is not None:
        push_coupled(s, blocks, w.pushed)
    for row in range(s.lam.size):
        w.after[row] = dot(s.rows[row], s.d, s.q.size)
    for i in range(s.mu.size):
        row = i * dim
        sums.work[i] += 0.5 * s.lam[row] * (s.moved[row] + w.after[row])
        if rough:
            for j in range(row + 1, row + dim):
                sums.friction[i] += 0.5 * s.lam[j] * (s.moved[j] + w.after[j])
    assign(s.moved, w.after, s.lam.size)
