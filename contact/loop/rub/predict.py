"""A step without forces, and which tips could touch after it."""

from __future__ import annotations

from contact.jit.compiled import jit
from contact.loop.rub.body_force import pull
from contact.loop.rub.rows import (
    RubLaws,
    RubRows,
    blade_dot,
    fill_block,
    gap_of,
    least_gap,
    rigid_gap,
    straight,
)
from contact.loop.rub.state import RubState, Work
from contact.solver.dense import dot


@jit
def propagate(s: RubState, laws: RubLaws, t: float, angle: float, omega: float) -> None:
    """D* = al D - be q + c (f + gravity and whirl - stiffening), the last increment kept in `old`."""
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
    if s.body.size > 0:
        pull(laws.pulls, laws.speed, t, angle, omega, s.body)
        for i in range(s.q.size):
            s.d[i] += s.c[i] * s.body[i]


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
    for p in range(w.fresh.size):
        w.fresh[p] = 0
    for j in range(s.mu.size):
        R = j * dim
        blade = blade_dot(rows, R, j, s.q) + blade_dot(rows, R, j, s.d)
        low = least_gap(laws, rows, j, closing) + blade - s.peaks[2 + rows.line[j]]
        pressed = s.lam[R] > 0.0 or (s.known[j] == 1 and min(s.now[j], s.last[j]) < 0.0)
        if low > 0.0 and not pressed and not every:
            s.inside[j], s.known[j], s.gap[j] = 0, 0, low
            continue
        if s.known[j] == 0:
            s.now[j] = gap_of(laws, rows, j, t, angle, dim, s.q, w.spare)
            s.last[j] = gap_of(laws, rows, j, t - h, before, dim, s.q, w.spare)
            s.last[j] -= dot(w.spare, s.old, m) + blade_dot(rows, R, j, s.old)
        p = rows.place[j]
        if w.fresh[p] == 0:
            w.fresh[p], w.rigid[p] = 1, rigid_gap(laws, rows, j, t + h, ahead)
            fill_block(rows, rows.line[j] * rows.directions, w.ahead[p])
            w.moved[p] = dot(w.ahead[p], s.q, m) + dot(w.ahead[p], s.d, m)
        s.free[j] = rows.clearance[j] + w.rigid[p] + blade + w.moved[p]
        s.test[j] = s.free[j] if share == 1.0 else 0.25 * (s.free[j] + 2.0 * s.now[j] + s.last[j])
        s.inside[j], s.motion[R] = 1, s.test[j]
        if not s.test[j] >= 0.0 or s.lam[R] > 0.0:
            s.inside[j] = 2
            inside += 1
    return inside
