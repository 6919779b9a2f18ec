"""A start for the friction problem where every contact slides: directions of slip held, normal forces solved for.

With force_T = -mu force_N d, d = u_T/|u_T| as it was, what remains is complementarity of the normals,
0 <= (W_NN - W_NT mu d) force_N + b_N, in a third of the unknowns; then d follows and it is solved again. Where a rim
turns fast, d hardly moves and two or three rounds end at round-off; where something sticks, the start is left alone.
"""

from __future__ import annotations

import math

import numpy as np

from contact.compiled import jit_allocating, jit_entry_allocating
from contact.model.arrays import Array, Indices

ROUNDS = 5
STILL = 1e-13  # change of direction at which the rounds end
MOST_CHANGES = 20  # of the set of closed contacts


@jit_entry_allocating
def glide(W: Array, b: Array, mu: Array, dim: int, force: Array) -> None:
    """Improve `force` for contacts that all slide; leaves it as it was where one does not, or no set settles."""
    count = mu.size
    trial, x, gap = force.copy(), np.zeros(count), b[::dim].copy()
    A, d = np.zeros((count, count)), np.zeros((count, dim - 1))
    closed = np.zeros(count, dtype=np.int64)
    for k in range(count):
        closed[k] = 1 if force[k * dim] > 0.0 or gap[k] < 0.0 else 0
    for turn in range(ROUNDS):
        moved = follow(np.dot(W, trial) + b, dim, d, turn == 0)
        if moved > 1.0:
            return
        if moved <= STILL:
            break
        for i in range(count):
            for k in range(count):
                A[i, k] = W[i * dim, k * dim]
                for j in range(dim - 1):
                    A[i, k] -= W[i * dim, k * dim + 1 + j] * mu[k] * d[k, j]
        if not press(A, gap, closed, x):
            return
        for k in range(count):
            trial[k * dim] = x[k]
            for j in range(dim - 1):
                trial[k * dim + 1 + j] = -mu[k] * x[k] * d[k, j]
    force[:] = trial


@jit_allocating
def follow(u: Array, dim: int, d: Array, first: bool) -> float:
    """Directions of slip into `d`; returns how far the worst turned, 2 where one stands still or turns round."""
    worst = 1.0 if first else 0.0
    for k in range(d.shape[0]):
        length, along, change = 0.0, 0.0, 0.0
        for j in range(dim - 1):
            length += u[k * dim + 1 + j] ** 2
        if not length > 0.0:
            return 2.0
        length = math.sqrt(length)
        for j in range(dim - 1):
            new = u[k * dim + 1 + j] / length
            along += new * d[k, j]
            change = max(change, abs(new - d[k, j]))
            d[k, j] = new
        if not first:
            if along <= 0.0:
                return 2.0
            worst = max(worst, change)
    return min(worst, 1.0)


@jit_allocating
def press(A: Array, gap: Array, closed: Indices, x: Array) -> bool:
    """0 <= x, 0 <= A x + gap, complementary, by exchanging whole sets; False where no set settles."""
    for _ in range(MOST_CHANGES):
        at = np.flatnonzero(closed)
        x[:] = 0.0
        if at.size > 0:
            part, short = np.zeros((at.size, at.size)), np.zeros(at.size)
            for i in range(at.size):
                short[i] = -gap[at[i]]
                for k in range(at.size):
                    part[i, k] = A[at[i], at[k]]
            found = np.linalg.solve(part, short)
            for i in range(at.size):
                x[at[i]] = found[i]
        left, same = np.dot(A, x) + gap, True
        for k in range(closed.size):
            now = (1 if x[k] > 0.0 else 0) if closed[k] == 1 else (1 if left[k] < 0.0 else 0)
            same = same and now == closed[k]
            closed[k] = now
        if same:
            return True
    return False
