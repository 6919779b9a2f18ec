"""Compiled turn of a rim in closed contact: exact free motion of the bodies between kicks of the contact."""

from __future__ import annotations

from typing import NamedTuple

from contact.base.arrays import Array, Indices
from contact.jit.compiled import jit, jit_entry
from contact.loop.modal.rows import RowBlocks, fill_some, rotate


class TurnRows(NamedTuple):
    """Rows of the modes of a rim with the compliance at the contact, where it stands, and work space."""

    normal: RowBlocks  # rows of the modes, then clearance, S_nn, S_nt, S_tt
    tangent: RowBlocks
    modes: int
    angle: float
    speed: float
    mu: float
    waves: Array  # (2, harmonics)


class Drifts(NamedTuple):
    """Free motion over each part of a step: blocks of modes that move alone.

    Block b has the modes `mode[start[b]:start[b + 1]]`, s of them, and its matrices (2 s, 2 s) of (q, q') begin at
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
def kick(q: Array, v: Array, Q: Array, T: Array, pull: float, strength: float, y: Array) -> None:
    """Add to v: -strength (Q - pull T) (Q . q), the acceleration by the closed contact; y (columns,) work space."""
    y[:] = 0.0
    for i in range(q.shape[0]):
        for j in range(y.size):
            y[j] += Q[i] * q[i, j]
    for i in range(q.shape[0]):
        push = strength * (Q[i] - pull * T[i])
        for j in range(y.size):
            v[i, j] -= push * y[j]


@jit_entry
def revolve(
    q: Array, v: Array, rows: TurnRows, Q: Array, T: Array, y: Array,
    drifts: Drifts, times: Array, kicks: Array, h: float, steps: int,
) -> None:  # fmt: skip
    """Splitting of order four: six free motions around kicks at `times` (5,) of a step, weights `kicks` (5,)."""
    for step in range(steps):
        for k in range(times.size):
            drift(q, v, drifts, k)
            rotate(rows.waves, rows.angle - rows.speed * (step + times[k]) * h)
            fill_some(rows.normal, rows.waves, 0, Q)
            if rows.mu != 0.0:
                fill_some(rows.tangent, rows.waves, 0, T)
            S = Q[rows.modes + 1] - rows.mu * Q[rows.modes + 2]
            kick(q, v, Q, T, rows.mu, kicks[k] * h / S, y)
        drift(q, v, drifts, times.size)
