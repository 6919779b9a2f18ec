"""Compiled rows and polynomials of the contact angle, eight modes or harmonics at a time."""

from __future__ import annotations

import math
from typing import NamedTuple

from contact.compiled import jit_inside
from contact.model.arrays import Array, Indices
from contact.vector import WIDTH, load, put, same, total


class Series(NamedTuple):
    """A trigonometric polynomial of the contact angle, coefficients by harmonic, as many as `waves` has."""

    cos: Array
    sin: Array


class RowBlocks(NamedTuple):
    """Rows of all modes, eight modes a block: the harmonics of a block stand from `start[block]` to the next start.

    Only harmonics that some mode of the block has are there: few for a nearly perfect casing, all for another.
    """

    start: Indices
    harmonic: Indices
    cos: Array  # (entries, 8)
    sin: Array


@jit_inside
def rotate(waves: Array, phi: float) -> None:
    """Cos n phi and sin n phi from one sine and cosine by the addition theorem: no drift over steps."""
    count = waves.shape[1]
    c, s = math.cos(phi), math.sin(phi)
    waves[0, 0], waves[1, 0] = 1.0, 0.0
    have = 1
    while have < WIDTH:  # n = have .. 2 have - 1 from n = 0 .. have - 1
        for n in range(have):
            a, b = waves[0, n], waves[1, n]
            waves[0, have + n], waves[1, have + n] = c * a - s * b, s * a + c * b
        have *= 2
        c, s = c * c - s * s, 2.0 * c * s
    a8, b8, c8, s8 = load(waves, 0), load(waves, count), same(c), same(s)
    for n in range(WIDTH, count, WIDTH):
        a8, b8 = c8 * a8 - s8 * b8, s8 * a8 + c8 * b8
        put(waves, n, a8)
        put(waves, count + n, b8)


@jit_inside
def value(series: Series, waves: Array) -> float:
    """Value at the angle of `waves`."""
    count = waves.shape[1]
    part = same(0.0)
    for n in range(0, count, WIDTH):
        part = part + load(series.cos, n) * load(waves, n) + load(series.sin, n) * load(waves, count + n)
    result: float = total(part)
    return result


@jit_inside
def block(rows: RowBlocks, waves: Array, k: int) -> float:
    """Rows of the eight modes of block k at the angle of `waves`: a vector."""
    cos_part, sin_part = same(0.0), same(0.0)
    for j in range(rows.start[k], rows.start[k + 1]):
        n = rows.harmonic[j]
        cos_part = cos_part + load(rows.cos, WIDTH * j) * same(waves[0, n])
        sin_part = sin_part + load(rows.sin, WIDTH * j) * same(waves[1, n])
    result: float = cos_part + sin_part
    return result


@jit_inside
def fill(rows: RowBlocks, waves: Array, row: Array) -> None:
    """Rows of all modes at the angle of `waves`."""
    whole = row.size // WIDTH
    for k in range(whole):
        put(row, WIDTH * k, block(rows, waves, k))
    if whole * WIDTH < row.size:
        for i in range(whole * WIDTH, row.size):
            row[i] = 0.0
        for j in range(rows.start[whole], rows.start[whole + 1]):
            c, s = waves[0, rows.harmonic[j]], waves[1, rows.harmonic[j]]
            for i in range(whole * WIDTH, row.size):
                row[i] += c * rows.cos[j, i - whole * WIDTH] + s * rows.sin[j, i - whole * WIDTH]


@jit_inside
def product(a: Array, b: Array) -> float:
    """Sum of products."""
    whole = a.size - a.size % WIDTH
    part = same(0.0)
    for i in range(0, whole, WIDTH):
        part = part + load(a, i) * load(b, i)
    result: float = total(part)
    for i in range(whole, a.size):
        result += a[i] * b[i]
    return result


@jit_inside
def weighted(a: Array, c: Array, b: Array) -> float:
    """Sum of a c b."""
    whole = a.size - a.size % WIDTH
    part = same(0.0)
    for i in range(0, whole, WIDTH):
        part = part + load(a, i) * load(c, i) * load(b, i)
    result: float = total(part)
    for i in range(whole, a.size):
        result += a[i] * c[i] * b[i]
    return result
