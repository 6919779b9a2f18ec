"""A start for the friction problem. Along one line each, all states of the contacts are found: `in_line`.

In a plane every contact is taken to slide: directions of slip held, normal forces solved for.

With force_T = -mu force_N d, d = u_T/|u_T| as it was, what remains is complementarity of the normals,
0 <= (W_NN - W_NT mu d) force_N + b_N, in a third of the unknowns; then d follows and it is solved again. Where a rim
turns fast, d hardly moves and two or three rounds end at round-off. Where the bodies slip as slowly as friction can
turn them round, d is continued in small steps instead: `continue_direction`. Where something sticks, the start is
left alone.
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
    """Improve `force`; False, `force` as it was, where no states settle, or in a plane where one does not slide."""
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
    """`all_sliding_start` as loops call it: a start for several tips, which loops of one tip need not contain."""

    kind: Any = types.boolean(
        MATRIX, VECTOR, VECTOR, types.int64, types.int64, VECTOR, Bundle(friction_room(1, 1)).kind
    )  # fmt: skip
    function = staticmethod(all_sliding_start)


@jit
def slide(W: Array, mu: Array, dim: int, count: int, room: Room) -> bool:
    """Forces TRIAL of contacts that slide along d = `pairs`; False where no set of closed ones settles."""
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
    """Directions in a plane where following the slip would turn them round; whether the last ones are near it.

    d aims at u_T + g d, g = -d . W_TT force_T what friction itself takes away of the slip: tips that move together and
    yield alike in all directions are there in one round. Aitken's factor from the last two errors shortens the steps.
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
    """Motion that the tangential forces alone make."""
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
    """Directions of slip into `d`; returns how far the worst turned, 2 where one stands still or turns round."""
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
    """0 <= NORMAL, 0 <= A NORMAL + GAP, complementary, NORMAL and CLOSED to begin from; False where no path ends.

    To GAP is added what makes the beginning right, tau times that: as tau goes from 1 to 0 one contact after the other
    opens or closes (parametric pivoting: Cottle, Pang & Stone, The Linear Complementarity Problem, 4.5), none in most
    steps. Where the path turns back, tau grows again.
    """
    x, gap, left, closed = room.vectors[NORMAL], room.vectors[GAP], room.vectors[LEFT], room.whole[CLOSED]
    added, rate, pull = room.vectors[ADDED], room.vectors[RATE], room.vectors[FALL]
    affine(A, x, gap, left, n)
    for i in range(n):
        spread = 1.0 + (GOLDEN * (i + 1)) % 1.0  # tips alike do not close at once
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
    """Forces x that keep the closed contacts closed, and the gaps `left`; False where no force does."""
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
