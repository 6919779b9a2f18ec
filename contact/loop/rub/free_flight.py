"""Compiled: skip time without contact: how long the gap is certainly open, and the state afterwards.

The contribution of the modes to the gap is at most B = sum_n hypot(sum_i |cos_in| A_i, sum_i |sin_in| A_i) at every
angle and for all time until the next force, with the current amplitude A_i of mode i. Where the clearance exceeds B no
contact is possible.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from contact.base.arrays import Array, Indices
from contact.jit.compiled import jit, jit_inside, jit_vectors
from contact.loop.modal.rows import RowBlocks, fill_some, product
from contact.loop.rub.rows import RubRows
from contact.loop.rub.state import RubState, Work
from contact.record.record import Samples, Tally

LEAST = 6  # steps: a shorter skip saves less than the search for it takes
PAUSE = 16  # steps after a contact before a skip is tried
WAIT = 512  # steps at most between two tries: amplitudes decay meanwhile
MANY = 16  # steps: the same of coupled modes, whose skip costs as much as several steps
FOREVER = 1 << 40


class Pairs(NamedTuple):
    """Coordinates z = x + i y of the free motion of m coupled modes, one for each pair of poles; arrays may be empty.

    Vectors (q, D) and (x, y) have 2 w entries, of w = m in whole blocks of eight.
    """

    into: RowBlocks  # (2 w, 2 w) from (q, D) to (x, y)
    back: RowBlocks  # (2 w, 2 w)
    most: Array  # (m,) that |z| = 1 moves the gap at any angle
    damping: RowBlocks  # (2 w, 2 w) upper triangle of the energy that damping changes
    false: RowBlocks  # (2 w, 2 w) of that which the scheme changes; empty if it changes none
    room: Array  # (3, 2 w) work space


class FreeFlight(NamedTuple):
    """Maps over 2^j steps, coefficients of the amplitudes, least clearance by angle.

    `powers` is empty if no step is skipped. Of coupled modes it maps the coordinates of `pairs`, and the fields from
    `cos` to `row` are empty.
    """

    powers: Array  # (bits, 4, m): (q, D) -> (q, D), entries 11, 12, 21, 22
    fade: Array  # (m,) e^{-a h}
    cos: Array  # (m,) cos w_d h
    sin: Array
    start: Indices  # terms of mode i, as in `contact.model.trig.Terms`
    wave: Indices
    row: Array
    floor: Array  # (cells,) least clearance of each cell of the contact angle
    reach: Array  # (2 (highest harmonic + 1),), work space
    taken: Indices  # (2,): skips taken, steps in them
    pairs: Pairs


@jit
def amplitude(q: float, d: float, fade: float, cos: float, sin: float) -> float:
    """Bound of |q| from now on without force; inf for a moving rigid mode."""
    if sin == 0.0:
        return abs(q) if d == 0.0 else math.inf
    other = (q * cos - fade * (q - d)) / sin
    return math.sqrt(q * q + other * other)


@jit_vectors
def largest_share(flight: FreeFlight, q: Array, d: Array) -> float:
    """Bound B of the modes' contribution to the gap at any angle and later time without force."""
    reach = flight.reach
    reach[:] = 0.0
    for i in range(q.size):
        A = amplitude(q[i], d[i], flight.fade[i], flight.cos[i], flight.sin[i])
        for j in range(flight.start[i], flight.start[i + 1]):
            reach[flight.wave[j]] += A * abs(flight.row[j])
    total = 0.0
    for n in range(0, reach.size, 2):
        total += math.sqrt(reach[n] * reach[n] + reach[n + 1] * reach[n + 1])
    return total


@jit_vectors
def open_steps(floor: Array, bound: float, phi: float, turn: float) -> int:
    """Number of steps from angle phi on, `turn` apart, at which the clearance certainly exceeds `bound`.

    If the first step is not one of them: minus the number of steps after which it may be.
    """
    cells = floor.size
    place = phi / (2.0 * math.pi)
    place = (place - math.floor(place)) * cells
    cell = min(int(place), cells - 1)
    stride = abs(turn) * cells / (2.0 * math.pi)
    is_open = floor[cell] > bound
    if stride < 1e-12:
        return FOREVER if is_open else -WAIT
    distance = place - cell if turn < 0.0 else cell + 1 - place
    for _ in range(cells):
        cell += -1 if turn < 0.0 else 1
        if cell < 0:
            cell = cells - 1
        elif cell == cells:
            cell = 0
        if (floor[cell] > bound) != is_open:
            steps = int((distance - 1e-6) / stride) + 1 if distance > 1e-6 else 0
            return steps if is_open else -min(steps + 1, WAIT)
        distance += 1.0
    return FOREVER if is_open else -WAIT


@jit_vectors
def propagate(q: Array, d: Array, powers: Array, steps: int) -> None:
    """Advance (q, D) by `steps` steps of free motion."""
    j = 0
    while steps > 0:
        if steps & 1:
            for i in range(q.size):
                x, y = q[i], d[i]
                q[i] = powers[j, 0, i] * x + powers[j, 1, i] * y
                d[i] = powers[j, 2, i] * x + powers[j, 3, i] * y
        steps >>= 1
        j += 1


@jit
def discrete_energy(q: Array, d: Array, be: Array, c: Array) -> float:
    """D^T D/(2 c) + omega^2 q_{n-1} q_n/2; its decrease during a skip is the work of damping."""
    total = 0.0
    for i in range(q.size):
        total += 0.5 * (d[i] * d[i] + be[i] * (q[i] - d[i]) * q[i]) / c[i]
    return total


@jit
def skip_free_flight(flight: FreeFlight, q: Array, d: Array, phi: float, turn: float, room: int) -> int:
    """Skip steps while contact is impossible, at most `room`; phi is the angle of the next gap.

    Returns the number of skipped steps, or minus the number of steps to wait before the next attempt.
    """
    bound = largest_share(flight, q, d)
    steps: int = min(open_steps(flight.floor, bound, phi, turn), room, (1 << flight.powers.shape[0]) - 1)
    if steps < 0:
        return steps
    if steps < LEAST:
        return -(steps + 1)
    propagate(q, d, flight.powers, steps)
    flight.taken[0] += 1
    flight.taken[1] += steps
    return steps


@jit_inside
def untouched(out: Samples, sums: Tally, step: int) -> int:
    """Number of steps from `step` to the next stored one; none if `step` is stored."""
    if out.every == 0:
        row = max(sums.filled[0], sums.filled[1])
        return int(out.at[row] - step) if row < out.at.size else FOREVER
    return int(-step % out.every)  # state_every is a multiple


@jit
def may_skip(s: RubState, sums: Tally) -> bool:
    """Whether the only tip was open in the last two steps."""
    return bool(sums.closed[0] == 0 and (s.known[0] == 0 or (s.now[0] > 0.0 and s.last[0] > 0.0)))


@jit
def skip_ahead(s: RubState, rows: RubRows, flight: FreeFlight, w: Work, angle: float, turn: float, room: int,
               sums: Tally) -> int:  # fmt: skip
    """Skip at most `room` steps without contact; `angle`: turned so far, `turn`: in a step. Negative: steps to wait."""
    m = flight.fade.size
    q, own, be, c = s.q[:m], s.d[:m], s.be[:m], s.c[:m]
    before = discrete_energy(q, own, be, c)
    steps = skip_free_flight(flight, q, own, rows.angle[0] - (angle + turn), -turn, room)
    if steps <= 0:
        return steps
    if loses(s.weight):
        sums.damping[0] += discrete_energy(q, own, be, c) - before
    s.known[0], s.inside[0] = 0, 0
    for side in range(2):
        w.fresh[side, 0] = 0
    return steps


@jit_inside
def form_of(triangle: RowBlocks, x: Array, y: Array) -> float:
    """Quadratic form of x with this upper triangle, 0 if it is empty; y is work space."""
    if triangle.wave.size == 0:
        return 0.0
    fill_some(triangle, x, 0, y)
    result: float = product(x, y)
    return result


@jit
def skip_coupled(s: RubState, rows: RubRows, flight: FreeFlight, w: Work, angle: float, turn: float, room: int,
                 sums: Tally) -> int:  # fmt: skip
    """Like `skip_ahead`, for coupled modes."""
    if room < MANY:
        return -(room + 1)
    m, n, pairs = flight.fade.size, s.q.size, flight.pairs
    x, z, y = pairs.room[0], pairs.room[1], pairs.room[2]
    for i in range(n):
        x[i], x[n + i] = s.q[i], s.d[i]
    fill_some(pairs.into, x, 0, z)
    bound = 0.0
    for k in range(m):
        bound += pairs.most[k] * math.sqrt(z[k] * z[k] + z[n + k] * z[n + k])
    clear: int = open_steps(flight.floor, bound, rows.angle[0] - (angle + turn), -turn)
    if clear < 0:
        return clear
    steps: int = min(clear, room, (1 << flight.powers.shape[0]) - 1)
    if steps < MANY:
        return -(steps + 1)
    damped, made = form_of(pairs.damping, x, y), form_of(pairs.false, x, y)
    propagate(z[:m], z[n : n + m], flight.powers, steps)
    fill_some(pairs.back, z, 0, x)
    for i in range(n):
        s.q[i], s.d[i] = x[i], x[n + i]
    sums.damping[0] += form_of(pairs.damping, x, y) - damped
    sums.algorithmic[0] += form_of(pairs.false, x, y) - made
    flight.taken[0] += 1
    flight.taken[1] += steps
    s.known[0], s.inside[0] = 0, 0
    for side in range(2):
        w.fresh[side, 0] = 0
    return steps


@jit
def loses(weight: Array) -> bool:
    """Whether any mode is damped."""
    found = False
    for i in range(weight.size):
        found |= weight[i] != 0.0
    return found
