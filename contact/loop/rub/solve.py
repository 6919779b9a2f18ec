"""The forces of one step: rows and compliances of the tips that close, friction, and what the forces push."""

from __future__ import annotations

from contact.base.arrays import Array
from contact.jit.compiled import jit, jit_inside
from contact.jit.vector import WIDTH, entry, load, put, same
from contact.loop.modal.rows import fill_some, product, weighted
from contact.loop.rub.compliance import copy, fill_soft, soft_at
from contact.loop.rub.rows import NOW, RubRows, blade_dot, fill_block, waves_at
from contact.loop.rub.state import ROUGH, TOGETHER, ModalBlocks, RubState, Solver, Work
from contact.solver.abradable.tips import Coats
from contact.solver.dense import affine, dot
from contact.solver.friction.coulomb import friction_forces
from contact.solver.friction.newton import TOLERANCE
from contact.solver.yielding.several import yielding_forces
from contact.solver.yielding.yields import Yielding


@jit
def gather(s: RubState, rows: RubRows, blocks: ModalBlocks | None, w: Work, dim: int, share: float) -> int:
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
            fill_slot(s, rows, blocks, w, j, dim, share)
        slot = w.slot[rows.place[j]]
        for i in range(dim):
            a = count * dim + i
            w.row[a], w.column[a], w.across[a] = j * dim + i, slot * dim + i, i * w.row_columns.shape[1] + slot
        w.chosen[count] = j
        count += 1
    return count


@jit
def fill_slot(s: RubState, rows: RubRows, blocks: ModalBlocks | None, w: Work, j: int, dim: int,
              share: float) -> None:  # fmt: skip
    """The next slot becomes the place of tip j."""
    p, slot, now = rows.place[j], w.slots[0], w.side[0]
    w.slot[p], w.slots[0] = slot, slot + 1
    place_now(rows, w, j)
    for i in range(dim):
        row = w.rows[slot * dim + i]
        if i > 0:
            fill_block(rows, rows.line[j] * rows.directions + i, w.waves[now, p], row)
        else:
            copy(w.normal[now, p], row)
        w.along[slot * dim + i] = product(row, s.d)
        if rows.steady or rows.W.size > 0:
            continue
        test = w.tests[slot * dim + i]
        law(s.c, row if i > 0 else w.normal[1 - now, p], 1.0 if i > 0 else share, test)
        if blocks is not None:
            fill_some(blocks.turned, row if i > 0 else w.normal[1 - now, p], 0, w.spare)
            add_part(w.spare, 1.0 if i > 0 else share, test)
        for k in range(rows.width):
            w.row_columns[i * rows.width + k, slot] = row[k]
    if rows.turns and not rows.few:
        fill_soft(rows, w, j, slot, dim)
        waves, n = w.waves[now, p], w.turn.size
        for k in range(w.wave_columns.shape[0]):
            w.wave_columns[k, slot] = 0.0
        for k in range(n):
            w.wave_columns[rows.line[j] * n + k, slot] = entry(waves, k)


@jit
def place_now(rows: RubRows, w: Work, j: int) -> None:
    """Waves and normal row where tip j is at t_n; they are there if it was near in the last step."""
    p, now = rows.place[j], w.side[0]
    if w.fresh[now, p] == 0:
        w.fresh[now, p] = 1
        waves_at(rows, j, w.angles, NOW, w.waves[now, p])
        fill_block(rows, rows.line[j] * rows.directions, w.waves[now, p], w.normal[now, p])


@jit_inside
def law(c: Array, row: Array, share: float, out: Array) -> None:
    """Fill out = share c row."""
    part = same(share)
    for i in range(0, out.size, WIDTH):
        put(out, i, part * load(c, i) * load(row, i))


@jit_inside
def add_part(row: Array, share: float, out: Array) -> None:
    """Add share row to `out`."""
    part = same(share)
    for i in range(0, out.size, WIDTH):
        put(out, i, load(out, i) + part * load(row, i))


@jit
def solve(s: RubState, rows: RubRows, w: Work, solver: Solver, coats: Coats | None, y: Yielding | None, count: int,
          dim: int, share: float, slid: float) -> bool:  # fmt: skip
    """Forces of the chosen tips into `lam`, gaps (from the pressed surface) and slips into `motion`."""
    size = count * dim
    if rows.W.size == 0:
        assemble(s, rows, w, count, dim, share)
    else:
        known(rows, w, size)
    start(s, rows, w, count, dim, slid)
    if coats is None:
        if y is None:
            solved = rigid(s, w, solver, count, dim, not rows.steady)
        else:
            solved = yielding_forces(
                None, y, w.chosen, w.W, w.b, w.mu, dim, count, w.lam, w.depth, solver.all_sliding, solver.room
            )
    else:
        solved = yielding_forces(
            coats, None, w.chosen, w.W, w.b, w.mu, dim, count, w.lam, w.depth, solver.all_sliding, solver.room
        )
    if not solved:
        s.counts[3] = ROUGH
        return False
    affine(w.W, w.lam, w.b, w.motion, size)
    if coats is not None:
        for a in range(count):
            coats.memory[w.chosen[a], 2] = w.depth[a]
            w.motion[a * dim] += w.depth[a]
    if y is not None:
        for a in range(count):
            y.depth[w.chosen[a]] = w.depth[a]
            w.motion[a * dim] += w.depth[a]
    hand_over(s, w, size, dim)
    return True


@jit
def rigid(s: RubState, w: Work, solver: Solver, count: int, dim: int, fast: bool) -> bool:
    """Forces of the chosen tips on a rigid surface; `fast`: the surface turns, and most tips slide."""
    if fast and dim > 1 and count > 1:
        solver.all_sliding(w.W, w.b, w.mu, dim, count, w.lam, solver.room)
    iterations, miss = friction_forces(w.W, w.b, w.mu, dim, count, w.lam, solver.room)
    s.counts[0] = max(s.counts[0], float(iterations))
    s.counts[1] += float(iterations)
    return bool(miss <= TOLERANCE)


@jit
def start(s: RubState, rows: RubRows, w: Work, count: int, dim: int, slid: float) -> None:
    """Fill b, mu and the last forces of the chosen tips; `slid` = Omega h, or 1 where rows do not change."""
    for n in range(count):
        j = w.chosen[n]
        w.mu[n] = s.mu[j]
        for i in range(dim):
            a, row = n * dim + i, j * dim + i
            w.lam[a] = s.lam[row]
            if i == 0:
                w.b[a], s.scale[j] = s.test[j] - s.skin[j], w.W[a, a]
            else:
                w.b[a] = w.along[w.column[a]] + blade_dot(rows, rows.apart, row, j, s.d) - s.strain[row]
                w.b[a] += rows.glide[row] * slid


@jit
def known(rows: RubRows, w: Work, size: int) -> None:
    """Fill W with the rows and columns of the chosen tips."""
    wide = rows.W.shape[1]
    for a in range(size):
        own = w.row[a] * wide
        for k in range(size):
            w.W[a, k] = entry(rows.W, own + entry(w.row, k))


@jit
def assemble(s: RubState, rows: RubRows, w: Work, count: int, dim: int, share: float) -> None:
    """Fill W of the chosen tips."""
    size = count * dim
    casing_yields(rows, w, dim)
    for a in range(size):
        casing = w.column[a] * w.casing.shape[1]
        for k in range(size):
            w.W[a, k] = entry(w.casing, casing + entry(w.across, k))
    for n in range(count):
        for m in range(count):
            if rows.turns and rows.own[w.chosen[n], 0] != rows.own[w.chosen[m], 0]:
                continue  # `still` is that of the blades alone
            for i in range(dim):
                a, row, part = n * dim + i, w.chosen[n] * dim + i, share if i == 0 else 1.0
                for k in range(dim):
                    other = w.chosen[m] * dim + k
                    w.W[a, m * dim + k] += part * rows.fixed[row, other] + rows.still[row, other]
    if rows.turns and rows.few:
        for n in range(count):
            for i in range(dim):
                for k in range(size):
                    w.W[n * dim + i, k] += w.S[w.side[0], w.chosen[n], i * s.lam.size + w.row[k]]


@jit
def casing_yields(rows: RubRows, w: Work, dim: int) -> None:
    """Fill `casing`: tests rows^T, and what turns of the residual compliance; eight rows by eight slots at a time."""
    width, slots, columns, waves = rows.width, w.row_columns.shape[1], w.casing.shape[1], w.strained.size
    n = w.turn.size
    for i in range(dim):
        for q in range(0, w.slots[0], WIDTH):
            for a in range(0, w.slots[0] * dim, TOGETHER):
                test, soft = a * width, a * waves
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
def hand_over(s: RubState, w: Work, size: int, dim: int) -> None:
    """Forces, gaps and slips to the tips, and what the forces push on the casing."""
    used = w.slots[0] * dim
    for a in range(used):
        w.pull[a] = 0.0
    for a in range(size):
        s.lam[w.row[a]], s.motion[w.row[a]] = w.lam[a], w.motion[a]
        w.pull[w.column[a]] += w.lam[a]
    for k in range(0, w.pushed.size, WIDTH):
        total = same(0.0)
        for a in range(used):
            total = total + same(w.pull[a]) * load(w.rows, a * w.pushed.size + k)
        put(w.pushed, k, total)
    for k in range(0, w.strained.size, WIDTH):
        total = same(0.0)
        for a in range(used):
            total = total + same(w.pull[a]) * load(w.soft, a * w.strained.size + k)
        put(w.strained, k, total)


@jit
def others_close(s: RubState, rows: RubRows, blocks: ModalBlocks | None, w: Work, count: int, dim: int,
                 share: float) -> bool:  # fmt: skip
    """Whether the forces close tips that were left out; these are marked, the gaps of the others noted."""
    grown = False
    find_gaps(s, rows, blocks, w, count, dim, share)
    for j in range(s.mu.size):
        if s.inside[j] == 1 and s.motion[j * dim] < 0.0:
            s.inside[j], grown = 2, True
    return grown


@jit
def find_gaps(s: RubState, rows: RubRows, blocks: ModalBlocks | None, w: Work, count: int, dim: int,
              share: float) -> None:  # fmt: skip
    """Gaps of the tips that were left out, under the forces of the chosen."""
    if blocks is not None:
        fill_some(blocks.casing, w.pushed, 0, w.normal_moves)
    for j in range(s.mu.size):
        if s.inside[j] != 1:
            continue
        R = j * dim
        casing = weighted(w.normal[1 - w.side[0], rows.place[j]], s.c, w.pushed)
        if blocks is not None:
            casing += product(w.normal[1 - w.side[0], rows.place[j]], w.normal_moves)
        if not rows.steady:
            casing += dot(rows.fixed[R], s.lam, s.lam.size)
        gap = s.test[j] + share * casing + dot(rows.still[R], s.lam, s.lam.size)
        if rows.turns and rows.few:
            for n in range(count):
                first = w.chosen[n] * dim
                for i in range(dim):
                    gap += w.S[w.side[0], w.chosen[n], i * s.lam.size + R] * s.lam[first + i]
        if rows.turns and not rows.few:
            place_now(rows, w, j)
            gap += soft_at(rows, w, -1, j, 0, dim)
        s.motion[R] = gap


@jit
def push(s: RubState, rows: RubRows, w: Work, count: int, dim: int) -> None:
    """Forces on the modes, and what they add to the increments."""
    for i in range(0, rows.width, WIDTH):
        pushed = load(w.pushed, i)
        put(s.contact, i, pushed)
        put(s.d, i, load(s.d, i) + load(s.c, i) * pushed)
    clear(s.contact, rows.width)
    for n in range(count):
        j = w.chosen[n]
        begin = rows.own[j, 0]
        for k in range(rows.apart[j, 0], rows.apart[j, 1]):
            force = 0.0
            for row in range(j * dim, (j + 1) * dim):
                force += rows.blade[row, k - begin] * s.lam[row]
            s.contact[k] += force
            s.d[k] += s.c[k] * force


@jit_inside
def clear(values: Array, first: int) -> None:
    """Zeros from block `first` on."""
    for i in range(first, values.size, WIDTH):
        put(values, i, same(0.0))


@jit
def update_gaps(s: RubState, w: Work, count: int, dim: int, share: float) -> None:
    """Add the forces' share to the gaps of q at t_{n+1}: of what the law states, all that is not S lam."""
    whole = 1.0 / share
    for j in range(s.mu.size):
        if s.inside[j] == 1:
            s.free[j] += whole * (s.motion[j * dim] - s.test[j] - w.strain[j * dim])
    for n in range(count):
        j = w.chosen[n]
        s.free[j] += whole * (s.motion[j * dim] - w.depth[n] - (s.test[j] - s.skin[j]) - w.strain[j * dim])
