"""Complementarity between the few contacts of an event, by principal pivoting, in NumPy."""

from __future__ import annotations

import numpy as np

from contact.base.arrays import Array
from contact.base.errors import NumericsError

PIVOTS = 200


def pressing(W: Array, g: Array) -> Array:
    """Forces lam >= 0 with W lam + g >= 0, complementary, by principal pivoting (after some steps by least index).

    >>> pressing(np.array([[2.0, 1.0], [1.0, 2.0]]), np.array([-1.0, 3.0])).tolist()
    [0.5, 0.0]
    """
    closed = g < 0.0
    if not closed.any():
        return np.zeros(g.size)
    for pivot in range(PIVOTS):
        lam = np.zeros(g.size)
        chosen = np.flatnonzero(closed)
        lam[chosen] = np.linalg.solve(W[np.ix_(chosen, chosen)], -g[chosen])
        wrong = np.flatnonzero((lam < 0.0) | (~closed & (W @ lam + g < -1e-14 * np.abs(g).max(initial=0.0))))
        if not wrong.size:
            return lam
        closed[wrong if pivot < 10 else wrong[:1]] ^= True
    raise NumericsError(
        "found no set of closed contacts that satisfies the contact law: contacts press against each other; give them "
        "a compliance"
    )
