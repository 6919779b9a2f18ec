"""Coulomb friction with a polyhedral_cone cone: a linear complementarity problem, solved by Lemke's pivoting.

With force_T = D beta, D (d - 1, m) unit directions around the ground, beta >= 0, and sigma the slip speed,

    0 <= [W_NN  W_NT D  0; D^T W_TN  D^T W_TT D  1; mu  -1^T  0] (force_N, beta, sigma) + (b_N, D^T b_T, 0)  _|_ >= 0

(Stewart & Trinkle, Int. J. Numer. Meth. Eng. 39, 1996, 2673). Its matrix is copositive, so that Lemke's path from far
away ends at an answer (Cottle, Pang & Stone, The Linear Complementarity Problem, 4.4): a start for Newton's method
where that fails. In two dimensions m = 2 is exact. Every pivot is computed from the original columns, not from the last
tableau: with W conditioned to 1e8 a tableau forgets what it was.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from contact.base.arrays import Array

ZERO = 1e-12  # of a column's largest entry: no pivot
TIE = 1e-13  # of the largest value: the covering variable is zero
FACETS = 8
FRESH = 16  # pivots after which the inverse of the basis is computed anew
GOLDEN = 0.6180339887498949


def directions(dim: int, turn: float, spread: float) -> Array:
    """Unit vectors (m, d - 1) around the ground: in a plane, five of them `spread` apart about the angle `turn`."""
    if dim == 2:
        return np.array([[1.0], [-1.0]])
    near = turn + (np.arange(5) - 2) * spread
    far = turn + math.pi + (np.arange(5, FACETS) - 6) * 1.7
    angle = np.concatenate([near, far])
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)


def polyhedral_cone(W: Array, b: Array, mu: Array, dim: int, turn: Array, spread: float, draw: int) -> Array | None:
    """Forces with facets, the first of contact k at turn[k]; None when no pivot is left."""
    k = mu.size
    D = [directions(dim, float(angle), spread) for angle in turn]
    m = len(D[0])
    inner = k * (m + 1)  # normals, facets; then slip speeds
    G, among = np.zeros((b.size, inner)), np.zeros((k, inner))
    for i in range(k):
        own = slice(k + i * m, k + (i + 1) * m)
        G[i * dim, i] = 1.0
        G[i * dim + 1 : (i + 1) * dim, own] = D[i].T
        among[i, own] = 1.0
    friction = np.zeros((k, inner))
    friction[:, :k] = np.diag(mu)
    M = np.block([[G.T @ W @ G, among.T], [friction - among, np.zeros((k, k))]])
    q = np.concatenate([b @ G, np.zeros(k)])
    z = lemke(M, q, covering(q.size, draw))
    if z is None:
        return None
    force: Array = np.dot(G, z[:inner])
    return force


def covering(n: int, draw: int) -> Array:
    """Covering vector of Lemke's method: ones, or entries spread over 1 .. 2; where one path ends, another goes on."""
    spread: Array = 1.0 + (GOLDEN * np.arange(1.0, n + 1.0) * draw) % 1.0
    return spread


def lemke(M: Array, q: Array, d: Array) -> Array | None:
    """Return z with 0 <= M z + q _|_ z >= 0; None on a ray or after too many pivots.

    Variables 0 .. n-1 are w, n .. 2n-1 are z, 2n is the covering one, w = M z + q + d z0.
    """
    n = q.size
    row = int(np.argmin(q / d))
    if q[row] >= 0.0:
        return np.zeros(n)
    columns = np.hstack([np.eye(n), -M, -d[:, None]])  # of w - M z - d z0
    basis = np.arange(n)
    leaving, basis[row] = row, 2 * n
    inverse: Any = exchanged(np.eye(n), columns[:, 2 * n], row)  # of the basis
    for pivot in range(50 * n):
        entering = leaving + n if leaving < n else leaving - n
        value, column = inverse @ q, inverse @ columns[:, entering]
        falls = column > ZERO * np.abs(column).max()
        if not falls.any():
            return None
        reach = np.full(n, math.inf)
        reach[falls] = np.maximum(value[falls], 0.0) / column[falls]
        row, cover = int(np.argmin(reach)), int(np.flatnonzero(basis == 2 * n)[0])
        if falls[cover] and value[cover] - reach[row] * column[cover] <= TIE * np.abs(value).max():
            row = cover  # the others may reach zero with it
        leaving, basis[row] = int(basis[row]), entering
        try:
            if leaving == 2 * n:
                value, z = np.linalg.solve(columns[:, basis], q), np.zeros(2 * n)
                z[basis] = np.maximum(value, 0.0)
                return z[n:]
            inverse = exchanged(inverse, column, row) if pivot % FRESH else np.linalg.inv(columns[:, basis])
        except np.linalg.LinAlgError:
            return None
    return None


def exchanged(inverse: Array, column: Array, row: int) -> Array:
    """Inverse of a basis whose entry `row` is exchanged for a variable; `column` what `inverse` makes of that."""
    entered = inverse[row] / column[row]
    found = inverse - np.outer(column, entered)
    found[row] = entered
    return found
