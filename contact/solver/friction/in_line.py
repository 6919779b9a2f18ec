"""Contacts with friction along one line each: a path of single changes finds which are open, slip or stick.

Each contact is in a state in which the law is linear: open (no force), slipping to one side (force_T = -mu d force_N,
u_N = 0) or sticking (u_N = u_T = 0). With all states known, the forces follow from one linear system. They are a
solution if every contact satisfies its conditions: u_N >= 0 if it is open; force_N >= 0 and d u_T >= 0 if it slips; mu
force_N -+ force_T >= 0 if it sticks.

b gets tau times a correction that makes the starting point a solution. As tau decreases from 1 to 0, conditions reach
zero one by one, and each time a contact changes its state (parametric pivoting: Cottle, Pang & Stone, The Linear
Complementarity Problem, 4.5). In most steps none does. If the path turns back, tau increases again.
"""

from __future__ import annotations

import math

from contact.base.arrays import Array, Indices
from contact.jit.compiled import jit
from contact.jit.vector import entry
from contact.solver.dense import affine, assign, solve_in_place
from contact.solver.friction.room import AT, CLOSED, INNER, TRIAL, Room, U

OPEN, SLIPS, STICKS = 0, 1, 2
START, PULL, SHORT, ADDED, RATE, FALL = 1, 5, 8, 12, 13, 14  # rows of `vectors`
INSIDE = 1e-9  # of the cone's radius: a force nearer to the edge slips
MOST_CHANGES = 10  # of states, and eight times the number of contacts
GOLDEN = 0.6180339887498949


@jit
def forces_in_line(W: Array, b: Array, mu: Array, count: int, force: Array, room: Room) -> bool:
    """Forces by the path from `force`, else from open contacts; returns False with `force` unchanged if both fail."""
    start = room.vectors[START]
    assign(start, force, 2 * count)
    if follow_path(W, b, mu, count, start, force, room):
        return True
    for i in range(2 * count):
        start[i] = 0.0
    return follow_path(W, b, mu, count, start, force, room)


@jit
def follow_path(W: Array, b: Array, mu: Array, count: int, start: Array, force: Array, room: Room) -> bool:
    """Fill `force` if the path from `start` leads to tau = 0."""
    found, u, added, state = room.vectors[TRIAL], room.vectors[U], room.vectors[ADDED], room.whole[CLOSED]
    rate, fall, side = room.vectors[RATE], room.vectors[FALL], room.pairs
    affine(W, start, b, u, 2 * count)
    begin(mu, count, start, u, added, state, side)
    tau, sign, last = 1.0, 1.0, -1
    for _ in range(8 * count + MOST_CHANGES):
        if not in_states(W, b, mu, count, found, u, room):
            return False
        right = True
        for n in range(2 * count):
            right = right and condition(mu, found, u, state, side, n) >= 0.0
        if right:
            assign(force, found, 2 * count)
            return True
        if not in_states(W, added, mu, count, rate, fall, room):
            return False
        if last >= 0:  # it grows from zero
            sign = 1.0 if condition(mu, rate, fall, state, side, last) < 0.0 else -1.0
        nearest, first = math.inf, -1
        for n in range(2 * count):
            slope = sign * condition(mu, rate, fall, state, side, n)
            if slope > 0.0 and n != last:
                value = max(condition(mu, found, u, state, side, n) + tau * sign * slope, 0.0)
                if value < nearest * slope:
                    nearest, first = value / slope, n
        if first < 0:
            return False
        tau -= sign * nearest
        k = first // 2
        last = change(state, side, first, u[2 * k + 1] + tau * fall[2 * k + 1])
    return False


@jit
def begin(mu: Array, count: int, force: Array, u: Array, added: Array, state: Indices, side: Array) -> None:
    """States of the contacts in `force`, and a correction of the motion for which `force` is exact."""
    for k in range(count):
        i = 2 * k
        spread = 1.0 + (GOLDEN * (k + 1)) % 1.0  # so that equal tips do not change at the same time
        side[k, 0] = 1.0 if u[i + 1] >= 0.0 else -1.0
        added[i], added[i + 1] = -u[i], 0.0
        if not force[i] > 0.0:
            state[k], added[i] = OPEN, -min(u[i], 0.0) * (1.0 + spread)
        elif abs(force[i + 1]) < mu[k] * force[i] * (1.0 - INSIDE):
            state[k], added[i + 1] = STICKS, -u[i + 1]
        else:
            state[k] = SLIPS
            if force[i + 1] != 0.0:
                side[k, 0] = -1.0 if force[i + 1] > 0.0 else 1.0
            if side[k, 0] * u[i + 1] < 0.0:
                added[i + 1] = -u[i + 1] * (1.0 + spread)


@jit
def condition(mu: Array, force: Array, u: Array, state: Indices, side: Array, number: int) -> float:
    """Quantities that must not be negative, two for each contact; the second one of an open contact is unused."""
    k, second = number // 2, number % 2 == 1
    i = 2 * k
    if state[k] == OPEN:
        return 0.0 if second else float(u[i])
    if state[k] == SLIPS:
        return float(side[k, 0] * u[i + 1]) if second else float(force[i])
    return float(mu[k] * force[i] + force[i + 1]) if second else float(mu[k] * force[i] - force[i + 1])


@jit
def change(state: Indices, side: Array, number: int, slip: float) -> int:
    """Next state of the contact whose condition reached zero, and the condition that is zero in that state.

    `slip` is unchanged.
    """
    k, second = number // 2, number % 2
    if state[k] == OPEN:
        state[k], side[k, 0] = SLIPS, 1.0 if slip >= 0.0 else -1.0
        return 2 * k
    if state[k] == SLIPS and second == 0:
        state[k] = OPEN
        return 2 * k
    if state[k] == SLIPS:
        state[k] = STICKS
        return 2 * k if side[k, 0] < 0.0 else 2 * k + 1
    state[k], side[k, 0] = SLIPS, -1.0 if second == 0 else 1.0
    return 2 * k + 1


@jit
def in_states(W: Array, b: Array, mu: Array, count: int, force: Array, u: Array, room: Room) -> bool:
    """Forces that keep the contacts in their states, and u = W force + b; returns False if there are none."""
    short, pull, part = room.vectors[SHORT], room.vectors[PULL], room.matrices[INNER]
    state, at, side = room.whole[CLOSED], room.whole[AT], room.pairs
    size = 0
    for k in range(count):
        i = 2 * k
        force[i], force[i + 1] = 0.0, 0.0
        if state[k] != OPEN:
            at[size], short[size], size = i, -b[i], size + 1
            pull[size - 1] = mu[k] * side[k, 0] if state[k] == SLIPS else 0.0
        if state[k] == STICKS:
            at[size], short[size], pull[size], size = i + 1, -b[i + 1], 0.0, size + 1
    for a in range(size):
        row = at[a] * W.shape[1]
        for c in range(size):
            column = row + entry(at, c)
            part[a, c] = entry(W, column)
            if entry(pull, c) != 0.0:
                part[a, c] -= entry(pull, c) * entry(W, column + 1)
    if not solve_in_place(part, short, size, room.panels):
        return False
    for a in range(size):
        i = at[a]
        force[i] = short[a]
        if pull[a] != 0.0:
            force[i + 1] = -pull[a] * short[a]
    affine(W, force, b, u, 2 * count)
    return True
