"""The forces of a step in which one tip closes, without friction or with one slip direction: one pass over the modes.

What `gather` and `solve` do for many tips; nearly every step of a single tip.
"""

from __future__ import annotations

from contact.jit.compiled import jit
from contact.jit.vector import WIDTH, load, put, same, total
from contact.loop.rub.compliance import fill_few, fill_soft, soft_at
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
    j, R, p = chosen, chosen * dim, rows.place[chosen]
    for i in range(dim):
        w.row[i], w.column[i] = R + i, i
    if dim > 2:
        return False
    place_now(rows, w, j)
    normal, ahead, tangent = w.normal[w.side[0], p], w.normal[1 - w.side[0], p], w.rows[dim - 1]
    if dim == 2:
        fill_block(rows, rows.line[j] * rows.directions + 1, w.waves[w.side[0], p], tangent)
    nn, nt, tn, tt, slip = same(0.0), same(0.0), same(0.0), same(0.0), same(0.0)
    for i in range(0, rows.width, WIDTH):
        row, along, c = load(normal, i), load(tangent, i), load(s.c, i)
        test, pull = load(ahead, i) * c, along * c
        nn, nt, tn, tt = nn + test * row, nt + test * along, tn + pull * row, tt + pull * along
        slip = slip + along * load(s.d, i)
        put(w.rows, i, row)
    w.W[0, 0], w.b[0] = share * (total(nn) + rows.fixed[R, R]), s.test[j]
    if dim == 2:
        w.W[0, 1], w.W[1, 0] = share * (total(nt) + rows.fixed[R, R + 1]), total(tn) + rows.fixed[R + 1, R]
        w.W[1, 1] = total(tt) + rows.fixed[R + 1, R + 1]
        w.b[1] = total(slip) + blade_dot(rows, R + 1, j, s.d) - s.strain[R + 1] + rows.radius[j] * slid
    if rows.turns and rows.few:
        fill_few(rows, w, dim, step)
    elif rows.turns:
        fill_soft(rows, w, j, 0, dim)
    for i in range(dim):
        for k in range(dim):
            w.W[i, k] += rows.still[R + i, R + k]
            if rows.turns:
                w.W[i, k] += w.S[R + i, R + k] if rows.few else soft_at(rows, w, i, j, k, dim)
    if not one_contact(w.W, w.b, s.mu[j], dim, w.lam):
        return False
    s.scale[j], w.chosen[0], w.slots[0], w.slot[p] = w.W[0, 0], j, 1, 0
    for i in range(dim):
        s.lam[R + i], s.motion[R + i] = w.lam[i], w.b[i]
        for k in range(dim):
            s.motion[R + i] += w.W[i, k] * w.lam[k]
    press, drag = same(w.lam[0]), same(w.lam[1] if dim == 2 else 0.0)
    for i in range(0, rows.width, WIDTH):
        put(w.pushed, i, load(normal, i) * press + load(tangent, i) * drag)
    for i in range(0, w.strained.size, WIDTH):
        put(w.strained, i, load(w.soft, i) * press)
        if dim == 2:
            put(w.strained, i, load(w.strained, i) + load(w.soft, w.strained.size + i) * drag)
    return True
