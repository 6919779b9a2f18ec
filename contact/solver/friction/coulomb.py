"""The one-step problem of contacts with Coulomb friction: Newton's method, and what helps it where it fails.

    u = W force + b,   0 <= u_N, force_N >= 0, u_N force_N = 0,
    |force_T| <= mu force_N,  force_T = -mu force_N u_T/|u_T| where u_T != 0,

W (d c, d c) the Delassus matrix of c contacts in d = 2 or 3 dimensions, normal component first; u the gap and the
slip of one step. `friction_newton` solves nearly all. Where contacts are coupled so closely that W is conditioned to
1e6 and more, its path may end at a kink: then Lemke's pivoting on polyhedral cones (`polyhedral_cone`), which has no
such trap, gives another start. The facets close in on the direction of slip that the last ones found; where pivoting
ends on a ray or Newton at a kink again, another covering vector takes another path.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from contact.base.arrays import Array
from contact.base.errors import InputError, NumericsError
from contact.jit.compiled import jit
from contact.solver.friction.inexact import LEFT, inexact
from contact.solver.friction.newton import MOST_ITERATIONS, TOLERANCE, newton, otherwise
from contact.solver.friction.polyhedral_cone import GOLDEN, polyhedral_cone
from contact.solver.friction.room import Room, friction_room

DRAWS, ROUNDS = 24, 8  # covering vectors, and closer facets with each
MOST_CONTACTS = 144  # contacts times covering vectors: pivoting grows with the cube
SPREAD, CLOSER = math.pi / 4.0, 0.4  # between facets [rad], and how much closer in the next round
SLIPS = 1e-9  # of the largest motion: less is sticking


class Friction(NamedTuple):
    """`force` and `motion` (contacts, dimensions), normal first; iterations; |F| over the largest force.

    `left`: the largest error of a contact as a motion, over its own free motion.
    """

    force: Array
    motion: Array
    iterations: int
    residual: float
    left: float = 0.0


def coulomb(W: Array, b: Array, mu: Array | float, start: Array | None = None) -> Friction:
    """Forces of contacts with Coulomb friction; see the module's equations.

    Parameters
    ----------
    W : (d c, d c), not necessarily symmetric, positive definite blocks on its diagonal
    b : (c, d), gap and slip of the free step, d = 2 or 3
    mu : (c,) or one number, friction coefficients >= 0
    start : (c, d), forces to start from, such as those of the last step

    Raises
    ------
    InputError
        Shapes that do not fit, mu < 0, values that are not finite, contacts without compliance.
    NumericsError
        No solution to `TOLERANCE` from any start: with friction there need not be one. Or one whose motions are off by
        more than `LEFT` of a contact's free motion, because forces in double precision can do no better.

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
            f"friction: residual {residual:.2e} after {iterations} iterations, wanted {TOLERANCE:.0e}: there may be no "
            "solution; contacts that close each other, directly or by friction, need not have one"
        )
    left = float(room.left[0])
    if not left <= LEFT:
        raise NumericsError(f"friction: {inexact(left)}")
    motion = (W @ force + b.ravel()).reshape(b.shape)
    return Friction(force.reshape(b.shape), motion, iterations, residual, left)


def solver_room(contacts: int, dim: int) -> Room:
    """Room of `friction_forces` for problems of up to this many contacts in `dim` directions."""
    return friction_room(contacts, dim, pivoted)


@jit
def friction_forces(W: Array, b: Array, mu: Array, dim: int, count: int, force: Array, room: Room) -> tuple[int, float]:
    """Improve `force` until it obeys the law to TOLERANCE of the largest force; returns (iterations, residual)."""
    iterations, residual = newton(W, b, mu, dim, count, force, room)
    if residual <= TOLERANCE:
        return iterations, residual
    residual = otherwise(W, b, mu, dim, count, force, room, 0)
    if residual <= TOLERANCE:
        _, residual = newton(W, b, mu, dim, count, force, room)  # which is there at once: notes what is left
    return iterations + MOST_ITERATIONS, residual


def pivoted(W: Array, b: Array, mu: Array, dim: int, force: Array) -> tuple[Array, float]:
    """Forces by pivoting and Newton's method from there, and their residual; `force` where none are better.

    Facets take the problem scaled to unit normal compliance in every contact.
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
    """Turn the facets of each contact that slips against its slip u_T."""
    if dim != 3:
        return turn
    across, along = u[1::3], u[2::3]
    return np.asarray(np.where(np.hypot(across, along) > SLIPS * np.abs(u).max(), np.arctan2(-along, -across), turn))
