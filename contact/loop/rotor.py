"""Compiled steps of a rotor: z <- P z of (q, v, rotating force, constant force), with the work of its forces."""

from __future__ import annotations

import math
from typing import NamedTuple

from contact.base.arrays import Array, Indices
from contact.jit.compiled import jit_entry, jit_inside
from contact.loop.limits import outgrown, tip_motion
from contact.loop.tally import store, store_state
from contact.record.record import Samples, Tally

NODES = 4  # of the interpolation over the speed


class RotorState(NamedTuple):
    """z = (q, v, cos, sin, 1) of t_n, d = 2 m + 3 entries, and the outputs of the loop."""

    z: Array
    new: Array
    q: Array  # (m,), of the record
    P: Array  # (d, d) of this step
    W: Array  # (3, d, d) of this step: work of damping, of what turns the rotor, of the unbalance
    share: Array  # of the nodes, (4,)
    turns: Array  # (rows, 5), as `contact.record.orbit.orbit` reads them
    turn: Indices  # number of the turn under way, one entry
    hz: Array  # speed at the end of the last step, one entry
    force: Array  # of no contact
    gap: Array
    limits: Array  # of `contact.model.gaps.limits.rotor_limits`


class RotorLaws(NamedTuple):
    """P and W at speeds first + k step, (speeds, d, d) and (speeds, 3, d, d); `parts` for the step of the release."""

    first: float
    spacing: float
    P: Array
    W: Array
    step_parts: Array  # (2, d, d): until the release, and after it
    work_parts: Array
    release: int  # step in which it falls; -1: none
    until: float  # from the beginning of that step to the release [s]
    before: Array  # cos and sin parts of the unbalance until then [kg m]
    after: Array
    speed: Array  # rows (from [s], angle there, Omega there, its slope)
    plane: Array  # (2, m)
    rest: Array  # x and y at rest
    places: Array  # (nodes, 2, m)


@jit_inside
def turned(speed: Array, t: float) -> tuple[float, float]:
    """Angle [rad] and speed [rad/s] at t."""
    k = 0
    while k + 1 < speed.shape[0] and speed[k + 1, 0] <= t:
        k += 1
    since = t - speed[k, 0]
    return (
        speed[k, 1] + speed[k, 2] * since + 0.5 * speed[k, 3] * since * since,
        speed[k, 2] + speed[k, 3] * since,
    )


@jit_inside
def interpolated(s: RotorState, laws: RotorLaws, omega: float) -> None:
    """P and W at a speed: cubic interpolation through the four nearest nodes."""
    last = laws.P.shape[0] - NODES
    at = (omega - laws.first) / laws.spacing
    k = min(max(math.floor(at) - 1, 0), last)
    x = at - k
    s.share[0] = -(x - 1.0) * (x - 2.0) * (x - 3.0) / 6.0
    s.share[1] = 0.5 * x * (x - 2.0) * (x - 3.0)
    s.share[2] = -0.5 * x * (x - 1.0) * (x - 3.0)
    s.share[3] = x * (x - 1.0) * (x - 2.0) / 6.0
    d = s.z.size
    for i in range(d):
        for j in range(d):
            total = 0.0
            for n in range(NODES):
                total += s.share[n] * laws.P[k + n, i, j]
            s.P[i, j] = total
    for w in range(3):
        for i in range(d):
            for j in range(d):
                total = 0.0
                for n in range(NODES):
                    total += s.share[n] * laws.W[k + n, w, i, j]
                s.W[w, i, j] = total


@jit_inside
def passed(s: RotorState, sums: Tally, P: Array, W: Array) -> None:
    """A step or part of it: first the works, then z."""
    d = s.z.size
    for w in range(3):
        total = 0.0
        for i in range(d):
            row = 0.0
            for j in range(d):
                row += W[w, i, j] * s.z[j]
            total += s.z[i] * row
        if w == 0:
            sums.damping[0] += total
        elif w == 1:
            sums.rotation[0] += total
        else:
            sums.external[0] += total
    for i in range(d):
        total = 0.0
        for j in range(d):
            total += P[i, j] * s.z[j]
        s.new[i] = total
    for i in range(d - 3):
        s.z[i] = s.new[i]


@jit_inside
def driven(s: RotorState, unbalance: Array, angle: float, square: float, slope: float) -> None:
    """Rotating force of an unbalance U: U (Omega^2 - i slope) e^(i angle)."""
    d = s.z.size
    x = square * unbalance[0] + slope * unbalance[1]
    y = square * unbalance[1] - slope * unbalance[0]
    s.z[d - 3] = math.cos(angle) * x - math.sin(angle) * y
    s.z[d - 2] = math.sin(angle) * x + math.cos(angle) * y


@jit_inside
def note_orbit(s: RotorState, laws: RotorLaws, unbalance: Array, angle: float, omega: float) -> None:
    """Add the position at t_n to the sums of its turn."""
    m = s.q.size
    x, y = -laws.rest[0], -laws.rest[1]
    for i in range(m):
        x += laws.plane[0, i] * s.z[i]
        y += laws.plane[1, i] * s.z[i]
    turn = math.floor(abs(angle) / (2.0 * math.pi))
    row = turn % s.turns.shape[0]
    if s.turns[row, 0] != turn or s.turns[row, 1] == 0.0:
        s.turns[row, 0] = turn
        for k in range(1, 5):
            s.turns[row, k] = 0.0
    c, n = math.cos(angle), math.sin(angle)
    ux, uy = c * unbalance[0] - n * unbalance[1], n * unbalance[0] + c * unbalance[1]
    s.turns[row, 1] += 1.0
    s.turns[row, 2] += math.sqrt(x * x + y * y)
    s.turns[row, 3] += x * ux + y * uy
    s.turns[row, 4] += math.copysign(1.0, omega) * (x * uy - y * ux)
    s.turn[0] = turn


@jit_inside
def note_motion(s: RotorState, laws: RotorLaws) -> None:
    """Update the largest distance of any node from its straight position."""
    far = 0.0
    for node in range(laws.places.shape[0]):
        x, y = 0.0, 0.0
        for i in range(s.q.size):
            x += laws.places[node, 0, i] * s.z[i]
            y += laws.places[node, 1, i] * s.z[i]
        far = max(far, x * x + y * y)
    tip_motion(s.limits, math.sqrt(far))


@jit_entry
def advance_rotor(s: RotorState, laws: RotorLaws, sums: Tally, out: Samples, h: float, first: int, steps: int) -> int:
    """Steps of a rotor without contact.

    Returns -1, or the step whose state is not finite or beyond the limit of motion.
    """
    m = s.q.size
    ramp = laws.P.shape[0] > 1
    for step in range(first, first + steps):
        for i in range(m):
            s.q[i] = s.z[i]
        store_state(sums, out, step, step * h, s.q)
        store(sums, out, step, step * h, s.force, s.gap)
        angle, omega = turned(laws.speed, step * h)
        end, faster = turned(laws.speed, (step + 1) * h)
        s.hz[0] = faster / (2.0 * math.pi)
        mean, slope = (end - angle) / h, (faster - omega) / h
        unbalance = laws.before if step <= laws.release else laws.after
        note_orbit(s, laws, unbalance, angle, omega)
        driven(s, unbalance, angle, mean * mean, slope)
        if step == laws.release:
            passed(s, sums, laws.step_parts[0], laws.work_parts[0])
            driven(s, laws.after, angle + mean * laws.until, mean * mean, slope)
            passed(s, sums, laws.step_parts[1], laws.work_parts[1])
        elif ramp:
            interpolated(s, laws, mean)
            passed(s, sums, s.P, s.W)
        else:
            passed(s, sums, laws.P[0], laws.W[0])
        note_motion(s, laws)
        if not math.isfinite(s.z[0]) or outgrown(s.limits):
            return step
    return -1
