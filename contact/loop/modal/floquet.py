"""Compiled turn of a rim in closed contact: every column of a set of states through one period."""

from __future__ import annotations

from contact.base.arrays import Array
from contact.jit.compiled import jit, jit_entry
from contact.loop.modal.rim import RimRows
from contact.loop.modal.rows import fill, rotate


@jit
def drift(q: Array, v: Array, exact: Array) -> None:
    """Free vibration of every mode, exact: q, v (m, columns), `exact` (4, m)."""
    for i in range(q.shape[0]):
        a, b, c, d = exact[0, i], exact[1, i], exact[2, i], exact[3, i]
        for j in range(q.shape[1]):
            x, y = q[i, j], v[i, j]
            q[i, j] = a * x + b * y
            v[i, j] = c * x + d * y


@jit
def kick(q: Array, v: Array, Q: Array, T: Array, pull: float, strength: float, y: Array) -> None:
    """Add to v: -strength (Q - pull T) (Q . q): what the closed contact does in a moment; y (columns,) work space."""
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
    q: Array, v: Array, rows: RimRows, Q: Array, T: Array, y: Array,
    drifts: Array, times: Array, kicks: Array, h: float, steps: int,
) -> None:  # fmt: skip
    """Splitting of order four: drifts (6, 4, m) around kicks at `times` (5,) of a step, weights `kicks` (5,)."""
    for step in range(steps):
        for k in range(times.size):
            drift(q, v, drifts[k])
            rotate(rows.waves, rows.angle - rows.speed * (step + times[k]) * h)
            fill(rows.normal, rows.waves, Q)
            if rows.mu != 0.0:
                fill(rows.tangent, rows.waves, T)
            S = Q[rows.modes + 1] - rows.mu * Q[rows.modes + 2]
            kick(q, v, Q, T, rows.mu, kicks[k] * h / S, y)
        drift(q, v, drifts[times.size])
