"""Compiled step loop of a rub: exact-modal coefficients, K turning tips, stick and slip by semi-smooth Newton."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from contact.compiled import jit, jit_allocating
from contact.model.arrays import Array, Indices
from contact.record import Samples, Tally
from contact.scheme.loop_patch import ROUGH
from contact.scheme.loop_rim import dot, turn
from contact.scheme.loop_rub_rows import (
    RubLaws,
    RubRows,
    blade_dot,
    fill_block,
    gap_of,
    least_gap,
    residual_row,
    rigid_gap,
    straight,
    turned,
)
from contact.scheme.loop_stick import INSIDE
from contact.scheme.loop_tally import due, note_contact, note_stick, store, store_state
from contact.solver.coulomb import friction_forces
from contact.solver.friction_newton import TOLERANCE
from contact.solver.gliding import glide


class RubState(NamedTuple):
    """Modes (m,), tips (K,) and their d directions each (K d,), normal first."""

    q: Array
    d: Array
    old: Array
    al: Array
    be: Array
    c: Array
    kick: Array
    weight: Array
    stiff: Array  # (b, b) of all blades' modes, empty without stiffening
    stiff_at: Array  # the same times Omega^2 of each basis
    push: Array  # (m,) force of the stiffening
    contact: Array  # (m,) force of the tips
    mu: Array
    lam: Array
    strain: Array  # S lam of the last step
    motion: Array  # gaps and slips that obey the law
    scale: Array  # (K,) Delassus number of each normal with itself
    now: Array  # gap of q at t_n, valid where `known`
    last: Array  # at t_{n-1}
    known: Indices
    inside: Indices  # 2 in the solve, 1 near, 0 far
    free: Array
    test: Array
    force: Array
    gap: Array
    seen: Array  # (m + K d,) what `Result.state` holds: q and lam of one instant
    heat: Array  # dissipated by slip
    drive: Array  # work of the drive against friction
    peaks: Array  # largest |u_r| of the rim at a tip, tangential motion of a tip; bound of |u_r| now, by line
    counts: Array  # most iterations of one step, their sum, steps with contact, fault


class Work(NamedTuple):
    """Buffers of one call: rows at t_{n+1} and t_n, Delassus matrix, and what the forces push."""

    ahead: Array  # (K, m_casing) normal rows at t_{n+1}
    rows: Array  # (K d, m_casing) all rows at t_n, in the order of `chosen`
    tests: Array  # (K d, m_casing) those the law is stated with, times c
    chosen: Indices  # (K,)
    pushed: Array  # (m_casing,)
    S: Array  # (K d, K d) residual compliance at phi_n; rows of tips that are not solved for may be stale
    S_old: Array  # at phi_{n-1}


@jit_allocating
def work_space(s: RubState, rows: RubRows) -> Work:
    """Buffers; a residual compliance that does not turn is put there for good."""
    K, R, m = s.mu.size, s.lam.size, rows.start.size - 1
    S = rows.S_cos[0].copy()
    return Work(
        np.zeros((K, m)), np.zeros((R, m)), np.zeros((R, m)), np.zeros(K, dtype=np.int64), np.zeros(m), S, S.copy()
    )


@jit
def soften(rows: RubRows, w: Work, count: int, dim: int, before: float, angle: float) -> None:
    """Residual compliance of the chosen tips at phi_{n-1} and phi_n."""
    if rows.S_harmonic.size == 1:
        return
    for a in range(count * dim):
        row = w.chosen[a // dim] * dim + a % dim
        residual_row(rows, row, before, w.S_old[row])
        residual_row(rows, row, angle, w.S[row])


@jit
def propagate(s: RubState, omega: float) -> None:
    """D* = al D - be q + c (f - stiffening), the last increment kept in `old`."""
    b = s.stiff.shape[0]
    begin = s.q.size - b
    for i in range(b):
        total = 0.0
        for k in range(b):
            total -= (omega * omega * s.stiff[i, k] - s.stiff_at[i, k]) * s.q[begin + k]
        s.push[begin + i] = total
    for i in range(s.q.size):
        s.old[i] = s.d[i]
        s.d[i] = s.al[i] * s.d[i] - s.be[i] * s.q[i] + s.kick[i]
    for i in range(begin, s.q.size):
        s.d[i] += s.c[i] * s.push[i]


@jit
def look(s: RubState, laws: RubLaws, rows: RubRows, w: Work, dim: int, share: float, every: bool,
         t: float, h: float, before: float, angle: float, ahead: float) -> int:  # fmt: skip
    """Free gaps of the tips that could touch; marks those that are solved for and returns how many."""
    inside, m = 0, rows.start.size - 1
    closing = straight(laws.closing, t + h)
    for line in range(rows.reach.shape[0]):
        bound = 0.0
        for i in range(m):
            bound += rows.reach[line, i] * abs(s.q[i] + s.d[i])
        s.peaks[2 + line] = bound
    for j in range(s.mu.size):
        R = j * dim
        blade = blade_dot(rows, R, j, s.q) + blade_dot(rows, R, j, s.d)
        low = least_gap(laws, rows, j, closing) + blade - s.peaks[2 + rows.line[j]]
        pressed = s.lam[R] > 0.0 or (s.known[j] == 1 and min(s.now[j], s.last[j]) < 0.0)
        if low > 0.0 and not pressed and not every:
            s.inside[j], s.known[j], s.gap[j] = 0, 0, low
            continue
        if s.known[j] == 0:
            s.now[j] = gap_of(laws, rows, j, t, angle, dim, s.q, w.ahead[j])
            s.last[j] = gap_of(laws, rows, j, t - h, before, dim, s.q, w.ahead[j])
            s.last[j] -= dot(w.ahead[j], s.old) + blade_dot(rows, R, j, s.old)
        rigid = rigid_gap(laws, rows, j, t + h, ahead)
        fill_block(rows, rows.line[j] * rows.directions, w.ahead[j])
        s.free[j] = rigid + blade + dot(w.ahead[j], s.q) + dot(w.ahead[j], s.d)
        s.test[j] = s.free[j] if share == 1.0 else 0.25 * (s.free[j] + 2.0 * s.now[j] + s.last[j])
        s.inside[j], s.motion[R] = 1, s.test[j]
        if not s.test[j] >= 0.0 or s.lam[R] > 0.0:
            s.inside[j] = 2
            inside += 1
    return inside


@jit
def gather(s: RubState, rows: RubRows, w: Work, dim: int, share: float, angle: float) -> int:
    """Rows at t_n of the tips to be solved, and the rows of the law times c; returns how many tips."""
    count = 0
    for j in range(s.mu.size):
        if s.inside[j] != 2:
            for i in range(j * dim, (j + 1) * dim):
                s.lam[i] = 0.0
            continue
        turn(rows.waves, rows.angle[j] - angle)
        for i in range(dim):
            a = count * dim + i
            fill_block(rows, rows.line[j] * rows.directions + i, w.rows[a])
            for k in range(w.pushed.size):
                w.tests[a, k] = s.c[k] * (share * w.ahead[j, k] if i == 0 else w.rows[a, k])
        w.chosen[count] = j
        count += 1
    return count


@jit_allocating
def solve(s: RubState, rows: RubRows, w: Work, count: int, dim: int, share: float, slid: float) -> bool:
    """Forces of the chosen tips into `lam`, their gaps into `gap`; `slid` = Omega h."""
    size = count * dim
    W = np.dot(w.tests[:size], w.rows[:size].T)
    b, lam, mu = np.zeros(size), np.zeros(size), np.zeros(count)
    for a in range(size):
        j, i = w.chosen[a // dim], a % dim
        row = j * dim + i
        for k in range(size):
            other = w.chosen[k // dim] * dim + k % dim
            W[a, k] += (share if i == 0 else 1.0) * rows.fixed[row, other] + w.S[row, other]
        lam[a] = s.lam[row]
        if i == 0:
            b[a], mu[a // dim], s.scale[j] = s.test[j], s.mu[j], W[a, a]
            continue
        b[a] = dot(w.rows[a], s.d) + blade_dot(rows, row, j, s.d) - s.strain[row]
        if i == 1:
            b[a] += rows.radius[j] * slid
    if dim > 1 and count > 1:
        glide(W, b, mu, dim, lam)
    iterations, miss = friction_forces(W, b, mu, dim, lam)
    s.counts[0] = max(s.counts[0], float(iterations))
    s.counts[1] += float(iterations)
    if not miss <= TOLERANCE:
        s.counts[3] = ROUGH
        return False
    w.pushed[:] = np.dot(lam, w.rows[:size])
    motion = np.dot(W, lam) + b
    for a in range(size):
        j, i = w.chosen[a // dim], a % dim
        s.lam[j * dim + i] = lam[a]
        s.motion[j * dim + i] = motion[a]
    return True


@jit
def drawn_in(s: RubState, rows: RubRows, w: Work, count: int, dim: int, share: float) -> bool:
    """Whether the forces close tips that were left out; these are marked, the gaps of the others noted."""
    grown = False
    for j in range(s.mu.size):
        if s.inside[j] != 1:
            continue
        R = j * dim
        gap = s.test[j]
        for k in range(w.pushed.size):
            gap += share * w.ahead[j, k] * s.c[k] * w.pushed[k]
        for a in range(count * dim):
            other = w.chosen[a // dim] * dim + a % dim
            gap += (share * rows.fixed[R, other] + w.S[other, R]) * s.lam[other]
        s.motion[R] = gap
        if gap < 0.0:
            s.inside[j], grown = 2, True
    return grown


@jit
def push(s: RubState, rows: RubRows, w: Work, count: int, dim: int) -> None:
    """Forces on the modes, and what they add to the increments."""
    for k in range(w.pushed.size):
        s.contact[k] = w.pushed[k]
    for a in range(count * dim):
        j = w.chosen[a // dim]
        row, begin = j * dim + a % dim, rows.own[j, 0]
        for k in range(begin, rows.own[j, 1]):
            s.contact[k] += rows.blade[row, k - begin] * s.lam[row]
    for i in range(s.d.size):
        s.d[i] += s.c[i] * s.contact[i]


@jit
def relax(s: RubState, rows: RubRows, w: Work, count: int, dim: int) -> None:
    """Add the forces' share to the gaps of q at t_{n+1}, for every tip near enough to be looked at."""
    for j in range(s.mu.size):
        if s.inside[j] == 0:
            continue
        s.free[j] += dot_c(w.ahead[j], s.c, w.pushed)
        for a in range(count * dim):
            other = w.chosen[a // dim] * dim + a % dim
            s.free[j] += rows.fixed[j * dim, other] * s.lam[other]


@jit
def book(s: RubState, rows: RubRows, w: Work, count: int, dim: int, slid: float, sums: Tally) -> None:
    """Work of the forces along (D_n + D_{n+1})/2: by the gap, by the turning point, by friction; heat and drive.

    What the tangential compliance takes up is friction's work on the bodies, and the contact's loss until S gives it
    back; what S stores because the point moves is the turning point's.
    """
    for a in range(count * dim):
        j, i = w.chosen[a // dim], a % dim
        row, before = j * dim + i, 0.0
        along = dot(w.rows[a], s.old) + dot(w.rows[a], s.d) + blade_dot(rows, row, j, s.old)
        along = 0.5 * s.lam[row] * (along + blade_dot(rows, row, j, s.d))
        strain, moved = 0.0, 0.0
        for k in range(count * dim):
            other = w.chosen[k // dim] * dim + k % dim
            strain += w.S[row, other] * s.lam[other]
            before += w.S_old[row, other] * s.lam[other]
        moved = 0.5 * s.lam[row] * (strain - before)
        sums.work[j] += moved
        sums.rotation[j] -= moved
        if i == 0:
            work = 0.5 * s.lam[row] * (s.free[j] - s.last[j])
            sums.work[j] += work
            sums.rotation[j] += along - work
            continue
        soft = s.lam[row] * (strain - s.strain[row])
        sums.friction[j] += along + soft
        sums.work[j] -= soft
        s.heat[j] -= s.lam[row] * s.motion[row]
        if i == 1:
            s.drive[j] -= s.lam[row] * rows.radius[j] * slid


@jit
def keep_strain(s: RubState, rows: RubRows, w: Work, count: int, dim: int) -> None:
    """S lam in every direction of every tip, for the slip of the next step."""
    for row in range(s.strain.size):
        s.strain[row] = 0.0
        for a in range(count * dim):
            other = w.chosen[a // dim] * dim + a % dim
            s.strain[row] += w.S[other, row] * s.lam[other]


@jit
def settle(s: RubState, sums: Tally) -> None:
    """Add the increments, and the work of damping and of the stiffening."""
    lost, given = 0.0, 0.0
    for i in range(s.q.size):
        lost -= s.weight[i] * s.old[i] * (s.old[i] + s.d[i])
        given += 0.5 * s.push[i] * (s.old[i] + s.d[i])
        s.q[i] += s.d[i]
    sums.damping[0] += lost
    sums.external[0] += given


@jit
def dot_c(a: Array, c: Array, b: Array) -> float:
    """Sum of a c b over the entries of a."""
    total = 0.0
    for i in range(a.size):
        total += a[i] * c[i] * b[i]
    return total


@jit
def note(s: RubState, rows: RubRows, w: Work, dim: int, sums: Tally, out: Samples, h: float, time: float) -> None:
    """Forces, gaps and events of this step; the gaps of q move on."""
    for j in range(s.mu.size):
        R = j * dim
        s.force[j] = s.lam[R]
        before, predicted = 0.0, 0.0
        if s.inside[j] > 0:
            s.gap[j] = s.motion[R]
            before, predicted = s.now[j], s.test[j]
            s.last[j], s.now[j], s.known[j] = s.now[j], s.free[j], 1
        if s.inside[j] == 2:
            s.peaks[0] = max(s.peaks[0], abs(dot(w.ahead[j], s.q)))
            if dim > 1:
                s.peaks[1] = max(s.peaks[1], abs(blade_dot(rows, R + 1, j, s.q)))
        note_contact(sums, out, j, h, time, s.force[j], s.gap[j], s.scale[j], before, predicted)
        if dim > 1:
            note_stick(sums, out, j, int(sticks(s, R, dim, j)), time)


@jit
def sticks(s: RubState, row: int, dim: int, j: int) -> bool:
    """Whether a contact presses and its tangential force lies inside the cone."""
    pull = 0.0
    for i in range(row + 1, row + dim):
        pull += s.lam[i] * s.lam[i]
    return bool(s.lam[row] > 0.0 and math.sqrt(pull) < s.mu[j] * s.lam[row] * (1.0 - INSIDE))


@jit_allocating
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
        propagate(s, omega)
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
