"""Compiled step loop of a hinged beam in a circle: central differences, contact at every node."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from contact.compiled import jit_allocating, jit_entry_allocating
from contact.model.arrays import Array, Indices
from contact.record import Samples, Tally
from contact.scheme.loop.tally import note_contact, store, store_state
from contact.solver.active_set import project

INTERNAL, MOMENT = 0, 1  # entries of `ledger`


class BeamState(NamedTuple):
    """Nodes x_n and their last increments (n, 3), ring modes, and what the equations need."""

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


@jit_entry_allocating
def strain_energy_and_forces(x: Array, rest: float, EA: float, EI: float, out: Array) -> float:
    """Fill `out` (n, 3) with internal forces of co-rotational elements; returns the strain energy."""
    out[:] = 0.0
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


@jit_allocating
def free_step(s: BeamState) -> None:
    """Predict the increments without contact, in place."""
    strain_energy_and_forces(s.x, s.rest, s.EA, s.EI, s.inner)
    for i in range(s.x.shape[0]):
        for j in range(3):
            s.d[i, j] += s.rate[i, j] * (s.load[i, j] - s.inner[i, j])
    for k in range(s.q.size):
        s.dq[k] = s.al[k] * s.dq[k] - s.be[k] * s.q[k]


@jit_allocating
def free_gaps(s: BeamState) -> bool:
    """Fill gaps and directions of the free step; whether one is negative (or not a number)."""
    touches = False
    flexible = s.q.size > 0
    if flexible:
        np.dot(s.rows, s.q + s.dq, s.rim)
    for i in range(1, s.x.shape[0]):
        x, y = s.x[i, 0] + s.d[i, 0] - s.offset, s.x[i, 1] + s.d[i, 1]
        r = math.hypot(x, y)
        s.push[i, 0], s.push[i, 1] = -x / r, -y / r
        s.free[i] = s.radius - r
        if flexible:
            fill_waves(s.waves[i], x / r, y / r)
            s.free[i] += np.dot(s.waves[i], s.rim)
        touches |= not s.free[i] >= 0.0
    return touches


@jit_allocating
def copy_gaps(s: BeamState) -> None:
    """Gaps of the free step; a loop compiles sooner than a slice."""
    for i in range(s.gap.size):
        s.gap[i] = s.free[i + 1]


@jit_allocating
def fill_waves(waves: Array, c: float, t: float) -> None:
    """Interface functions (1, cos theta .. cos N theta, sin theta .. sin N theta) from cosine and sine."""
    top = (waves.size - 1) // 2
    cos, sin, waves[0] = 1.0, 0.0, 1.0
    for n in range(1, top + 1):
        cos, sin = c * cos - t * sin, t * cos + c * sin
        waves[n], waves[top + n] = cos, sin


@jit_allocating
def compliance(s: BeamState, i: int, j: int) -> float:
    """Gap at node i per unit force at node j within a step; `phi` of both must be filled."""
    W = s.rate[i, 0] if i == j else 0.0
    for k in range(s.q.size):
        W += s.phi[i, k] * s.c[k] * s.phi[j, k]
    if s.q.size > 0:
        W += np.dot(s.waves[i], np.dot(s.S, s.waves[j]))
    return W


@jit_allocating
def solve_contacts(s: BeamState, chosen: Indices) -> bool:
    """Forces that open every gap of the free step; False when there are none.

    Starts with the nodes that the free step leaves outside; those that the rim's own motion would cross join them.
    """
    n, count = s.free.size, 0
    inside = np.zeros(n, dtype=np.int64)
    copy_gaps(s)
    while True:
        before = count
        for i in range(1, n):
            if inside[i] == 0 and s.gap[i - 1] < 0.0:
                chosen[count], inside[i] = i, 1
                count += 1
                np.dot(s.waves[i], s.rows, s.phi[i])
        if count == before:
            return True
        W, b, force = np.zeros((count, count)), np.zeros(count), np.zeros(count)
        for a in range(count):
            b[a] = s.free[chosen[a]]
            for z in range(count):
                W[a, z] = compliance(s, chosen[a], chosen[z])
        A = np.linalg.cholesky(W).astype(np.float64)
        if project(A, b, force, np.zeros(count))[0] != 0:
            return False
        for a in range(count):
            s.force[chosen[a] - 1] = force[a]
            s.scale[chosen[a] - 1] = W[a, a]
            s.gap[chosen[a] - 1] = max(b[a] + np.dot(W[a], force), 0.0) if force[a] == 0.0 else 0.0
        if s.q.size == 0:  # nodes against a rigid circle do not feel each other
            return True
        moved, pressed = np.zeros(s.q.size), np.zeros(s.rim.size)
        for a in range(count):
            for m in range(moved.size):
                moved[m] += s.phi[chosen[a], m] * force[a]
            for m in range(pressed.size):
                pressed[m] += s.waves[chosen[a], m] * force[a]
        for m in range(moved.size):
            moved[m] *= s.c[m]
        radial, soft = np.dot(s.rows, moved), np.dot(s.S, pressed)
        for m in range(pressed.size):
            radial[m] += soft[m]
        for i in range(1, n):
            if inside[i] == 0:
                s.gap[i - 1] = s.free[i] + np.dot(s.waves[i], radial)


@jit_allocating
def push_bodies(s: BeamState, sums: Tally, old: Array, old_q: Array) -> None:
    """Add the contact forces to the increments; their work and moment to the sums."""
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
                work += force * s.push[i, j] * (s.d[i, j] + old[i, j])
            for k in range(s.q.size):
                work += force * s.phi[i, k] * (s.dq[k] + old_q[k])
            sums.work[i - 1] += 0.5 * work


@jit_entry_allocating
def advance_beam(s: BeamState, sums: Tally, out: Samples, h: float, first: int, steps: int) -> int:
    """Central differences with forward increment Lagrange multipliers at the nodes."""
    n = s.x.shape[0]
    old, old_q = np.zeros((n, 3)), np.zeros(s.q.size)
    chosen = np.zeros(n, dtype=np.int64)
    for step in range(first, first + steps):
        store_state(sums, out, step, step * h, s.x.ravel())
        for i in range(n):
            for j in range(3):
                old[i, j] = s.d[i, j]
        for k in range(s.q.size):
            old_q[k] = s.dq[k]
        free_step(s)
        s.force[:] = 0.0
        if free_gaps(s):
            if not solve_contacts(s, chosen):
                return step
            push_bodies(s, sums, old, old_q)
        else:
            copy_gaps(s)
        total = 0.0
        for i in range(n):
            for j in range(3):
                total += s.inner[i, j] * (s.d[i, j] + old[i, j])
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
