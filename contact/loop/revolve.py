"""Compiled motion of a rim in closed contact over a turn: exact free motion between impulses of the contact."""

from __future__ import annotations

from typing import NamedTuple

from contact.base.arrays import Array, Indices
from contact.jit.compiled import jit, jit_entry
from contact.loop.modal.rows import RowBlocks, fill_some, rotate


class TurnRows(NamedTuple):
    """Action of the closed contact on the coordinates (q, v): rows as sums of waves, its angle, and work arrays.

    `gap`: contribution of each of the 2 m coordinates to the gap, then the compliance S_nn - mu S_nt. `push`: rate of
    each coordinate under a unit contact force.
    """

    gap: RowBlocks
    push: RowBlocks
    angle: float
    speed: float
    waves: Array  # (2, harmonics)


class Drifts(NamedTuple):
    """Free motion over each part of a step, by blocks of coordinates that are not coupled.

    Block b has the pairs `mode[start[b]:start[b + 1]]` of (q, v), s of them, and its matrices (2 s, 2 s) begin at
    `first[b]` of each row of `value` (parts, entries); `work` (2 s, columns) has room for the largest.
    """

    start: Indices
    mode: Indices
    first: Indices
    value: Array
    work: Array


@jit
def drift(q: Array, v: Array, parts: Drifts, part: int) -> None:
    """Free motion of every block: q, v (m, columns)."""
    for b in range(parts.first.size):
        begin, size = parts.start[b], parts.start[b + 1] - parts.start[b]
        if size == 1:
            mode, at = parts.mode[begin], parts.first[b]
            qq, qv, vq, vv = (
                parts.value[part, at], parts.value[part, at + 1], parts.value[part, at + 2], parts.value[part, at + 3],
            )  # fmt: skip
            for j in range(q.shape[1]):
                x, y = q[mode, j], v[mode, j]
                q[mode, j], v[mode, j] = qq * x + qv * y, vq * x + vv * y
            continue
        for i in range(size):
            mode = parts.mode[begin + i]
            for j in range(q.shape[1]):
                parts.work[i, j], parts.work[size + i, j] = q[mode, j], v[mode, j]
                q[mode, j], v[mode, j] = 0.0, 0.0
        at = parts.first[b]
        for i in range(size):
            mode = parts.mode[begin + i]
            for k in range(2 * size):
                a, c = parts.value[part, at + 2 * size * i + k], parts.value[part, at + 2 * size * (size + i) + k]
                for j in range(q.shape[1]):
                    q[mode, j] += a * parts.work[k, j]
                    v[mode, j] += c * parts.work[k, j]


@jit
def kick(q: Array, v: Array, gap: Array, push: Array, strength: float, y: Array) -> None:
    """Apply the contact over a part of a step: add -strength push (gap . (q, v)); y (columns,) is a work array."""
    y[:] = 0.0
    m = q.shape[0]
    for i in range(m):
        for j in range(y.size):
            y[j] += gap[i] * q[i, j] + gap[m + i] * v[i, j]
    for i in range(m):
        along, across = strength * push[i], strength * push[m + i]
        for j in range(y.size):
            q[i, j] -= along * y[j]
            v[i, j] -= across * y[j]


@jit_entry
def revolve(
    q: Array, v: Array, rows: TurnRows, gap: Array, push: Array, y: Array,
    drifts: Drifts, times: Array, kicks: Array, h: float, steps: int,
) -> None:  # fmt: skip
    """Splitting of order four.

    Six free motions around contact impulses at `times` (5,) of a step, weights `kicks` (5,).
    """
    for step in range(steps):
        for k in range(times.size):
            drift(q, v, drifts, k)
            rotate(rows.waves, rows.angle - rows.speed * (step + times[k]) * h)
            fill_some(rows.gap, rows.waves, 0, gap)
            fill_some(rows.push, rows.waves, 0, push)
            kick(q, v, gap, push, kicks[k] * h / gap[y.size], y)
        drift(q, v, drifts, times.size)
