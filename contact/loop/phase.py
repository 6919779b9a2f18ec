"""Compiled motion through one phase.

The set of closed contacts is constant and modes move exactly, until a gap or force is 0.

In the eigenvectors of the phase, y' = lam y + beta, so y(t + tau) = e^{lam tau} y + tau phi(lam tau) beta with
phi(z) = (e^z - 1)/z. The watched quantities (gaps of open contacts, forces of closed ones, then outputs) are
Re(rows y) + rest + Re(sum wave e^{i harmonic w t}). This is exact; the step determines only when they are evaluated.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from contact.base.arrays import Array, Indices
from contact.jit.compiled import jit

TINY = 1e-12  # of the terms of a watched value: below, it is zero
STILL = 1e-9  # of what a slope is the sum of: a smaller one is none
HALVINGS = 60
NEWTON = 60


class PhaseArrays(NamedTuple):
    """Arrays of a phase: real parts at [0], imaginary parts at [1]."""

    lam: Array  # (2, n)
    beta: Array  # (2, n)
    rows: Array  # (2, watched, n)
    rest: Array  # (watched,)
    wave: Array  # (2, watched, harmonics)
    harmonic: Array  # (harmonics,) in rad/s


class PhaseWork(NamedTuple):
    """State and work arrays; `most` and `least` of the watched quantities, in and out; `at`: the time reached.

    Entries that are inf in `most`, or -inf in `least`, are not computed.
    """

    y: Array  # (2, n)
    new: Array  # (2, n)
    circle: Array  # (2, harmonics): cosine and sine
    step: Array  # (2, n)
    drift: Array  # (2, n)
    now: Array  # (watched,)
    last: Array  # (watched,)
    before: Array  # (watched,)
    size: Array  # (watched,): of what adds up to a gap or a force
    most: Array  # (watched,)
    least: Array  # (watched,)
    at: Array  # (1,)


def phase_work(p: PhaseArrays) -> PhaseWork:
    """Work arrays for a phase of these arrays."""
    room, values = np.zeros((4, *p.lam.shape)), np.zeros((6, p.rest.size))
    return PhaseWork(
        y=room[0], new=room[1], circle=np.zeros((2, p.harmonic.size)), step=room[2], drift=room[3], now=values[0],
        last=values[1], before=values[2], size=values[3], most=values[4], least=values[5], at=np.zeros(1),
    )  # fmt: skip


@jit
def number_of(known: Indices, table: Indices, closed: Indices) -> int:
    """Number of the phase of these closed contacts in a table (phases, contacts), -1 if it is none of the known[0]."""
    for phase in range(known[0]):
        same = True
        for i in range(closed.size):
            if table[phase, i] != closed[i]:
                same = False
                break
        if same:
            return phase
    return -1


@jit
def flow(lam: Array, i: int, tau: float) -> tuple[float, float, float, float]:
    """Real and imaginary part of e^{lam tau} and of tau phi(lam tau)."""
    a, b = lam[0, i] * tau, lam[1, i] * tau
    size = math.exp(a)
    c, s = size * math.cos(b), size * math.sin(b)
    square = a * a + b * b
    if square > 1e-4:
        return c, s, tau * ((c - 1.0) * a + s * b) / square, tau * (s * a - (c - 1.0) * b) / square
    re, im = 1.0, 0.0
    for k in range(7, 1, -1):  # 1 + z/2 (1 + z/3 (1 + ...))
        re, im = 1.0 + (a * re - b * im) / k, (a * im + b * re) / k
    return c, s, tau * re, tau * im


@jit
def wave_at(p: PhaseArrays, row: int, t: float) -> tuple[float, float]:
    """Periodic part of a watched quantity and its slope."""
    value, slope = p.rest[row], 0.0
    for h in range(p.harmonic.size):
        w = p.harmonic[h]
        c, s = math.cos(w * t), math.sin(w * t)
        value += p.wave[0, row, h] * c - p.wave[1, row, h] * s
        slope -= w * (p.wave[0, row, h] * s + p.wave[1, row, h] * c)
    return value, slope


@jit
def watched_at(p: PhaseArrays, y: Array, row: int, t: float, tau: float) -> tuple[float, float]:
    """A watched quantity and its slope, `tau` after the state y at time t."""
    value, slope = wave_at(p, row, t + tau)
    for i in range(y.shape[1]):
        c, s, u, v = flow(p.lam, i, tau)
        a, b = y[0, i], y[1, i]
        f, g = p.beta[0, i], p.beta[1, i]
        re, im = c * a - s * b + u * f - v * g, c * b + s * a + u * g + v * f
        value += p.rows[0, row, i] * re - p.rows[1, row, i] * im
        up, across = p.lam[0, i] * re - p.lam[1, i] * im + f, p.lam[0, i] * im + p.lam[1, i] * re + g
        slope += p.rows[0, row, i] * up - p.rows[1, row, i] * across
    return value, slope


@jit
def root(p: PhaseArrays, y: Array, row: int, t: float, low: float, high: float) -> float:
    """Time of the zero of a quantity that is positive after `low` and negative at `high`."""
    first = low
    low += 0.5 * (high - low)
    for _ in range(HALVINGS):  # the value at the start may be the zero of the event that began the phase
        value, _slope = watched_at(p, y, row, t, low)
        if value > 0.0:
            break
        high = low
        low = first + 0.5 * (low - first)
    tau, found, least = high, high, math.inf
    for _ in range(NEWTON):
        value, slope = watched_at(p, y, row, t, tau)
        if abs(value) < least:
            found, least = tau, abs(value)
        if value > 0.0:
            low = tau
        else:
            high = tau
        close = 4e-16 * (abs(t) + abs(tau))
        if abs(value) <= close * abs(slope) or high - low <= close:  # before the next guess, which may be far away
            break
        guess = tau - value / slope if slope != 0.0 else high
        if not low < guess < high:
            guess = 0.5 * (low + high)
        tau = guess
    return found


@jit
def turn(p: PhaseArrays, y: Array, row: int, t: float, low: float, high: float, sense: float) -> float:
    """Time of the minimum (sense 1) or maximum (-1) of a quantity, by the secant method on its slope (Illinois)."""
    _value, below = watched_at(p, y, row, t, low)
    _value, above = watched_at(p, y, row, t, high)
    below, above = sense * below, sense * above
    if not below < 0.0 < above:
        return low if below >= 0.0 else high
    width, side = high - low, 0
    middle = low
    for _ in range(HALVINGS):
        last = middle
        middle = (low * above - high * below) / (above - below)
        _value, slope = watched_at(p, y, row, t, middle)
        slope *= sense
        if abs(middle - last) <= 1e-9 * width or slope == 0.0:
            break
        if slope < 0.0:
            low, below = middle, slope
            if side == -1:
                above *= 0.5
            side = -1
        else:
            high, above = middle, slope
            if side == 1:
                below *= 0.5
            side = 1
    return middle


@jit
def move_to(p: PhaseArrays, y: Array, tau: float) -> None:
    """Advance the state by any time step."""
    for i in range(y.shape[1]):
        c, s, u, v = flow(p.lam, i, tau)
        a, b = y[0, i], y[1, i]
        y[0, i] = c * a - s * b + u * p.beta[0, i] - v * p.beta[1, i]
        y[1, i] = c * b + s * a + u * p.beta[1, i] + v * p.beta[0, i]


@jit
def begun(p: PhaseArrays, w: PhaseWork, contacts: int, t: float) -> int:
    """Watched quantities at the start; returns the contact that has already passed its event, or -1."""
    found = -1
    for row in range(w.now.size):
        value, slope = watched_at(p, w.y, row, t, 0.0)
        w.now[row], w.last[row] = value, value
        w.most[row], w.least[row] = max(w.most[row], value), min(w.least[row], value)
        if row < contacts:
            size, speed = abs(p.rest[row]), 0.0
            for i in range(w.y.shape[1]):
                part = abs(p.rows[0, row, i] * w.y[0, i]) + abs(p.rows[1, row, i] * w.y[1, i])
                size += part
                speed += part * (abs(p.lam[0, i]) + abs(p.lam[1, i]))
            for h in range(p.harmonic.size):
                part = abs(p.wave[0, row, h]) + abs(p.wave[1, row, h])
                size += part
                speed += part * abs(p.harmonic[h])
            w.size[row] = size
            if value <= TINY * size and slope < -STILL * speed:
                found = row
    return found


@jit
def look(p: PhaseArrays, w: PhaseWork, t: float) -> None:
    """Watched quantities of the new state at time t."""
    for h in range(p.harmonic.size):
        w.circle[0, h], w.circle[1, h] = math.cos(p.harmonic[h] * t), math.sin(p.harmonic[h] * t)
    for row in range(w.now.size):
        total = p.rest[row]
        for h in range(p.harmonic.size):
            total += p.wave[0, row, h] * w.circle[0, h] - p.wave[1, row, h] * w.circle[1, h]
        for i in range(w.y.shape[1]):
            total += p.rows[0, row, i] * w.new[0, i] - p.rows[1, row, i] * w.new[1, i]
        w.before[row], w.last[row], w.now[row] = w.last[row], w.now[row], total


@jit
def extremes(p: PhaseArrays, w: PhaseWork, t: float, h: float) -> None:
    """Update the largest and smallest watched quantities, also with their extremes between samples near time t."""
    for row in range(w.now.size):
        before, last, now = w.before[row], w.last[row], w.now[row]
        w.most[row], w.least[row] = max(w.most[row], now), min(w.least[row], now)
        if (now - last) * (last - before) < 0.0:
            beyond = -((now - before) ** 2) / (8.0 * (now - 2.0 * last + before))  # of a parabola, over the look
            top = last + 2.0 * beyond
            if top > w.most[row] or top < w.least[row]:
                tau = turn(p, w.y, row, t, -h, h, math.copysign(1.0, now - last))
                value, _slope = watched_at(p, w.y, row, t, tau)
                w.most[row], w.least[row] = max(w.most[row], value), min(w.least[row], value)


@jit
def turned(p: PhaseArrays, y: Array, row: int, t: float, low: float, high: float) -> float:
    """Time of an extreme between two times at an end of a phase, if the slopes at both differ in sign; else inf."""
    _value, first = watched_at(p, y, row, t, low)
    _value, last = watched_at(p, y, row, t, high)
    if first * last >= 0.0:
        return math.inf
    return float(turn(p, y, row, t, low, high, math.copysign(1.0, last)))


@jit
def edge_extremes(p: PhaseArrays, w: PhaseWork, t: float, low: float, high: float) -> None:
    """Extremes in a step at the beginning or end of a phase, where there are not three samples around them."""
    for row in range(w.now.size):
        if w.most[row] < math.inf or w.least[row] > -math.inf:
            tau = turned(p, w.y, row, t, low, high)
            if tau < math.inf:
                value, _slope = watched_at(p, w.y, row, t, tau)
                w.most[row], w.least[row] = max(w.most[row], value), min(w.least[row], value)


@jit
def end_values(p: PhaseArrays, w: PhaseWork, t: float, tau: float) -> None:
    """Evaluate the watched quantities at the event too."""
    for row in range(w.now.size):
        value, _slope = watched_at(p, w.y, row, t, tau)
        w.most[row], w.least[row] = max(w.most[row], value), min(w.least[row], value)


@jit
def first_event(
    p: PhaseArrays, w: PhaseWork, contacts: int, t: float, h: float, started: bool, edge: bool
) -> tuple[int, float]:  # fmt: skip
    """The first contact whose watched quantity reaches zero up to t + h, and the time after t; or -1."""
    found, when = -1, h
    for row in range(contacts):
        tau = math.inf
        if w.now[row] < 0.0:
            tau = root(p, w.y, row, t, 0.0, h)
        if started and w.last[row] < w.before[row] and w.last[row] < w.now[row]:
            bend = w.now[row] - 2.0 * w.last[row] + w.before[row]
            if w.last[row] < 0.5 * (w.now[row] - w.before[row]) ** 2 / bend + 0.1 * bend:
                bottom = turn(p, w.y, row, t, -h, h, 1.0)
                value, _slope = watched_at(p, w.y, row, t, bottom)
                if value < -TINY * w.size[row]:
                    tau = root(p, w.y, row, t, -h, bottom)
        if edge and tau == math.inf:
            bottom = turned(p, w.y, row, t, 0.0, h)
            if bottom < math.inf:
                value, _slope = watched_at(p, w.y, row, t, bottom)
                if value < -TINY * w.size[row]:
                    tau = root(p, w.y, row, t, 0.0, bottom)
        if tau < when or (tau <= when and found < 0):
            found, when = row, tau
    return found, when


@jit
def pass_phase(p: PhaseArrays, w: PhaseWork, contacts: int, t: float, t_end: float, longest: float) -> int:
    """Advance y to the first event or to `t_end` in equal steps; returns the contact of the event, or -1.

    Sets the time `at`.
    """
    n = w.y.shape[1]
    w.at[0] = t
    found = begun(p, w, contacts, t)
    if found >= 0:
        return found
    steps = max(math.ceil((t_end - t) / longest), 1)
    h = (t_end - t) / steps
    for i in range(n):
        w.step[0, i], w.step[1, i], u, v = flow(p.lam, i, h)
        w.drift[0, i] = u * p.beta[0, i] - v * p.beta[1, i]
        w.drift[1, i] = u * p.beta[1, i] + v * p.beta[0, i]
    for k in range(steps):
        now = t + k * h
        for i in range(n):
            a, b = w.y[0, i], w.y[1, i]
            w.new[0, i] = w.step[0, i] * a - w.step[1, i] * b + w.drift[0, i]
            w.new[1, i] = w.step[0, i] * b + w.step[1, i] * a + w.drift[1, i]
        look(p, w, now + h)
        edge = k == 0 or k == steps - 1
        found, tau = first_event(p, w, contacts, now, h, k > 0, edge)
        if found >= 0:
            if k > 0:
                edge_extremes(p, w, now, -h, 0.0)
            edge_extremes(p, w, now, 0.0, tau)
            end_values(p, w, now, tau)
            move_to(p, w.y, tau)
            w.at[0] = now + tau
            return found
        extremes(p, w, now, h)
        if edge:
            edge_extremes(p, w, now, 0.0, h)
        for i in range(n):
            w.y[0, i], w.y[1, i] = w.new[0, i], w.new[1, i]
    w.at[0] = t_end
    return -1
