"""Compiled step loop of eight rotating rims at once: `advance_rim` with the runs, lanes, as innermost index.

Lanes do not wait for each other: each has its own step, skips alone, and ends alone. No sum runs across lanes, so that
a run's numbers do not depend on its neighbours.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from contact.base.arrays import Array, Indices
from contact.jit.compiled import jit, jit_entry, jit_inside
from contact.jit.vector import WIDTH, below_zero, entry, larger, load, put, same
from contact.loop.beam.circle import cosine, half_turns, sign_of, sine, within
from contact.loop.modal.free_flight import PAUSE, FreeFlight, discrete_energy, skip_free_flight
from contact.loop.modal.stick import INSIDE
from contact.loop.tally import note_event, note_stick
from contact.model.gaps.limits import LOOK, REACHED, RIM, TIP
from contact.record.record import Samples, Tally
from contact.solver.friction.one_contact import drag_ratio


class BatchTerms(NamedTuple):
    """Sums of waves: block b of rows has those at wave[start[b]] .. wave[start[b + 1] - 1]; all count single numbers.

    Where all lanes have the same coefficients a block is four rows with most of their waves in common, so that a wave
    is read once for them, and coefficient 4 j + r is that of wave j in row[4 b + r]; else it is one row.
    """

    row: Indices
    start: Indices
    wave: Indices
    value: Array  # (terms, 8)
    alike: Array  # (terms,), empty where lanes differ: an eighth of the memory


class BatchFreeFlight(NamedTuple):
    """The fields of `FreeFlight`, one row a lane."""

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


class BatchSamples(NamedTuple):
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


class BatchState(NamedTuple):
    """State and coefficients of eight runs (m, 8), what differs between them (8,), and work space."""

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
    reach: Array  # (m, 8), as `RimRows.reach`
    limits: Array  # (4, 8), of `motion_limits`
    memory: Array  # (10, 8), as on a rim alone
    Q: Array  # (m + 5, 8): the rows of `normal`, then one that nothing reads
    Q_next: Array
    T: Array  # (m + 1, 8)
    waves: Array  # (harmonics, 2, 8): cos n phi, sin n phi
    waves_next: Array
    work: Array  # (18, 8)


FREE, TEST, FORCE, PULL, DRAG, H_, SCALE, NORMAL, TANGENT, DAMPING, SLIDE, ANGLE, N_T, BEFORE, GAP = range(15)
T_N, T_T, SLIP = 15, 16, 17
STRAIN, HEAT, DRIVE = 7, 8, 9  # rows of `memory`; 4 .. 6 are S_nn, S_nt, S_tt


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


@jit_inside
def coefficient(s: BatchState, alike: bool, k: int, values: Array, i: int) -> float:
    """One of al, be, c, weight (k = 0 .. 3) of mode i, in every lane."""
    found: float = same(entry(s.alike, k * s.q.shape[0] + i)) if alike else load(values, i * WIDTH)
    return found


@jit_inside
def fly(s: BatchState, Q_next: Array, ahead: Array, old: Array, new: Array) -> bool:
    """Free motion over a step into `new`, the rows ahead, and the gaps; whether one would close."""
    fill_lanes(s.normal, ahead, Q_next)
    alike = s.alike.size > 0
    free = load(Q_next, s.q.shape[0] * WIDTH)
    for i in range(s.q.shape[0]):
        at = i * WIDTH
        row, q = load(Q_next, at), load(s.q, at)
        step = coefficient(s, alike, 0, s.al, i) * load(old, at) - coefficient(s, alike, 1, s.be, i) * q
        put(new, at, step)
        free = free + row * (q + step)
    now, last, share = load(s.memory, 0), load(s.memory, WIDTH), load(s.averaged, 0)
    mean = same(0.25) * (free + now + now + last)
    test = share * mean + (same(1.0) - share) * free  # one of the two, to the bit
    put(s.work, FREE * WIDTH, free)
    put(s.work, TEST * WIDTH, test)
    closes: bool = below_zero(test + load(s.away, 0))
    return closes


@jit_inside
def touch(s: BatchState, Q: Array, Q_next: Array, waves: Array, new: Array, rubs: bool) -> None:
    """Slip, Delassus numbers and forces of the lanes whose gap would close."""
    nn, nt, tn, tt, slip, m = same(0.0), same(0.0), same(0.0), same(0.0), same(0.0), s.q.shape[0]
    alike = s.alike.size > 0
    if rubs:
        fill_lanes(s.tangent, waves, s.T)
    for i in range(s.q.shape[0]):
        at = i * WIDTH
        row, c = load(Q, at), coefficient(s, alike, 2, s.c, i)
        ahead = load(Q_next, at)
        nn = nn + ahead * c * row
        if rubs:
            along = load(s.T, at)
            pull = along * c
            nt, tn, tt, slip = nt + ahead * pull, tn + pull * row, tt + pull * along, slip + along * load(new, at)
    put(s.work, H_ * WIDTH, nn)
    put(s.work, N_T * WIDTH, nt)
    put(s.work, T_N * WIDTH, tn)
    put(s.work, T_T * WIDTH, tt)
    put(s.work, SLIP * WIDTH, slip)
    for k in range(s.step.size):
        force, scale, pull, H, test = 0.0, 1.0, 0.0, 0.0, s.work[TEST, k]
        if s.live[k] == 1 and not test >= 0.0:
            share = 0.25 if s.averaged[k] == 1.0 else 1.0
            S_nn, S_nt, S_tt = Q[m + 1, k], Q[m + 2, k], Q[m + 3, k]
            if s.mu[k] > 0.0:
                slide = s.work[SLIP, k] + s.h[k] * s.surface[k] - s.memory[STRAIN, k]
                n, across = share * s.work[H_, k] + S_nn, share * s.work[N_T, k] + S_nt
                along, t = s.work[T_N, k] + S_nt, s.work[T_T, k] + S_tt
                pull = drag_ratio(n, across, along, t, test, slide, s.mu[k])
                s.work[SLIDE, k] = slide
            H = s.work[H_, k] - pull * s.work[N_T, k]
            scale = share * H + S_nn - pull * S_nt
            force = -test / scale if scale > 0.0 else math.nan
            if not force >= 0.0:
                s.failed[k], force, pull, scale, H = 1, 0.0, 0.0, 1.0, 0.0
            s.retry[k] = max(s.retry[k], s.step[k] + PAUSE)
        s.work[FORCE, k], s.work[PULL, k], s.work[DRAG, k] = force, pull, pull * force
        s.work[H_, k], s.work[SCALE, k] = H, scale


@jit_inside
def move_lanes(s: BatchState, Q: Array, old: Array, new: Array, touching: bool, rubs: bool) -> None:
    """Add the forces to D and D to q; what forces and damping do along D_n + D_{n+1}."""
    normal, tangent, damping = same(0.0), same(0.0), same(0.0)
    alike = s.alike.size > 0
    force, drag = load(s.work, FORCE * WIDTH), load(s.work, DRAG * WIDTH)
    for i in range(s.q.shape[0]):
        at = i * WIDTH
        step, before = load(new, at), load(old, at)
        if touching:
            row, c = load(Q, at), coefficient(s, alike, 2, s.c, i)
            step = step + c * row * force
            if rubs:
                along = load(s.T, at)
                step = step - c * along * drag
                tangent = tangent + along * (before + step)
            normal = normal + row * (before + step)
            put(new, at, step)
        damping = damping + coefficient(s, alike, 3, s.weight, i) * before * (before + step)
        put(s.q, at, load(s.q, at) + step)
    put(s.work, NORMAL * WIDTH, normal)
    put(s.work, TANGENT * WIDTH, tangent)
    put(s.work, DAMPING * WIDTH, damping)


@jit_inside
def add_up(s: BatchState, sums: Tally, Q: Array, Q_next: Array) -> bool:
    """Sums of one step of every lane, and the gaps the next one needs; where no force is, it does no work.

    Returns whether some tip has moved further against its rim than it may.
    """
    force, H = load(s.work, FORCE * WIDTH), load(s.work, H_ * WIDTH)
    scale, pull = load(s.work, SCALE * WIDTH), load(s.work, PULL * WIDTH)
    free, now, last, h = load(s.work, FREE * WIDTH), load(s.memory, 0), load(s.memory, WIDTH), load(s.h, 0)
    m = s.q.shape[0]
    half, drag = same(0.5), same(0.0) - pull * force
    S_nn, S_nt, S_tt = load(Q, (m + 1) * WIDTH), load(Q, (m + 2) * WIDTH), load(Q, (m + 3) * WIDTH)
    after = free + H * force
    d_nn, d_nt, d_tt = (
        S_nn - load(s.memory, 4 * WIDTH), S_nt - load(s.memory, 5 * WIDTH), S_tt - load(s.memory, 6 * WIDTH)
    )  # fmt: skip
    turned = force * (d_nn * force + d_nt * drag) + drag * (d_nt * force + d_tt * drag)
    work = half * (force * (after - last) + turned * load(s.turns, 0))
    strain, before = S_nt * force + S_tt * drag, load(s.memory, STRAIN * WIDTH)
    soft = drag * (strain - before)
    put(sums.work, 0, load(sums.work, 0) + (work - soft))
    put(sums.rotation, 0, load(sums.rotation, 0) + (half * force * load(s.work, NORMAL * WIDTH) - work))
    put(sums.friction, 0, load(sums.friction, 0) + (half * drag * load(s.work, TANGENT * WIDTH) + soft))
    slip = load(s.work, SLIDE * WIDTH) + (load(s.work, T_N * WIDTH) + S_nt) * force
    slip = slip + (load(s.work, T_T * WIDTH) + S_tt) * drag
    put(s.memory, HEAT * WIDTH, load(s.memory, HEAT * WIDTH) - drag * slip)
    put(s.memory, DRIVE * WIDTH, load(s.memory, DRIVE * WIDTH) - drag * h * load(s.surface, 0))
    put(s.memory, STRAIN * WIDTH, strain)
    put(sums.damping, 0, load(sums.damping, 0) - load(s.work, DAMPING * WIDTH))
    impulse, none = load(sums.impulse, 0) + force * h, same(0.0)
    put(sums.impulse, 0, impulse)
    put(sums.peak, 0, larger(load(sums.peak, 0), force))
    gap = load(s.work, TEST * WIDTH) + scale * force
    put(s.work, GAP * WIDTH, gap)
    put(sums.penetration, 0, larger(load(sums.penetration, 0), none - gap))
    slack = larger(none - force * scale, none - gap)  # minus the lesser
    put(sums.residual, 0, larger(load(sums.residual, 0), larger(slack, none - slack)))
    put(s.memory, 0, after)
    put(s.memory, WIDTH, now)
    put(s.memory, 2 * WIDTH, force)
    put(s.memory, 3 * WIDTH, pull)
    put(s.memory, 4 * WIDTH, S_nn)
    put(s.memory, 5 * WIDTH, S_nt)
    put(s.memory, 6 * WIDTH, S_tt)
    moved = after - load(Q_next, m * WIDTH)
    reached = larger(load(s.limits, (REACHED + TIP) * WIDTH), larger(moved, none - moved))
    put(s.limits, (REACHED + TIP) * WIDTH, reached)
    far: bool = below_zero(load(s.limits, TIP * WIDTH) - reached)
    return far


@jit_inside
def note_lane(s: BatchState, sums: Tally, out: Samples, kept: BatchSamples, before: float, k: int) -> None:
    """Events and samples of one step of lane k; the gap was `before`."""
    force, h, step = s.work[FORCE, k], s.h[k], s.step[k]
    if force > 0.0:
        sums.contact_steps[k] += 1
        if s.mu[k] > 0.0 and s.work[PULL, k] * s.surface[k] < 0.0 and abs(s.work[PULL, k]) == s.mu[k]:
            sums.reversals[k] += 1
        if sums.closed[k] == 0:
            predicted = s.work[FREE, k]
            part = before / (before - predicted) if before > 0.0 and before > predicted else 0.0
            note_event(sums, out, k, 1, step * h + part * h)
    elif sums.closed[k] == 1:
        note_event(sums, out, k, 0, step * h - 0.5 * h)
    if s.mu[k] > 0.0:
        stuck = force > 0.0 and abs(s.work[PULL, k]) < s.mu[k] * (1.0 - INSIDE)
        note_stick(sums, out, k, int(stuck), step * h)
    if step == kept.due[0, k]:
        row = kept.filled[0, k]
        kept.time[row, k], kept.force[row, k], kept.gap[row, k] = step * h, force, s.work[GAP, k]
        kept.impulse[row, k] = sums.impulse[k]
        kept.filled[0, k] += 1
        kept.due[0, k] += kept.every[0, k]


@jit_inside
def rim_too_far(s: BatchState, k: int) -> bool:
    """Note the rim's deflection in lane k, as `rim_amplitude`; whether that or the tip's motion passes its limit."""
    limits, total = s.limits, 0.0
    for i in range(s.q.shape[0]):
        total += (s.reach[i, k] * s.q[i, k]) ** 2
    limits[REACHED + RIM, k] = max(limits[REACHED + RIM, k], total**0.5)
    return not (limits[REACHED + RIM, k] <= limits[RIM, k] and limits[REACHED + TIP, k] <= limits[TIP, k])


@jit_inside
def keep_state(s: BatchState, kept: BatchSamples, k: int) -> None:
    """Store the displacements of lane k at the start of a step that is due, and the forces of that step."""
    if s.step[k] == kept.due[1, k]:
        row = kept.filled[1, k]
        kept.state_time[row, k] = s.step[k] * s.h[k]
        for i in range(s.q.shape[0]):
            kept.state[row, i, k] = s.q[i, k]
        kept.state[row, s.q.shape[0], k] = s.work[FORCE, k]
        if kept.state.shape[1] > s.q.shape[0] + 1:
            kept.state[row, s.q.shape[0] + 1, k] = -s.work[DRAG, k]
        kept.filled[1, k] += 1
        kept.due[1, k] += kept.every[1, k]


@jit_entry
def advance_batch(
    s: BatchState, flights: BatchFreeFlight, sums: Tally, out: Samples, kept: BatchSamples, rubs: bool, budget: int
) -> None:
    """Step all live lanes, until one is at its end or has failed, or `budget` steps are taken."""
    old, new, Q, Q_next, waves, ahead = s.old, s.d, s.Q, s.Q_next, s.waves, s.waves_next
    for k in range(s.step.size):
        if s.live[k] == 1 and s.step[k] == 0:
            land(s, waves, Q, k, 0, 0.0, new)
    skips, swapped = flights.powers.shape[1] > 0, False
    for _ in range(budget):
        stop = False
        for k in range(s.step.size):
            if s.live[k] == 1:
                if skips and s.step[k] >= s.retry[k] and s.memory[0, k] > 0.0 and s.memory[1, k] > 0.0:
                    room = min(s.end[k], kept.due[0, k], kept.due[1, k]) - s.step[k]
                    skipped = -1 if room <= 0 or sums.closed[k] == 1 else 0
                    if skipped == 0:
                        skipped = skip_in_batch(s, flights, sums, Q, waves, new, k, room)
                    s.retry[k] = s.step[k] + max(1, -skipped)  # not twice at a step, should the loop be left here
                stop = stop or s.step[k] == s.end[k]
        if stop:
            break
        old, new, swapped = new, old, not swapped
        rotate_lanes(s, ahead, 1)
        touching = fly(s, Q_next, ahead, old, new)
        for row in (FORCE, PULL, DRAG, H_, SLIDE, T_N, T_T):
            put(s.work, row * WIDTH, same(0.0))
        put(s.work, SCALE * WIDTH, same(1.0))
        if touching:
            touch(s, Q, Q_next, waves, new, rubs)
        for k in range(s.step.size):
            if s.live[k] == 1:
                keep_state(s, kept, k)
        move_lanes(s, Q, old, new, touching, rubs)
        put(s.work, BEFORE * WIDTH, load(s.memory, 0))
        far = add_up(s, sums, Q, Q_next)
        for k in range(s.step.size):
            if s.live[k] == 1 and s.failed[k] == 0:
                note_lane(s, sums, out, kept, s.work[BEFORE, k], k)
                if (far or s.step[k] % LOOK == 0) and rim_too_far(s, k):
                    s.failed[k] = 2
                s.step[k] += 1
            stop = stop or (s.live[k] == 1 and (s.failed[k] > 0 or s.step[k] == s.end[k]))
        Q, Q_next, waves, ahead = Q_next, Q, ahead, waves
        if stop:
            break
    if swapped:  # the buffers changed places an odd number of times; nothing is computed anew, not to change a bit
        for i in range(s.q.shape[0]):
            put(s.d, i * WIDTH, load(s.old, i * WIDTH))
        for i in range(s.Q.shape[0]):
            put(s.Q, i * WIDTH, load(s.Q_next, i * WIDTH))
        for n in range(2 * s.waves.shape[0]):
            put(s.waves, n * WIDTH, load(s.waves_next, n * WIDTH))
