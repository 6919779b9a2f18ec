"""Lemke's pivoting for w = M z + q, w, z >= 0, w . z = 0: a reference that shares nothing with the solvers."""

import numpy as np


def lemke(M, q):
    """Return z; ValueError on a secondary ray (Cottle, Pang & Stone, The Linear Complementarity Problem, 4.4)."""
    n = len(q)
    if np.all(q >= 0.0):
        return np.zeros(n)
    table = np.hstack([np.eye(n), -M, -np.ones((n, 1)), q[:, None]])
    basis = list(range(n))
    row, entering = int(np.argmin(q)), 2 * n
    for _ in range(200 * n):
        table[row] /= table[row, entering]
        others = np.arange(n) != row
        table[others] -= np.outer(table[others, entering], table[row])
        leaving, basis[row] = basis[row], entering
        if leaving == 2 * n:
            z = np.zeros(2 * n + 1)
            z[basis] = table[:, -1]
            return z[n : 2 * n]
        entering = leaving + n if leaving < n else leaving - n
        column = table[:, entering]
        rows = np.flatnonzero(column > 1e-12)
        if not len(rows):
            raise ValueError("secondary ray")
        ratios = table[rows, -1] / column[rows]
        least = rows[ratios <= ratios.min() + 1e-12]
        z0 = [r for r in least if basis[r] == 2 * n]
        row = int(z0[0] if z0 else least[0])
    raise ValueError("too many pivots")
