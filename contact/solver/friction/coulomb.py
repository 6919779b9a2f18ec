"""The one-step problem of contacts with Coulomb friction: Newton's method, and fallbacks if it fails.

    u = W force + b,   0 <= u_N, force_N >= 0, u_N force_N = 0,
    |force_T| <= mu force_N,  force_T = -mu force_N u_T/|u_T| where u_T != 0,

W (d c, d c) the Delassus matrix of c contacts in d = 2 or 3 dimensions, normal component first; u the gap and the slip
of one step. `friction_newton` solves nearly all. If contacts are so strongly coupled that the condition of W exceeds
1e6, Newton's path may end at a kink. Then Lemke's pivoting on polyhedral cones (`polyhedral_cone`), which cannot stop
there, gives another starting point. The facets are refined about the slip direction found last. If pivoting ends on a
ray, or Newton at a kink again, another covering vector leads to another path.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from contact.base.arrays import Array
from contact.base.errors import InputError, NumericsError
from contact.io.trust import LEFT
from contact.jit.compiled import jit_apart
from contact.solver.friction.inexact import inexact
from contact.solver.friction.newton import MOST_ITERATIONS, TOLERANCE, newton, otherwise
from contact.solver.friction.room import Room, friction_room

ZERO = 1e-12  # of a column's largest entry: no pivot
TIE = 1e-13  # of the largest value: the covering variable is zero
FACETS = 8
FRESH = 16  # pivots after which the inverse of the basis is computed anew
GOLDEN = 0.6180339887498949
DRAWS, ROUNDS = 24, 8  # covering vectors, and closer facets with each
MOST_CONTACTS = 144  # contacts times covering vectors: pivoting grows with the cube
SPREAD, CLOSER = math.pi / 4.0, 0.4  # angle between facets [rad], and its reduction in the next round
SLIPS = 1e-9  # of the largest motion: less is sticking


def directions(dim: int, turn: float, spread: float) -> Array:
    """Unit tangential vectors (m, d - 1); in a plane, five of them `spread` apart about the angle `turn`."""
    if dim == 2:
        return np.array([[1.0], [-1.0]])
    near = turn + (np.arange(5) - 2) * spread
    far = turn + math.pi + (np.arange(5, FACETS) - 6) * 1.7
    angle = np.concatenate([near, far])
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)


def polyhedral_cone(W: Array, b: Array, mu: Array, dim: int, turn: Array, spread: float, draw: int) -> Array | None:
    """Forces with polyhedral cones, the first facet of contact k at turn[k], by Lemke's pivoting.

    None if no pivot remains.

    With force_T = D beta, D (d - 1, m) unit directions in the tangential plane, beta >= 0, and sigma the slip speed,

        0 <= [W_NN  W_NT D  0; D^T W_TN  D^T W_TT D  1; mu  -1^T  0] z + (b_N, D^T b_T, 0)  _|_ z >= 0,
        z = (force_N, beta, sigma)

    (Stewart & Trinkle, Int. J. Numer. Meth. Eng. 39, 1996, 2673). Its matrix is copositive, so that Lemke's path ends
    at a solution (Cottle, Pang & Stone, The Linear Complementarity Problem, 4.4): a starting point for Newton's method
    if that fails. In two dimensions m = 2 is exact. Every pivot is computed from the original columns, not from the
    last tableau: with a condition of 1e8, a tableau loses all digits.
    """
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
    """Covering vector of Lemke's method: ones, or entries spread over 1 .. 2.

    If one path fails, another vector is used.
    """
    spread: Array = 1.0 + (GOLDEN * np.arange(1.0, n + 1.0) * draw) % 1.0
    return spread


def lemke(M: Array, q: Array, d: Array) -> Array | None:
    """Find z with 0 <= M z + q _|_ z >= 0; None on a ray or after too many pivots.

    Variables 0 .. n-1 are w, n .. 2n-1 are z, 2n is the covering variable, w = M z + q + d z0.
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
            row = cover  # others may reach zero at the same time
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
    """Inverse of a basis after a variable enters at `row`; `column` is `inverse` times its column."""
    entered = inverse[row] / column[row]
    found = inverse - np.outer(column, entered)
    found[row] = entered
    return found


class Friction(NamedTuple):
    """Forces and motions of each contact (contacts, dimensions), normal first, with iterations and residual.

    `residual`: |F| of Newton's method, over the largest force. `left`: the largest error of a contact's motion, over
    its own free motion.

    >>> found = coulomb(np.eye(2), np.array([[-1.0, -2.0]]), 0.5)  # pressed by 1, it slips at the limit of 0.5
    >>> found.force.tolist(), found.motion.tolist()
    ([[1.0, 0.5]], [[0.0, -1.5]])
    """

    force: Array
    motion: Array
    iterations: int
    residual: float
    left: float = 0.0


def coulomb(W: Array, b: Array, mu: Array | float, start: Array | None = None) -> Friction:
    """Forces of contacts with Coulomb friction in one step.

    With u = W force + b: u_N >= 0, force_N >= 0, u_N force_N = 0; |force_T| <= mu force_N, and force_T = -mu force_N
    u_T/|u_T| where a contact slips. Newton's method; if it ends at a kink, Lemke's pivoting on polyhedral cones
    (Stewart & Trinkle, Int. J. Numer. Meth. Eng. 39, 1996, 2673) gives another start.

    Parameters
    ----------
    W
        Delassus matrix: motion of the contacts in the step by unit forces, (d c, d c) for c contacts with d = 2 or 3
        directions, the normal first. It need not be symmetric; the blocks on its diagonal are positive definite.
    b
        Gap and slip of the free step, without these forces [m], (c, d).
    mu
        Friction coefficients >= 0, (c,) or one for all.
    start
        Forces to start from, such as those of the last step, (c, d).

    Returns
    -------
    Friction
        `force` [N] and `motion` u [m], (c, d) each.

    Raises
    ------
    InputError
        Shapes that do not fit, mu < 0, values that are not finite, contacts without compliance.
    NumericsError
        No solution to `TOLERANCE` is found; with friction none need exist. Or the motion of a contact has an error
        above `LEFT` of its free motion, because double precision of the forces allows no better.

    Examples
    --------
    A block pushed down with 1 and sideways with 2 slips under mu = 1 and sticks under mu = 3:

    >>> b = np.array([[-1.0, -2.0]])
    >>> coulomb(np.eye(2), b, 1.0).motion.tolist(), coulomb(np.eye(2), b, 3.0).motion.tolist()
    ([[0.0, -1.0]], [[0.0, 0.0]])
    """
    W, b = np.ascontiguousarray(W, dtype=float), np.ascontiguousarray(b, dtype=float)
    if b.ndim != 2 or b.shape[1] not in (2, 3) or W.shape != (b.size, b.size):
        raise InputError(f"W, b: found shapes {W.shape} and {b.shape}, expected (d c, d c) and (c, d), d = 2 or 3")
    friction = np.broadcast_to(np.asarray(mu, dtype=float), b.shape[:1]).copy()
    if not (np.isfinite(W).all() and np.isfinite(b).all() and np.isfinite(friction).all()):
        raise InputError("W, b, mu: found values that are not finite, expected numbers")
    if friction.min(initial=0.0) < 0.0:
        raise InputError(f"mu: found {friction.min():g}, expected coefficients >= 0")
    if W.diagonal().min(initial=1.0) <= 0.0:
        raise InputError(f"W: found a diagonal entry {W.diagonal().min():g}, expected compliances > 0")
    force = np.zeros(b.size) if start is None else np.array(start, dtype=float).ravel()
    room = solver_room(len(b), b.shape[1])
    iterations, residual = friction_forces(W, b.ravel(), friction, b.shape[1], len(b), force, room)
    if not residual <= TOLERANCE:
        raise NumericsError(
            f"friction: found residual {residual:.2e} after {iterations} iterations, expected at most {TOLERANCE:.0e}: "
            "contacts that close each other, directly or by friction, may have no solution"
        )
    left = float(room.left[0])
    if not left <= LEFT:
        raise NumericsError(f"friction: {inexact(left)[0]}")
    motion = (W @ force + b.ravel()).reshape(b.shape)
    return Friction(force.reshape(b.shape), motion, iterations, residual, left)


def solver_room(contacts: int, dim: int) -> Room:
    """Work arrays of `friction_forces` for problems of up to this many contacts with `dim` directions."""
    return friction_room(contacts, dim, pivoted)


@jit_apart
def friction_forces(W: Array, b: Array, mu: Array, dim: int, count: int, force: Array, room: Room) -> tuple[int, float]:
    """Improve `force` until it satisfies the law to TOLERANCE of the largest force; returns (iterations, residual)."""
    iterations, residual = newton(W, b, mu, dim, count, force, room)
    if residual <= TOLERANCE:
        return iterations, residual
    residual = otherwise(W, b, mu, dim, count, force, room, 0)
    if residual <= TOLERANCE:
        _, residual = newton(W, b, mu, dim, count, force, room)  # already solved: only the remaining error is computed
    return iterations + MOST_ITERATIONS, residual


def pivoted(W: Array, b: Array, mu: Array, dim: int, force: Array) -> tuple[Array, float]:
    """Forces by pivoting, then Newton's method, and their residual; `force` unchanged if that is not better.

    Facets refer to the problem scaled to unit normal compliance in every contact.
    """
    k, space = mu.size, friction_room(mu.size, dim)
    if not np.isfinite(b).all():
        return force, math.nan
    unit = np.repeat(1.0 / np.sqrt(W.diagonal()[::dim]), dim)
    scaled, short = W * unit * unit[:, None], b * unit
    residual = math.inf
    for draw in range(min(DRAWS, max(1, MOST_CONTACTS // k))):
        turn: Array = 2.0 * math.pi * GOLDEN * draw * np.arange(1.0, k + 1.0)
        for closer in range(ROUNDS if dim == 3 else 1):
            near = polyhedral_cone(scaled, short, mu, dim, turn, SPREAD * CLOSER**closer, draw)
            if near is None:
                break
            trial = near.copy()
            newton(scaled, short, mu, dim, k, trial, space)
            trial *= unit
            space.left[0] = 0.0
            _, found = newton(W, b, mu, dim, k, trial, space)
            if found < residual:
                force, residual = trial, found
            if residual <= TOLERANCE:
                return force, residual
            turn = against_slip(scaled @ near + short, dim, turn)
    return force, residual


def against_slip(u: Array, dim: int, turn: Array) -> Array:
    """Rotate the facets of each sliding contact against its slip u_T."""
    if dim != 3:
        return turn
    across, along = u[1::3], u[2::3]
    return np.asarray(np.where(np.hypot(across, along) > SLIPS * np.abs(u).max(), np.arctan2(-along, -across), turn))
