"""A tip on a coating of bars: force at a depth, rest position of the tip, and yielding.

m bars are under the tip, each with its surface at the depth cut + w, with worn depth w. A bar pressed to depth d has
the force f = k (d - cut - w) >= 0 and yields if that exceeds Y + H w, so that w' = (k (d - cut) - Y)/(k + H); at the
bare casing yielding stops. With the compliance D of the step, d + D sum f(d) = -gap has one root, since sum f grows
with d. `solver.yielding` solves for several tips.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from contact.base.arrays import Array, Indices
from contact.jit.compiled import jit

MOST_ALONE = 100  # Newton steps: piecewise linear, so a few do
ROUND_OFF = 1e-14


class Coating(NamedTuple):
    """Bars around the rim: worn depths (cells,) [m], empty without a coating; cut where the radius was below `round`.

    `thickness`, `mean` clearance [m]; `stiffness`, `hardening` [N/m] and `yield_force` [N] of one bar; `under` is the
    number of bars under the tip. `memory`: energy dissipated [J], elastic energy now [J], depth of the tip [m].
    """

    worn: Array
    round: float
    mean: float
    thickness: float
    stiffness: float
    yield_force: float
    hardening: float
    under: int
    memory: Array


@jit
def first_bar(c: Coating, turns: float) -> int:
    """Index of the first bar under a tip whose middle is at `turns`, an angle in turns."""
    cells = c.worn.size
    return math.floor((turns - math.floor(turns)) * cells - 0.5 * (c.under - 1)) % cells


@jit
def machined(c: Coating, clearance: float) -> float:
    """Machined depth [m] where the rim at rest is `clearance` away: up to the circle, where the rim was narrower."""
    return max(c.round - (clearance - c.mean), 0.0)


@jit
def surface(c: Coating, first: int, cut: float) -> float:
    """Depth of the shallowest bar under the tip [m], where contact begins."""
    low: float = c.worn[first]
    for j in range(1, c.under):
        low = min(low, c.worn[(first + j) % c.worn.size])
    return cut + low


@jit
def worn_by(c: Coating, i: int, cut: float, depth: float) -> float:
    """Worn depth of bar i after the tip has pressed to `depth`."""
    flown = (c.stiffness * (depth - cut) - c.yield_force) / (c.stiffness + c.hardening)
    most: float = max(c.worn[i], min(flown, c.thickness - cut))
    return most


@jit
def borne(c: Coating, first: int, cut: float, depth: float) -> tuple[float, float]:
    """Force of the bars under a tip at `depth`, and its slope; without yielding."""
    force, slope = 0.0, 0.0
    k, yielding = c.stiffness, c.stiffness * c.hardening / (c.stiffness + c.hardening)
    for j in range(c.under):
        i = (first + j) % c.worn.size
        w = worn_by(c, i, cut, depth)
        elastic = depth - cut - w
        if elastic > 0.0:
            force += k * elastic
            slope += yielding if c.worn[i] < w < c.thickness - cut else k
    return force, slope


@jit
def settled(c: Coating, first: int, cut: float, D: float, gap: float) -> float:
    """Depth d of a tip whose free `gap` is below the bars' surface: d + D force(d) = -gap; without yielding."""
    low, high, depth = surface(c, first, cut), -gap, -gap
    for _ in range(MOST_ALONE):
        force, slope = borne(c, first, cut, depth)
        error = depth + D * force + gap
        if abs(error) <= ROUND_OFF * abs(gap):
            break
        if error > 0.0:
            high = depth
        else:
            low = depth
        depth -= error / (1.0 + D * slope)
        if not low < depth < high:
            depth = 0.5 * (low + high)
    return depth


@jit
def wear(c: Coating, first: int, cut: float, depth: float) -> None:
    """Let the bars under the tip yield, and add the dissipated energy: integral of (Y + H w) dw over each bar."""
    c.memory[1], c.memory[2] = 0.0, depth
    for j in range(c.under):
        i = (first + j) % c.worn.size
        before, w = c.worn[i], worn_by(c, i, cut, depth)
        elastic = max(depth - cut - w, 0.0)
        c.memory[0] += (w - before) * (c.yield_force + 0.5 * c.hardening * (before + w))
        c.memory[1] += 0.5 * c.stiffness * elastic * elastic
        c.worn[i] = w


class Coats(NamedTuple):
    """Tracks of bars; the bars of track k are worn[start[k]:start[k + 1]]; K tips, tip j on track[j].

    Per track: `round`, `mean`, `stiffness`, `yield_force`, `hardening`; the others as in `Coating`, `memory` (K, 3).
    `first` bar under each tip now and the `cut` there. Without a coating there are no tracks.
    """

    worn: Array
    start: Indices
    track: Indices
    round: Array
    mean: Array
    thickness: float
    stiffness: Array
    yield_force: Array
    hardening: Array
    under: int
    memory: Array
    first: Indices
    cut: Array


def no_coats() -> Coats:
    """Tips before a surface without coating."""
    none, whole = np.zeros(0), np.zeros(0, dtype=np.int64)
    return Coats(
        worn=none, start=whole, track=whole, round=none, mean=none, thickness=0.0, stiffness=none, yield_force=none,
        hardening=none, under=0, memory=np.zeros((0, 0)), first=whole, cut=none,
    )  # fmt: skip


@jit
def coated(c: Coats) -> bool:
    """Whether there is a coating."""
    return bool(c.track.size > 0)


@jit
def coating_of(c: Coats, j: int) -> Coating:
    """The bars that tip j wears, and its own memory."""
    k = c.track[j]
    return Coating(
        c.worn[c.start[k] : c.start[k + 1]], c.round[k], c.mean[k], c.thickness, c.stiffness[k], c.yield_force[k],
        c.hardening[k], c.under, c.memory[j],
    )  # fmt: skip
