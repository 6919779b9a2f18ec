"""The forces of a step in which one tip closes, without friction or with one slip direction: one pass over the modes.

What `gather` and `solve` do for many tips; nearly every step of a single tip.
"""

from __future__ import annotations

from contact.base.arrays import Array
from contact.jit.compiled import jit, jit_inside
from contact.jit.vector import WIDTH, load, put, same, total
from contact.loop.modal.rows import weighted
from contact.loop.rub.compliance import fill_few, fill_soft, yields
from contact.loop.rub.rows import RubRows, blade_dot, fill_block
from contact.loop.rub.solve import place_now
from contact.loop.rub.state import RubState, Work
from contact.solver.friction.one_contact import one_contact


@jit
def alone(s: RubState, rows: RubRows, w: Work, dim: int, share: float, slid: float, step: int) -> bool:  # fmt: skip
    """Force of the one tip marked, gap and slip; False where the general way is to be taken. `slid` = Omega h."""
    chosen = 0
    for j in range(s.mu.size):
        if s.inside[j] == 2:
            chosen = j
        else:
            for i in range(j * dim, (j + 1) * dim):
                s.lam[i] = 0.0
    if dim > 2:
        return False
    j, R, p, rubs = chosen, chosen * dim, rows.place[chosen], dim == 2
    place_now(rows, w, j)
    normal, ahead, tangent = w.normal[w.side[0], p], w.normal[1 - w.side[0], p], w.rows[dim - 1]
    nn, nt, tn, tt, slip = share * rows.fixed[R, R], 0.0, 0.0, 0.0, 0.0
    if rubs:
        fill_block(rows, rows.line[j] * rows.directions + 1, w.waves[w.side[0], p], tangent)
        n, across, along, t, slid_by = couplings(s, normal, ahead, tangent, rows.width)
        nn, nt, tn = nn + share * n, share * (across + rows.fixed[R, R + 1]), along + rows.fixed[R + 1, R]
        tt = t + rows.fixed[R + 1, R + 1]
        slip = slid_by + blade_dot(rows, R + 1, j, s.d) - s.strain[R + 1] + rows.radius[j] * slid
    else:
        nn += share * weighted(ahead, s.c, normal)
    w.chosen[0] = j
    for i in range(dim):
        w.column[i] = i
    if rows.turns and rows.few:
        fill_few(rows, w, 1, step)
    elif rows.turns:
        fill_soft(rows, w, j, 0, dim)
    nn += yields(rows, w, j, 0, 0, dim)
    if rubs:
        nt, tn = nt + yields(rows, w, j, 0, 1, dim), tn + yields(rows, w, j, 1, 0, dim)
        tt += yields(rows, w, j, 1, 1, dim)
    found, press, drag = one_contact(nn, nt, tn, tt, s.test[j], slip, s.mu[j] if rubs else 0.0)
    if not found:
        return False
    s.scale[j], w.slots[0], w.slot[p] = nn, 1, 0
    s.lam[R], s.motion[R] = press, nn * press + nt * drag + s.test[j]
    if rubs:
        s.lam[R + 1], s.motion[R + 1] = drag, tn * press + tt * drag + slip
    push_one(w, normal, tangent, press, drag, rubs)
    return True


@jit_inside
def couplings(s: RubState, normal: Array, ahead: Array, tangent: Array,
              width: int) -> tuple[float, float, float, float, float]:  # fmt: skip
    """What the casing yields at t_{n+1} along the normal, and at t_n along the tangent, to forces; and its slip."""
    nn, nt, tn, tt, slip = same(0.0), same(0.0), same(0.0), same(0.0), same(0.0)
    for i in range(0, width, WIDTH):
        row, along, c = load(normal, i), load(tangent, i), load(s.c, i)
        test, pull = load(ahead, i) * c, along * c
        nn, nt, tn, tt = nn + test * row, nt + test * along, tn + pull * row, tt + pull * along
        slip = slip + along * load(s.d, i)
    return total(nn), total(nt), total(tn), total(tt), total(slip)


@jit_inside
def push_one(w: Work, normal: Array, tangent: Array, press: float, drag: float, rubs: bool) -> None:
    """The row of the tip, and what its forces push and strain."""
    to, along = same(press), same(drag)
    for i in range(0, w.pushed.size, WIDTH):
        row = load(normal, i)
        put(w.rows, i, row)
        put(w.pushed, i, row * to + load(tangent, i) * along if rubs else row * to)
    for i in range(0, w.strained.size, WIDTH):
        strained = load(w.soft, i) * to
        put(w.strained, i, strained + load(w.soft, w.strained.size + i) * along if rubs else strained)
