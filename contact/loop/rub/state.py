"""State of a rub in its compiled loop, and its work space."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from contact.base.arrays import Array, Indices
from contact.loop.rub.rows import RubRows
from contact.solver.friction.gliding import Glide
from contact.solver.friction.room import Room, friction_room


class RubState(NamedTuple):
    """Modes (m,), tips (K,) and their d directions each (K d,), normal first."""

    q: Array
    d: Array
    old: Array
    al: Array
    be: Array
    c: Array
    kick: Array
    weight: Array
    stiff: Array  # (b, b) of all blades' modes, empty without stiffening
    stiff_at: Array  # the same times Omega^2 of each basis
    push: Array  # (m,) force of the stiffening
    contact: Array  # (m,) force of the tips
    body: Array  # (m,) gravity and whirl, empty without any
    mu: Array
    lam: Array
    strain: Array  # S lam of the last step
    motion: Array  # gaps and slips that obey the law
    scale: Array  # (K,) Delassus number of each normal with itself
    now: Array  # gap of q at t_n, valid where `known`
    last: Array  # at t_{n-1}
    known: Indices
    inside: Indices  # 2 in the solve, 1 near, 0 far
    free: Array
    test: Array
    skin: Array  # (K,) depth of the surface that a coating has left [m]
    force: Array
    gap: Array
    seen: Array  # (m + K d,) what `Result.state` holds: q and lam of one instant
    heat: Array  # dissipated by slip
    drive: Array  # work of the drive against friction
    peaks: Array  # largest |u_r| of the rim at a tip, tangential motion of a tip; bound of |u_r| now, by line
    counts: Array  # most iterations of one step, their sum, steps with contact, fault


class Work(NamedTuple):
    """Work space, K tips at P places: rows at t_{n+1} and t_n, the problem of one step, what forces push.

    The tips that are solved for are `chosen`, their directions stand in rows `row` of `lam`; the places where they are
    have a slot each, row `column` of `rows`.
    """

    ahead: Array  # (P, m_casing) normal rows at t_{n+1}, where `fresh`
    fresh: Indices  # (P,)
    rigid: Array  # (P,) gap of the rigid casing there
    moved: Array  # (P,) motion of the casing there
    spare: Array  # (m_casing,) any other row
    slot: Indices  # (P,) -1 for a place without a chosen tip
    slots: Indices  # (1,) how many
    rows: Array  # (P d, m_casing) all rows at t_n, by slot
    tests: Array  # (P d, m_casing) those the law is stated with, times c
    along: Array  # (P d,) motion of the casing along them
    pull: Array  # (P d,) sum of the forces of one place
    chosen: Indices  # (K,)
    row: Indices  # (K d,)
    column: Indices  # (K d,)
    casing: Array  # (P d, P d) what the casing yields between slots
    W: Array  # (K d, K d) Delassus matrix of the chosen
    b: Array  # (K d,) free gaps and slips of the chosen
    lam: Array
    motion: Array
    mu: Array  # (K,)
    depth: Array  # (K,) of the tips in a coating
    pushed: Array  # (m_casing,)
    S: Array  # (K d, K d) residual compliance at phi_n; rows of tips that are not solved for may be stale
    strain: Array  # (K d,) S lam
    waves_old: Array  # (2, harmonics of S) at phi_{n-1}
    glide: Glide
    room: Room  # of the friction solver


def work_space(s: RubState, rows: RubRows) -> Work:
    """Buffers; a residual compliance that does not turn is put there for good."""
    K, R, m = s.mu.size, s.lam.size, rows.start.size - 1
    P = int(rows.place.max()) + 1
    D = P * (R // K)

    def none(*shape: int) -> Array:
        return np.zeros(shape)

    def whole(size: int) -> Indices:
        return np.zeros(size, dtype=np.int64)

    return Work(
        ahead=none(P, m), fresh=whole(P), rigid=none(P), moved=none(P), spare=none(m), slot=whole(P), slots=whole(1),
        rows=none(D, m), tests=none(D, m), along=none(D), pull=none(D), chosen=whole(K), row=whole(R), column=whole(R),
        casing=none(D, D), W=none(R, R), b=none(R), lam=none(R), motion=none(R), mu=none(K), depth=none(K),
        pushed=none(m), S=np.array(rows.S_cos[0]), strain=none(R), waves_old=none(2, rows.S_harmonic.size),
        glide=Glide(used=R > K > 1), room=friction_room(K, R // K),
    )  # fmt: skip
