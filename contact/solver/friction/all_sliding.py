"""A starting point for the friction problem with all contacts sliding.

Contacts with one tangential line each are solved completely by `in_line`. In a plane every contact is assumed to slide:
slip directions are fixed, and normal forces solved for.

With force_T = -mu force_N d and the previous direction d = u_T/|u_T|, complementarity of the normals remains, 0 <=
(W_NN - W_NT mu d) force_N + b_N, with a third of the unknowns. Then d is updated and the problem solved again. On a
fast rim d hardly changes, and two or three rounds end at round-off. If the slip is so slow that friction can reverse
it, d is continued in small steps instead: `continue_direction`. If a contact sticks, the starting point is not changed.
"""

from __future__ import annotations

import math
from typing import Any

from numba import types

from contact.base.arrays import Array
from contact.jit.bundle import Bundle
from contact.jit.compiled import MATRIX, VECTOR, ByAddress, jit
from contact.solver.dense import affine, assign, solve_in_place
from contact.solver.friction.in_line import forces_in_line
from contact.solver.friction.room import AT, CLOSED, INNER, JACOBIAN, TRIAL, Room, U, friction_room

OWN, NORMAL, GAP, PHI, LAST, LEFT, SHORT = 1, 2, 4, 5, 6, 7, 8  # rows of `vectors`
ADDED, RATE, FALL = 12, 13, 14  # those which the path to the set of closed contacts takes
ROUNDS = 8
CONTINUED = 9  # rounds of `continue_direction`
NEAR = 0.3  # angle [rad] to the slip's direction from where Newton's method goes on
SHORT_STEP, LONG_STEP = 0.1, 2.0  # bounds of Aitken's factor
STILL = 1e-13  # change of direction at which the rounds end
MOST_CHANGES = 10  # of the set of closed contacts, and four times their number
GOLDEN = 0.6180339887498949


def all_sliding_start(W: Array, b: Array, mu: Array, dim: int, count: int, force: Array, room: Room) -> bool:
    """Improve `force`.

    Returns False and leaves `force` unchanged if no states are found, or a contact in a plane sticks.
    """
    if dim == 2:
        return forces_in_line(W, b, mu, count, force, room)
    size = count * dim
    trial, u, gap, closed, d = room.vectors[TRIAL], room.vectors[U], room.vectors[GAP], room.whole[CLOSED], room.pairs
    assign(trial, force, size)
    for k in range(count):
        gap[k] = b[k * dim]
        closed[k] = 1 if force[k * dim] > 0.0 else 0
    for turn in range(ROUNDS):
        affine(W, trial, b, u, size)
        moved = follow(u, dim, count, d, turn == 0)
        if moved > 1.0:
            if continue_direction(W, b, mu, count, force, room):
                break
            return False
        if moved <= STILL:
            break
        if not slide(W, mu, dim, count, room):
            return False
    assign(force, trial, size)
    return True


class AllSliding(ByAddress):
    """`all_sliding_start` as a function address, so that loops of one tip do not contain its code."""

    kind: Any = types.boolean(
        MATRIX, VECTOR, VECTOR, types.int64, types.int64, VECTOR, Bundle(friction_room(1, 1)).kind
    )  # fmt: skip
    function = staticmethod(all_sliding_start)


@jit
def slide(W: Array, mu: Array, dim: int, count: int, room: Room) -> bool:
    """Forces TRIAL of contacts that slide along d = `pairs`; returns False if no set of closed ones is consistent."""
    trial, x, A, d = room.vectors[TRIAL], room.vectors[NORMAL], room.matrices[JACOBIAN], room.pairs
    for i in range(count):
        x[i] = trial[i * dim]
        for k in range(count):
            A[i, k] = W[i * dim, k * dim]
            for j in range(dim - 1):
                A[i, k] -= W[i * dim, k * dim + 1 + j] * mu[k] * d[k, j]
    if not press(A, count, room):
        return False
    for k in range(count):
        trial[k * dim] = x[k]
        for j in range(dim - 1):
            trial[k * dim + 1 + j] = -mu[k] * x[k] * d[k, j]
    return True


@jit
def continue_direction(W: Array, b: Array, mu: Array, count: int, force: Array, room: Room) -> bool:
    """Slip directions in a plane if following the slip would reverse them.

    Returns whether the last ones are close to it.

    d moves towards u_T + g d, where g = -d . W_TT force_T is the slip that friction removes. Tips that move together
    with isotropic compliance converge in one round. Aitken's factor from the last two errors shortens the steps.
    """
    size = 3 * count
    trial, u, own, d = room.vectors[TRIAL], room.vectors[U], room.vectors[OWN], room.pairs
    phi, last = room.vectors[PHI], room.vectors[LAST]
    factor, worst = 1.0, math.pi
    assign(trial, force, size)
    for k in range(count):
        last[k] = 0.0
    for turn in range(CONTINUED):
        affine(W, trial, b, u, size)
        dragged(W, trial, size, own)
        worst, product, square = 0.0, 0.0, 0.0
        for k in range(count):
            u1, u2, v1, v2 = u[3 * k + 1], u[3 * k + 2], own[3 * k + 1], own[3 * k + 2]
            if turn == 0:
                phi[k] = math.atan2(u2 - v2, u1 - v1)
                continue
            d1, d2 = d[k, 0], d[k, 1]
            g = max(-d1 * v1 - d2 * v2, 0.0)
            error = between(u1 + g * d1, u2 + g * d2, d1, d2)
            worst = max(worst, abs(between(u1, u2, d1, d2)))
            change = error - last[k]
            product, square, last[k] = product + last[k] * change, square + change * change, error
        if turn > 0 and worst <= STILL:
            return True
        if turn > 1 and square > 0.0:
            factor = min(max(-factor * product / square, SHORT_STEP), LONG_STEP)
        for k in range(count):
            phi[k] += factor * last[k]
            d[k, 0], d[k, 1] = math.cos(phi[k]), math.sin(phi[k])
        if not slide(W, mu, 3, count, room):
            return False
    return worst < NEAR


@jit
def dragged(W: Array, force: Array, size: int, out: Array) -> None:
    """Motion due to the tangential forces alone."""
    for i in range(size):
        total = 0.0
        for k in range(0, size, 3):
            total += W[i, k + 1] * force[k + 1] + W[i, k + 2] * force[k + 2]
        out[i] = total


@jit
def between(a: float, c: float, d1: float, d2: float) -> float:
    """Angle from the unit vector d to (a, c)."""
    return math.atan2(d1 * c - d2 * a, d1 * a + d2 * c)


@jit
def follow(u: Array, dim: int, count: int, d: Array, first: bool) -> float:
    """Slip directions into `d`; returns the largest change of direction, 2 if a contact is at rest or reverses."""
    worst = 1.0 if first else 0.0
    for k in range(count):
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


@jit
def press(A: Array, n: int, room: Room) -> bool:
    """Solve 0 <= NORMAL, 0 <= A NORMAL + GAP, complementary, from NORMAL and CLOSED; returns False if no path ends.

    GAP gets tau times a correction that makes the starting point a solution. As tau decreases from 1 to 0, contacts
    open or close one by one (parametric pivoting: Cottle, Pang & Stone, The Linear Complementarity Problem, 4.5); in
    most steps none does. If the path turns back, tau increases again.
    """
    x, gap, left, closed = room.vectors[NORMAL], room.vectors[GAP], room.vectors[LEFT], room.whole[CLOSED]
    added, rate, pull = room.vectors[ADDED], room.vectors[RATE], room.vectors[FALL]
    affine(A, x, gap, left, n)
    for i in range(n):
        spread = 1.0 + (GOLDEN * (i + 1)) % 1.0  # so that equal tips do not close at the same time
        added[i] = -left[i] if closed[i] == 1 else -min(left[i], 0.0) * (1.0 + spread)
    tau, sign, last = 1.0, 1.0, -1
    for _ in range(4 * n + MOST_CHANGES):
        if not with_closed(A, gap, n, x, left, room):
            return False
        right = True
        for i in range(n):
            right = right and (x[i] > 0.0 if closed[i] == 1 else not left[i] < 0.0)
        if right:
            return True
        if not with_closed(A, added, n, rate, pull, room):
            return False
        if last >= 0:  # it grows from zero
            sign = 1.0 if (rate[last] if closed[last] == 1 else pull[last]) < 0.0 else -1.0
        nearest, first = math.inf, -1
        for i in range(n):
            slope = sign * (rate[i] if closed[i] == 1 else pull[i])
            if slope > 0.0 and i != last:
                value = (x[i] if closed[i] == 1 else left[i]) + tau * sign * slope
                if max(value, 0.0) < nearest * slope:
                    nearest, first = max(value, 0.0) / slope, i
        if first < 0:
            return False
        tau, last = tau - sign * nearest, first
        closed[first] = 1 - closed[first]
    return False


@jit
def with_closed(A: Array, gap: Array, n: int, x: Array, left: Array, room: Room) -> bool:
    """Forces x that keep the closed contacts closed, and the gaps `left`; returns False if there are none."""
    short, closed, at, part = room.vectors[SHORT], room.whole[CLOSED], room.whole[AT], room.matrices[INNER]
    size = 0
    for i in range(n):
        x[i] = 0.0
        if closed[i] == 1:
            at[size], short[size], size = i, -gap[i], size + 1
    for i in range(size):
        for k in range(size):
            part[i, k] = A[at[i], at[k]]
    if not solve_in_place(part, short, size, room.panels):
        return False
    for i in range(size):
        x[at[i]] = short[i]
    affine(A, x, gap, left, n)
    return True
