"""Compiled motion in one phase between events: exact modes, and a search for the first zero that misses none.

In a phase the set of closed contacts is constant. With T the time since its start, z_i = z_i(0) e^{lam_i T}, rigid
modes are s + s' T + a T^2/2, and each watched quantity (the gap of an open contact, the force of a closed one) is
w = alpha + beta T + gamma T^2/2 + Re(rho z).

With b >= max(sum |rho lam^2 z| - gamma, 0), w'' >= -b holds for the rest of the phase (no pole grows), so between two
instants w lies above the parabolas of curvature -b through its values and slopes at both. A stretch is certified if the
lower one of them stays above zero where they meet; else it is halved. In the shortest stretch, steps from the parabola
of the left end alone approach the first zero from below, as fast as Newton's method. If no contact is closed, flights
are skipped up to the first time at which alpha + beta T + gamma T^2/2 - sum |rho z| can be zero.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from contact.base.arrays import Array, Indices
from contact.jit.compiled import jit

TINY = 1e-12  # of the terms of a watched quantity: penetrations below are round-off
EXACT = 1e-2  # of TINY: round-off of constant terms that cancel
STILL = 1e-10  # of the terms of its rate: a smaller rate is none
MOST_STEPS = 10_000  # of a search for a zero
POLISH = 3
FRESH = 64  # steps from table to table, after which a state is computed from the start of its phase
STEP, PHASE, HIT, EVENTS, INSIDE, COUNT = range(6)  # entries of `where`


class Phases(NamedTuple):
    """Known phases of n modes, r of them rigid, m poles, k contacts; a complex number is split at [phase, part]."""

    known: Indices  # (1,)
    closed: Indices  # (P, k)
    flying: Indices  # (P,): 1 where no contact is closed
    lam: Array  # (P, 2, m)
    factor: Array  # (P, levels, 2, m): e^{lam h}, e^{lam h/2}, ...
    V: Array  # (P, 2, n, m): q = rest + R s + Re(V z)
    U: Array  # (P, 2, m, 2 n): z = U (q - rest, v)
    R: Array  # (P, n, r)
    rest: Array  # (P, n)
    pull: Array  # (P, r): accelerations of the rigid modes
    level: Array  # (P, k): a watched quantity at rest
    terms: Array  # (P, k): sizes of the terms that make it
    moved: Array  # (P, k, r): its part by s
    rows: Array  # (P, 3, 2, k, m): rho, rho lam, rho/lam
    sizes: Array  # (P, 3, k, m): |rho|, |rho lam|, |rho lam^2|
    loss: Array  # (P, 4, d, d): V'C V lam lam, real and imaginary, and with the conjugate; d = 0 without damping


class EventWork(NamedTuple):
    """State and work arrays; `at`: start of the phase, T, end of the certified flight [s]."""

    q: Array  # (n,)
    v: Array  # (n,)
    closed: Indices  # (k,)
    rigid: Indices  # (k,)
    z: Array  # (2, m)
    new: Array  # (2, m)
    start: Array  # (2, m)
    s: Array  # (2, r): s, s' at the start of the phase
    poly: Array  # (3, k): alpha, beta, gamma
    bound: Array  # (3, k): reach, rate, bend
    size: Array  # (2, k): of gaps and of forces, over the run
    now: Array  # (2, k): values and rates
    then: Array  # (2, k)
    before: Array  # (k,): primitive of a force
    push: Array  # (k,): impulse of the present step
    change: Array  # (2, k): time of the first and last opening or closing in the step
    changes: Indices  # (k,)
    force: Array  # (k,)
    gap: Array  # (k,)
    at: Array  # (3,)
    where: Indices  # (6,)


@jit
def sway(lam: Array, start: Array, T: float, z: Array) -> None:
    """State z at time T of the phase, from that at its start."""
    for i in range(lam.shape[1]):
        size = math.exp(lam[0, i] * T)
        c, s = size * math.cos(lam[1, i] * T), size * math.sin(lam[1, i] * T)
        z[0, i] = c * start[0, i] - s * start[1, i]
        z[1, i] = c * start[1, i] + s * start[0, i]


@jit
def watch(rows: Array, poly: Array, z: Array, T: float, into: Array) -> None:
    """Values and rates of the watched quantities."""
    for row in range(poly.shape[1]):
        value, rate = 0.0, 0.0
        for i in range(z.shape[1]):
            value += rows[0, 0, row, i] * z[0, i] - rows[0, 1, row, i] * z[1, i]
            rate += rows[1, 0, row, i] * z[0, i] - rows[1, 1, row, i] * z[1, i]
        into[0, row] = value + poly[0, row] + T * (poly[1, row] + 0.5 * T * poly[2, row])
        into[1, row] = rate + poly[1, row] + T * poly[2, row]


@jit
def primitive(rows: Array, poly: Array, z: Array, T: float, row: int) -> float:
    """Integral of a closed contact's force over time, up to a constant; no rigid mode changes such a force."""
    total = T * poly[0, row]
    for i in range(z.shape[1]):
        total += rows[2, 0, row, i] * z[0, i] - rows[2, 1, row, i] * z[1, i]
    return float(total)


@jit
def bounds(p: Phases, w: EventWork, phase: int) -> None:
    """Reach, rate and bend of the watched quantities from now on, and the end of the certified flight."""
    T, safe = w.at[1], math.inf
    for row in range(w.closed.size):
        for part in range(3):
            total = 0.0
            for i in range(w.z.shape[1]):
                total += p.sizes[phase, part, row, i] * math.hypot(w.z[0, i], w.z[1, i])
            w.bound[part, row] = total
        kind = w.closed[row]
        value, rate, curve = w.now[0, row], w.poly[1, row] + T * w.poly[2, row], w.poly[2, row]
        w.size[kind, row] = max(w.size[kind, row], abs(value) + w.bound[0, row] + EXACT * p.terms[phase, row])
        w.bound[1, row] += abs(rate)
        w.bound[2, row] = max(w.bound[2, row] - curve, 0.0)
        smooth = w.poly[0, row] + T * (w.poly[1, row] + 0.5 * T * curve) - w.bound[0, row]
        safe = min(safe, falls(smooth - TINY * w.size[kind, row], rate, curve))
    w.at[2] = T + safe if p.flying[phase] else T


@jit
def falls(value: float, rate: float, curve: float) -> float:
    """The first time at which value + rate t + curve t^2/2 is zero; 0 if it is so already, inf if never."""
    if value <= 0.0:
        return 0.0
    square = rate * rate - 2.0 * curve * value
    if square < 0.0:
        return math.inf
    below = math.sqrt(square) - rate
    return 2.0 * value / below if below > 0.0 else math.inf


@jit
def certified(w: EventWork, h: float) -> bool:
    """Whether no watched quantity falls below zero between `now` and `then`, h later."""
    for row in range(w.closed.size):
        least = -TINY * w.size[w.closed[row], row]
        first, last, bend = w.now[0, row], w.then[0, row], w.bound[2, row]
        if not (first >= least and last >= least):
            return False
        rate, end = w.now[1, row], w.then[1, row]
        slope = rate - end - bend * h
        if slope < 0.0:
            meet = (last - end * h - 0.5 * bend * h * h - first) / slope
            if 0.0 < meet < h and first + meet * (rate - 0.5 * bend * meet) < least:
                return False
    return True


@jit
def search(p: Phases, w: EventWork, phase: int, h: float) -> tuple[int, float]:
    """The first contact whose watched quantity falls through zero up to h from now, and when; -1 without one."""
    T, tau = w.at[1], 0.0
    for _ in range(MOST_STEPS):
        if tau > 0.0:
            sway(p.lam[phase], w.start, T + tau, w.new)
            watch(p.rows[phase], w.poly, w.new, T + tau, w.then)
        else:
            for row in range(w.closed.size):
                w.then[0, row], w.then[1, row] = w.now[0, row], w.now[1, row]
        step = math.inf
        for row in range(w.closed.size):
            value, rate, hair = w.then[0, row], w.then[1, row], TINY * w.size[w.closed[row], row]
            if rate < 0.0 and (value < -hair or (value <= 0.0 and rate < -STILL * w.bound[1, row])):
                return row, polished(p, w, phase, row, tau)
            above = max(value, 0.0) + hair  # at the start of a phase a value may be below zero by round-off, and rise
            step = min(step, max(falls(above, rate, -w.bound[2, row]), 1e-15 * h))
        tau += step
        if tau >= h:
            return -1, h
    return -2, h


@jit
def polished(p: Phases, w: EventWork, phase: int, row: int, tau: float) -> float:
    """The time of a zero by Newton's method, from a time just behind it."""
    T = w.at[1]
    for _ in range(POLISH):
        value, rate = w.then[0, row], w.then[1, row]
        if not rate < -STILL * w.bound[1, row] or value == 0.0:
            break
        better = max(tau - value / rate, 0.0)
        if better == tau:
            break
        tau = better
        sway(p.lam[phase], w.start, T + tau, w.new)
        watch(p.rows[phase], w.poly, w.new, T + tau, w.then)
    return tau


@jit
def move(p: Phases, w: EventWork, phase: int, T: float) -> None:
    """Go to a time of the phase, from its start."""
    w.at[1] = T
    sway(p.lam[phase], w.start, T, w.z)
    watch(p.rows[phase], w.poly, w.z, T, w.now)


@jit
def near(w: EventWork, T: float) -> bool:
    """Whether a time of the phase is that of the state, up to round-off."""
    return bool(abs(T - w.at[1]) <= 1e-14 * (abs(w.at[0]) + abs(T)))


@jit
def travel(p: Phases, w: EventWork, phase: int, until: float, h: float) -> int:
    """Go on to the time `until` of the phase, or to the first event; returns its contact, -1, or -2 if lost."""
    levels, level = p.factor.shape[1], 0
    while True:
        T = w.at[1]
        left = until - T
        if left <= 0.0 or near(w, until):
            return -1
        if w.at[2] >= until:
            move(p, w, phase, until)
            continue
        while level < levels and math.ldexp(h, -level) > left * (1.0 + 1e-12):
            level += 1
        step = math.ldexp(h, -level) if level < levels else left
        w.where[COUNT] += 1
        if level < levels and w.where[COUNT] % FRESH:
            factor = p.factor[phase, level]
            for i in range(w.z.shape[1]):
                a, b, c, s = w.z[0, i], w.z[1, i], factor[0, i], factor[1, i]
                w.new[0, i] = c * a - s * b
                w.new[1, i] = c * b + s * a
        else:
            sway(p.lam[phase], w.start, T + step, w.new)
        watch(p.rows[phase], w.poly, w.new, T + step, w.then)
        if not certified(w, step):
            if level < levels - 1:
                level += 1
                continue
            found, tau = search(p, w, phase, step)
            if found != -1:
                move(p, w, phase, T + tau)
                return found
            move(p, w, phase, T + step)
        else:
            w.at[1] = T + step
            for i in range(w.z.shape[1]):
                w.z[0, i], w.z[1, i] = w.new[0, i], w.new[1, i]
            for row in range(w.closed.size):
                w.now[0, row], w.now[1, row] = w.then[0, row], w.then[1, row]
            level = max(level - 1, 0)
        if w.where[COUNT] % FRESH == 0:
            bounds(p, w, phase)


@jit
def displaced(p: Phases, w: EventWork, phase: int) -> None:
    """Modal displacements and velocities now."""
    T, V, lam = w.at[1], p.V[phase], p.lam[phase]
    for j in range(w.q.size):
        place, speed = p.rest[phase, j], 0.0
        for i in range(p.R.shape[2]):
            a = p.pull[phase, i]
            place += p.R[phase, j, i] * (w.s[0, i] + T * (w.s[1, i] + 0.5 * T * a))
            speed += p.R[phase, j, i] * (w.s[1, i] + T * a)
        for i in range(w.z.shape[1]):
            re, im = w.z[0, i], w.z[1, i]
            place += V[0, j, i] * re - V[1, j, i] * im
            up, across = lam[0, i] * re - lam[1, i] * im, lam[0, i] * im + lam[1, i] * re
            speed += V[0, j, i] * up - V[1, j, i] * across
        w.q[j], w.v[j] = place, speed


@jit
def damped(p: Phases, w: EventWork, phase: int) -> float:
    """Work of damping since the start of the phase: minus the integral of v^T C v, in closed form."""
    d, T, lam, total = p.loss.shape[2], w.at[1], p.lam[phase], 0.0
    for i in range(d):
        a, b, e, f = w.start[0, i], w.start[1, i], w.z[0, i], w.z[1, i]
        for j in range(d):
            c, s, g, k = w.start[0, j], w.start[1, j], w.z[0, j], w.z[1, j]
            for side in range(2):
                sense = 1.0 - 2.0 * side  # of z_j or its conjugate
                x, y = lam[0, i] + lam[0, j], lam[1, i] + sense * lam[1, j]
                re = (e * g - sense * f * k) - (a * c - sense * b * s)
                im = (sense * e * k + f * g) - (sense * a * s + b * c)
                square = x * x + y * y
                if square > 0.0:
                    re, im = (re * x + im * y) / square, (im * x - re * y) / square
                else:
                    re, im = T * (a * c - sense * b * s), T * (sense * a * s + b * c)
                total -= 0.5 * (p.loss[phase, 2 * side, i, j] * re - p.loss[phase, 2 * side + 1, i, j] * im)
    return float(total)
