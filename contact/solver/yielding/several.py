"""Contact problem of one step for compliant contacts, on a coating or with a force-depth law: depths and forces.

    u = W force + b,   contact j has the depth d_j = -u_Nj and force_Nj = max(F_j(d_j), 0) if u_Nj < 0,

with F_j the force of the coating's bars (`solver.abradable`) or of the law. Tangential forces obey Coulomb's law as in
rigid contacts. Newton's method: each contact alone, with the other forces fixed, has one depth; the slope of F_j there
is a spring of 1/F'_j in series with W, which leaves rigid contacts with friction (`friction_forces`). One contact needs
one step, several need a few; steps that do not converge are halved.
"""

from __future__ import annotations

import math
from typing import Any

from numba import types

from contact.base.arrays import Array, Indices
from contact.jit.bundle import Bundle, function_type
from contact.jit.compiled import MATRIX, VECTOR, ByAddress, VectorPipeline, jit
from contact.solver.abradable.tips import Coats, borne, coated, coating_of, no_coats, settled, surface
from contact.solver.dense import affine, assign
from contact.solver.friction.all_sliding import AllSliding
from contact.solver.friction.coulomb import friction_forces
from contact.solver.friction.newton import TOLERANCE
from contact.solver.friction.room import BEHIND, GUESS, MOTION, SOFT, Room, friction_room
from contact.solver.yielding.yields import Yielding, bears, gives_way, no_law, pressed

MOST = 200  # Newton steps: a few do
NEAR = 1e-11  # of the largest depth or gap: largest error of the depths
FLAT = 1e-8  # of a bar's stiffness, or of 1/D: the least slope of F, where bars flow without hardening or a law is flat
INDICES: Any = types.Array(types.int64, 1, "C")
CLOSER, LONGER, SHORTEST = 0.9, 1.3, 1.0 / 32.0  # error to reach; growth of the fraction of a step; least fraction


@jit
def alone(c: Coats, y: Yielding, k: int, D: float, gap: float) -> tuple[float, float, float]:
    """Depth of contact k alone, its force and slope > 0; for an open contact the slope at first touch."""
    if coated(c):
        tip, first, cut = coating_of(c, k), c.first[k], c.cut[k]
        low = surface(tip, first, cut)
        depth = settled(tip, first, cut, D, gap) if -gap > low else low
        force, slope = borne(tip, first, cut, depth)
        return depth, force, max(slope, FLAT * tip.stiffness) if force > 0.0 else tip.stiffness
    if gap < 0.0 and gives_way(y):
        depth = pressed(y, k, D, gap)
        if depth == 0.0:
            return 0.0, -gap / D, 1.0 / (FLAT * D)
        force, slope = bears(y, k, depth)
        if force > 0.0:
            return depth, force, max(slope, FLAT / D)
        return -gap, 0.0, FLAT / D  # it opens faster than its law follows
    return 0.0, 0.0, 1.0 / D


def yielding_forces(c: Coats, y: Yielding, tips: Indices, W: Array, b: Array, mu: Array, dim: int,
                    count: int, force: Array, depth: Array, start: AllSliding, room: Room) -> bool:  # fmt: skip
    """Improve `force` (d n,) of n = `count` tips and find `depth` (n,) that satisfy both laws.

    Returns False if that fails.

    Bars do not yield yet.
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
            D = own_compliance(W, i, dim, force)
            depth[a], found, slope = alone(c, y, tips[a], D, u[i] - D * force[i])
            soft[i, i] = W[i, i] + 1.0 / slope
            short[i] = b[i] + (depth[a] - found / slope if found > 0.0 else 2.0 * depth[a])  # clearly open without one
            miss = max(miss, abs(found - force[i]) / (slope + 1.0 / D))
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


class YieldingForces(ByAddress):
    """`yielding_forces` as a function address, so that loops of rigid contacts do not contain its code."""

    kind: Any = types.boolean(
        Bundle(no_coats()).kind, Bundle(no_law()).kind, INDICES, MATRIX, VECTOR, VECTOR, types.int64, types.int64,
        VECTOR, VECTOR, function_type(AllSliding, AllSliding(used=False)), Bundle(friction_room(1, 1)).kind,
    )  # fmt: skip
    function = staticmethod(yielding_forces)
    pipeline = VectorPipeline


@jit
def own_compliance(W: Array, i: int, dim: int, force: Array) -> float:
    """Gap that a tip's own force opens, with the current effect of friction."""
    D: float = W[i, i]
    if force[i] > 0.0:
        for j in range(i + 1, i + dim):
            D += W[i, j] * force[j] / force[i]
    return D if D > 0.0 else W[i, i]
