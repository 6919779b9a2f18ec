"""Compiled step loop of a hinged beam in a rigid circle: Newmark, Newton's method, active set of contacts.

M a + f_int(x) = f + sum lam_i G_i(x),  g_i(x) >= 0, lam_i >= 0, lam_i g_i = 0   at t_{n+1},
x_{n+1} = x_n + h v_n + h^2 ((1/2 - beta) a_n + beta a),  v_{n+1} = v_n + h ((1 - gamma) a_n + gamma a).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from contact.base.arrays import Array, Indices
from contact.jit.compiled import jit, jit_entry
from contact.loop.beam.beam import strain_energy_and_forces
from contact.loop.tally import note_step, store, store_state
from contact.record.record import Samples, Tally
from contact.solver.dense import LARGE, Panels, solve_in_place

MOST_NEWTON, MOST_CHANGES = 30, 40
SMALL = 1e-11  # of the element length: the Newton correction that ends a step


class ImplicitBeam(NamedTuple):
    """State (n, 3) of the nodes, contact forces and gaps of the nodes beyond the hinge, and constants."""

    x: Array
    v: Array
    a: Array
    mass: Array
    load: Array
    rest: float
    EA: float
    EI: float
    beta: float
    gamma: float
    radius: float
    offset: float
    force: Array
    gap: Array
    last: Array  # forces and gaps of the step before
    before: Array
    ledger: Array  # numerical work, moment impulse, Newton iterations


class ImplicitWork(NamedTuple):
    """Work arrays: the step to be solved, Newton's system, the strains of one element."""

    x: Array  # (n, 3)
    a: Array  # (n, 3)
    start: Array  # (n, 3)
    inner: Array  # (n, 3)
    seen: Array  # (3 n,) what is stored of a step
    active: Indices  # (n,)
    A: Array  # (4 n, 4 n)
    r: Array  # (4 n,)
    B: Array  # (3, 6)
    z: Array  # (6,)
    panels: Panels


def implicit_work(n: int) -> ImplicitWork:
    """Work arrays for n nodes."""
    x, a, start, inner = np.zeros((4, n, 3))
    return ImplicitWork(
        x=x, a=a, start=start, inner=inner, seen=np.zeros(3 * n), active=np.zeros(n, dtype=np.int64),
        A=np.zeros((4 * n, 4 * n)), r=np.zeros(4 * n), B=np.zeros((3, 6)), z=np.zeros(6),
        panels=Panels(used=4 * n >= LARGE),
    )  # fmt: skip


@jit
def add_tangent(x: Array, rest: float, EA: float, EI: float, B: Array, z: Array, K: Array) -> None:
    """Add the tangent stiffness of co-rotational elements to K (3n, 3n)."""
    stretching, bending = EA / rest, EI / rest
    for e in range(x.shape[0] - 1):
        dx, dy = x[e + 1, 0] - x[e, 0], x[e + 1, 1] - x[e, 1]
        length = math.hypot(dx, dy)
        c, s = dx / length, dy / length
        stretch = (dx * dx + dy * dy - rest * rest) / (length + rest)
        r1 = math.atan2(c * math.sin(x[e, 2]) - s * math.cos(x[e, 2]), c * math.cos(x[e, 2]) + s * math.sin(x[e, 2]))
        r2 = r1 + x[e + 1, 2] - x[e, 2]
        N, M = EA * stretch / rest, EI / rest * 6.0 * (r1 + r2)
        for i in range(6):
            B[0, i], z[i] = 0.0, 0.0
        B[0, 0], B[0, 1], B[0, 3], B[0, 4] = -c, -s, c, s
        z[0], z[1], z[3], z[4] = s, -c, -s, c
        for k in range(1, 3):
            for i in range(6):
                B[k, i] = -z[i] / length
            B[k, 3 * k - 1] += 1.0
        for i in range(6):
            along, left, right = stretching * B[0, i], 4.0 * B[1, i] + 2.0 * B[2, i], 2.0 * B[1, i] + 4.0 * B[2, i]
            for j in range(6):
                elastic = along * B[0, j] + bending * (left * B[1, j] + right * B[2, j])
                turned = N / length * z[i] * z[j] + M / (length * length) * (B[0, i] * z[j] + z[i] * B[0, j])
                K[3 * e + i, 3 * e + j] += elastic + turned


@jit
def newton(s: ImplicitBeam, w: ImplicitWork, h: float) -> bool:
    """Solve one step for x, a and the forces of the active contacts, from the guess in x; False if it fails."""
    x, a, active, A, r = w.x, w.a, w.active, w.A, w.r
    n = x.shape[0]
    size = 3 * n
    for i in range(n):
        size += active[i]
    factor = 1.0 / (s.beta * h * h)
    for _ in range(MOST_NEWTON):
        s.ledger[2] += 1.0
        strain_energy_and_forces(x, s.rest, s.EA, s.EI, w.inner)
        for i in range(size):
            for j in range(size):
                A[i, j] = 0.0
        add_tangent(x, s.rest, s.EA, s.EI, w.B, w.z, A)
        for i in range(n):
            for j in range(3):
                a[i, j] = factor * (x[i, j] - w.start[i, j])
                r[3 * i + j] = s.load[i, j] - w.inner[i, j] - s.mass[i, j] * a[i, j]
                A[3 * i + j, 3 * i + j] += factor * s.mass[i, j]
        row = 3 * n
        for i in range(1, n):
            if active[i] == 0:
                continue
            ex, ey = x[i, 0] - s.offset, x[i, 1]
            length = math.hypot(ex, ey)
            ex, ey, lam = ex / length, ey / length, s.force[i - 1]
            r[3 * i] -= lam * ex
            r[3 * i + 1] -= lam * ey
            r[row] = length - s.radius
            A[3 * i, row], A[3 * i + 1, row] = ex, ey
            A[row, 3 * i], A[row, 3 * i + 1] = -ex, -ey
            A[3 * i, 3 * i] += lam / length * ey * ey
            A[3 * i + 1, 3 * i + 1] += lam / length * ex * ex
            A[3 * i, 3 * i + 1] -= lam / length * ex * ey
            A[3 * i + 1, 3 * i] -= lam / length * ex * ey
            row += 1
        for j in range(2):  # the hinge stays
            for i in range(size):
                A[i, j], A[j, i] = 0.0, 0.0
            A[j, j], r[j] = 1.0, 0.0
        if not solve_in_place(A, r, size, w.panels):
            return False
        largest = 0.0
        for i in range(n):
            for j in range(3):
                x[i, j] += r[3 * i + j]
                largest = max(largest, abs(r[3 * i + j]) * (s.rest if j == 2 else 1.0))
        row = 3 * n
        for i in range(1, n):
            if active[i] == 1:
                s.force[i - 1] += r[row]
                row += 1
        if not math.isfinite(largest):
            return False
        if largest <= SMALL * s.rest:
            return True
    return False


@jit
def solve_step(s: ImplicitBeam, w: ImplicitWork, h: float) -> bool:
    """Newton's method for a set of active contacts, which is changed until gaps and forces have the right signs."""
    x, active = w.x, w.active
    n = x.shape[0]
    for _ in range(MOST_CHANGES):
        for i in range(1, n):
            if active[i] == 0:
                s.force[i - 1] = 0.0
        if not newton(s, w, h):
            return False
        changed = False
        for i in range(1, n):
            s.gap[i - 1] = s.radius - math.hypot(x[i, 0] - s.offset, x[i, 1])
            if active[i] == 1 and s.force[i - 1] < 0.0:
                active[i], changed = 0, True
            elif active[i] == 0 and s.gap[i - 1] < 0.0:
                active[i], changed = 1, True
            elif active[i] == 1:
                s.gap[i - 1] = 0.0
        if not changed:
            return True
    return False


@jit
def numerical_work(s: ImplicitBeam, w: ImplicitWork, h: float) -> float:
    """Energy that Newmark adds or removes in a step: residual of its identity, plus that of the trapezoid rule."""
    half, shift = s.gamma - 0.5, s.beta - 0.5 * s.gamma
    x, a, inner, inner_old = w.x, w.a, w.inner, w.start
    energy = strain_energy_and_forces(x, s.rest, s.EA, s.EI, inner)
    energy -= strain_energy_and_forces(s.x, s.rest, s.EA, s.EI, inner_old)
    total = 0.0
    for i in range(x.shape[0]):
        for j in range(3):
            m, d, da = s.mass[i, j], x[i, j] - s.x[i, j], a[i, j] - s.a[i, j]
            total += m * (half * d * da - 0.5 * shift * h * h * (a[i, j] ** 2 - s.a[i, j] ** 2))
            total -= m * shift * half * h * h * da * da
            energy -= 0.5 * (inner[i, j] + inner_old[i, j]) * d
    return total + energy


@jit
def contact_work(s: ImplicitBeam, sums: Tally, x: Array, h: float) -> None:
    """Trapezoid work of the contact forces over a step, and the impulse of their moment about the hinge."""
    for i in range(1, x.shape[0]):
        for which in range(2):
            force = s.force[i - 1] if which == 1 else s.last[i - 1]
            at = x if which == 1 else s.x
            if force > 0.0:
                ex, ey = at[i, 0] - s.offset, at[i, 1]
                r = math.hypot(ex, ey)
                sums.work[i - 1] -= 0.5 * force * ((x[i, 0] - s.x[i, 0]) * ex + (x[i, 1] - s.x[i, 1]) * ey) / r
                s.ledger[1] += 0.5 * h * force * (at[i, 1] * ex - at[i, 0] * ey) / r


@jit_entry
def advance_implicit(
    s: ImplicitBeam, w: ImplicitWork, sums: Tally, out: Samples, h: float, first: int, steps: int
) -> int:
    """Newmark steps; samples hold the state and forces at the end of each step."""
    n, x, a, active = s.x.shape[0], w.x, w.a, w.active
    for step in range(first, first + steps):
        begin, time = step * h, (step + 1) * h
        for i in range(n):
            for j in range(3):
                x[i, j] = s.x[i, j] + h * s.v[i, j]
                w.start[i, j] = s.x[i, j] + h * s.v[i, j] + h * h * (0.5 - s.beta) * s.a[i, j]
        for i in range(1, n):
            active[i] = 1 if s.force[i - 1] > 0.0 else 0
            s.last[i - 1] = s.force[i - 1]
        if not solve_step(s, w, h):
            return step
        s.ledger[0] += numerical_work(s, w, h)
        contact_work(s, sums, x, h)
        for k in range(n - 1):
            slack = abs(min(s.force[k] * s.beta * h * h / s.mass[k + 1, 0], s.gap[k]))
            out_x, out_y = s.x[k + 1, 0] + h * s.v[k + 1, 0] - s.offset, s.x[k + 1, 1] + h * s.v[k + 1, 1]
            ahead = s.radius - math.hypot(out_x, out_y)
            note_step(sums, out, k, h, s.force[k], s.gap[k], slack, begin, s.before[k], ahead, begin + 0.5 * h)
            s.before[k] = s.gap[k]
        for i in range(n):
            for j in range(3):
                s.v[i, j] += h * ((1.0 - s.gamma) * s.a[i, j] + s.gamma * a[i, j])
                s.x[i, j], s.a[i, j], w.seen[3 * i + j] = x[i, j], a[i, j], x[i, j]
        store(sums, out, step, time, s.force, s.gap)
        store_state(sums, out, step, time, w.seen)
    return -1
