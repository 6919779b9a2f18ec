"""Compiled: rows of a single tip by Taylor series in the angle turned, about the middle of a cell of angle.

A row is a sum of waves, so its derivatives are sums of the same waves. At low speed a tip stays in a cell for many
steps, and a series of `TERMS` vectors takes less time than the sum of all waves. `contact.scheme.modal.cells` chooses
the cells so that the error is round-off. The choice of the cell depends on the angle alone.
"""

from __future__ import annotations

import math

from contact.base.arrays import Array
from contact.jit.compiled import jit, jit_inside
from contact.jit.vector import WIDTH, load, put, same
from contact.loop.rub.rows import NOW, RubRows, fill_block, look_at, waves_at
from contact.loop.rub.state import TERMS, Work


@jit
def fill_row(rows: RubRows, w: Work, j: int, i: int, when: int, waves: Array, row: Array) -> None:
    """Row of the casing at tip j along direction i, at angle number `when`; `waves` are those of that angle."""
    if rows.cells == 0.0:
        fill_block(rows, rows.line[j] * rows.directions + i, waves, row)
        return
    place = w.angles[when, 0] * rows.cells
    number = math.floor(place)
    if w.series_at[i] != number:
        w.series_at[i] = number
        expand(rows, w, j, i, (number + 0.5) / rows.cells)
    sum_series(w.series, i * TERMS * row.size, 2.0 * (place - number) - 1.0, row)


@jit
def expand(rows: RubRows, w: Work, j: int, i: int, middle: float) -> None:
    """Fill the series of a row about the angle `middle`: term k times x^k, x = -1 .. 1 over the cell."""
    look_at(w.node_angles, NOW, middle)
    waves_at(rows, j, w.node_angles, NOW, w.turn)
    for k in range(TERMS):
        fill_block(rows, rows.line[j] * rows.directions + i, w.turn, w.series[i * TERMS + k])
        for n in range(w.turn.shape[1]):  # the tip's angle falls where the angle turned grows
            part, cos, sin = 0.5 * n / (rows.cells * (k + 1)), w.turn[0, n], w.turn[1, n]
            w.turn[0, n], w.turn[1, n] = part * sin, -part * cos


@jit_inside
def sum_series(series: Array, first: int, x: float, row: Array) -> None:
    """Sum over k of x^k times term k, by Horner's rule for even and for odd k."""
    odd, square, wide = same(x), same(x * x), row.size
    for i in range(0, wide, WIDTH):
        last = first + i + (TERMS - 2) * wide
        even, uneven = load(series, last), load(series, last + wide)
        for k in range(TERMS // 2 - 1):
            at = last - 2 * (k + 1) * wide
            even, uneven = even * square + load(series, at), uneven * square + load(series, at + wide)
        put(row, i, even + odd * uneven)
