"""Gauss-Seidel sweeps over contacts with Coulomb friction: a start for Newton's method where its own path ends."""

from __future__ import annotations

import math

from contact.base.arrays import Array
from contact.jit.compiled import jit, jit_entry
from contact.solver.dense import dot

ROUGHLY = 1e-3  # how closely each contact is solved: a start is wanted


@jit_entry
def sweep(W: Array, b: Array, mu: Array, dim: int, count: int, force: Array, sweeps: int) -> None:
    """Nonlinear Gauss-Seidel sweeps: each contact solved with the others' forces held."""
    size = count * dim
    for visit in range(sweeps * count):
        k = visit % count
        i = k * dim
        q0, q1, q2 = without(W, b, i, i, dim, force, size), 0.0, 0.0
        if dim > 1:
            q1 = without(W, b, i + 1, i, dim, force, size)
        if dim > 2:
            q2 = without(W, b, i + 2, i, dim, force, size)
        one_contact(W, i, dim, q0, q1, q2, mu[k], force)


@jit
def without(W: Array, b: Array, row: int, i: int, dim: int, force: Array, size: int) -> float:
    """Motion of one direction without the contact's own force, which begins at i."""
    q = b[row] + dot(W[row], force, size)
    for m in range(i, i + dim):
        q -= W[row, m] * force[m]
    return float(q)


@jit
def one_contact(W: Array, i: int, dim: int, q0: float, q1: float, q2: float, mu: float, force: Array) -> None:
    """Force of one contact with free gap and slip q0, q1, q2: open, sticking, or slipping (to `ROUGHLY`).

    Slipping, force_T = -(W_TT + alpha)^-1 (q_T + W_TN force_N) with alpha >= 0 the ratio of slip to tangential force:
    force_N follows, and |force_T| - mu force_N changes sign between alpha = 0 (too much) and infinity (too little).
    """
    if q0 >= 0.0:
        for j in range(i, i + dim):
            force[j] = 0.0
        return
    if dim == 1:
        force[i] = -q0 / W[i, i]
        return
    low, high = 0.0, 1.0
    if slip_excess(W, i, dim, q0, q1, q2, mu, 0.0, force) <= 0.0:
        return
    base = W[i + 1, i + 1] + W[i + dim - 1, i + dim - 1]
    while slip_excess(W, i, dim, q0, q1, q2, mu, high * base, force) > 0.0 and high < 1e18:
        low, high = high, 16.0 * high
    if low == 0.0:
        low = high
        while slip_excess(W, i, dim, q0, q1, q2, mu, low * base, force) < 0.0 and low > 1e-18:
            high, low = low, low / 16.0
    for _ in range(60):
        middle = math.sqrt(low * high)
        if slip_excess(W, i, dim, q0, q1, q2, mu, middle * base, force) > 0.0:
            low = middle
        else:
            high = middle
        if high - low <= ROUGHLY * high:
            break


@jit
def slip_excess(W: Array, i: int, dim: int, q0: float, q1: float, q2: float, mu: float, alpha: float,
                force: Array) -> float:  # fmt: skip
    """Set the force of a contact that slips by alpha times its tangential force; returns |force_T| - mu force_N."""
    a, c, m = W[i + 1, i + 1] + alpha, 1.0, 0.0
    w2, v2, mt = 0.0, 0.0, 0.0
    if dim == 3:
        c, m, mt = W[i + 2, i + 2] + alpha, W[i + 1, i + 2], W[i + 2, i + 1]
        w2, v2 = W[i + 2, i], W[i, i + 2]
    w1, v1 = W[i + 1, i], W[i, i + 1]
    det = a * c - m * mt
    f1, f2 = (c * q1 - m * q2) / det, (a * q2 - mt * q1) / det  # (W_TT + alpha)^-1 q_T
    g1, g2 = (c * w1 - m * w2) / det, (a * w2 - mt * w1) / det
    normal = (-q0 + v1 * f1 + v2 * f2) / (W[i, i] - v1 * g1 - v2 * g2)
    t1, t2 = -f1 - g1 * normal, -f2 - g2 * normal
    force[i], force[i + 1] = normal, t1
    if dim == 3:
        force[i + 2] = t2
    return float(math.hypot(t1, t2) - mu * normal)
