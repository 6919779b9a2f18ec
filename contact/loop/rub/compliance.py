"""Compiled.

Residual compliance of the casing, which rotates relative to the tips, and the static response to all forces.

S = E(phi) S_w E(phi)^T + still, with the waves E at the tips and the compliance S_w between waves. For few tips, S is a
table over the angle, whose cost grows with their number squared. For many, only S_w E^T is computed, for the tips that
close.
"""

from __future__ import annotations

from contact.base.arrays import Array
from contact.jit.compiled import jit, jit_inside
from contact.jit.vector import WIDTH, entry, load, put, same
from contact.loop.modal.rows import RowBlocks, fill_one, fill_some
from contact.loop.rub.motion import felt, press_waves
from contact.loop.rub.rows import BEFORE, NOW, RubRows, waves_at
from contact.loop.rub.state import RubState, Work
from contact.solver.dense import add_from, dot, dot_from


@jit_inside
def copy(row: Array, out: Array) -> None:
    """Copy `row` into `out`, which may be longer."""
    for i in range(0, row.size, WIDTH):
        put(out, i, load(row, i))


@jit
def fill_few(rows: RubRows, w: Work, count: int, step: int) -> None:
    """S of the chosen tips at phi_n and at phi_{n-1}, from the waves at t_n."""
    blocks, now = w.S.shape[2] // WIDTH, w.side[0]
    for n in range(count):
        j = w.chosen[n]
        if w.S_at[j] == step:  # solved for a second time
            continue
        if w.S_at[j] != step - 1:
            waves_at(rows, j, w.angles, BEFORE, w.turn)
            fill_S(rows, w.turn, j * blocks, w.S[1 - now, j])
        w.S_at[j] = step
        fill_S(rows, w.waves[now, rows.place[j]], j * blocks, w.S[now, j])


@jit_inside
def row_of_few(w: Work, side: int, j: int, first: int) -> int:
    """Row of entry `first` of the S of tip j, at t_n or before."""
    at: int = (side * w.S.shape[1] + j) * w.S.shape[2] + first
    return at


@jit_inside
def fill_S(rows: RubRows, waves: Array, first: int, row: Array) -> None:
    """S of one tip, from block `first`: a single block if there is one tip."""
    if row.size == WIDTH:
        fill_one(rows.S, waves, first, row, 0)
    else:
        fill_some(rows.S, waves, first, row)


@jit
def fill_soft(S: RowBlocks, rows: RubRows, w: Work, j: int, slot: int, dim: int, waves: Array) -> None:
    """Static response of the casing, by waves, to unit forces at tip j; `waves` are those at the tip."""
    for i in range(dim):
        block = (rows.line[j] * dim + i) * (w.strained.size // WIDTH)
        fill_some(S, waves, block, w.soft[slot * dim + i])


@jit
def soft_at(rows: RubRows, w: Work, row: int, j: int, i: int, dim: int) -> float:
    """Rotating part of S between row `row` of `soft` (all forces if negative) and direction i of tip j."""
    waves = w.waves[w.side[0], rows.place[j]]
    first = (rows.line[j] * dim + i) * waves.size
    if row < 0:
        return float(felt(w.strained, first, waves))
    return float(felt(w.soft, row * w.strained.size + first, waves))


@jit_inside
def yields(rows: RubRows, w: Work, j: int, i: int, k: int, dim: int) -> float:
    """Residual compliance between two directions of tip j; the rotating part is in `S` or first in `soft`."""
    R = j * dim
    found = entry(rows.still, (R + i) * rows.still.shape[1] + R + k)
    if rows.turns:
        found += w.S[w.side[0], j, i * rows.still.shape[1] + R + k] if rows.few else soft_at(rows, w, i, j, k, dim)
    return found  # type: ignore[no-any-return]


@jit
def strains(s: RubState, rows: RubRows, w: Work, count: int, dim: int) -> None:
    """S lam in every direction of every tip, and its rotating part."""
    R = w.strain.size
    for k in range(R):
        w.strain[k], w.turning[k] = dot(rows.still[k], s.lam, R) if count > 0 else 0.0, 0.0
    if rows.turns and rows.few:
        for n in range(count):  # S is symmetric
            for i in range(dim):
                add_from(w.turning, s.lam[w.chosen[n] * dim + i], w.S, row_of_few(w, w.side[0], w.chosen[n], i * R), R)
    if count > 0 and rows.turns and not rows.few:
        for j in range(s.mu.size):
            if w.fresh[w.side[0], rows.place[j]] == 1:
                for i in range(dim):
                    w.turning[j * dim + i] = soft_at(rows, w, -1, j, i, dim)
                continue
            waves_at(rows, j, w.angles, NOW, w.turn)
            for i in range(dim):
                w.turning[j * dim + i] = felt(w.strained, (rows.line[j] * dim + i) * w.turn.size, w.turn)
    for k in range(w.strain.size):
        w.strain[k] += w.turning[k]


@jit
def strains_before(s: RubState, rows: RubRows, w: Work, count: int, dim: int) -> None:
    """Rotating part of S lam with S at phi_{n-1}, along the directions of the chosen tips."""
    if rows.few:
        R = s.lam.size
        for n in range(count):
            j = w.chosen[n]
            for i in range(dim):
                w.before[j * dim + i] = dot_from(w.S, row_of_few(w, 1 - w.side[0], j, i * R), s.lam, R)
        return
    press_waves(s, rows, w, count, dim, BEFORE)
    strain_waves(rows, w)
    for a in range(count):
        j = w.chosen[a]
        waves_at(rows, j, w.angles, BEFORE, w.turn)
        for i in range(dim):
            w.before[j * dim + i] = felt(w.strained, (rows.line[j] * dim + i) * w.turn.size, w.turn)


@jit
def strain_waves(rows: RubRows, w: Work) -> None:
    """Static response of the casing to forces, both by waves."""
    for k in range(0, w.strained.size, WIDTH):
        put(w.strained, k, same(0.0))
    for b in range(w.pressed.shape[0]):
        fill_some(rows.S, w.pressed[b], b * (w.strained.size // WIDTH), w.spread)
        for k in range(0, w.strained.size, WIDTH):
            put(w.strained, k, load(w.strained, k) + load(w.spread, k))
