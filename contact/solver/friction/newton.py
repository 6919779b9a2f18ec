"""Semi-smooth Newton for contacts with Coulomb friction, on the projections of the law.

With W, b and u as in `solver.coulomb`, the law is equivalent to F = 0 (Alart & Curnier, Comput. Methods Appl. Mech.
Eng. 92, 1991, 353)

    F_N = force_N - s_N^+,  s_N = force_N - rho_N u_N,
    F_T = force_T - s_T min(1, mu s_N^+/|s_T|),  s_T = force_T - rho_T u_T.

Newton's matrix is slightly regularised, so that redundant contacts (singular W) also have a solution. A step that does
not reduce |F| is halved; if that fails, projected Gauss-Seidel sweeps find a better starting point.

An F that is small compared with the largest force can still mean a motion as large as a contact's free motion. This
happens if compliances differ by powers of ten, or if contacts are so strongly coupled that forces nearly cancel. Steps
without regularisation remove this error up to double precision, and `Room.left` is the remaining error.
"""

from __future__ import annotations

import math

from contact.base.arrays import Array, Indices
from contact.jit.compiled import jit
from contact.jit.vector import entry
from contact.solver.dense import affine, assign, dot, solve_in_place
from contact.solver.friction.room import BASE, CLOSED, INNER, JACOBIAN, MISS, RIGHT, STEP, TRIAL, TRIAL_MISS, Room, U

TOLERANCE = 1e-12  # of the largest force
MOST_ITERATIONS = 50  # Newton steps and bursts of sweeps together
SWEEPS = 8  # Gauss-Seidel sweeps in the first burst
HAIR = 1e-11  # regularisation of Newton's matrix, whose entries are of order one
HALVINGS = 8
UNDAMPED = 8
CLOSE, POLISHES = 1e-10, 12  # error over the free motion that more steps reduce; their largest number
EXACT, HALF_A_UNIT = 1e-12, 2.0**-53  # error from which the round-off of sums is checked; rounding of a number over it


@jit
def newton(W: Array, b: Array, mu: Array, dim: int, count: int, force: Array, room: Room) -> tuple[int, float]:
    """Improve `force` until F is below TOLERANCE of the largest force; returns (iterations, residual).

    Steps are taken while they reduce |F|. Then follow groups of sweeps, each with UNDAMPED undamped steps, because
    beyond a kink |F| may have to rise before it decreases. `count`: number of contacts, the first in the arrays.
    """
    size = count * dim
    rho, u, miss, step = room.pairs, room.vectors[U], room.vectors[MISS], room.vectors[STEP]
    trial, trial_miss, base = room.vectors[TRIAL], room.vectors[TRIAL_MISS], room.vectors[BASE]
    J, inside, closed = room.matrices[JACOBIAN], room.matrices[INNER], room.whole[CLOSED]
    steps_in(W, dim, count, rho)
    found = law_residual(W, b, mu, rho, dim, count, force, u, miss)
    undamped, sweeps, reached, part = 0, SWEEPS, found, 1.0
    for iteration in range(MOST_ITERATIONS + 1):
        scale = force_scale(b, rho, dim, count, force)
        if found <= TOLERANCE * scale or iteration == MOST_ITERATIONS:
            if found <= TOLERANCE * scale:
                polish(W, b, mu, dim, count, force, room)
            release(rho, dim, count, u, force)
            return iteration, found / scale if scale > 0.0 else found
        if undamped == 0:
            assign(base, force, size)
        n = law_slope(W, mu, rho, dim, count, force, u, J, closed)
        newton_step(J, closed, n, miss, inside, room, step, size, HAIR)
        part = 1.0
        for _ in range(1 if undamped > 0 else HALVINGS):
            for i in range(size):
                trial[i] = force[i] - part * step[i]
            reached = law_residual(W, b, mu, rho, dim, count, trial, u, trial_miss)
            if reached < found * (1.0 - 1e-4 * part) or undamped > 0:
                break
            part *= 0.5
        if undamped > 1 or reached < found * (1.0 - 1e-4 * part):
            assign(force, trial, size)
            assign(miss, trial_miss, size)
            found = reached
            undamped = max(undamped - 1, 0)
            continue
        assign(force, base, size)
        if not otherwise(W, b, mu, dim, count, force, room, sweeps) == 0.0:
            return MOST_ITERATIONS, math.nan
        assign(base, force, size)
        found = law_residual(W, b, mu, rho, dim, count, force, u, miss)
        undamped, sweeps = UNDAMPED, 2 * sweeps
    return MOST_ITERATIONS, found


@jit
def polish(W: Array, b: Array, mu: Array, dim: int, count: int, force: Array, room: Room) -> None:
    """Newton steps without regularisation while they halve the error of motion; `room.left` is the rest."""
    size, rho, u, miss = count * dim, room.pairs, room.vectors[U], room.vectors[MISS]
    step, trial, trial_miss = room.vectors[STEP], room.vectors[TRIAL], room.vectors[TRIAL_MISS]
    J, inside, closed = room.matrices[JACOBIAN], room.matrices[INNER], room.whole[CLOSED]
    left = motion_miss(b, rho, dim, count, miss)
    for _ in range(POLISHES):
        if left <= CLOSE:
            break
        n = law_slope(W, mu, rho, dim, count, force, u, J, closed)
        newton_step(J, closed, n, miss, inside, room, step, size, 0.0)
        for i in range(size):
            trial[i] = force[i] - step[i]
        law_residual(W, b, mu, rho, dim, count, trial, u, trial_miss)
        now = motion_miss(b, rho, dim, count, trial_miss)
        if not now < 0.5 * left:
            law_residual(W, b, mu, rho, dim, count, force, u, miss)
            break
        assign(force, trial, size)
        assign(miss, trial_miss, size)
        left = now
    if left > EXACT:
        left += sums_rounding(W, b, dim, count, force)
    room.left[0] = max(room.left[0], left)


@jit
def motion_miss(b: Array, rho: Array, dim: int, count: int, miss: Array) -> float:
    """Largest F of a contact as a motion, F/rho, relative to its free motion |b|, or the largest one if that is 0."""
    worst = 0.0
    for k in range(count):
        error = 0.0
        for i in range(k * dim, (k + 1) * dim):
            error = max(error, abs(miss[i]) / rho[k, 0 if i == k * dim else 1])
        if error > 0.0:
            worst = max(worst, error / free_motion(b, dim, count, k))
    return worst


@jit
def sums_rounding(W: Array, b: Array, dim: int, count: int, force: Array) -> float:
    """Largest round-off of a contact's motion W force + b, from the largest product, over its own free motion.

    Forces that nearly cancel leave this error in every motion, even if F happens to be much smaller.
    """
    worst = 0.0
    for k in range(count):
        product = 0.0
        for i in range(k * dim, (k + 1) * dim):
            for j in range(count * dim):
                product = max(product, abs(W[i, j] * force[j]))
        if product > 0.0:
            worst = max(worst, HALF_A_UNIT * product / free_motion(b, dim, count, k))
    return worst


@jit
def free_motion(b: Array, dim: int, count: int, k: int) -> float:
    """Free motion |b| of contact k; the largest one if it is 0."""
    own = 0.0
    for i in range(k * dim, (k + 1) * dim):
        own = max(own, abs(b[i]))
    if own > 0.0:
        return own
    for i in range(count * dim):
        own = max(own, abs(b[i]))
    return own


@jit
def otherwise(W: Array, b: Array, mu: Array, dim: int, count: int, force: Array, room: Room, sweeps: int) -> float:
    """Improve `force` by sweeps, or by pivoting if their number is 0; returns the residual after pivoting."""
    hard, size = room.matrices[INNER], count * dim
    for i in range(size):
        assign(hard[i], W[i], size)
    assign(room.vectors[MISS], b, size)
    assign(room.vectors[STEP], mu, count)
    assign(room.vectors[TRIAL], force, size)
    residual = room.otherwise(count, dim, sweeps)
    assign(force, room.vectors[TRIAL], size)
    return float(residual)


@jit
def release(rho: Array, dim: int, count: int, u: Array, force: Array) -> None:
    """Set the remaining forces in open contacts to zero."""
    for k in range(count):
        i = k * dim
        if force[i] <= rho[k, 0] * u[i]:
            for j in range(i, i + dim):
                force[j] = 0.0


@jit
def steps_in(W: Array, dim: int, count: int, rho: Array) -> None:
    """Step lengths of each contact: 1/W_NN, 1/(largest eigenvalue of the tangential block).

    Without tangential compliance the slip is given, and the step length of the normal serves for the tangent.
    """
    for k in range(count):
        i = k * dim
        rho[k, 0], rho[k, 1] = 1.0 / W[i, i], 0.0
        if dim == 1:
            continue
        top = W[i + 1, i + 1]
        if dim == 3:
            a, c, m = W[i + 1, i + 1], W[i + 2, i + 2], 0.5 * (W[i + 1, i + 2] + W[i + 2, i + 1])
            top = 0.5 * (a + c) + math.hypot(0.5 * (a - c), m)
        rho[k, 1] = 1.0 / top if top > 0.0 else rho[k, 0]


@jit
def force_scale(b: Array, rho: Array, dim: int, count: int, force: Array) -> float:
    """The largest force, or the force that the gap of a free step alone would need.

    The slip of a rotating rim in a step is no scale: it is far more than any tangential force could prevent.
    """
    scale = 0.0
    for k in range(count):
        scale = max(scale, abs(b[k * dim]) * rho[k, 0])
        for i in range(k * dim, (k + 1) * dim):
            scale = max(scale, abs(force[i]))
    return scale


@jit
def law_residual(W: Array, b: Array, mu: Array, rho: Array, dim: int, count: int, force: Array, u: Array,
                 miss: Array) -> float:  # fmt: skip
    """Fill u = W force + b and `miss` = F; returns |F|."""
    affine(W, force, b, u, count * dim)
    total = 0.0
    for k in range(count):
        i = k * dim
        normal = max(force[i] - rho[k, 0] * u[i], 0.0)
        miss[i] = force[i] - normal
        length = 0.0
        for j in range(i + 1, i + dim):
            miss[j] = force[j] - rho[k, 1] * u[j]
            length += miss[j] * miss[j]
        length = math.sqrt(length)
        radius = mu[k] * normal
        part = 1.0 if length <= radius else radius / length
        for j in range(i + 1, i + dim):
            miss[j] = force[j] - part * miss[j]
        for j in range(i, i + dim):
            total += miss[j] * miss[j]
    return math.sqrt(total)


@jit
def law_slope(W: Array, mu: Array, rho: Array, dim: int, count: int, force: Array, u: Array, J: Array,
              closed: Indices) -> int:  # fmt: skip
    """Rows of dF/dforce (a member of the generalised derivative) for pressing contacts, one below the other, into J.

    Returns their number; `closed` marks them. The other rows are those of the unit matrix.
    """
    n, size = 0, count * dim
    for k in range(count):
        i = k * dim
        normal = force[i] - rho[k, 0] * u[i]
        if normal <= 0.0:
            continue
        for j in range(i, i + dim):
            closed[n + j - i] = j
        for m in range(size):
            J[n, m] = rho[k, 0] * W[i, m]
        first = n
        n += dim
        t1, t2 = 0.0, 0.0
        if dim > 1:
            t1 = force[i + 1] - rho[k, 1] * u[i + 1]
        if dim > 2:
            t2 = force[i + 2] - rho[k, 1] * u[i + 2]
        length = math.hypot(t1, t2)
        if length <= mu[k] * normal:
            for j in range(1, dim):
                for m in range(size):
                    J[first + j, m] = rho[k, 1] * W[i + j, m]
            continue
        part, t1, t2 = mu[k] * normal / length, t1 / length, t2 / length
        for j in range(1, dim):  # d s_N = e_N - rho_N W_N, (1 - t t^T) part (d force_T - rho_T W_T)
            t = t1 if j == 1 else t2
            a1, a2 = part * ((1.0 if j == 1 else 0.0) - t * t1), part * ((1.0 if j == 2 else 0.0) - t * t2)
            for m in range(size):
                J[first + j, m] = mu[k] * t * rho[k, 0] * W[i, m] + a1 * rho[k, 1] * W[i + 1, m]
            J[first + j, i] -= mu[k] * t
            J[first + j, i + 1] -= a1
            if dim > 2:
                for m in range(size):
                    J[first + j, m] += a2 * rho[k, 1] * W[i + 2, m]
                J[first + j, i + 2] -= a2
            J[first + j, i + j] += 1.0
    return n


@jit
def newton_step(J: Array, closed: Indices, n: int, miss: Array, inside: Array, room: Room, step: Array,
                size: int, hair: float) -> None:  # fmt: skip
    """Solve J step = miss with J slightly regularised, open contacts first; NaN if J is singular."""
    right = room.vectors[RIGHT]
    assign(step, miss, size)
    for a in range(n):
        step[closed[a]] = 0.0
    for a in range(n):
        right[a] = miss[closed[a]] - dot(J[a], step, size)
        row = a * J.shape[1]
        for b in range(n):
            inside[a, b] = entry(J, row + entry(closed, b))
        inside[a, a] += hair
    solved = solve_in_place(inside, right, n, room.panels)
    for a in range(n):
        step[closed[a]] = right[a] if solved else math.nan  # no step: sweeps follow
