"""The one-step problem of several tips against coatings: depths of the tips and forces of Coulomb's law together.

    u = W force + b,   tip j presses to d_j = -u_Nj where force_Nj = F_j(d_j) > 0,

F_j what the bars under it bear (`solver.abradable`), piecewise linear and never falling; tangential forces obey
Coulomb's law as on a rigid rim. Newton's method: each tip alone, with the other forces as they are, has one depth; the
piece of F_j there is a spring of 1/F'_j in series with W, which leaves rigid contacts with friction
(`friction_forces`). One tip is done after one step, several after a few; where these do not close in, they are halved.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from contact.base.arrays import Array, Indices
from contact.jit.compiled import jit
from contact.solver.abradable.one_tip import Coating, borne, settled, surface
from contact.solver.dense import affine, assign
from contact.solver.friction.all_sliding import AllSliding
from contact.solver.friction.coulomb import friction_forces
from contact.solver.friction.newton import TOLERANCE
from contact.solver.friction.room import BEHIND, GUESS, MOTION, SOFT, Room

MOST = 200  # Newton steps: piecewise linear, so a few do
NEAR = 1e-11  # of the largest depth or gap: what the depths may miss
FLAT = 1e-8  # of a bar's stiffness: the least slope of F, where bars flow without hardening
CLOSER, LONGER, SHORTEST = 0.9, 1.3, 1.0 / 32.0  # what a step should leave; how its part grows; its least part


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
