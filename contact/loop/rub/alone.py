"""Compiled: the force of one tip that closes alone, and its effects if the run has no other tip."""

from __future__ import annotations

from contact.base.arrays import Array
from contact.jit.compiled import jit, jit_inside
from contact.jit.vector import WIDTH, load, put, same, total
from contact.loop.formulas import turned_work, works
from contact.loop.modal.rows import fill_some, fill_two, product, weighted
from contact.loop.rub.compliance import fill_few, fill_soft, yields
from contact.loop.rub.motion import place_row
from contact.loop.rub.rows import NOW, RubRows, blade_dot
from contact.loop.rub.series import fill_row
from contact.loop.rub.solve import place_now
from contact.loop.rub.state import ModalBlocks, RubState, Solver, Work, couples, tips
from contact.record.record import Tally
from contact.solver.friction.one_contact import one_contact, only_contact

UNSOLVED, SOLVED, DONE = 0, 1, 2


@jit
def alone(s: RubState, rows: RubRows, blocks: ModalBlocks, w: Work, solver: Solver | None, dim: int,
          share: float, slid: float, step: int, sums: Tally) -> int:  # fmt: skip
    """Force of the single marked tip, its gap and slip; UNSOLVED if `solver` must find it. `slid` = Omega h.

    Without friction or with one slip direction, one pass over the modes does the work of `gather` and `solve`. DONE if
    the run has no other tip: the force is also added to the increments and the sums.
    """
    chosen = 0
    for j in range(tips(s, solver)):
        if s.inside[j] == 2:
            chosen = j
        else:
            for i in range(j * dim, (j + 1) * dim):
                s.lam[i] = 0.0
    if dim > 2:
        return UNSOLVED
    j, R, p, rubs = chosen, chosen * dim, rows.place[chosen], dim == 2
    place_now(rows, w, j)
    place_row(rows, w, j, w.side[0])
    place_row(rows, w, j, 1 - w.side[0])
    normal, ahead, tangent = w.normal[w.side[0], p], w.normal[1 - w.side[0], p], w.rows[dim - 1]
    nn, nt, tn, tt, slip = share * rows.fixed[R, R], 0.0, 0.0, 0.0, 0.0
    if rubs:
        fill_row(rows, w, j, 1, NOW, w.waves[w.side[0], p], tangent)
        n, across, along, t, slid_by = couplings(s, normal, ahead, tangent, rows.width)
        nn, nt, tn = nn + share * n, share * (across + rows.fixed[R, R + 1]), along + rows.fixed[R + 1, R]
        tt = t + rows.fixed[R + 1, R + 1]
        slip = slid_by + blade_dot(rows, rows.apart, R + 1, j, s.d) - s.strain[R + 1] + rows.glide[R + 1] * slid
    else:
        nn += share * weighted(ahead, s.c, normal)
    if solver is not None:
        if couples(blocks):
            if rubs:
                fill_two(blocks.casing, normal, tangent, w.normal_moves, w.tangent_moves)
            else:
                fill_some(blocks.casing, normal, 0, w.normal_moves)
            nn += share * product(ahead, w.normal_moves)
            if rubs:
                nt, tn = nt + share * product(ahead, w.tangent_moves), tn + product(tangent, w.normal_moves)
                tt += product(tangent, w.tangent_moves)
    w.chosen[0] = j
    if rows.turns and rows.few:
        fill_few(rows, w, 1, step)
    elif rows.turns:
        fill_soft(rows.S, rows, w, j, 0, dim, w.waves[w.side[0], p])
    S_nn, S_nt, S_tt = yields(rows, w, j, 0, 0, dim), 0.0, 0.0
    if rubs:
        S_nt, S_tt = yields(rows, w, j, 0, 1, dim), yields(rows, w, j, 1, 1, dim)
        nt, tn, tt = nt + S_nt, tn + S_nt, tt + S_tt
    nn += S_nn
    mu = s.mu[j] if rubs else 0.0
    if solver is None:
        found, press, drag = only_contact(nn, nt, tn, tt, s.test[j], slip, mu)
    else:
        found, press, drag = one_contact(nn, nt, tn, tt, s.test[j], slip, mu)
    if not found:
        return UNSOLVED
    s.scale[j], s.lam[R], s.motion[R] = nn, press, nn * press + nt * drag + s.test[j]
    if rubs:
        s.lam[R + 1], s.motion[R + 1] = drag, tn * press + tt * drag + slip
    if alone_in_run(s, rows, solver):
        across, along = push_now(s, blocks, w, solver, normal, tangent, press, drag)
        add_work(s, rows, w, across, along, S_nn * press + S_nt * drag, S_nt * press + S_tt * drag, share, sums)
        if rubs:
            s.drive[0] -= drag * rows.glide[1] * slid
        return DONE
    w.slots[0], w.slot[p], w.column[0] = 1, 0, 0
    if rubs:
        w.column[1] = 1
    push_one(w, normal, tangent, press, drag, rubs)
    if solver is not None:
        if couples(blocks):
            respond_one(w, press, drag)
    return SOLVED


@jit_inside
def alone_in_run(s: RubState, rows: RubRows, solver: Solver | None) -> bool:
    """Whether the run has no other tip, and all of its effects are in the row of this one."""
    only = True
    if solver is not None:
        only = s.mu.size == 1 and not rows.steady and rows.few
    return only


@jit_inside
def couplings(s: RubState, normal: Array, ahead: Array, tangent: Array,
              width: int) -> tuple[float, float, float, float, float]:  # fmt: skip
    """Response of the casing to forces along the normal at t_{n+1} and along the tangent at t_n, and its slip."""
    nn, nt, tn, tt, slip = same(0.0), same(0.0), same(0.0), same(0.0), same(0.0)
    for i in range(0, width, WIDTH):
        row, along, c = load(normal, i), load(tangent, i), load(s.c, i)
        test, pull = load(ahead, i) * c, along * c
        nn, nt, tn, tt = nn + test * row, nt + test * along, tn + pull * row, tt + pull * along
        slip = slip + along * load(s.d, i)
    return total(nn), total(nt), total(tn), total(tt), total(slip)


@jit_inside
def push_now(s: RubState, blocks: ModalBlocks, w: Work, solver: Solver | None, normal: Array, tangent: Array,
             press: float, drag: float) -> tuple[float, float]:  # fmt: skip
    """Add the response to the forces of the only tip to the increments.

    Returns its motion along the forces over two steps.

    Without friction `drag` is zero, and `tangent` any row.
    """
    to, drags, across, along = same(press), same(drag), same(0.0), same(0.0)
    if solver is not None:
        if couples(blocks):
            respond_one(w, press, drag)
            for i in range(0, normal.size, WIDTH):
                put(s.d, i, load(s.d, i) + load(w.response, i))
    for i in range(0, normal.size, WIDTH):
        row, pull = load(normal, i), load(tangent, i)
        pushed = row * to + pull * drags
        put(s.contact, i, pushed)
        step = load(s.d, i) + load(s.c, i) * pushed
        put(s.d, i, step)
        both = load(s.old, i) + step
        across, along = across + row * both, along + pull * both
    return total(across), total(along)


@jit_inside
def add_work(s: RubState, rows: RubRows, w: Work, across: float, along: float, strain: float, strain_along: float,
             share: float, sums: Tally) -> None:  # fmt: skip
    """Add the work of the only tip's forces along its motion, as `add_works` for many; and the resulting gap."""
    press, drag, turned, soft = s.lam[0], 0.0, 0.0, 0.0
    s.free[0] += 1.0 / share * (s.motion[0] - s.test[0] - strain)
    rubs = s.lam.size > 1
    if rubs:
        drag = s.lam[1]
        soft = drag * (strain_along - s.strain[1])
        s.heat[0] -= drag * s.motion[1]
        s.strain[1] = strain_along
    if rows.turns:
        now, before = w.side[0], 1 - w.side[0]
        nt, tt = (w.S[now, 0, 1] - w.S[before, 0, 1], w.S[now, 0, 3] - w.S[before, 0, 3]) if rubs else (0.0, 0.0)
        turned = turned_work(press, drag, w.S[now, 0, 0] - w.S[before, 0, 0], nt, tt)
    opened = press * (s.free[0] - s.last[0])
    work, rotation, friction = works(0.5, opened, turned, press * across, drag * along, soft)
    sums.work[0] += work
    sums.rotation[0] += rotation
    sums.friction[0] += friction
    s.strain[0] = strain


@jit_inside
def push_one(w: Work, normal: Array, tangent: Array, press: float, drag: float, rubs: bool) -> None:
    """The row of the tip, and the modal forces and static response due to its forces."""
    to, along = same(press), same(drag)
    for i in range(0, w.pushed.size, WIDTH):
        row = load(normal, i)
        put(w.rows, i, row)
        put(w.pushed, i, row * to + load(tangent, i) * along if rubs else row * to)
    for i in range(0, w.strained.size, WIDTH):
        strained = load(w.soft, i) * to
        put(w.strained, i, strained + load(w.soft, w.strained.size + i) * along if rubs else strained)


@jit_inside
def respond_one(w: Work, press: float, drag: float) -> None:
    """Response of the casing's coupled modes to the forces of the tip; `tangent_moves` is zero without friction."""
    to, along = same(press), same(drag)
    for i in range(0, w.response.size, WIDTH):
        put(w.response, i, load(w.normal_moves, i) * to + load(w.tangent_moves, i) * along)
