"""Compiled rows and polynomials of the contact angle, for eight modes or harmonics at a time."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from contact.base.arrays import Array, Indices
from contact.jit.compiled import jit, jit_inside
from contact.jit.vector import WIDTH, eight, entry, larger, load, put, same, total
from contact.loop.formulas import damped


class RowBlocks(NamedTuple):
    """Sums of waves in blocks of eight sums.

    The waves of a block are at `start[block]` up to the next start, an even number.

    A block has only the waves that one of its sums needs: few for a nearly perfect casing, all for others. If a block
    is `alike`, the next three have the same waves, and each wave is read once for all four.
    """

    start: Indices
    wave: Indices  # n is cos n phi, harmonics + n is sin n phi
    value: Array  # (entries, 8)
    alike: Indices


@jit_inside
def rotate(waves: Array, phi: float) -> None:
    """Cos n phi and sin n phi."""
    multiples(waves, math.cos(phi), math.sin(phi))


@jit_inside
def multiples(waves: Array, c: float, s: float) -> None:
    """Cos n phi and sin n phi from cos phi and sin phi by the addition theorem, without accumulated error."""
    count = waves.shape[1]
    c2, s2 = c * c - s * s, 2.0 * c * s
    c3, s3 = c2 * c - s2 * s, s2 * c + c2 * s
    c4, s4 = c2 * c2 - s2 * s2, 2.0 * c2 * s2
    c5, s5, c6, s6 = c4 * c - s4 * s, s4 * c + c4 * s, c4 * c2 - s4 * s2, s4 * c2 + c4 * s2
    # put together in registers: a vector read where single numbers were just written waits for all of them
    a8 = eight(1.0, c, c2, c3, c4, c5, c6, c4 * c3 - s4 * s3)
    b8 = eight(0.0, s, s2, s3, s4, s5, s6, s4 * c3 + c4 * s3)
    c8, s8 = same(c4 * c4 - s4 * s4), same(2.0 * c4 * s4)
    put(waves, 0, a8)
    put(waves, count, b8)
    for n in range(WIDTH, count, WIDTH):
        a8, b8 = c8 * a8 - s8 * b8, s8 * a8 + c8 * b8
        put(waves, n, a8)
        put(waves, count + n, b8)


@jit
def fill_some(rows: RowBlocks, waves: Array, first: int, row: Array) -> None:
    """Fill `row` with as many sums as it has entries, from block `first` on."""
    block, end = first, first + row.size // WIDTH
    while block < end:
        begin, last = entry(rows.start, block), entry(rows.start, block + 1)
        place = WIDTH * (block - first)
        if entry(rows.alike, block) == 1:
            a, b, c, d = same(0.0), same(0.0), same(0.0), same(0.0)
            next_block = WIDTH * (last - begin)
            for j in range(begin, last, 2):
                wave, at = same(entry(waves, entry(rows.wave, j))), WIDTH * j
                a = a + load(rows.value, at) * wave
                b = b + load(rows.value, at + next_block) * wave
                c = c + load(rows.value, at + 2 * next_block) * wave
                d = d + load(rows.value, at + 3 * next_block) * wave
                wave, at = same(entry(waves, entry(rows.wave, j + 1))), at + WIDTH
                a = a + load(rows.value, at) * wave
                b = b + load(rows.value, at + next_block) * wave
                c = c + load(rows.value, at + 2 * next_block) * wave
                d = d + load(rows.value, at + 3 * next_block) * wave
            put(row, place, a)
            put(row, place + WIDTH, b)
            put(row, place + 2 * WIDTH, c)
            put(row, place + 3 * WIDTH, d)
            block += 4
        else:
            fill_one(rows, waves, block, row, place)
            block += 1


@jit_inside
def fill_one(rows: RowBlocks, waves: Array, block: int, row: Array, place: int) -> None:
    """Fill the eight sums of a block, from entry `place` of the row on."""
    begin, last = entry(rows.start, block), entry(rows.start, block + 1)
    a, b, c, d = same(0.0), same(0.0), same(0.0), same(0.0)
    for j in range(begin, last - 3, 4):  # four sums, so that none waits for the last product
        at = WIDTH * j
        a = a + load(rows.value, at) * same(entry(waves, entry(rows.wave, j)))
        b = b + load(rows.value, at + WIDTH) * same(entry(waves, entry(rows.wave, j + 1)))
        c = c + load(rows.value, at + 2 * WIDTH) * same(entry(waves, entry(rows.wave, j + 2)))
        d = d + load(rows.value, at + 3 * WIDTH) * same(entry(waves, entry(rows.wave, j + 3)))
    if (last - begin) % 4 > 0:  # two are left
        a = a + load(rows.value, WIDTH * last - 2 * WIDTH) * same(entry(waves, entry(rows.wave, last - 2)))
        b = b + load(rows.value, WIDTH * last - WIDTH) * same(entry(waves, entry(rows.wave, last - 1)))
    put(row, place, (a + b) + (c + d))


@jit
def fill_two(rows: RowBlocks, waves: Array, others: Array, row: Array, other: Array) -> None:
    """Fill `row` with sums of `waves`, and `other` with the same sums of `others`; values are read once for both."""
    for block in range(row.size // WIDTH):
        a, b, c, d = same(0.0), same(0.0), same(0.0), same(0.0)
        for j in range(entry(rows.start, block), entry(rows.start, block + 1), 2):  # a block has an even number
            first, wave, value = entry(rows.wave, j), entry(rows.wave, j + 1), load(rows.value, WIDTH * j)
            a, c = a + value * same(entry(waves, first)), c + value * same(entry(others, first))
            value = load(rows.value, WIDTH * j + WIDTH)
            b, d = b + value * same(entry(waves, wave)), d + value * same(entry(others, wave))
        put(row, WIDTH * block, a + b)
        put(other, WIDTH * block, c + d)


@jit_inside
def product(a: Array, b: Array) -> float:
    """Sum of products over whole blocks."""
    part = same(0.0)
    for i in range(0, a.size, WIDTH):
        part = part + load(a, i) * load(b, i)
    result: float = total(part)
    return result


@jit_inside
def product_of_sum(a: Array, b: Array, c: Array) -> float:
    """Sum of a (b + c) over whole blocks."""
    part = same(0.0)
    for i in range(0, a.size, WIDTH):
        part = part + load(a, i) * (load(b, i) + load(c, i))
    result: float = total(part)
    return result


@jit_inside
def weighted(a: Array, c: Array, b: Array) -> float:
    """Sum of a c b over whole blocks."""
    part = same(0.0)
    for i in range(0, a.size, WIDTH):
        part = part + load(a, i) * load(c, i) * load(b, i)
    result: float = total(part)
    return result


@jit_inside
def bound(a: Array, b: Array, c: Array) -> float:
    """Sum of a |b + c| over whole blocks."""
    part, none = same(0.0), same(0.0)
    for i in range(0, a.size, WIDTH):
        both = load(b, i) + load(c, i)
        part = part + load(a, i) * larger(both, none - both)
    result: float = total(part)
    return result


@jit_inside
def move(s: Any, old: Array, new: Array) -> float:
    """Add D to q; returns the work of modal damping, -sum (1 - al) D_n (D_n + D_{n+1})/(2 c)."""
    part = same(0.0)
    for i in range(0, s.q.size, WIDTH):
        step, before = load(new, i), load(old, i)
        part = part + damped(load(s.weight, i), before, step)
        put(s.q, i, load(s.q, i) + step)
    return -total(part)  # type: ignore[no-any-return]
