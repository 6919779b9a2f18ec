"""Coulomb friction with a faceted cone: a linear complementarity problem, solved by Lemke's pivoting.

With force_T = D beta, D (d - 1, m) unit directions around the ground, beta >= 0, and sigma the slip speed,

    0 <= [W_NN  W_NT D  0; D^T W_TN  D^T W_TT D  1; mu  -1^T  0] (force_N, beta, sigma) + (b_N, D^T b_T, 0)  _|_ >= 0

(Stewart & Trinkle, Int. J. Numer. Meth. Eng. 39, 1996, 2673). Its matrix is copositive, so that Lemke's path from far
away ends at an answer (Cottle, Pang & Stone, The Linear Complementarity Problem, 4.4): a start for Newton's method
where that fails. In two dimensions m = 2 is exact. Every pivot is computed from the original columns, not from the last
tableau: with W conditioned to 1e8 a tableau forgets what it was.
"""

from __future__ import annotations

import math

import numpy as np

from contact.compiled import jit_allocating, jit_entry_allocating
from contact.model.arrays import Array, Indices
from contact.solver.dense import assign

ZERO = 1e-12  # of a column's largest entry: no pivot
TIE = 1e-13  # of the largest value: the covering variable is zero
FACETS = 8
GOLDEN = 0.6180339887498949


@jit_allocating
def directions(dim: int, turn: float, spread: float) -> Array:
    """Unit vectors (m, d - 1) around the ground: in a plane, five of them `spread` apart about the angle `turn`."""
    if dim == 2:
        D = np.ones((2, 1))
        D[1, 0] = -1.0
        return D
    D = np.zeros((FACETS, 2))
    for j in range(5):
        angle = turn + (j - 2) * spread
        D[j, 0], D[j, 1] = math.cos(angle), math.sin(angle)
    for j in range(5, FACETS):
        angle = turn + math.pi + (j - 6) * 1.7
        D[j, 0], D[j, 1] = math.cos(angle), math.sin(angle)
    return D


@jit_entry_allocating
def faceted(
    W: Array, b: Array, mu: Array, dim: int, turn: Array, spread: float, draw: int, force: Array
) -> bool:  # fmt: skip
    """Overwrite `force` by the forces with facets, the first of contact k at turn[k]; False when no pivot is left."""
    k = mu.size
    m = 2 if dim == 2 else FACETS
    n = k * (m + 2)  # normals, facets, slip speeds
    G = np.zeros((b.size, k * (m + 1)))
    for i in range(k):
        G[i * dim, i] = 1.0
        D = directions(dim, turn[i], spread)
        for j in range(m):
            for a in range(dim - 1):
                G[i * dim + 1 + a, k + i * m + j] = D[j, a]
    M, q = np.zeros((n, n)), np.zeros(n)
    inner = k * (m + 1)
    among, short = np.dot(np.ascontiguousarray(G.T), np.dot(W, G)), np.dot(b, G)
    for i in range(inner):
        q[i] = short[i]
        for j in range(inner):
            M[i, j] = among[i, j]
    for i in range(k):
        M[inner + i, i] = mu[i]
        for j in range(k + i * m, k + (i + 1) * m):
            M[j, inner + i], M[inner + i, j] = 1.0, -1.0
    z = np.zeros(n)
    found = lemke(M, q, covering(n, draw), z)
    assign(force, np.dot(G, z[:inner]))
    return found


@jit_entry_allocating
def covering(n: int, draw: int) -> Array:
    """Covering vector of Lemke's method: ones, or entries spread over 1 .. 2; where one path ends, another goes on."""
    d = np.ones(n)
    for i in range(n):
        d[i] += (GOLDEN * (i + 1) * draw) % 1.0
    return d


@jit_entry_allocating
def lemke(M: Array, q: Array, d: Array, z: Array) -> bool:
    """Fill z with 0 <= M z + q _|_ z >= 0; False on a ray or after too many pivots.

    Variables 0 .. n-1 are w, n .. 2n-1 are z, 2n is the covering one, w = M z + q + d z0.
    """
    n = q.size
    row = int(np.argmin(q / d))
    z[:] = 0.0
    if q[row] >= 0.0:
        return True
    basis = np.arange(n)
    entering, leaving = 2 * n, int(basis[row])
    basis[row] = entering
    B, right = np.zeros((n, n)), np.zeros((n, 2))
    for _ in range(50 * n):
        entering = leaving + n if leaving < n else leaving - n
        fill_basis(M, d, basis, B)
        column_of(M, d, entering, right)
        for i in range(n):
            right[i, 0] = q[i]
        solved = np.linalg.solve(B, right)  # B x = q + column t
        value, column = solved[:, 0], solved[:, 1]
        top = np.abs(column).max()
        best, row, cover = math.inf, -1, 0
        for i in range(n):
            cover = i if basis[i] == 2 * n else cover
            if column[i] > ZERO * top and max(value[i], 0.0) < best * column[i]:
                best, row = max(value[i], 0.0) / column[i], i
        if row < 0:
            return False
        if column[cover] > ZERO * top and value[cover] - best * column[cover] <= TIE * np.abs(value).max():
            row = cover  # the others may reach zero with it
        leaving = int(basis[row])
        basis[row] = entering
        if leaving == 2 * n:
            fill_basis(M, d, basis, B)
            for i in range(n):
                right[i, 0], right[i, 1] = q[i], q[i]
            value = np.linalg.solve(B, right)[:, 0]
            for i in range(n):
                if basis[i] >= n:
                    z[basis[i] - n] = max(value[i], 0.0)
            return True
    return False


@jit_allocating
def column_of(M: Array, d: Array, variable: int, right: Array) -> None:
    """Column of w - M z - d z0 in right[:, 1]."""
    n = M.shape[0]
    for i in range(n):
        if variable == 2 * n:
            right[i, 1] = -d[i]
        elif variable >= n:
            right[i, 1] = -M[i, variable - n]
        else:
            right[i, 1] = 1.0 if i == variable else 0.0


@jit_allocating
def fill_basis(M: Array, d: Array, basis: Indices, B: Array) -> None:
    """Columns of the basic variables."""
    n = M.shape[0]
    for j in range(n):
        variable = basis[j]
        for i in range(n):
            if variable == 2 * n:
                B[i, j] = -d[i]
            elif variable >= n:
                B[i, j] = -M[i, variable - n]
            else:
                B[i, j] = 1.0 if i == variable else 0.0
