"""The forces of one step: rows and compliances of the closing tips, friction, and the modal forces."""

from __future__ import annotations

from contact.base.arrays import Array
from contact.jit.compiled import jit, jit_inside
from contact.jit.vector import WIDTH, entry, load, put, same
from contact.loop.modal.rows import product, weighted
from contact.loop.rub.compliance import copy, row_of_few, soft_at, strain_waves
from contact.loop.rub.matrix import add_part, assemble, fill_factors, interpolate, known, law
from contact.loop.rub.motion import felt, place_row, press_waves, push_waves, see_spare
from contact.loop.rub.rows import NOW, RubRows, blade_dot, waves_at
from contact.loop.rub.series import fill_row
from contact.loop.rub.state import ROUGH, ModalBlocks, RubState, Solver, Work, couples
from contact.solver.abradable.tips import Coats, coated
from contact.solver.dense import affine, assign, dot
from contact.solver.friction.coulomb import friction_forces
from contact.solver.friction.newton import TOLERANCE
from contact.solver.yielding.yields import Yielding, gives_way


@jit
def gather(s: RubState, rows: RubRows, blocks: ModalBlocks, w: Work, dim: int, share: float,
           interpolated: bool) -> int:  # fmt: skip
    """Rows at t_n of the tips to solve for, and the factors of W unless `interpolated`; returns the number of tips."""
    count, w.slots[0] = 0, 0
    for p in range(w.slot.size):
        w.slot[p] = -1
    if rows.many:
        assign(w.spare, s.d, rows.width)
        see_spare(rows, w, dim, 1, dim)  # normal directions are not asked for
    for j in range(s.mu.size):
        if s.inside[j] != 2:
            for i in range(j * dim, (j + 1) * dim):
                s.lam[i] = 0.0
            continue
        if w.slot[rows.place[j]] < 0:
            fill_slot(s, rows, blocks, w, j, dim, share, interpolated)
        slot = w.slot[rows.place[j]]
        for i in range(dim):
            a = count * dim + i
            w.row[a], w.column[a], w.across[a] = j * dim + i, slot * dim + i, i * w.row_columns.shape[1] + slot
        w.chosen[count] = j
        count += 1
    return count


@jit
def fill_slot(s: RubState, rows: RubRows, blocks: ModalBlocks, w: Work, j: int, dim: int, share: float,
              interpolated: bool) -> None:  # fmt: skip
    """Set the next slot to the position of tip j."""
    p, slot, now, n = rows.place[j], w.slots[0], w.side[0], w.turn.size
    w.slot[p], w.slots[0] = slot, slot + 1
    place_now(rows, w, j)
    known = rows.steady or rows.W.size > 0 or interpolated
    for i in range(dim):
        row = w.rows[slot * dim + i]
        if rows.many:
            w.along[slot * dim + i] = felt(w.motion_waves, (rows.line[j] * dim + i) * n, w.waves[now, p])
            if known:
                continue
        if i > 0:
            fill_row(rows, w, j, i, NOW, w.waves[now, p], row)
        else:
            place_row(rows, w, j, now)
            copy(w.normal[now, p], row)
        if not rows.many:
            w.along[slot * dim + i] = product(row, s.d)
    if not known:
        place_row(rows, w, j, 1 - now)
        fill_factors(s, rows, blocks, w, j, slot, dim, share, w.waves[now, p], w.normal[1 - now, p])


@jit
def place_now(rows: RubRows, w: Work, j: int) -> None:
    """Waves at tip j at t_n; already known if it was near in the last step."""
    p, now = rows.place[j], w.side[0]
    if w.fresh[now, p] == 0:
        w.fresh[now, p], w.filled[now, p] = 1, 0
        waves_at(rows, j, w.angles, NOW, w.waves[now, p])


@jit
def solve(s: RubState, rows: RubRows, w: Work, solver: Solver, coats: Coats, y: Yielding, count: int,
          dim: int, share: float, slid: float, interpolated: bool) -> bool:  # fmt: skip
    """Forces of the chosen tips into `lam`; gaps (from the pressed surface) and slips into `motion`."""
    size, W = count * dim, w.W
    if interpolated:
        interpolate(w, size)
    elif rows.W.size == 0:
        assemble(s, rows, w, count, dim, share)
    elif size == rows.W.shape[0]:  # all tips, in their order
        W = rows.W
    else:
        known(rows, w, size)
    start(s, rows, w, W, count, dim, slid)
    if coated(coats) or gives_way(y):
        solved = solver.yielding(
            coats, y, w.chosen, W, w.b, w.mu, dim, count, w.lam, w.depth, solver.all_sliding, solver.room
        )
    else:
        solved = rigid(s, w, W, solver, count, dim, not rows.steady)
    if not solved:
        s.counts[3] = ROUGH
        return False
    affine(W, w.lam, w.b, w.motion, size)
    if coated(coats):
        for a in range(count):
            coats.memory[w.chosen[a], 2] = w.depth[a]
            w.motion[a * dim] += w.depth[a]
    if gives_way(y):
        for a in range(count):
            y.depth[w.chosen[a]] = w.depth[a]
            w.motion[a * dim] += w.depth[a]
    hand_over(s, rows, w, count, dim)
    return True


@jit
def rigid(s: RubState, w: Work, W: Array, solver: Solver, count: int, dim: int, fast: bool) -> bool:
    """Forces of the chosen tips on a rigid surface; `fast`: the surface rotates, and most tips slide."""
    if fast and dim > 1 and count > 1:
        solver.all_sliding(W, w.b, w.mu, dim, count, w.lam, solver.room)
    iterations, miss = friction_forces(W, w.b, w.mu, dim, count, w.lam, solver.room)
    s.counts[0] = max(s.counts[0], float(iterations))
    s.counts[1] += float(iterations)
    return bool(miss <= TOLERANCE)


@jit
def start(s: RubState, rows: RubRows, w: Work, W: Array, count: int, dim: int, slid: float) -> None:
    """Set b, mu and the last forces of the chosen tips; `slid` = Omega h, or 1 if rows are constant."""
    for n in range(count):
        j = w.chosen[n]
        w.mu[n] = s.mu[j]
        for i in range(dim):
            a, row = n * dim + i, j * dim + i
            w.lam[a] = s.lam[row]
            if i == 0:
                w.b[a], s.scale[j] = s.test[j] - s.skin[j], W[a, a]
            else:
                w.b[a] = w.along[w.column[a]] + blade_dot(rows, rows.apart, row, j, s.d) - s.strain[row]
                w.b[a] += rows.glide[row] * slid


@jit
def hand_over(s: RubState, rows: RubRows, w: Work, count: int, dim: int) -> None:
    """Copy forces, gaps and slips to the tips, and their modal forces to the casing."""
    for a in range(count * dim):
        s.lam[w.row[a]], s.motion[w.row[a]] = w.lam[a], w.motion[a]
    if rows.many:
        press_waves(s, rows, w, count, dim, NOW)
        push_waves(rows, w, dim)
        if rows.turns:
            strain_waves(rows, w)
        return
    used = w.slots[0] * dim
    for a in range(used):
        w.pull[a] = 0.0
    for a in range(count * dim):
        w.pull[w.column[a]] += w.lam[a]
    for k in range(0, w.pushed.size, WIDTH):
        total = same(0.0)
        for a in range(used):
            total = total + same(w.pull[a]) * load(w.rows, a * w.pushed.size + k)
        put(w.pushed, k, total)


@jit
def others_close(s: RubState, rows: RubRows, blocks: ModalBlocks, w: Work, count: int, dim: int,
                 share: float) -> bool:  # fmt: skip
    """Whether the forces close tips that were left out; marks these, and records the gaps of the others."""
    grown = False
    find_gaps(s, rows, blocks, w, count, dim, share)
    for j in range(s.mu.size):
        if s.inside[j] == 1 and s.motion[j * dim] < 0.0:
            s.inside[j], grown = 2, True
    return grown


@jit
def find_gaps(s: RubState, rows: RubRows, blocks: ModalBlocks, w: Work, count: int, dim: int,
              share: float) -> None:  # fmt: skip
    """Gaps of the tips that were left out, under the forces of the chosen ones."""
    if rows.many:
        law(s.c, w.pushed, 1.0, w.spare)
        if couples(blocks):
            add_part(w.response, 1.0, w.spare)
        see_spare(rows, w, dim, 0, 1)
    for j in range(s.mu.size):
        if s.inside[j] != 1:
            continue
        R, p, ahead = j * dim, rows.place[j], 1 - w.side[0]
        if rows.many:
            casing = felt(w.motion_waves, rows.line[j] * dim * w.turn.size, w.waves[ahead, p])
        else:
            casing = weighted(w.normal[ahead, p], s.c, w.pushed)
            if couples(blocks):
                casing += product(w.normal[ahead, p], w.response)
        if not rows.steady:
            casing += dot(rows.fixed[R], s.lam, s.lam.size)
        gap = s.test[j] + share * casing + dot(rows.still[R], s.lam, s.lam.size)
        if rows.turns and rows.few:
            for n in range(count):
                first = w.chosen[n] * dim
                for i in range(dim):
                    at = row_of_few(w, w.side[0], w.chosen[n], i * s.lam.size + R)
                    gap += entry(w.S, at) * s.lam[first + i]
        if rows.turns and not rows.few:
            place_now(rows, w, j)
            gap += soft_at(rows, w, -1, j, 0, dim)
        s.motion[R] = gap


@jit
def push(s: RubState, rows: RubRows, w: Work, count: int, dim: int) -> None:
    """Apply forces to the modes, and add the response to the increments."""
    for i in range(0, rows.width, WIDTH):
        pushed = load(w.pushed, i)
        put(s.contact, i, pushed)
        put(s.d, i, load(s.d, i) + load(s.c, i) * pushed)
    clear(s.contact, rows.width)
    for n in range(count):
        j = w.chosen[n]
        size = rows.blade.shape[1]
        first = j * dim * size - entry(rows.own, 2 * j)
        k, end = entry(rows.apart, 2 * j), entry(rows.apart, 2 * j + 1)
        while k + WIDTH <= end:
            forces = same(0.0)
            for i in range(dim):
                forces = forces + load(rows.blade, first + i * size + k) * same(entry(s.lam, j * dim + i))
            put(s.contact, k, load(s.contact, k) + forces)
            put(s.d, k, load(s.d, k) + load(s.c, k) * forces)
            k += WIDTH
        while k < end:
            force = 0.0
            for i in range(dim):
                force += entry(rows.blade, first + i * size + k) * entry(s.lam, j * dim + i)
            s.contact[k] += force
            s.d[k] += s.c[k] * force
            k += 1


@jit_inside
def clear(values: Array, first: int) -> None:
    """Set zeros from block `first` on."""
    for i in range(first, values.size, WIDTH):
        put(values, i, same(0.0))


@jit
def update_gaps(s: RubState, w: Work, count: int, dim: int, share: float) -> None:
    """Add the effect of the forces to the gaps of q at t_{n+1}: the complete gap of the law except S lam."""
    whole = 1.0 / share
    for j in range(s.mu.size):
        if s.inside[j] == 1:
            s.free[j] += whole * (s.motion[j * dim] - s.test[j] - w.strain[j * dim])
    for n in range(count):
        j = w.chosen[n]
        s.free[j] += whole * (s.motion[j * dim] - w.depth[n] - (s.test[j] - s.skin[j]) - w.strain[j * dim])
