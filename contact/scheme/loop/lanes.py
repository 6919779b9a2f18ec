"""Compiled step loop of eight rotating rims at once: `advance_rim` with the runs, lanes, as innermost index.

Lanes do not wait for each other: each has its own step, leaps alone, and ends alone. No sum runs across lanes, so that
a run's numbers do not depend on its neighbours.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from contact.compiled import jit, jit_inside
from contact.model.arrays import Array, Indices
from contact.record import Samples, Tally
from contact.scheme.loop.leap import PAUSE, Leap, discrete_energy, leap_ahead
from contact.scheme.loop.tally import note_contact
from contact.vector import WIDTH, load, put, same


class LaneRows(NamedTuple):
    """Rows of the modes: entries start[i] .. start[i + 1] - 1 of mode i, coefficients by lane (entries, 8).

    `alike` (entries, 2) are cos and sin where all lanes have the same: an eighth of the memory; else it is empty.
    """

    start: Indices
    harmonic: Indices
    cos: Array
    sin: Array
    alike: Array


class LaneSeries(NamedTuple):
    """Trigonometric polynomials with their harmonics in common, coefficients by lane (terms, 8)."""

    harmonic: Indices
    cos: Array
    sin: Array


class LaneLeaps(NamedTuple):
    """The fields of `Leap`, one row a lane; `row_cos`, `row_sin` belong to the entries of `Lanes.normal`."""

    powers: Array
    fade: Array
    cos: Array
    sin: Array
    row_cos: Array
    row_sin: Array
    floor: Array
    reach: Array
    taken: Indices


class LaneSamples(NamedTuple):
    """What lanes store: samples (rows, 8), states (states, m, 8); `due` (2, 8) the next steps that are stored."""

    time: Array
    force: Array
    gap: Array
    impulse: Array
    state_time: Array
    state: Array
    due: Indices
    every: Indices  # (2, 8)
    filled: Indices  # (2, 8)


class Lanes(NamedTuple):
    """State and coefficients of eight runs (m, 8), what differs between them (8,), and work space."""

    q: Array
    d: Array
    old: Array
    al: Array
    be: Array
    c: Array
    weight: Array
    normal: LaneRows
    tangent: LaneRows
    clearance: LaneSeries
    S_nn: LaneSeries
    S_nt: LaneSeries
    angle: Array
    speed: Array
    surface: Array
    mu: Array
    h: Array
    averaged: Indices
    turns: Indices  # S depends on the angle
    live: Indices
    step: Indices
    end: Indices
    retry: Indices
    failed: Indices
    memory: Array  # (5, 8), as `ModalState.memory`
    Q: Array  # (m, 8)
    Q_next: Array
    T: Array
    waves: Array  # (2, harmonics, 8), an even number of harmonics
    waves_next: Array
    work: Array  # (16, 8)


FREE, TEST, FORCE, PULL, DRAG, H_, SCALE, NORMAL, TANGENT, DAMPING, SLIDE, S_NN, S_NT, COS, SIN, H_T = range(16)


@jit_inside
def angle_after(s: Lanes, k: int, step: int) -> float:
    """Contact angle of lane k at a step."""
    return float(s.angle[k] - s.speed[k] * step * s.h[k])


@jit_inside
def rotate_lanes(s: Lanes, waves: Array, ahead: int) -> None:
    """Cos n phi, sin n phi of every lane, `ahead` steps from where it is."""
    count = waves.shape[1]
    for k in range(WIDTH):
        phi = angle_after(s, k, s.step[k] + ahead)
        s.work[COS, k], s.work[SIN, k] = math.cos(phi), math.sin(phi)
    c, s1 = load(s.work, COS * WIDTH), load(s.work, SIN * WIDTH)
    even, even_sin, odd, odd_sin = same(1.0), same(0.0), c, s1  # n = 0, 2, .. and 1, 3, ..: two shorter chains
    c, s1 = c * c - s1 * s1, c * s1 + c * s1
    for n in range(0, count, 2):
        put(waves, n * WIDTH, even)
        put(waves, (count + n) * WIDTH, even_sin)
        put(waves, (n + 1) * WIDTH, odd)
        put(waves, (count + n + 1) * WIDTH, odd_sin)
        even, even_sin = c * even - s1 * even_sin, s1 * even + c * even_sin
        odd, odd_sin = c * odd - s1 * odd_sin, s1 * odd + c * odd_sin


@jit_inside
def entry_sum(rows: LaneRows, waves: Array, i: int) -> float:
    """Row of mode i in every lane: a vector."""
    count = waves.shape[1]
    cos_part, sin_part = same(0.0), same(0.0)
    if rows.alike.shape[0] > 0:
        for j in range(rows.start[i], rows.start[i + 1]):
            n = rows.harmonic[j]
            cos_part = cos_part + same(rows.alike[j, 0]) * load(waves, n * WIDTH)
            sin_part = sin_part + same(rows.alike[j, 1]) * load(waves, (count + n) * WIDTH)
        alike: float = cos_part + sin_part
        return alike
    for j in range(rows.start[i], rows.start[i + 1]):
        n = rows.harmonic[j]
        cos_part = cos_part + load(rows.cos, j * WIDTH) * load(waves, n * WIDTH)
        sin_part = sin_part + load(rows.sin, j * WIDTH) * load(waves, (count + n) * WIDTH)
    result: float = cos_part + sin_part
    return result


@jit_inside
def series_value(series: LaneSeries, waves: Array) -> float:
    """Value of the polynomials: a vector."""
    count = waves.shape[1]
    part = same(0.0)
    for j in range(series.harmonic.size):
        n = series.harmonic[j]
        part = part + load(series.cos, j * WIDTH) * load(waves, n * WIDTH)
        part = part + load(series.sin, j * WIDTH) * load(waves, (count + n) * WIDTH)
    result: float = part
    return result


@jit
def land(s: Lanes, waves: Array, Q: Array, k: int, step: int, back: float, d: Array) -> float:
    """Gap of lane k at a step, its waves, rows and S there; q - back D is its displacement.

    Sums are formed as vectors, so that harmonics which only other lanes have cannot change their order.
    """
    phi = angle_after(s, k, step)
    c, s1, a, b = math.cos(phi), math.sin(phi), 1.0, 0.0
    for n in range(waves.shape[1]):
        waves[0, n, k], waves[1, n, k] = a, b
        a, b = c * a - s1 * b, s1 * a + c * b
    gap = pick(s, series_value(s.clearance, waves), k)
    for i in range(Q.shape[0]):
        row = pick(s, entry_sum(s.normal, waves, i), k)
        Q[i, k] = row
        gap += row * (s.q[i, k] - back * d[i, k])
    s.work[S_NN, k] = pick(s, series_value(s.S_nn, waves), k)
    s.work[S_NT, k] = pick(s, series_value(s.S_nt, waves), k)
    return gap


@jit_inside
def pick(s: Lanes, vector: float, k: int) -> float:
    """Entry k of a vector."""
    put(s.work, COS * WIDTH, vector)
    return float(s.work[COS, k])


@jit
def leap_lane(s: Lanes, leaps: LaneLeaps, sums: Tally, Q: Array, waves: Array, d: Array, k: int, room: int) -> int:
    """Leap lane k over steps without contact, as `leap_rim`. Negative: wait."""
    leap = Leap(
        leaps.powers[k], leaps.fade[k], leaps.cos[k], leaps.sin[k], s.normal.start, s.normal.harmonic,
        leaps.row_cos[k], leaps.row_sin[k], leaps.floor[k], leaps.reach, leaps.taken[k],
    )  # fmt: skip
    q, own, be, c = s.q[:, k], d[:, k], s.be[:, k], s.c[:, k]
    before = discrete_energy(q, own, be, c)
    steps = leap_ahead(leap, q, own, angle_after(s, k, s.step[k] + 1), -s.speed[k] * s.h[k], room)
    if steps > 0:
        sums.damping[k] += discrete_energy(q, own, be, c) - before
        s.step[k] += steps
        s.memory[1, k] = land(s, waves, Q, k, s.step[k] - 1, 1.0, d)
        s.memory[4, k] = s.work[S_NN, k]
        s.memory[0, k] = land(s, waves, Q, k, s.step[k], 0.0, d)
        s.memory[2, k], s.memory[3, k] = 0.0, 0.0
    return steps


@jit_inside
def fly(s: Lanes, Q_next: Array, ahead: Array, old: Array, new: Array) -> None:
    """Free motion over a step into `new`, the rows ahead, and the free gap."""
    gap = series_value(s.clearance, ahead)
    for i in range(s.q.shape[0]):
        at = i * WIDTH
        row, q = entry_sum(s.normal, ahead, i), load(s.q, at)
        put(Q_next, at, row)
        step = load(s.al, at) * load(old, at) - load(s.be, at) * q
        put(new, at, step)
        gap = gap + row * (q + step)
    put(s.work, FREE * WIDTH, gap)


@jit_inside
def touch(s: Lanes, Q: Array, Q_next: Array, waves: Array, old: Array, rubs: bool) -> None:
    """Slip, Delassus numbers and forces of the lanes whose gap would close."""
    H, H_t, slide = same(0.0), same(0.0), same(0.0)
    for i in range(s.q.shape[0]):
        at = i * WIDTH
        stiff = load(Q_next, at) * load(s.c, at)
        H = H + stiff * load(Q, at)
        if rubs:
            row = entry_sum(s.tangent, waves, i)
            put(s.T, at, row)
            slide = slide + row * load(old, at)
            H_t = H_t + stiff * row
    put(s.work, H_ * WIDTH, H)
    put(s.work, H_T * WIDTH, H_t)
    put(s.work, SLIDE * WIDTH, slide)
    for k in range(WIDTH):
        force, scale, pull, H_k, test = 0.0, 1.0, 0.0, 0.0, s.work[TEST, k]
        if s.live[k] == 1 and not test >= 0.0:
            if s.mu[k] > 0.0:
                sliding = s.surface[k] + s.work[SLIDE, k] / s.h[k]
                pull = s.mu[k] if sliding > 0.0 else (-s.mu[k] if sliding < 0.0 else 0.0)
                s.work[SLIDE, k] = sliding
            H_k = s.work[H_, k] - pull * s.work[H_T, k]
            scale = (0.25 * H_k if s.averaged[k] == 1 else H_k) + s.work[S_NN, k] - pull * s.work[S_NT, k]
            force = -test / scale if scale > 0.0 else math.nan
            if not force >= 0.0:
                s.failed[k], force = 1, 0.0
            s.retry[k] = max(s.retry[k], s.step[k] + PAUSE)
        s.work[FORCE, k], s.work[PULL, k], s.work[DRAG, k] = force, pull, pull * force
        s.work[H_, k], s.work[SCALE, k] = H_k, scale


@jit_inside
def move_lanes(s: Lanes, Q: Array, old: Array, new: Array, touching: bool, rubs: bool) -> None:
    """Add the forces to D and D to q; what forces and damping do along D_n + D_{n+1}."""
    normal, tangent, damping = same(0.0), same(0.0), same(0.0)
    force, drag = load(s.work, FORCE * WIDTH), load(s.work, DRAG * WIDTH)
    for i in range(s.q.shape[0]):
        at = i * WIDTH
        step, before = load(new, at), load(old, at)
        if touching:
            row, c = load(Q, at), load(s.c, at)
            step = step + c * row * force
            if rubs:
                along = load(s.T, at)
                step = step - c * along * drag
                tangent = tangent + along * (before + step)
            normal = normal + row * (before + step)
            put(new, at, step)
        damping = damping + load(s.weight, at) * before * (before + step)
        put(s.q, at, load(s.q, at) + step)
    put(s.work, NORMAL * WIDTH, normal)
    put(s.work, TANGENT * WIDTH, tangent)
    put(s.work, DAMPING * WIDTH, damping)


@jit_inside
def note_lane(s: Lanes, sums: Tally, out: Samples, kept: LaneSamples, k: int) -> None:
    """Sums, events and samples of one step of lane k."""
    force, H, scale, pull = s.work[FORCE, k], s.work[H_, k], s.work[SCALE, k], s.work[PULL, k]
    free, now, last, h, step = s.work[FREE, k], s.memory[0, k], s.memory[1, k], s.h[k], s.step[k]
    S = s.work[S_NN, k] - pull * s.work[S_NT, k]
    if force > 0.0:
        work = 0.5 * force * (free + H * force - last)
        if s.turns[k] == 1:
            work += 0.5 * force * force * (S - s.memory[4, k])
        sums.work[k] += work
        sums.rotation[k] += 0.5 * force * s.work[NORMAL, k] - work
        sums.friction[k] -= 0.5 * force * pull * s.work[TANGENT, k]
        if s.mu[k] > 0.0 and s.work[SLIDE, k] * s.surface[k] < 0.0:
            sums.reversals[k] += 1
    sums.damping[k] -= s.work[DAMPING, k]
    gap = s.work[TEST, k] + scale * force
    note_contact(sums, out, k, h, step * h, force, gap, scale, now, free)
    s.memory[1, k], s.memory[0, k] = now, free + H * force
    s.memory[2, k], s.memory[3, k], s.memory[4, k] = force, pull, S
    if step == kept.due[0, k]:
        row = kept.filled[0, k]
        kept.time[row, k], kept.force[row, k], kept.gap[row, k] = step * h, force, gap
        kept.impulse[row, k] = sums.impulse[k]
        kept.filled[0, k] += 1
        kept.due[0, k] += kept.every[0, k]


@jit_inside
def keep_state(s: Lanes, kept: LaneSamples, k: int) -> None:
    """Store the displacements of lane k at the start of a step that is due."""
    if s.step[k] == kept.due[1, k]:
        row = kept.filled[1, k]
        kept.state_time[row, k] = s.step[k] * s.h[k]
        for i in range(s.q.shape[0]):
            kept.state[row, i, k] = s.q[i, k]
        kept.filled[1, k] += 1
        kept.due[1, k] += kept.every[1, k]


@jit
def advance_lanes(
    s: Lanes, leaps: LaneLeaps, sums: Tally, out: Samples, kept: LaneSamples, rubs: bool, turns: bool, budget: int
) -> None:
    """Step all live lanes, until one is at its end or has failed, or `budget` steps are taken."""
    old, new, Q, Q_next, waves, ahead = s.old, s.d, s.Q, s.Q_next, s.waves, s.waves_next
    for k in range(WIDTH):
        if s.live[k] == 1 and s.step[k] == 0:
            land(s, waves, Q, k, 0, 0.0, new)
    skips, swapped = leaps.powers.shape[1] > 0, False
    for _ in range(budget):
        stop = False
        for k in range(WIDTH):
            if s.live[k] == 1:
                if skips and s.step[k] >= s.retry[k] and s.memory[0, k] > 0.0 and s.memory[1, k] > 0.0:
                    room = min(s.end[k], kept.due[0, k], kept.due[1, k]) - s.step[k]
                    leapt = -1 if room <= 0 or sums.closed[k] == 1 else 0
                    if leapt == 0:
                        leapt = leap_lane(s, leaps, sums, Q, waves, new, k, room)
                    s.retry[k] = s.step[k] + max(1, -leapt)  # not twice at a step, should the loop be left here
                if s.step[k] == s.end[k]:
                    stop = True
                else:
                    keep_state(s, kept, k)
        if stop:
            break
        old, new, swapped = new, old, not swapped
        rotate_lanes(s, ahead, 1)
        fly(s, Q_next, ahead, old, new)
        touching = False
        for k in range(WIDTH):
            free, test = s.work[FREE, k], s.work[FREE, k]
            if s.averaged[k] == 1:
                test = 0.25 * (free + 2.0 * s.memory[0, k] + s.memory[1, k])
            touching = touching or (s.live[k] == 1 and not test >= 0.0)
            s.work[TEST, k], s.work[FORCE, k], s.work[PULL, k], s.work[DRAG, k] = test, 0.0, 0.0, 0.0
            s.work[H_, k], s.work[SCALE, k] = 0.0, 1.0
        if touching:
            touch(s, Q, Q_next, waves, old, rubs)
        move_lanes(s, Q, old, new, touching, rubs)
        for k in range(WIDTH):
            if s.live[k] == 1 and s.failed[k] == 0:
                note_lane(s, sums, out, kept, k)
                s.step[k] += 1
            stop = stop or (s.live[k] == 1 and (s.failed[k] == 1 or s.step[k] == s.end[k]))
        Q, Q_next, waves, ahead = Q_next, Q, ahead, waves
        if turns:
            put(s.work, S_NN * WIDTH, series_value(s.S_nn, waves))
            put(s.work, S_NT * WIDTH, series_value(s.S_nt, waves))
        if stop:
            break
    if swapped:  # the buffers changed places an odd number of times; nothing is computed anew, not to change a bit
        for i in range(s.q.shape[0]):
            put(s.d, i * WIDTH, load(s.old, i * WIDTH))
            put(s.Q, i * WIDTH, load(s.Q_next, i * WIDTH))
        for n in range(2 * s.waves.shape[1]):
            put(s.waves, n * WIDTH, load(s.waves_next, n * WIDTH))
