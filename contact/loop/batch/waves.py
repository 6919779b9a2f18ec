"""Arrays of eight rims at once, (m, 8) and (8,); waves and rows at their angles; skips over free flight."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from contact.base.arrays import Array, Indices
from contact.jit.compiled import jit, jit_inside
from contact.jit.vector import WIDTH, entry, load, put, same
from contact.loop.rub.deflection import RimWaves
from contact.loop.rub.free_flight import LEAST, FreeFlight, Pairs, largest_share, open_steps
from contact.record.record import Tally

FREE, TEST, FORCE, PULL, DRAG, H_, SCALE, NORMAL, TANGENT, DAMPING, SLIDE, ANGLE, N_T, BEFORE, GAP = range(15)
T_N, T_T, SLIP = 15, 16, 17
STRAIN, HEAT, DRIVE = 7, 8, 9  # rows of `memory`; 4 .. 6 are S_nn, S_nt, S_tt
WHOLE = 6755399441055744.0  # 1.5 2^52: added and taken away again, it rounds to a whole number
HIGH = math.floor(math.pi * 2.0**24) / 2.0**24  # n HIGH is exact for n < 2^27
LOW = math.pi - HIGH
REST = 1.2246467991473532e-16  # of pi, beyond double precision
COS = np.array([(-1.0) ** k / math.factorial(2 * k) for k in range(12)])  # of |x| <= pi/2: Taylor, to 1e-17
SIN = np.array([(-1.0) ** k / math.factorial(2 * k + 1) for k in range(12)])


class BatchTerms(NamedTuple):
    """Sums of waves: block b of rows uses wave[start[b]] .. wave[start[b + 1] - 1]; all indices count single numbers.

    If all slots have the same coefficients, a block has four rows that share most of their waves, so that each wave is
    read once. Then coefficient 4 j + r belongs to wave j in row[4 b + r]. Else a block is one row.
    """

    row: Indices
    start: Indices
    wave: Indices
    value: Array  # (terms, 8)
    alike: Array  # (terms,), empty where slots differ: an eighth of the memory


class BatchFreeFlight(NamedTuple):
    """The fields of `FreeFlight`, one row for each slot; `powers` (1, bits, 4, m) if all slots share them."""

    powers: Array
    fade: Array
    cos: Array
    sin: Array
    start: Indices
    wave: Indices
    row: Array
    floor: Array
    reach: Array
    taken: Indices
    pairs: Pairs  # none
    open: Indices  # (8,): steps whose gap is surely open, up to this one


class BatchSamples(NamedTuple):
    """Stored samples of all slots (8, rows), states (8, states, m); `due` (2, 8) the next steps to store."""

    time: Array
    force: Array
    gap: Array
    impulse: Array
    state_time: Array
    state: Array
    due: Indices
    every: Indices  # (2, 8)
    filled: Indices  # (2, 8)


class BatchState(NamedTuple):
    """State and coefficients of eight runs (m, 8), quantities of each run (8,), and work arrays."""

    q: Array
    d: Array
    old: Array
    al: Array
    be: Array
    c: Array
    weight: Array
    alike: Array  # (4, m): al, be, c, weight where all runs have the same, else empty
    normal: BatchTerms  # rows of the modes, then clearance, S_nn, S_nt, S_tt
    tangent: BatchTerms
    angle: Array
    speed: Array
    surface: Array
    mu: Array
    h: Array
    averaged: Array  # 1, or 0 for the forward law
    turns: Array  # 1 where S depends on the angle, else 0
    away: Array  # 0, or a gap that never closes where no run is
    live: Indices
    step: Indices
    end: Indices
    retry: Indices
    failed: Indices  # 1 no force was found, 2 the motion passed a limit
    casing: Indices  # modes of the casing, which come first
    reach: Array  # (m, 8), how far each of the casing's modes moves the rim at most, zero for others
    peaks: Array  # largest motion of the blade's tip along the rim
    limits: Array  # (6, 8), of `motion_limits`
    rim: RimWaves  # one line, its rows (1 or 8, 2 N + 1, m) and S (1 or 8, 2 N + 1, d, 2 N + 1) by slot
    soft: Array  # (2, 8), most that a unit force along the normal and the tangent strains the rim
    memory: Array  # (10, 8), as in `Slot`
    Q: Array  # (m + 5, 8): the rows of `normal`, then one that nothing reads
    Q_next: Array
    T: Array  # (m + 1, 8)
    waves: Array  # (harmonics, 2, 8): cos n phi, sin n phi
    waves_next: Array
    work: Array  # (18, 8)


@jit_inside
def half_turns(phi: float) -> float:
    """Nearest whole number of half turns."""
    turns: float = (phi * same(1.0 / math.pi) + same(WHOLE)) - same(WHOLE)
    return turns


@jit_inside
def within(phi: float, turns: float) -> float:
    """Subtract a number of half turns from an angle."""
    left: float = ((phi - turns * same(HIGH)) - turns * same(LOW)) - turns * same(REST)
    return left


@jit_inside
def sign_of(turns: float) -> float:
    """Sign that sine and cosine get from these half turns: -1 if their number is odd."""
    half = turns * same(0.5)
    odd = half - ((half + same(WHOLE)) - same(WHOLE))  # 0 or +-1/2
    sign: float = same(1.0) - same(8.0) * odd * odd
    return sign


@jit_inside
def cosine(x: float) -> float:
    """Cosine for |x| <= pi/2."""
    y, total = x * x, same(entry(COS, 11))
    for k in range(10, -1, -1):
        total = total * y + same(entry(COS, k))
    result: float = total
    return result


@jit_inside
def sine(x: float) -> float:
    """Sine for |x| <= pi/2."""
    y, total = x * x, same(entry(SIN, 11))
    for k in range(10, -1, -1):
        total = total * y + same(entry(SIN, k))
    result: float = total * x
    return result


@jit_inside
def angle_after(s: BatchState, k: int, step: int) -> float:
    """Contact angle of slot k at a step."""
    return float(s.angle[k] - s.speed[k] * step * s.h[k])


@jit
def rotate_slots(s: BatchState, waves: Array, ahead: int) -> None:
    """Cos n phi and sin n phi of every slot, `ahead` steps from now."""
    for k in range(s.step.size):
        s.work[ANGLE, k] = angle_after(s, k, s.step[k] + ahead)
    phi = load(s.work, ANGLE * WIDTH)
    turns = half_turns(phi)
    x, sign = within(phi, turns), sign_of(turns)
    c, s1 = sign * cosine(x), sign * sine(x)
    put(waves, 0, same(1.0))
    put(waves, WIDTH, same(0.0))
    have, count = 1, waves.shape[0]
    while have < WIDTH:  # n = have .. 2 have - 1 from n = 0 .. have - 1
        turn_on(waves, have, min(2 * have, count), have, c, s1)
        c, s1 = c * c - s1 * s1, c * s1 + c * s1
        have *= 2
    turn_on(waves, WIDTH, count, WIDTH, c, s1)


@jit_inside
def turn_on(waves: Array, begin: int, end: int, by: int, c: float, s1: float) -> None:
    """Rotate waves `begin` .. `end` - 1 by phi from the waves `by` before, with c + i s1 = e^{i by phi}."""
    for n in range(begin, end):
        at = 2 * WIDTH * (n - by)
        a, b = load(waves, at), load(waves, at + WIDTH)
        put(waves, at + 2 * WIDTH * by, c * a - s1 * b)
        put(waves, at + 2 * WIDTH * by + WIDTH, s1 * a + c * b)


@jit
def fill_slots(terms: BatchTerms, waves: Array, rows: Array) -> None:
    """Rows of every slot. The terms of a row are added one by one; zeros of other rows or slots change no bit."""
    if terms.alike.size > 0:
        fill_fours(terms, waves, rows)
        return
    for b in range(terms.row.size):
        part = same(0.0)
        for j in range(entry(terms.start, b), entry(terms.start, b + 1)):
            part = part + load(terms.value, j * WIDTH) * load(waves, entry(terms.wave, j))
        put(rows, entry(terms.row, b), part)


@jit_inside
def fill_fours(terms: BatchTerms, waves: Array, rows: Array) -> None:
    """Four rows at once, of coefficients that all slots share."""
    for b in range(terms.start.size - 1):
        one, two, three, four = same(0.0), same(0.0), same(0.0), same(0.0)
        for j in range(entry(terms.start, b), entry(terms.start, b + 1)):
            wave = load(waves, entry(terms.wave, j))
            one = one + same(entry(terms.alike, 4 * j)) * wave
            two = two + same(entry(terms.alike, 4 * j + 1)) * wave
            three = three + same(entry(terms.alike, 4 * j + 2)) * wave
            four = four + same(entry(terms.alike, 4 * j + 3)) * wave
        put(rows, entry(terms.row, 4 * b), one)
        put(rows, entry(terms.row, 4 * b + 1), two)
        put(rows, entry(terms.row, 4 * b + 2), three)
        put(rows, entry(terms.row, 4 * b + 3), four)


@jit
def land(s: BatchState, Q: Array, Q_next: Array, waves: Array, ahead: Array, d: Array, landed: int) -> None:
    """Waves, rows and gaps at the current step, and the gap a step before, of the slots in the bit mask `landed`.

    The rows at the next angle are work arrays. Rows of other slots do not change.
    """
    m = s.q.shape[0]
    for back in range(1, -1, -1):
        rotate_slots(s, ahead, -back)
        fill_slots(s.normal, ahead, Q_next)
        gap, part = load(Q_next, m * WIDTH), same(float(back))
        for i in range(m):
            gap = gap + load(Q_next, i * WIDTH) * (load(s.q, i * WIDTH) - part * load(d, i * WIDTH))
        put(s.work, FREE * WIDTH, gap)
        for k in range(s.step.size):
            if landed >> k & 1:
                s.memory[back, k] = s.work[FREE, k]
                for i in range(3 * back):
                    s.memory[4 + i, k] = Q_next[m + 1 + i, k]
    for k in range(s.step.size):
        if landed >> k & 1:
            s.memory[2, k], s.memory[3, k], s.memory[STRAIN, k] = 0.0, 0.0, 0.0
            for i in range(m + 4):
                Q[i, k] = Q_next[i, k]
            for n in range(waves.shape[0]):
                waves[n, 0, k], waves[n, 1, k] = ahead[n, 0, k], ahead[n, 1, k]


@jit
def skip_in_batch(s: BatchState, flights: BatchFreeFlight, sums: Tally, d: Array, k: int, room: int) -> int:
    """Skip steps without contact in slot k, at most `room`, as `skip_free_flight`. Negative: wait.

    The number of steps over which the gap is certainly open is kept until it is used up, since no force occurs
    meanwhile.
    """
    if flights.open[k] < s.step[k] + min(room, LEAST):
        flight = FreeFlight(
            flights.powers[0], flights.fade[k], flights.cos[k], flights.sin[k], flights.start[k], flights.wave[k],
            flights.row[k], flights.floor[k], flights.reach, flights.taken[k], flights.pairs,
        )  # fmt: skip
        bound = largest_share(flight, s.q[:, k], d[:, k])
        clear: int = open_steps(flight.floor, bound, angle_after(s, k, s.step[k] + 1), -s.speed[k] * s.h[k])
        if clear < 0:
            return clear
        flights.open[k] = s.step[k] + clear
    powers = flights.powers[min(k, flights.powers.shape[0] - 1)]
    steps: int = min(flights.open[k] - s.step[k], room, (1 << powers.shape[0]) - 1)
    if steps < LEAST:
        return -(steps + 1)
    sums.damping[k] += propagate_slot(s, powers, d, k, steps)
    flights.taken[k, 0] += 1
    flights.taken[k, 1] += steps
    s.step[k] += steps
    return steps


@jit
def propagate_slot(s: BatchState, powers: Array, d: Array, k: int, steps: int) -> float:
    """Advance (q, D) of slot k by `steps` steps of free motion, as `propagate`.

    Returns the change of `discrete_energy`.
    """
    gained = 0.0
    for i in range(s.q.shape[0]):
        x, y, be = s.q[i, k], d[i, k], s.be[i, k]
        before, left, j = y * y + be * (x - y) * x, steps, 0
        while left > 0:
            if left & 1:
                x, y = powers[j, 0, i] * x + powers[j, 1, i] * y, powers[j, 2, i] * x + powers[j, 3, i] * y
            left >>= 1
            j += 1
        gained += 0.5 * (y * y + be * (x - y) * x - before) / s.c[i, k]
        s.q[i, k], d[i, k] = x, y
    return gained
