"""Compiled: positions of the tips of a rub, their gaps, and the casing's rows there."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from contact.base.arrays import Array, Indices
from contact.jit.compiled import jit, jit_inside
from contact.jit.vector import WIDTH, entry, load, same, total
from contact.loop.modal.rows import RowBlocks, fill_some, multiples, product
from contact.loop.rub.deflection import RimWaves

# rows of `angles`: what is turned at t_{n-1}, t_n, t_{n+1}, and the middle of the cell of t_{n+1}; with cosine and sine
BEFORE, NOW, AHEAD, MIDDLE = 0, 1, 2, 3
CELL = 1.0 / 16.0  # [rad]
TAIL = np.repeat([0.0, 1.0], WIDTH)  # eight entries from number n on keep the last n of eight


class Terms(NamedTuple):
    """A trigonometric polynomial of the contact angle."""

    harmonic: Indices
    cos: Array
    sin: Array


@jit
def polynomial(terms: Terms, waves: Array) -> float:
    """Value of the polynomial at the angle of `waves`."""
    value = 0.0
    for j in range(terms.harmonic.size):
        n = terms.harmonic[j]
        value += terms.cos[j] * waves[0, n] + terms.sin[j] * waves[1, n]
    return value


class Pulls(NamedTuple):
    """Body forces by their rows (`BodyForce.row`), and the participation of the modes along x and y."""

    laws: Array  # (forces, 8)
    plane: Array  # (2, m)
    casing: int  # modes of the casing, which come first


class Swing(NamedTuple):
    """The unbalance of a rotor; without rows if there is none."""

    jumps: Array  # (jumps, 4): from [s], 1/h, and what the unbalance gains along the rotor's x and y [kg m]
    plane: Array  # (2, modes of the rotor): motion of the unbalance along x and y
    first: int  # number of the first mode of the rotor


class Spin(NamedTuple):
    """The angle of a rotor whose speed follows from its torques: mode number `mode`, -1 if the speed is given."""

    mode: int
    scale: float  # 1/sqrt(inertia)
    drive: float  # constant torque [N m]
    now: Array  # (3,): torque other than drive and friction, all rotation work until now, work of new coefficients
    sums: Array  # of `contact.record.spin`


class RubLaws(NamedTuple):
    """Laws that are known before the run: rows of the tables in `model.rub_laws`."""

    speed: Array  # (segments, 4): from, angle, omega, slope
    closing: Array  # (points, 2): time, reduction
    whirl: Array  # (offsets, 4): amplitude, per_rev, rad/s, phase
    terms: Terms  # of the profile
    table: Array  # (points, 3) of the profile, may be empty
    lowest: float  # of the profile
    pulls: Pulls
    swing: Swing
    spin: Spin


class RubRows(NamedTuple):
    """Casing rows by harmonic and block (block = directions line + direction); the tips; residual compliance by angle.

    Rows over the casing's modes are filled up with zeros to whole blocks of eight, `width` in all. For a single tip the
    rows also contain its blade's modes, which do not rotate; then `apart` is empty and `fixed` zero.
    """

    casing: RowBlocks
    width: int
    many: bool  # whether the loop computes the casing's motion by waves, not by a row for each tip
    seen: RowBlocks  # waves of the casing's motion by its modes, `waves` of each block; empty unless `many`
    reach: Array  # (lines, width): bound of |normal row| over the angle
    rim: RimWaves  # what its deflection is computed from
    directions: int
    line: Indices  # (K,)
    place: Indices  # (K,) number of the tip's (line, angle): tips at one place share their rows
    glide: Array  # (K d,) slip along each direction per unit of rotation: the radius, or the velocity of the ground
    angle: Array  # (K,)
    heading: Array  # (K, 2) its cosine and sine
    clearance: Array  # (K,)
    blade: Array  # (K d, widest blade)
    own: Indices  # (K, 2)
    apart: Indices  # (K, 2): those of its blade's modes that the casing's rows leave out; none where they hold them
    fixed: Array  # (K d, K d): response of the blades' modes to a force within a step
    still: Array  # (K d, K d) residual compliance that does not turn
    turns: bool  # whether there is any that does
    steady: bool  # whether no row depends on time: all contacts are near at every step, and have rows of their own
    W: Array  # (K d, K d) matrix of the contacts where it never changes and forces are solved for, else empty
    cell: float  # angle over which W is interpolated, 0 where it is not [rad]
    form: RowBlocks  # as `S` between waves, and with what the modes yield, where it is
    cells: float  # in a radian, in which rows of a single tip are power series; 0 where they are sums of waves [1/rad]
    few: bool  # whether `S` is that between the tips by its own angle, a row each; else that between waves, by block
    S: RowBlocks
    harmonics: int  # waves that the rows, the profile and S take, in whole blocks


@jit
def turned(speed: Array, t: float) -> tuple[float, float]:
    """Angle turned since t = 0, and speed Omega."""
    i = speed.shape[0] - 1
    while i > 0 and t < speed[i, 0]:
        i -= 1
    since = t - speed[i, 0]
    return speed[i, 1] + speed[i, 2] * since + 0.5 * speed[i, 3] * since * since, speed[i, 2] + speed[i, 3] * since


@jit
def spun(spin: Spin, angle: float, q: float) -> float:
    """Angle turned by a rotor that leads by the modal coordinate q; it turns against the angle of the casing."""
    return angle - spin.scale * q


@jit
def look_at(angles: Array, when: int, angle: float) -> None:
    """Fill a row of `angles`."""
    angles[when, 0], angles[when, 1], angles[when, 2] = angle, math.cos(angle), math.sin(angle)


@jit
def look_ahead(angles: Array, angle: float) -> None:
    """Fill the row of t_{n+1} by a series about the middle of the cell that contains the angle, exact to round-off.

    The middle depends on the angle alone, so that a run in several parts gives identical results.
    """
    middle = CELL * math.floor(angle / CELL + 0.5)
    if not middle == angles[MIDDLE, 0]:
        look_at(angles, MIDDLE, middle)
    x, c, s = angle - middle, angles[MIDDLE, 1], angles[MIDDLE, 2]
    y = x * x
    sin = x - x * y * (1.0 / 6.0 - y * (1.0 / 120.0 - y * (1.0 / 5040.0 - y / 362880.0)))
    less = y * (0.5 - y * (1.0 / 24.0 - y * (1.0 / 720.0 - y / 40320.0)))  # 1 - cos x
    angles[AHEAD, 0], angles[AHEAD, 1], angles[AHEAD, 2] = angle, c - (c * less + s * sin), s - (s * less - c * sin)


@jit
def waves_at(rows: RubRows, j: int, angles: Array, when: int, waves: Array) -> None:
    """Waves at tip j by the addition theorem: one sine and cosine a step serve all tips."""
    cos, sin, c, s = rows.heading[j, 0], rows.heading[j, 1], angles[when, 1], angles[when, 2]
    multiples(waves, cos * c + sin * s, sin * c - cos * s)


@jit
def straight(table: Array, t: float) -> float:
    """Piecewise linear table, constant outside its range."""
    last = table.shape[0] - 1
    if t <= table[0, 0]:
        return float(table[0, 1])
    if t >= table[last, 0]:
        return float(table[last, 1])
    low, high = 0, last
    while high - low > 1:
        middle = (low + high) // 2
        if table[middle, 0] <= t:
            low = middle
        else:
            high = middle
    share = (t - table[low, 0]) / (table[high, 0] - table[low, 0])
    return float(table[low, 1] + share * (table[high, 1] - table[low, 1]))


@jit
def hermite(table: Array, phi: float) -> float:
    """Periodic piecewise cubic, zero for an empty table."""
    last = table.shape[0] - 1
    if last < 0:
        return 0.0
    turns = math.floor((phi - table[0, 0]) / (2.0 * math.pi))
    at = phi - 2.0 * math.pi * turns
    low, high = 0, last
    while high - low > 1:
        middle = (low + high) // 2
        if table[middle, 0] <= at:
            low = middle
        else:
            high = middle
    h = table[high, 0] - table[low, 0]
    s = (at - table[low, 0]) / h
    r = 1.0 - s
    left = (1.0 + 2.0 * s) * r * r * table[low, 1] + s * r * r * h * table[low, 2]
    return float(left + s * s * (3.0 - 2.0 * s) * table[high, 1] - s * s * r * h * table[high, 2])


@jit
def fill_block(rows: RubRows, block: int, waves: Array, row: Array) -> None:
    """One row of the casing at the angle of `waves`."""
    fill_some(rows.casing, waves, block * (rows.width // WIDTH), row)


@jit
def rigid_gap(laws: RubLaws, rows: RubRows, j: int, t: float, angles: Array, when: int, waves: Array) -> float:
    """Gap at tip j without its own clearance, closing and deflection; leaves the waves at the tip in `waves`."""
    angle = angles[when, 0]
    phi = rows.angle[j] - angle
    waves_at(rows, j, angles, when, waves)
    gap = polynomial(laws.terms, waves) + hermite(laws.table, phi)
    for w in range(laws.whirl.shape[0]):
        beta = laws.whirl[w, 3] + laws.whirl[w, 1] * angle + laws.whirl[w, 2] * t
        gap += laws.whirl[w, 0] * math.cos(phi - beta)
    return float(gap)


@jit
def least_gap(laws: RubLaws, rows: RubRows, j: int, closing: float) -> float:
    """Lower bound of the tip's clearance plus `rigid_gap`, without trigonometric functions."""
    gap = rows.clearance[j] - closing + laws.lowest
    for w in range(laws.whirl.shape[0]):
        gap -= laws.whirl[w, 0]
    return float(gap)


@jit_inside
def blade_dot(rows: RubRows, modes: Indices, row: int, j: int, values: Array) -> float:
    """Product of a row of the tip's own blade (`rows.own` or `rows.apart`) in one direction with `modes`."""
    found, first = 0.0, row * rows.blade.shape[1] - entry(rows.own, 2 * j)
    i, end = entry(modes, 2 * j), entry(modes, 2 * j + 1)
    if end - i < WIDTH:
        while i < end:
            found += entry(rows.blade, first + i) * entry(values, i)
            i += 1
        return found
    part = same(0.0)
    while i + WIDTH <= end:
        part = part + load(rows.blade, first + i) * load(values, i)
        i += WIDTH
    if i < end:
        last = end - WIDTH
        part = part + load(TAIL, end - i) * load(rows.blade, first + last) * load(values, last)
    result: float = total(part)
    return result


@jit_inside
def blade_dot_of_sum(rows: RubRows, modes: Indices, row: int, j: int, some: Array, others: Array) -> float:
    """Like `blade_dot`, for the sum of two vectors of modes."""
    found, first = 0.0, row * rows.blade.shape[1] - entry(rows.own, 2 * j)
    i, end = entry(modes, 2 * j), entry(modes, 2 * j + 1)
    if end - i < WIDTH:
        while i < end:
            found += entry(rows.blade, first + i) * (entry(some, i) + entry(others, i))
            i += 1
        return found
    part = same(0.0)
    while i + WIDTH <= end:
        part = part + load(rows.blade, first + i) * (load(some, i) + load(others, i))
        i += WIDTH
    if i < end:
        last = end - WIDTH
        both = load(some, last) + load(others, last)
        part = part + load(TAIL, end - i) * load(rows.blade, first + last) * both
    result: float = total(part)
    return result


@jit
def gap_of(laws: RubLaws, rows: RubRows, j: int, t: float, angles: Array, when: int, dim: int, q: Array,
           waves: Array, row: Array) -> float:  # fmt: skip
    """Gap of tip j for the modal coordinates q, without residual compliance; leaves its casing row in `row`."""
    rigid = rows.clearance[j] + rigid_gap(laws, rows, j, t, angles, when, waves) - straight(laws.closing, t)
    fill_block(rows, rows.line[j] * rows.directions, waves, row)
    return float(rigid + product(row, q) + blade_dot(rows, rows.apart, j * dim, j, q))
