"""The forces of one step: rows and compliances of the tips that close, friction, and what the forces push."""

from __future__ import annotations

import math

from contact.base.arrays import Array
from contact.jit.compiled import jit
from contact.loop.modal.patch import ROUGH
from contact.loop.rub.rows import RubRows, blade_dot, fill_block, turn
from contact.loop.rub.state import RubState, Work
from contact.solver.abradable.tips import Coats, crush_tips
from contact.solver.dense import affine, dot
from contact.solver.friction.coulomb import friction_forces
from contact.solver.friction.newton import TOLERANCE


@jit
def gather(s: RubState, rows: RubRows, w: Work, dim: int, share: float, angle: float) -> int:
    """Rows at t_n where tips are to be solved, and the rows of the law times c; returns how many tips."""
    count, w.slots[0] = 0, 0
    for p in range(w.slot.size):
        w.slot[p] = -1
    for j in range(s.mu.size):
        if s.inside[j] != 2:
            for i in range(j * dim, (j + 1) * dim):
                s.lam[i] = 0.0
            continue
        if w.slot[rows.place[j]] < 0:
            fill_slot(s, rows, w, j, dim, share, angle)
        first = w.slot[rows.place[j]] * dim
        for i in range(dim):
            w.row[count * dim + i], w.column[count * dim + i] = j * dim + i, first + i
        w.chosen[count] = j
        count += 1
    return count


@jit
def fill_slot(s: RubState, rows: RubRows, w: Work, j: int, dim: int, share: float, angle: float) -> None:
    """The next slot becomes the place of tip j."""
    p, slot = rows.place[j], w.slots[0]
    w.slot[p], w.slots[0] = slot, slot + 1
    turn(rows.waves, rows.angle[j] - angle)
    for i in range(dim):
        a = slot * dim + i
        fill_block(rows, rows.line[j] * rows.directions + i, w.rows[a])
        w.along[a] = dot(w.rows[a], s.d, w.pushed.size)
        for k in range(w.pushed.size):
            w.tests[a, k] = s.c[k] * (share * w.ahead[p, k] if i == 0 else w.rows[a, k])


@jit
def soften(rows: RubRows, w: Work, size: int, before: float, angle: float) -> None:
    """Residual compliance of the chosen tips at phi_n, and the waves of that at phi_{n-1}."""
    if rows.S_harmonic.size == 1:
        return
    for p in range(rows.S_harmonic.size):
        n = rows.S_harmonic[p]
        c, s = math.cos(n * angle), math.sin(n * angle)
        w.waves_old[0, p], w.waves_old[1, p] = math.cos(n * before), math.sin(n * before)
        for a in range(size):
            r = w.row[a]
            for k in range(w.strain.size):
                last = w.S[r, k] if p > 0 else 0.0
                w.S[r, k] = last + c * rows.S_cos[p, r, k] + s * rows.S_sin[p, r, k]


@jit
def solve(s: RubState, rows: RubRows, w: Work, coats: Coats | None, count: int, dim: int, share: float,
          slid: float) -> bool:  # fmt: skip
    """Forces of the chosen tips into `lam`, gaps (from the pressed surface) and slips into `motion`."""
    size = count * dim
    assemble(s, rows, w, count, dim, share, slid)
    if coats is None:
        if dim > 1 and count > 1:
            w.glide(w.W, w.b, w.mu, dim, count, w.lam, w.room)
        iterations, miss = friction_forces(w.W, w.b, w.mu, dim, count, w.lam, w.room)
        s.counts[0] = max(s.counts[0], float(iterations))
        s.counts[1] += float(iterations)
        solved = miss <= TOLERANCE
    else:
        solved = crush_tips(coats, w.chosen, w.W, w.b, w.mu, dim, count, w.lam, w.depth, w.glide, w.room)
    if not solved:
        s.counts[3] = ROUGH
        return False
    affine(w.W, w.lam, w.b, w.motion, size)
    if coats is not None:
        for a in range(count):
            coats.memory[w.chosen[a], 2] = w.depth[a]
            w.motion[a * dim] += w.depth[a]
    hand_over(s, w, size, dim)
    return True


@jit
def assemble(s: RubState, rows: RubRows, w: Work, count: int, dim: int, share: float, slid: float) -> None:
    """Fill W, b, mu and the last forces of the chosen tips; `slid` = Omega h."""
    size, used = count * dim, w.slots[0] * dim
    for a in range(used):
        for k in range(used):
            w.casing[a, k] = dot(w.tests[a], w.rows[k], w.pushed.size)
    for n in range(count):
        j = w.chosen[n]
        w.mu[n] = s.mu[j]
        for i in range(dim):
            a, row, part = n * dim + i, j * dim + i, share if i == 0 else 1.0
            for k in range(size):
                other = w.row[k]
                w.W[a, k] = w.casing[w.column[a], w.column[k]] + part * rows.fixed[row, other] + w.S[row, other]
            w.lam[a] = s.lam[row]
            if i == 0:
                w.b[a], s.scale[j] = s.test[j] - s.skin[j], w.W[a, a]
            else:
                w.b[a] = w.along[w.column[a]] + blade_dot(rows, row, j, s.d) - s.strain[row]
            if i == 1:
                w.b[a] += rows.radius[j] * slid


@jit
def hand_over(s: RubState, w: Work, size: int, dim: int) -> None:
    """Forces, gaps and slips to the tips, and what the forces push on the casing."""
    used = w.slots[0] * dim
    for a in range(used):
        w.pull[a] = 0.0
    for a in range(size):
        s.lam[w.row[a]], s.motion[w.row[a]] = w.lam[a], w.motion[a]
        w.pull[w.column[a]] += w.lam[a]
    for k in range(w.pushed.size):
        w.pushed[k] = 0.0
    for a in range(used):
        for k in range(w.pushed.size):
            w.pushed[k] += w.pull[a] * w.rows[a, k]


@jit
def drawn_in(s: RubState, rows: RubRows, w: Work, size: int, dim: int, share: float) -> bool:
    """Whether the forces close tips that were left out; these are marked, the gaps of the others noted."""
    grown = False
    for j in range(s.mu.size):
        if s.inside[j] != 1:
            continue
        R = j * dim
        gap = s.test[j] + share * (dot_c(w.ahead[rows.place[j]], s.c, w.pushed) + dot(rows.fixed[R], s.lam, s.lam.size))
        for a in range(size):
            gap += w.S[w.row[a], R] * w.lam[a]
        s.motion[R] = gap
        if gap < 0.0:
            s.inside[j], grown = 2, True
    return grown


@jit
def push(s: RubState, rows: RubRows, w: Work, count: int, dim: int) -> None:
    """Forces on the modes, and what they add to the increments."""
    for k in range(w.pushed.size):
        s.contact[k] = w.pushed[k]
    for n in range(count):
        j = w.chosen[n]
        begin = rows.own[j, 0]
        for row in range(j * dim, (j + 1) * dim):
            for k in range(begin, rows.own[j, 1]):
                s.contact[k] += rows.blade[row, k - begin] * s.lam[row]
    for i in range(s.d.size):
        s.d[i] += s.c[i] * s.contact[i]


@jit
def relax(s: RubState, rows: RubRows, w: Work, dim: int) -> None:
    """Add the forces' share to the gaps of q at t_{n+1}, for every tip near enough to be looked at."""
    for p in range(w.fresh.size):
        if w.fresh[p] == 1:
            w.moved[p] = dot_c(w.ahead[p], s.c, w.pushed)
    for j in range(s.mu.size):
        if s.inside[j] > 0:
            s.free[j] += w.moved[rows.place[j]] + dot(rows.fixed[j * dim], s.lam, s.lam.size)


@jit
def dot_c(a: Array, c: Array, b: Array) -> float:
    """Sum of a c b over the entries of a."""
    total = 0.0
    for i in range(a.size):
        total += a[i] * c[i] * b[i]
    return total
