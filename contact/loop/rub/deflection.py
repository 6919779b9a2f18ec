"""Compiled: largest deflection around a rim, as `contact.model.gaps.deflection`, only where it may matter."""

from __future__ import annotations

import math
from typing import NamedTuple

from contact.base.arrays import Array
from contact.jit.compiled import jit, jit_inside
from contact.jit.vector import WIDTH, entry, larger, load, put, same, total
from contact.loop.modal.rows import product
from contact.model.gaps.limits import LARGEST, REACHED, RIM, WATCHED


class RimWaves(NamedTuple):
    """`RimRows` in whole blocks of eight modes, and work arrays."""

    reach: Array  # (lines, width)
    soft: Array  # (lines, lines d)
    rows: Array  # (lines, 2 N + 1, width)
    S: Array  # (lines, 2 N + 1, lines d, 2 N + 1 and zeros to whole blocks), may be empty
    places: Array  # (2, points) cosine and sine of the first half of `places`
    force: Array  # (lines d, 2 N + 1 and zeros) forces of the tips by waves
    z: Array  # (2 N + 1,) motion by waves
    top: Array  # (8,)


@jit
def add_waves(force: Array, N: int, amount: float, c: float, s: float) -> None:
    """Add a force at the angle with this cosine and sine to the forces by waves 1, cos .. cos N, sin .. sin N."""
    x, y = 1.0, 0.0
    force[0] += amount
    for n in range(1, N + 1):
        x, y = x * c - y * s, y * c + x * s
        force[n] += amount * x
        force[N + n] += amount * y


@jit_inside
def strained(rim: RimWaves, line: int) -> None:
    """Add the static deflection of a line under the forces to its motion by waves."""
    for a in range(rim.z.size if rim.S.size > 0 else 0):
        rim.z[a] += product(rim.S[line, a], rim.force)


@jit
def largest_of_waves(z: Array) -> float:
    """Upper bound of the sum of waves over all angles."""
    N, most = z.size // 2, abs(z[0])
    for n in range(1, N + 1):
        most += math.sqrt(z[n] * z[n] + z[N + n] * z[N + n])
    return float(most)


@jit
def largest_around(z: Array, places: Array, top: Array) -> float:
    """Largest magnitude of the sum of waves at the angles theta, pi - theta, and their negatives.

    At theta and -theta together it is |sum of cosines| + |sum of sines|. At pi - theta, cosines of odd waves and sines
    of even ones change sign.
    """
    N, count, none = z.size // 2, places.shape[1], same(0.0)
    most = none
    for p in range(0, count, WIDTH):
        c, s = load(places, p), load(places, count + p)
        c2, s2 = c * c - s * s, (c + c) * s
        x, y, u, v = c, s, c2, s2  # cos n theta and sin n theta of an odd wave, and of the even one after it
        odd_cos, odd_sin, even_cos, even_sin = none, none, same(entry(z, 0)), none
        for n in range(1, N, 2):
            odd_cos = odd_cos + x * same(entry(z, n))
            odd_sin = odd_sin + y * same(entry(z, N + n))
            even_cos = even_cos + u * same(entry(z, n + 1))
            even_sin = even_sin + v * same(entry(z, N + n + 1))
            x, y = x * c2 - y * s2, y * c2 + x * s2
            u, v = u * c2 - v * s2, v * c2 + u * s2
        if N % 2 == 1:
            odd_cos = odd_cos + x * same(entry(z, N))
            odd_sin = odd_sin + y * same(entry(z, 2 * N))
        most = larger(magnitude(even_cos + odd_cos) + magnitude(even_sin + odd_sin), most)
        most = larger(magnitude(even_cos - odd_cos) + magnitude(even_sin - odd_sin), most)
    put(top, 0, most)
    found = 0.0
    for i in range(WIDTH):
        found = max(found, top[i])
    return found


@jit_inside
def magnitude(x: Array) -> Array:
    """Absolute values of the entries."""
    found: Array = larger(x, same(0.0) - x)
    return found


@jit_inside
def most_of(reach: Array, q: Array) -> float:
    """Sum of reach |q|, an upper bound of a line's deflection by its modes."""
    part = same(0.0)
    for i in range(0, reach.size, WIDTH):
        part = part + load(reach, i) * magnitude(load(q, i))
    found: float = total(part)
    return found


@jit_inside
def matters(limits: Array, bound: float, ends: bool) -> bool:
    """Whether a deflection below `bound` may exceed the limit or the largest one so far."""
    return not bound <= max(limits[WATCHED], limits[REACHED + RIM] if ends else limits[LARGEST])


@jit
def note_deflection(limits: Array, rim: RimWaves, ends: bool) -> None:
    """Update the largest deflection; `ends`: whether a deflection beyond the limit in this step ends the run."""
    if not matters(limits, largest_of_waves(rim.z), ends):
        return
    deflected = largest_around(rim.z, rim.places, rim.top)
    limits[LARGEST] = max(limits[LARGEST], deflected)
    if ends:
        limits[REACHED + RIM] = max(limits[REACHED + RIM], deflected)
