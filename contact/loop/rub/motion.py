"""Compiled: motion of the casing at its tips, from their rows or, for many tips, from waves.

A row is a sum of waves at the angle of its tip. So the motion at all tips follows from the motion by waves, which is
computed once. Likewise the modal forces follow from the contact forces by waves.
"""

from __future__ import annotations

from contact.base.arrays import Array
from contact.jit.compiled import jit, jit_inside
from contact.jit.vector import WIDTH, load, put, same, total
from contact.loop.modal.rows import fill_some
from contact.loop.rub.rows import AHEAD, NOW, RubRows, fill_block, waves_at
from contact.loop.rub.series import fill_row
from contact.loop.rub.state import RubState, Work


@jit_inside
def felt(values: Array, first: int, waves: Array) -> float:
    """Sum of products of `waves` with as many values from `first` on."""
    part = same(0.0)
    for k in range(0, waves.size, WIDTH):
        part = part + load(values, first + k) * load(waves, k)
    result: float = total(part)
    return result


@jit
def see(rows: RubRows, w: Work, some: Array, others: Array, dim: int, first: int, end: int) -> None:
    """Sum of two motions of the modes by waves, along the directions `first` .. `end` - 1 of every line."""
    for i in range(0, rows.width, WIDTH):
        put(w.spare, i, load(some, i) + load(others, i))
    see_spare(rows, w, dim, first, end)


@jit
def see_spare(rows: RubRows, w: Work, dim: int, first: int, end: int) -> None:
    """Like `see`, for the motion in `spare`."""
    for line in range(rows.reach.shape[0]):
        for i in range(first, end):
            block = (line * rows.directions + i) * (w.turn.size // WIDTH)
            fill_some(rows.seen, w.spare, block, w.motion_waves[line * dim + i])


@jit
def place_row(rows: RubRows, w: Work, j: int, side: int) -> None:
    """Normal row of tip j at t_n or t_{n+1}, for which the waves have been computed."""
    p = rows.place[j]
    if w.filled[side, p] == 0:
        w.filled[side, p] = 1
        fill_row(rows, w, j, 0, NOW if side == w.side[0] else AHEAD, w.waves[side, p], w.normal[side, p])


@jit
def press_waves(s: RubState, rows: RubRows, w: Work, count: int, dim: int, when: int) -> None:
    """Forces of the chosen tips by waves, at their positions at t_n or before."""
    n = w.turn.size
    for k in range(0, w.pressed.size, WIDTH):
        put(w.pressed, k, same(0.0))
    for a in range(count):
        j = w.chosen[a]
        waves_at(rows, j, w.angles, when, w.turn)
        for i in range(dim):
            first, part = (rows.line[j] * dim + i) * n, same(s.lam[j * dim + i])
            for k in range(0, n, WIDTH):
                put(w.pressed, first + k, load(w.pressed, first + k) + part * load(w.turn, k))


@jit
def push_waves(rows: RubRows, w: Work, dim: int) -> None:
    """Modal forces from the forces by waves."""
    for k in range(0, w.pushed.size, WIDTH):
        put(w.pushed, k, same(0.0))
    for line in range(rows.reach.shape[0]):
        for i in range(dim):
            fill_block(rows, line * rows.directions + i, w.pressed[line * dim + i], w.spare)
            for k in range(0, w.pushed.size, WIDTH):
                put(w.pushed, k, load(w.pushed, k) + load(w.spare, k))
