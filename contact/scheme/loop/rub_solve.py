"""The forces of one step: rows and compliances of the tips that close, friction, and what the forces push."""

from __future__ import annotations

import numpy as np

from contact.compiled import jit, jit_allocating
from contact.model.arrays import Array
from contact.scheme.loop.patch import ROUGH
from contact.scheme.loop.rub_rows import RubRows, blade_dot, dot, fill_block, residual_row, turn
from contact.scheme.loop.rub_state import RubState, Work
from contact.solver.coulomb import friction_forces
from contact.solver.friction_newton import TOLERANCE
from contact.solver.gliding import glide


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


@jit
def soften(rows: RubRows, w: Work, count: int, dim: int, before: float, angle: float) -> None:
    """Residual compliance of the chosen tips at phi_{n-1} and phi_n."""
    if rows.S_harmonic.size == 1:
        return
    for a in range(count * dim):
        row = w.chosen[a // dim] * dim + a % dim
        residual_row(rows, row, before, w.S_old[row])
        residual_row(rows, row, angle, w.S[row])


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
def dot_c(a: Array, c: Array, b: Array) -> float:
    """Sum of a c b over the entries of a."""
    total = 0.0
    for i in range(a.size):
        total += a[i] * c[i] * b[i]
    return total
