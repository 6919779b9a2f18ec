"""Waves and rows of eight rims at their angles, and where a lane lands that skips over free flight."""

from __future__ import annotations

import math

from contact.base.arrays import Array
from contact.jit.compiled import jit, jit_inside
from contact.jit.vector import WIDTH, entry, load, put, same
from contact.loop.batch.state import ANGLE, STRAIN, BatchFreeFlight, BatchState, BatchTerms
from contact.loop.beam.circle import cosine, half_turns, sign_of, sine, within
from contact.loop.modal.free_flight import FreeFlight, discrete_energy, skip_free_flight
from contact.record.record import Tally


@jit_inside
def angle_after(s: BatchState, k: int, step: int) -> float:
    """Contact angle of lane k at a step."""
    return float(s.angle[k] - s.speed[k] * step * s.h[k])


@jit_inside
def rotate_lanes(s: BatchState, waves: Array, ahead: int) -> None:
    """Cos n phi, sin n phi of every lane, `ahead` steps from where it is."""
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
    """Waves `begin` .. `end` - 1 from those `by` before, c + i s1 = e^{i by phi}."""
    for n in range(begin, end):
        at = 2 * WIDTH * (n - by)
        a, b = load(waves, at), load(waves, at + WIDTH)
        put(waves, at + 2 * WIDTH * by, c * a - s1 * b)
        put(waves, at + 2 * WIDTH * by + WIDTH, s1 * a + c * b)


@jit_inside
def fill_lanes(terms: BatchTerms, waves: Array, rows: Array) -> None:
    """Rows in every lane. Terms of a row are added one by one: zeros, of other rows or lanes, change no bit."""
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
    """Four rows at once, of coefficients that all lanes share."""
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
def land(s: BatchState, waves: Array, Q: Array, k: int, step: int, back: float, d: Array) -> float:
    """Gap of lane k at a step, its waves and rows there; q - back D is its displacement.

    The other lanes' rows are formed again from their waves: the same to the bit.
    """
    phi = angle_after(s, k, step)
    c, s1, a, b = math.cos(phi), math.sin(phi), 1.0, 0.0
    for n in range(waves.shape[0]):
        waves[n, 0, k], waves[n, 1, k] = a, b
        a, b = c * a - s1 * b, s1 * a + c * b
    fill_lanes(s.normal, waves, Q)
    m = s.q.shape[0]
    gap = Q[m, k]
    for i in range(m):
        gap += Q[i, k] * (s.q[i, k] - back * d[i, k])
    return float(gap)


@jit
def skip_in_batch(
    s: BatchState, flights: BatchFreeFlight, sums: Tally, Q: Array, waves: Array, d: Array, k: int, room: int
) -> int:
    """Skip in lane k over steps without contact, as `skip_on_rim`. Negative: wait."""
    flight = FreeFlight(
        flights.powers[k], flights.fade[k], flights.cos[k], flights.sin[k], flights.start[k], flights.wave[k],
        flights.row[k], flights.floor[k], flights.reach, flights.taken[k],
    )  # fmt: skip
    q, own, be, c = s.q[:, k], d[:, k], s.be[:, k], s.c[:, k]
    before = discrete_energy(q, own, be, c)
    steps = skip_free_flight(flight, q, own, angle_after(s, k, s.step[k] + 1), -s.speed[k] * s.h[k], room)
    if steps > 0:
        sums.damping[k] += discrete_energy(q, own, be, c) - before
        s.step[k] += steps
        s.memory[1, k] = land(s, waves, Q, k, s.step[k] - 1, 1.0, d)
        for i in range(3):
            s.memory[4 + i, k] = Q[s.q.shape[0] + 1 + i, k]
        s.memory[0, k] = land(s, waves, Q, k, s.step[k], 0.0, d)
        s.memory[2, k], s.memory[3, k], s.memory[STRAIN, k] = 0.0, 0.0, 0.0
    return steps
