"""A step without forces, which tips could touch after it, and the force of one that closes alone."""

from __future__ import annotations

import math

from contact.base.arrays import Array
from contact.jit.compiled import jit, jit_inside
from contact.jit.vector import WIDTH, load, put, same, total
from contact.loop.modal.rows import bound, fill_some, product, product_of_sum, rotate, weighted
from contact.loop.rub.compliance import fill_few, fill_soft, yields
from contact.loop.rub.rows import (
    AHEAD,
    BEFORE,
    NOW,
    Pulls,
    RubLaws,
    RubRows,
    blade_dot,
    blade_dot_of_sum,
    fill_block,
    gap_of,
    hermite,
    least_gap,
    polynomial,
    rigid_gap,
    straight,
)
from contact.loop.rub.solve import place_now
from contact.loop.rub.state import ModalBlocks, RubState, Work
from contact.solver.abradable.tips import Coats, coating_of, first_bar, machined, surface, wear
from contact.solver.friction.one_contact import one_contact


@jit
def body_force(pulls: Pulls, speed: Array, t: float, angle: float, omega: float, out: Array) -> None:
    """Modal forces at t, when the casing has turned by `angle`; the blades' axes turn against it."""
    segment = speed.shape[0] - 1
    while segment > 0 and t < speed[segment, 0]:
        segment -= 1
    slope = speed[segment, 3]
    x, y, blade_x, blade_y = 0.0, 0.0, 0.0, 0.0
    for k in range(pulls.laws.shape[0]):
        law = pulls.laws[k]
        w = law[3] * omega + law[4]
        along, across = law[0] + law[1] * w * w, -law[1] * law[3] * slope
        beta = law[5] + law[2] * angle + law[4] * t
        c, s = math.cos(beta), math.sin(beta)
        x += law[6] * (along * c - across * s)
        y += law[6] * (along * s + across * c)
        c, s = math.cos(beta + angle), math.sin(beta + angle)
        blade_x += law[7] * (along * c - across * s)
        blade_y += law[7] * (along * s + across * c)
    for i in range(pulls.casing):
        out[i] = pulls.plane[0, i] * x + pulls.plane[1, i] * y
    for i in range(pulls.casing, out.size):
        out[i] = pulls.plane[0, i] * blade_x + pulls.plane[1, i] * blade_y


@jit
def propagate(s: RubState, laws: RubLaws, t: float, angle: float, omega: float) -> None:
    """D* = al D - be q + c (f + gravity and whirl - stiffening), the last increment kept in `old`."""
    for i in range(0, s.q.size, WIDTH):
        last = load(s.d, i)
        put(s.old, i, last)
        put(s.d, i, load(s.al, i) * last - load(s.be, i) * load(s.q, i) + load(s.kick, i))
    b, begin = s.stiff.shape[0], laws.pulls.casing
    for i in range(b):
        total = 0.0
        for k in range(b):
            total -= (omega * omega * s.stiff[i, k] - s.stiff_at[i, k]) * s.q[begin + k]
        s.push[begin + i] = total
        s.d[begin + i] += s.c[begin + i] * total
    if s.body.size > 0:
        body_force(laws.pulls, laws.speed, t, angle, omega, s.body)
        for i in range(s.body.size):
            s.d[i] += s.c[i] * s.body[i]


@jit
def find_near(s: RubState, laws: RubLaws, rows: RubRows, w: Work, dim: int, share: float, every: bool,
         t: float, h: float) -> int:  # fmt: skip
    """Free gaps of the tips that could touch; marks those that are solved for and returns how many."""
    inside, side = 0, 1 - w.side[0]
    closing = straight(laws.closing, t + h)
    for line in range(w.bound.size):
        w.bound[line] = -1.0
    for p in range(w.fresh.shape[1]):
        w.fresh[side, p] = 0
    for j in range(s.mu.size):
        R, line, p = j * dim, rows.line[j], rows.place[j]
        blade = blade_dot_of_sum(rows, R, j, s.q, s.d)
        pressed = s.lam[R] > 0.0 or (s.known[j] == 1 and min(s.now[j], s.last[j]) < 0.0)
        if not pressed and not every:
            if w.bound[line] < 0.0:
                w.bound[line] = bound(rows.reach[line], s.q, s.d)
            low = least_gap(laws, rows, j, closing) + blade - w.bound[line]
            if low > 0.0:
                s.inside[j], s.known[j], s.gap[j] = 0, 0, low
                continue
        if s.known[j] == 0:
            s.now[j] = gap_of(laws, rows, j, t, w.angles, NOW, dim, s.q, w.turn, w.spare)
            s.last[j] = gap_of(laws, rows, j, t - h, w.angles, BEFORE, dim, s.q, w.turn, w.spare)
            s.last[j] -= product(w.spare, s.old) + blade_dot(rows, R, j, s.old)
        if w.fresh[side, p] == 0:
            w.rigid[p] = rigid_gap(laws, rows, j, t + h, w.angles, AHEAD, w.waves[side, p]) - closing
            w.fresh[side, p] = 1
            fill_block(rows, line * rows.directions, w.waves[side, p], w.normal[side, p])
            w.moved[p] = product_of_sum(w.normal[side, p], s.q, s.d)
        free = rows.clearance[j] + w.rigid[p] + blade + w.moved[p]
        test = free if share == 1.0 else 0.25 * (free + 2.0 * s.now[j] + s.last[j])
        s.free[j], s.test[j], s.motion[R], s.inside[j] = free, test, test, 1
        if not test >= 0.0 or s.lam[R] > 0.0:
            s.inside[j] = 2
            inside += 1
    return inside


@jit
def alone(s: RubState, rows: RubRows, blocks: ModalBlocks | None, w: Work, dim: int, share: float, slid: float,
          step: int) -> bool:  # fmt: skip
    """Force of the one tip marked, gap and slip; False where the general way is to be taken. `slid` = Omega h.

    Without friction or with one slip direction, in one pass over the modes: what `gather` and `solve` do for many tips;
    nearly every step of a single tip.
    """
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
    if blocks is not None:
        fill_some(blocks.casing, normal, 0, w.normal_moves)
        nn += share * product(ahead, w.normal_moves)
        if rubs:
            fill_some(blocks.casing, tangent, 0, w.tangent_moves)
            nt, tn = nt + share * product(ahead, w.tangent_moves), tn + product(tangent, w.normal_moves)
            tt += product(tangent, w.tangent_moves)
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
