"""Compiled: W, the contact matrix: motion of the chosen tips due to unit forces within a step.

Its entries are products of the tips' rows. At constant speed W is a smooth function of the angle alone. For many tips
it is interpolated between `NODES` Chebyshev points of a cell of angle, where it is computed once for all tips.
`contact.scheme.modal.cells` chooses the cells so that the error is round-off.
"""

from __future__ import annotations

import math

from contact.base.arrays import Array
from contact.jit.compiled import jit, jit_inside
from contact.jit.vector import WIDTH, entry, load, put, same
from contact.loop.modal.rows import fill_some
from contact.loop.rub.compliance import fill_soft, row_of_few
from contact.loop.rub.rows import NOW, RubRows, look_at, waves_at
from contact.loop.rub.state import NODES, TOGETHER, ModalBlocks, RubState, Work, couples

FEWER = 3  # tips over those chosen: of fewer, products take less time


@jit
def fill_factors(s: RubState, rows: RubRows, blocks: ModalBlocks, w: Work, j: int, slot: int, dim: int,
                 share: float, waves: Array, ahead: Array) -> None:  # fmt: skip
    """Factors of `casing_yields` for tip j; `waves` are at t_n, `ahead` is the normal row at t_{n+1}."""
    for i in range(dim):
        row, test = w.rows[slot * dim + i], w.tests[slot * dim + i]
        law(s.c, row if i > 0 else ahead, 1.0 if i > 0 else share, test)
        if couples(blocks):
            fill_some(blocks.turned, row if i > 0 else ahead, 0, w.spare)
            add_part(w.spare, 1.0 if i > 0 else share, test)
        for k in range(rows.width):
            w.row_columns[i * rows.width + k, slot] = row[k]
    if rows.turns and not rows.few:
        fill_soft(rows.S, rows, w, j, slot, dim, waves)
        fill_columns(rows, w, j, slot, waves)


@jit
def fill_columns(rows: RubRows, w: Work, j: int, slot: int, waves: Array) -> None:
    """Waves of a slot, at the position of tip j, as a column."""
    n = w.turn.size
    for k in range(w.wave_columns.shape[0]):
        w.wave_columns[k, slot] = 0.0
    for k in range(n):
        w.wave_columns[rows.line[j] * n + k, slot] = entry(waves, k)


@jit_inside
def law(c: Array, row: Array, share: float, out: Array) -> None:
    """Set out = share c row."""
    part = same(share)
    for i in range(0, out.size, WIDTH):
        put(out, i, part * load(c, i) * load(row, i))


@jit_inside
def add_part(row: Array, share: float, out: Array) -> None:
    """Add `share` times `row` to `out`."""
    part = same(share)
    for i in range(0, out.size, WIDTH):
        put(out, i, load(out, i) + part * load(row, i))


@jit
def known(rows: RubRows, w: Work, size: int) -> None:
    """Fill W from the known rows and columns of the chosen tips."""
    wide = rows.W.shape[1]
    for a in range(size):
        own = w.row[a] * wide
        for k in range(size):
            w.W[a, k] = entry(rows.W, own + entry(w.row, k))


@jit
def assemble(s: RubState, rows: RubRows, w: Work, count: int, dim: int, share: float) -> None:
    """Compute W of the chosen tips."""
    size = count * dim
    casing_yields(w, rows.width, dim)
    few, R, side = rows.turns and rows.few, s.lam.size, w.side[0]
    for n in range(count):
        j = w.chosen[n]
        for i in range(dim):
            a, row, part = n * dim + i, j * dim + i, share if i == 0 else 1.0
            casing, own, turning = w.column[a] * w.casing.shape[1], row * R, row_of_few(w, side, j, i * R)
            for k in range(size):
                yields, other = entry(w.casing, casing + entry(w.across, k)), entry(w.row, k)
                if few:
                    yields += entry(w.S, turning + other)
                if not rows.turns:  # else `still` is that of the blades alone
                    yields += part * entry(rows.fixed, own + other) + entry(rows.still, own + other)
                w.W[a, k] = yields
            for m in range(count if rows.turns else 0):
                if rows.own[w.chosen[m], 0] == rows.own[j, 0]:
                    for k in range(dim):
                        other = own + w.chosen[m] * dim + k
                        w.W[a, m * dim + k] += part * entry(rows.fixed, other) + entry(rows.still, other)


@jit
def casing_yields(w: Work, width: int, dim: int) -> None:
    """Fill `casing` with tests rows^T of `width` modes, and `soft` by waves; eight rows by eight slots at a time."""
    slots, columns, waves = w.row_columns.shape[1], w.casing.shape[1], w.strained.size
    n = w.turn.size
    for i in range(dim):
        for q in range(0, w.slots[0], WIDTH):
            for a in range(0, w.slots[0] * dim, TOGETHER):
                test, soft = a * w.tests.shape[1], a * waves
                a0, a1, a2, a3 = same(0.0), same(0.0), same(0.0), same(0.0)
                a4, a5, a6, a7 = same(0.0), same(0.0), same(0.0), same(0.0)
                for k in range(width):
                    row, at = load(w.row_columns, (i * width + k) * slots + q), test + k
                    a0 = a0 + same(entry(w.tests, at)) * row
                    a1 = a1 + same(entry(w.tests, at + width)) * row
                    a2 = a2 + same(entry(w.tests, at + 2 * width)) * row
                    a3 = a3 + same(entry(w.tests, at + 3 * width)) * row
                    a4 = a4 + same(entry(w.tests, at + 4 * width)) * row
                    a5 = a5 + same(entry(w.tests, at + 5 * width)) * row
                    a6 = a6 + same(entry(w.tests, at + 6 * width)) * row
                    a7 = a7 + same(entry(w.tests, at + 7 * width)) * row
                for line in range(w.pressed.shape[0] // dim):
                    begin = soft + (line * dim + i) * n
                    for k in range(n):
                        row, at = load(w.wave_columns, (line * n + k) * slots + q), begin + k
                        a0 = a0 + same(entry(w.soft, at)) * row
                        a1 = a1 + same(entry(w.soft, at + waves)) * row
                        a2 = a2 + same(entry(w.soft, at + 2 * waves)) * row
                        a3 = a3 + same(entry(w.soft, at + 3 * waves)) * row
                        a4 = a4 + same(entry(w.soft, at + 4 * waves)) * row
                        a5 = a5 + same(entry(w.soft, at + 5 * waves)) * row
                        a6 = a6 + same(entry(w.soft, at + 6 * waves)) * row
                        a7 = a7 + same(entry(w.soft, at + 7 * waves)) * row
                place = a * columns + i * slots + q
                put(w.casing, place, a0)
                put(w.casing, place + columns, a1)
                put(w.casing, place + 2 * columns, a2)
                put(w.casing, place + 3 * columns, a3)
                put(w.casing, place + 4 * columns, a4)
                put(w.casing, place + 5 * columns, a5)
                put(w.casing, place + 6 * columns, a6)
                put(w.casing, place + 7 * columns, a7)


@jit
def enter_cell(s: RubState, rows: RubRows, w: Work, dim: int, share: float) -> bool:
    """Set `nodes` and `weights` for the angle at t_n, where W is interpolated; returns False where it is not."""
    chosen, K = 0, s.mu.size
    for j in range(K if rows.cell > 0.0 else 0):
        chosen += 1 if s.inside[j] == 2 else 0
    if FEWER * chosen < K or not rows.cell > 0.0:
        return False
    place = w.angles[NOW, 0] / rows.cell
    number = math.floor(place)
    if w.cell[0] != number:
        w.cell[0] = number
        for k in range(NODES):
            fill_node(s, rows, w, dim, share, k, (number + 0.5 + 0.5 * chebyshev(k)) * rows.cell)
    weigh(2.0 * (place - number) - 1.0, w.weights)
    return True


@jit_inside
def chebyshev(k: int) -> float:
    """Chebyshev point k in -1 .. 1."""
    return math.cos(math.pi * (2.0 * k + 1.0) / (2.0 * NODES))


@jit
def weigh(x: float, weights: Array) -> None:
    """Weights of the node values for interpolation at x (Berrut & Trefethen, SIAM Review 46, 2004, 501, 4.2)."""
    total, sign = 0.0, 1.0
    for k in range(NODES):
        away = x - chebyshev(k)
        if away == 0.0:
            weights[:] = 0.0
            weights[k] = 1.0
            return
        weights[k] = sign * math.sin(math.pi * (2.0 * k + 1.0) / (2.0 * NODES)) / away
        total, sign = total + weights[k], -sign
    for k in range(NODES):
        weights[k] /= total


@jit
def fill_node(s: RubState, rows: RubRows, w: Work, dim: int, share: float, node: int, angle: float) -> None:
    """W of all tips when the casing has turned by `angle`, into node `node`; the slots then have all positions."""
    look_at(w.node_angles, NOW, angle)
    K, slots, wide, count = s.mu.size, w.row_columns.shape[1], w.line.size, 0
    for p in range(w.slot.size):
        w.slot[p] = -1
    for j in range(K):
        if w.slot[rows.place[j]] < 0:
            w.slot[rows.place[j]], count = count, count + 1
            waves_at(rows, j, w.node_angles, NOW, w.turn)
            fill_soft(rows.form, rows, w, j, count - 1, dim, w.turn)
            fill_columns(rows, w, j, count - 1, w.turn)
    w.slots[0] = count
    casing_yields(w, 0, dim)
    for j in range(K):
        slot = w.slot[rows.place[j]] * dim
        for i in range(dim):
            row, part = j * dim + i, share if i == 0 else 1.0
            at, casing = (row * NODES + node) * wide, (slot + i) * w.casing.shape[1]
            for m in range(K):
                other = w.slot[rows.place[m]]
                for k in range(dim):
                    column = m * dim + k
                    found = entry(w.casing, casing + k * slots + other) + part * rows.fixed[row, column]
                    w.nodes[at + column] = found + rows.still[row, column]


@jit
def interpolate(w: Work, size: int) -> None:
    """Interpolate W of the chosen tips from the nodes."""
    a, b, c, d = same(w.weights[0]), same(w.weights[1]), same(w.weights[2]), same(w.weights[3])
    e, f, g, h = same(w.weights[4]), same(w.weights[5]), same(w.weights[6]), same(w.weights[7])
    wide = w.line.size
    for n in range(size):
        first = w.row[n] * NODES * wide
        for k in range(0, wide, WIDTH):
            at = first + k
            some = a * load(w.nodes, at) + b * load(w.nodes, at + wide)
            more = c * load(w.nodes, at + 2 * wide) + d * load(w.nodes, at + 3 * wide)
            some = some + e * load(w.nodes, at + 4 * wide) + f * load(w.nodes, at + 5 * wide)
            more = more + g * load(w.nodes, at + 6 * wide) + h * load(w.nodes, at + 7 * wide)
            put(w.line, k, some + more)
        for k in range(size):
            w.W[n, k] = entry(w.line, entry(w.row, k))
