"""The one-step problem of tips against coatings: depths of the tips and forces of Coulomb's law together.

    u = W force + b,   tip j presses to d_j = -u_Nj where force_Nj = F_j(d_j) > 0,

F_j what the bars under it bear (`solver.abradable`), piecewise linear and never falling; tangential forces obey
Coulomb's law as on a rigid rim. Newton's method: each tip alone, with the other forces as they are, has one depth; the
piece of F_j there is a spring of 1/F'_j in series with W, which leaves rigid contacts with friction
(`friction_forces`). One tip is done after one step, several after a few; where these do not close in, they are halved.
Alone: m bars lie under the tip, each with its surface at the depth cut + w, w what is worn. Pressed by d it carries
f = k (d - cut - w) >= 0 and flows where that exceeds Y + H w, so that w' = (k (d - cut) - Y)/(k + H); at the bare
casing flow stops. With D the compliance of the step, d + D sum f(d) = -gap has one root: d -> sum f grows.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from contact.base.arrays import Array, Indices
from contact.jit.compiled import jit
from contact.solver.dense import affine, assign
from contact.solver.friction.all_sliding import AllSliding
from contact.solver.friction.coulomb import friction_forces
from contact.solver.friction.newton import TOLERANCE
from contact.solver.friction.one_contact import JAMMED
from contact.solver.friction.room import BEHIND, GUESS, MOTION, SOFT, Room

MOST_ALONE = 100  # Newton steps: piecewise linear, so a few do
ROUND_OFF = 1e-14
MOST = 200  # Newton steps: piecewise linear, so a few do
NEAR = 1e-11  # of the largest depth or gap: what the depths may miss
FLAT = 1e-8  # of a bar's stiffness: the least slope of F, where bars flow without hardening
CLOSER, LONGER, SHORTEST = 0.9, 1.3, 1.0 / 32.0  # what a step should leave; how its part grows; its least part


class Coating(NamedTuple):
    """Bars around the rim: worn depths (cells,) [m], empty without a coating; cut where the radius was below `round`.

    `thickness`, `mean` clearance [m]; `stiffness`, `hardening` [N/m] and `yield_force` [N] of one bar; `under` bars lie
    under the tip. `memory`: energy dissipated [J], elastic energy now [J], depth of the tip [m].
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
    """Number of the first bar under a tip in the middle of `turns`, an angle in turns."""
    cells = c.worn.size
    return math.floor((turns - math.floor(turns)) * cells - 0.5 * (c.under - 1)) % cells


@jit
def machined(c: Coating, clearance: float) -> float:
    """Depth of the cut [m] where the rim at rest is `clearance` away: up to the circle, where it was narrower."""
    return max(c.round - (clearance - c.mean), 0.0)


@jit
def surface(c: Coating, first: int, cut: float) -> float:
    """Depth of the shallowest bar under the tip [m]: where it touches first."""
    low: float = c.worn[first]
    for j in range(1, c.under):
        low = min(low, c.worn[(first + j) % c.worn.size])
    return cut + low


@jit
def worn_by(c: Coating, i: int, cut: float, depth: float) -> float:
    """Worn depth of bar i once the tip has pressed to `depth`."""
    flown = (c.stiffness * (depth - cut) - c.yield_force) / (c.stiffness + c.hardening)
    most: float = max(c.worn[i], min(flown, c.thickness - cut))
    return most


@jit
def borne(c: Coating, first: int, cut: float, depth: float) -> tuple[float, float]:
    """Force of the bars under a tip that presses to `depth`, and its slope; nothing flows yet."""
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
    """Depth d of a tip whose free `gap` is below the bars' surface: d + D force(d) = -gap; nothing flows yet."""
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
def crush(c: Coating, first: int, cut: float, D: float, gap: float) -> float:
    """Force of the tip on the bars under it, which flow; JAMMED where D <= 0."""
    if not D > 0.0:
        return JAMMED
    depth = settled(c, first, cut, D, gap)
    wear(c, first, cut, depth)
    return max(-(gap + depth) / D, 0.0)


@jit
def force_on(c: Coating, first: int, cut: float, D: float, gap: float) -> float:
    """Force of the tip; nothing flows yet."""
    return max(-(gap + settled(c, first, cut, D, gap)) / D, 0.0)


@jit
def wear(c: Coating, first: int, cut: float, depth: float) -> None:
    """Let the bars under the tip flow, and add what that dissipates: integral of (Y + H w) dw over each bar."""
    c.memory[1], c.memory[2] = 0.0, depth
    for j in range(c.under):
        i = (first + j) % c.worn.size
        before, w = c.worn[i], worn_by(c, i, cut, depth)
        elastic = max(depth - cut - w, 0.0)
        c.memory[0] += (w - before) * (c.yield_force + 0.5 * c.hardening * (before + w))
        c.memory[1] += 0.5 * c.stiffness * elastic * elastic
        c.worn[i] = w


class Coats(NamedTuple):
    """Tracks of bars, the bars of track k at worn[start[k]:start[k + 1]]; K tips, tip j on track[j].

    Per track: `round`, `mean`, `stiffness`, `yield_force`, `hardening`; the others as in `Coating`, `memory` (K, 3).
    `first` bar under each tip now and the `cut` there.
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


@jit
def coating_of(c: Coats, j: int) -> Coating:
    """The bars that tip j wears, and its own memory."""
    k = c.track[j]
    return Coating(
        c.worn[c.start[k] : c.start[k + 1]], c.round[k], c.mean[k], c.thickness, c.stiffness[k], c.yield_force[k],
        c.hardening[k], c.under, c.memory[j],
    )  # fmt: skip


@jit
def crush_tips(c: Coats, tips: Indices, W: Array, b: Array, mu: Array, dim: int, count: int, force: Array,
               depth: Array, start: AllSliding, room: Room) -> bool:  # fmt: skip
    """Improve `force` (d n,) of n = `count` tips and find `depth` (n,) so that both laws hold; False where they do not.

    Nothing flows yet.
    """
    size = count * dim
    soft, short, trial, u = room.matrices[SOFT], room.vectors[BEHIND], room.vectors[GUESS], room.vectors[MOTION]
    for i in range(size):
        assign(soft[i], W[i], size)
    assign(short, b, size)
    assign(trial, force, size)
    affine(W, force, b, u, size)
    part, last = 1.0, math.inf
    for step in range(MOST):
        miss, scale = 0.0, 0.0
        for a in range(count):
            i = a * dim
            tip, first, cut = coating_of(c, tips[a]), c.first[tips[a]], c.cut[tips[a]]
            D, low = own_compliance(W, i, dim, force), surface(tip, first, cut)
            gap = u[i] - D * force[i]
            depth[a] = settled(tip, first, cut, D, gap) if -gap > low else low
            bears, slope = borne(tip, first, cut, depth[a])
            slope = max(slope, FLAT * tip.stiffness) if bears > 0.0 else tip.stiffness
            soft[i, i] = W[i, i] + 1.0 / slope
            short[i] = b[i] + depth[a] - bears / slope
            miss = max(miss, abs(bears - force[i]) / (slope + 1.0 / D))
            scale = max(scale, abs(b[i]), depth[a])
        if step > 0 and part == 1.0 and miss <= NEAR * scale:
            return True
        if miss > CLOSER * last and miss > NEAR * scale:
            part = max(0.5 * part, SHORTEST)
        else:
            part = min(LONGER * part, 1.0)
        last = miss
        if dim > 1 and count > 1:
            start(soft, short, mu, dim, count, trial, room)
        _, left = friction_forces(soft, short, mu, dim, count, trial, room)
        if not left <= TOLERANCE:
            return False
        for i in range(size):
            force[i] = trial[i] if part == 1.0 else force[i] + part * (trial[i] - force[i])
        affine(W, force, b, u, size)
    return False


@jit
def own_compliance(W: Array, i: int, dim: int, force: Array) -> float:
    """Gap that a tip's own force opens, with the share of friction in it that there is now."""
    D: float = W[i, i]
    if force[i] > 0.0:
        for j in range(i + 1, i + dim):
            D += W[i, j] * force[j] / force[i]
    return D if D > 0.0 else W[i, i]
