"""What a step did: work of the forces by where it goes, forces, gaps and events."""

from __future__ import annotations

import math

from contact.jit.compiled import jit
from contact.loop.modal.rows import move, product_of_sum
from contact.loop.modal.stick import INSIDE
from contact.loop.rub.compliance import strains_before
from contact.loop.rub.rows import RubRows, blade_dot, blade_dot_of_sum
from contact.loop.rub.state import RubState, Work
from contact.loop.tally import note_contact, note_stick, tip_motion
from contact.record.record import Samples, Tally


@jit
def add_works(s: RubState, rows: RubRows, w: Work, count: int, dim: int, slid: float, sums: Tally) -> None:  # fmt: skip
    """Work of the forces along (D_n + D_{n+1})/2: by the gap, by the turning point, by friction; heat and drive.

    What the tangential compliance takes up is friction's work on the bodies, and the contact's loss until S gives it
    back; what S stores because the point moves is the turning point's.
    """
    if rows.turns:
        strains_before(s, rows, w, count, dim)
    for a in range(w.slots[0] * dim):
        w.along[a] = product_of_sum(w.rows[a], s.old, s.d)
    for n in range(count):
        j = w.chosen[n]
        R = j * dim
        work = 0.5 * s.lam[R] * (s.free[j] - s.last[j])
        rotation, friction = -work, 0.0
        for i in range(dim):
            row = R + i
            force = s.lam[row]
            along = w.along[w.column[n * dim + i]] + blade_dot_of_sum(rows, row, j, s.old, s.d)
            if rows.turns:
                moved = 0.5 * force * (w.turning[row] - w.before[row])
                work += moved
                rotation -= moved
            if i == 0:
                rotation += 0.5 * force * along
                continue
            soft = force * (w.strain[row] - s.strain[row])
            friction += 0.5 * force * along + soft
            work -= soft
            s.heat[j] -= force * s.motion[row]
            if i == 1:
                s.drive[j] -= force * rows.radius[j] * slid
        sums.work[j] += work
        sums.rotation[j] += rotation
        sums.friction[j] += friction


@jit
def advance_modes(s: RubState, sums: Tally) -> None:
    """Add the increments, and the work of damping, of the stiffening, of gravity and whirl."""
    for i in range(s.body.size):
        sums.body_force[0] += 0.5 * s.body[i] * (s.old[i] + s.d[i])
    given = 0.0
    for i in range(s.push.size - s.stiff.shape[0], s.push.size):
        given += 0.5 * s.push[i] * (s.old[i] + s.d[i])
    sums.external[0] += given
    sums.damping[0] += move(s, s.old, s.d)


@jit
def note(s: RubState, rows: RubRows, w: Work, dim: int, sums: Tally, out: Samples, h: float, time: float) -> None:
    """Forces, gaps and events of this step; the gaps of q move on."""
    for j in range(s.mu.size):
        R = j * dim
        s.force[j] = s.lam[R]
        before, predicted = 0.0, 0.0
        if s.inside[j] > 0:
            s.gap[j] = s.motion[R]
            before, predicted = s.now[j] + s.skin[j], s.test[j]
            s.last[j], s.now[j], s.known[j] = s.now[j], s.free[j], 1
        if s.inside[j] == 2:
            if dim > 1:
                s.peaks[0] = max(s.peaks[0], abs(blade_dot(rows, R + 1, j, s.q)))
            tip_motion(s.limits, s.free[j] - rows.clearance[j] - w.rigid[rows.place[j]])
        note_contact(sums, out, j, h, time, s.force[j], s.gap[j], s.scale[j], before, predicted)
        if dim > 1:
            note_stick(sums, out, j, int(sticks(s, R, dim, j)), time)


@jit
def sticks(s: RubState, row: int, dim: int, j: int) -> bool:
    """Whether a contact presses and its tangential force lies inside the cone."""
    pull = 0.0
    for i in range(row + 1, row + dim):
        pull += s.lam[i] * s.lam[i]
    return bool(s.lam[row] > 0.0 and math.sqrt(pull) < s.mu[j] * s.lam[row] * (1.0 - INSIDE))
