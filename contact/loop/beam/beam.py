"""Compiled step loop of a hinged beam inside a circle: central differences, contact at every node."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from contact.base.arrays import Array, Indices
from contact.jit.compiled import jit, jit_entry
from contact.loop.tally import note_contact, store, store_state
from contact.record.record import Samples, Tally
from contact.solver.dense import cholesky, dot
from contact.solver.unilateral.active_set import ActiveSpace, active_space, project

INTERNAL, MOMENT = 0, 1  # entries of `ledger`


class BeamState(NamedTuple):
    """Nodes x_n and their last increments (n, 3), ring modes, and the coefficients of the equations."""

    x: Array
    d: Array
    rate: Array  # h^2/mass, zero where held
    load: Array
    rest: float  # element length
    EA: float
    EI: float
    inner: Array  # internal forces (n, 3)
    q: Array  # ring modes
    dq: Array
    al: Array
    be: Array
    c: Array
    rows: Array  # (2N + 1, m)
    S: Array  # (2N + 1, 2N + 1)
    radius: float
    offset: float
    push: Array  # unit vectors of the contact forces on the nodes (n, 2)
    waves: Array  # interface functions at the nodes (n, 2N + 1)
    phi: Array  # rows of the ring at the nodes (n, m)
    rim: Array  # radial displacement of the rim by interface function (2N + 1,)
    free: Array  # gaps of the free step (n,)
    before: Array  # gaps of the last step, per contact (n - 1,)
    force: Array
    gap: Array
    scale: Array  # Delassus numbers
    ledger: Array  # work done against internal forces; impulse of the contacts' moment about the hinge


class BeamWork(NamedTuple):
    """Work arrays: increments and coordinates of the last step, and the contact problem of the chosen nodes."""

    old: Array  # (n, 3)
    old_q: Array
    seen: Array  # (3 n,) what is stored of a step
    chosen: Indices  # (n,)
    inside: Indices  # (n,)
    W: Array  # (n, n)
    A: Array  # (n, n), A A^T = W
    b: Array  # (n,)
    push: Array  # (n,), forces
    moved: Array  # ring modes
    pressed: Array  # (2N + 1,)
    radial: Array  # (2N + 1,)
    active: ActiveSpace


def beam_work(s: BeamState) -> BeamWork:
    """Work arrays of a run."""
    n, m, p = len(s.x), s.q.size, s.rim.size
    return BeamWork(
        old=np.zeros((n, 3)), old_q=np.zeros(m), seen=np.zeros(3 * n), chosen=np.zeros(n, dtype=np.int64),
        inside=np.zeros(n, dtype=np.int64), W=np.zeros((n, n)), A=np.zeros((n, n)), b=np.zeros(n), push=np.zeros(n),
        moved=np.zeros(m), pressed=np.zeros(p), radial=np.zeros(p), active=active_space(n, n),
    )  # fmt: skip


@jit
def strain_energy_and_forces(x: Array, rest: float, EA: float, EI: float, out: Array) -> float:
    """Fill `out` (n, 3) with internal forces of co-rotational elements; returns the strain energy."""
    for i in range(x.shape[0]):
        for j in range(3):
            out[i, j] = 0.0
    energy = 0.0
    for e in range(x.shape[0] - 1):
        dx, dy = x[e + 1, 0] - x[e, 0], x[e + 1, 1] - x[e, 1]
        length = math.hypot(dx, dy)
        c, s = dx / length, dy / length
        stretch = (dx * dx + dy * dy - rest * rest) / (length + rest)
        # rotations of the ends against the chord, free of jumps at half turns
        r1 = math.atan2(c * math.sin(x[e, 2]) - s * math.cos(x[e, 2]), c * math.cos(x[e, 2]) + s * math.sin(x[e, 2]))
        r2 = r1 + x[e + 1, 2] - x[e, 2]
        N = EA * stretch / rest
        bend1, bend2 = EI / rest * (4.0 * r1 + 2.0 * r2), EI / rest * (2.0 * r1 + 4.0 * r2)
        V = (bend1 + bend2) / length
        fx, fy = N * c + V * s, N * s - V * c
        out[e, 0] -= fx
        out[e, 1] -= fy
        out[e, 2] += bend1
        out[e + 1, 0] += fx
        out[e + 1, 1] += fy
        out[e + 1, 2] += bend2
        energy += 0.5 * N * stretch + 0.5 * (bend1 * r1 + bend2 * r2)
    return energy


@jit
def free_step(s: BeamState) -> None:
    """Increments without contact, in place."""
    strain_energy_and_forces(s.x, s.rest, s.EA, s.EI, s.inner)
    for i in range(s.x.shape[0]):
        for j in range(3):
            s.d[i, j] += s.rate[i, j] * (s.load[i, j] - s.inner[i, j])
    for k in range(s.q.size):
        s.dq[k] = s.al[k] * s.dq[k] - s.be[k] * s.q[k]


@jit
def free_gaps(s: BeamState) -> bool:
    """Gaps and directions of the free step; returns whether a gap is negative or not a number."""
    touches = False
    flexible = s.q.size > 0
    if flexible:
        for p in range(s.rim.size):
            s.rim[p] = dot(s.rows[p], s.q, s.q.size) + dot(s.rows[p], s.dq, s.q.size)
    for i in range(1, s.x.shape[0]):
        x, y = s.x[i, 0] + s.d[i, 0] - s.offset, s.x[i, 1] + s.d[i, 1]
        r = math.hypot(x, y)
        s.push[i, 0], s.push[i, 1] = -x / r, -y / r
        s.free[i] = s.radius - r
        if flexible:
            fill_waves(s.waves[i], x / r, y / r)
            s.free[i] += dot(s.waves[i], s.rim, s.rim.size)
        touches |= not s.free[i] >= 0.0
    return touches


@jit
def copy_gaps(s: BeamState) -> None:
    """Copy the gaps of the free step; a loop compiles sooner than a slice."""
    for i in range(s.gap.size):
        s.gap[i] = s.free[i + 1]


@jit
def fill_waves(waves: Array, c: float, t: float) -> None:
    """Interface functions (1, cos theta .. cos N theta, sin theta .. sin N theta) from cosine and sine."""
    top = (waves.size - 1) // 2
    cos, sin, waves[0] = 1.0, 0.0, 1.0
    for n in range(1, top + 1):
        cos, sin = c * cos - t * sin, t * cos + c * sin
        waves[n], waves[top + n] = cos, sin


@jit
def compliance(s: BeamState, i: int, j: int) -> float:
    """Gap at node i per unit force at node j within a step; `phi` of both must be filled."""
    W = s.rate[i, 0] if i == j else 0.0
    for k in range(s.q.size):
        W += s.phi[i, k] * s.c[k] * s.phi[j, k]
    if s.q.size > 0:
        for p in range(s.rim.size):
            W += s.waves[i, p] * dot(s.S[p], s.waves[j], s.rim.size)
    return W


@jit
def solve_contacts(s: BeamState, w: BeamWork) -> bool:
    """Forces that open every gap of the free step; returns False if there is no contact.

    It starts with the nodes that are outside after the free step, and adds those that the rim's own motion would cross.
    """
    n, count = s.free.size, 0
    for i in range(n):
        w.inside[i] = 0
    copy_gaps(s)
    while True:
        before = count
        for i in range(1, n):
            if w.inside[i] == 0 and s.gap[i - 1] < 0.0:
                w.chosen[count], w.inside[i] = i, 1
                count += 1
                combine(s.waves[i], s.rows, s.phi[i])
        if count == before:
            return True
        for a in range(count):
            w.b[a] = s.free[w.chosen[a]]
            for z in range(count):
                w.W[a, z] = compliance(s, w.chosen[a], w.chosen[z])
        cholesky(w.W, w.A, count)
        if project(w.A, w.b, count, count, w.push, w.active)[0] != 0:
            return False
        for a in range(count):
            s.force[w.chosen[a] - 1] = w.push[a]
            s.scale[w.chosen[a] - 1] = w.W[a, a]
            open_gap = max(w.b[a] + dot(w.W[a], w.push, count), 0.0)
            s.gap[w.chosen[a] - 1] = open_gap if w.push[a] == 0.0 else 0.0
        if s.q.size == 0:  # nodes against a rigid circle do not feel each other
            return True
        deflect(s, w, count)
        for i in range(1, n):
            if w.inside[i] == 0:
                s.gap[i - 1] = s.free[i] + dot(s.waves[i], w.radial, s.rim.size)


@jit
def combine(weights: Array, rows: Array, out: Array) -> None:
    """Compute out = weights rows."""
    for k in range(out.size):
        total = 0.0
        for p in range(weights.size):
            total += weights[p] * rows[p, k]
        out[k] = total


@jit
def deflect(s: BeamState, w: BeamWork, count: int) -> None:
    """Radial motion of the rim by interface function under the forces at the chosen nodes."""
    for m in range(s.q.size):
        w.moved[m] = 0.0
    for p in range(s.rim.size):
        w.pressed[p] = 0.0
    for a in range(count):
        i = w.chosen[a]
        for m in range(s.q.size):
            w.moved[m] += s.c[m] * s.phi[i, m] * w.push[a]
        for p in range(s.rim.size):
            w.pressed[p] += s.waves[i, p] * w.push[a]
    for p in range(s.rim.size):
        w.radial[p] = dot(s.rows[p], w.moved, s.q.size) + dot(s.S[p], w.pressed, s.rim.size)


@jit
def push_bodies(s: BeamState, w: BeamWork, sums: Tally) -> None:
    """Add the effect of the contact forces to the increments, and their work and moment to the sums."""
    for i in range(1, s.x.shape[0]):
        force = s.force[i - 1]
        if force <= 0.0:
            continue
        for j in range(2):
            s.d[i, j] += s.rate[i, j] * force * s.push[i, j]
        for k in range(s.q.size):
            s.dq[k] += s.c[k] * s.phi[i, k] * force
        s.ledger[MOMENT] += force * (s.x[i, 0] * s.push[i, 1] - s.x[i, 1] * s.push[i, 0])
    for i in range(1, s.x.shape[0]):
        force = s.force[i - 1]
        if force > 0.0:
            work = 0.0
            for j in range(2):
                work += force * s.push[i, j] * (s.d[i, j] + w.old[i, j])
            for k in range(s.q.size):
                work += force * s.phi[i, k] * (s.dq[k] + w.old_q[k])
            sums.work[i - 1] += 0.5 * work


@jit_entry
def advance_beam(s: BeamState, w: BeamWork, sums: Tally, out: Samples, h: float, first: int, steps: int) -> int:
    """Central differences with forward increment Lagrange multipliers at the nodes."""
    n = s.x.shape[0]
    for step in range(first, first + steps):
        for i in range(n):
            for j in range(3):
                w.old[i, j], w.seen[3 * i + j] = s.d[i, j], s.x[i, j]
        store_state(sums, out, step, step * h, w.seen)
        for k in range(s.q.size):
            w.old_q[k] = s.dq[k]
        free_step(s)
        for k in range(s.force.size):
            s.force[k] = 0.0
        if free_gaps(s):
            if not solve_contacts(s, w):
                return step
            push_bodies(s, w, sums)
        else:
            copy_gaps(s)
        total = 0.0
        for i in range(n):
            for j in range(3):
                total += s.inner[i, j] * (s.d[i, j] + w.old[i, j])
                s.x[i, j] += s.d[i, j]
        s.ledger[INTERNAL] += 0.5 * total
        for k in range(s.q.size):
            s.q[k] += s.dq[k]
        if not math.isfinite(total):
            return step
        for i in range(1, n):
            k = i - 1
            note_contact(sums, out, k, h, step * h, s.force[k], s.gap[k], s.scale[k], s.before[k], s.free[i])
            s.before[k] = s.gap[k]
        store(sums, out, step, step * h, s.force, s.gap)
    return -1
