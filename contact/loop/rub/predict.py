"""A step without contact forces, the tips that could touch after it, and the force of one that closes alone."""

from __future__ import annotations

import math

from contact.base.arrays import Array
from contact.jit.compiled import jit, jit_apart
from contact.jit.vector import WIDTH, load, put
from contact.loop.formulas import free_step, mean_gap
from contact.loop.modal.rows import bound, product, product_of_sum, rotate
from contact.loop.rub.motion import felt, place_row, see
from contact.loop.rub.rows import (
    AHEAD,
    BEFORE,
    NOW,
    Pulls,
    RubLaws,
    RubRows,
    Swing,
    blade_dot,
    blade_dot_of_sum,
    gap_of,
    hermite,
    least_gap,
    polynomial,
    rigid_gap,
    straight,
)
from contact.loop.rub.spin import TORQUE, add_unbalance
from contact.loop.rub.state import RubState, Solver, Work, tips
from contact.solver.abradable.tips import Coats, coating_of, first_bar, machined, surface, wear

SPARE = 0.25  # of the bound of a casing's deflection: margin for forces of this step, beyond which a tip is far


@jit
def slope_at(speed: Array, t: float) -> float:
    """Angular acceleration [rad/s^2]."""
    segment = speed.shape[0] - 1
    while segment > 0 and t < speed[segment, 0]:
        segment -= 1
    return float(speed[segment, 3])


@jit_apart
def body_force(pulls: Pulls, speed: Array, t: float, angle: float, omega: float, out: Array) -> None:
    """Modal forces of gravity and whirl at t, when the casing has turned by `angle`.

    The blades' axes rotate against it.
    """
    slope = slope_at(speed, t)
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
def propagate(s: RubState, laws: RubLaws, angles: Array, t: float, omega: float, h: float) -> None:
    """D* = al D - be q + c (f + gravity and whirl - stiffening); the last increment is kept in `old`."""
    for i in range(0, s.q.size, WIDTH):
        last = load(s.d, i)
        put(s.old, i, last)
        put(s.d, i, free_step(load(s.al, i), load(s.be, i), last, load(s.q, i)) + load(s.kick, i))
    b, begin = s.stiff.shape[0], laws.pulls.casing
    for i in range(b):
        total = 0.0
        for k in range(b):
            total -= (omega * omega * s.stiff[i, k] - s.stiff_at[i, k]) * s.q[begin + k]
        s.push[begin + i] = total
        s.d[begin + i] += s.c[begin + i] * total
    if s.body.size > 0:
        body_force(laws.pulls, laws.speed, t, angles[NOW, 0], omega, s.body)
        if laws.swing.jumps.shape[0] > 0:
            add_unbalance(laws.swing, t, h, angles, s.body)
        if laws.spin.mode >= 0:
            s.body[laws.spin.mode] += laws.spin.scale * laws.spin.now[TORQUE]
        for i in range(s.body.size):
            s.d[i] += s.c[i] * s.body[i]


@jit
def find_disk(s: RubState, swing: Swing, w: Work) -> None:
    """Position of the disk of a rotor at t_{n+1} without contact forces, along x and y."""
    x, y = 0.0, 0.0
    for i in range(swing.plane.shape[1]):
        k = swing.first + i
        x += swing.plane[0, i] * (s.q[k] + s.d[k])
        y += swing.plane[1, i] * (s.q[k] + s.d[k])
    w.disk[0], w.disk[1] = x, y


@jit
def nearer(swing: Swing, rows: RubRows, w: Work, j: int) -> float:
    """Approach of tip j to the casing due to the disk, x cos phi + y sin phi, and a share of the casing's bound.

    Forces of other tips in this step also move a tip; the share is a margin for that.
    """
    if swing.plane.shape[1] == 0:
        return 0.0
    cos, sin, c, s = rows.heading[j, 0], rows.heading[j, 1], w.angles[AHEAD, 1], w.angles[AHEAD, 2]
    moved = w.disk[0] * (cos * c + sin * s) + w.disk[1] * (sin * c - cos * s)
    return float(moved + SPARE * w.bound[rows.line[j]])


@jit
def find_near(s: RubState, laws: RubLaws, rows: RubRows, w: Work, solver: Solver | None, dim: int, share: float,
              every: bool, now_too: bool, t: float, h: float) -> int:  # fmt: skip
    """Free gaps of the tips that could touch; marks the tips to solve for and returns their number.

    With `now_too`, tips that were near in the last step are tested again. For one tip the bound costs as much as the
    gap.
    """
    inside, side = 0, 1 - w.side[0]
    closing = straight(laws.closing, t + h)
    for line in range(w.bound.size):
        w.bound[line] = -1.0
    if laws.swing.plane.shape[1] > 0:
        find_disk(s, laws.swing, w)
    unseen = True
    if not rows.steady:
        for p in range(1 if solver is None else w.fresh.shape[1]):
            w.fresh[side, p] = 0
    for j in range(tips(s, solver)):
        R, line, p = j * dim, rows.line[j], rows.place[j]
        pressed = s.lam[R] > 0.0 or (s.known[j] == 1 and min(s.now[j], s.last[j]) < 0.0)
        if not (pressed or every or rows.steady) and (now_too or s.known[j] == 0):
            if w.bound[line] < 0.0:
                w.bound[line] = bound(rows.reach[line], s.q, s.d)
            low = least_gap(laws, rows, j, closing) - w.bound[line] - nearer(laws.swing, rows, w, j)
            low += blade_dot_of_sum(rows, rows.own, R, j, s.q, s.d)
            if low > 0.0:
                s.inside[j], s.known[j], s.gap[j] = 0, 0, low
                continue
        if s.known[j] == 0:
            s.now[j] = gap_of(laws, rows, j, t, w.angles, NOW, dim, s.q, w.turn, w.spare)
            s.last[j] = gap_of(laws, rows, j, t - h, w.angles, BEFORE, dim, s.q, w.turn, w.spare)
            s.last[j] -= product(w.spare, s.old) + blade_dot(rows, rows.apart, R, j, s.old)
        if w.fresh[side, p] == 0:
            w.rigid[p] = rigid_gap(laws, rows, j, t + h, w.angles, AHEAD, w.waves[side, p]) - closing
            w.fresh[side, p] = 1
            w.filled[side, p] = 0
            if solver is not None and rows.many:
                if unseen:
                    see(rows, w, s.q, s.d, dim, 0, 1)
                    unseen = False
                w.moved[p] = felt(w.motion_waves, line * dim * w.turn.size, w.waves[side, p])
            else:
                place_row(rows, w, j, side)
                w.moved[p] = product_of_sum(w.normal[side, p], s.q, s.d)
        elif rows.steady:
            w.moved[p] = product_of_sum(w.normal[side, p], s.q, s.d)
        free = rows.clearance[j] + w.rigid[p] + w.moved[p] + blade_dot_of_sum(rows, rows.apart, R, j, s.q, s.d)
        test = free if share == 1.0 else mean_gap(0.25, free, s.now[j], s.last[j])
        s.free[j], s.test[j], s.motion[R], s.inside[j] = free, test, test, 1
        if not test >= 0.0 or s.lam[R] > 0.0:
            s.inside[j] = 2
            inside += 1
    return inside


@jit_apart
def stand(s: RubState, laws: RubLaws, rows: RubRows, w: Work, coats: Coats, dim: int, angle: float) -> int:
    """Find the coating bars under the near tips, and measure gaps to the bars' surface.

    Returns the number of tips that do not close on the bars.
    """
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
    """Let the bars under the chosen tips yield, each to the depth found."""
    for a in range(count):
        j = w.chosen[a]
        if s.lam[j * dim] > 0.0:
            wear(coating_of(coats, j), coats.first[j], coats.cut[j], coats.memory[j, 2])
