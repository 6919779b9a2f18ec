"""State of a rub in its compiled loop, and the buffers of one call."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from contact.compiled import jit_allocating
from contact.model.arrays import Array, Indices
from contact.scheme.loop.rub_rows import RubRows


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
    """Buffers of one call: rows at t_{n+1} and t_n, Delassus matrix, and what the forces push."""

    ahead: Array  # (K, m_casing) normal rows at t_{n+1}
    rows: Array  # (K d, m_casing) all rows at t_n, in the order of `chosen`
    tests: Array  # (K d, m_casing) those the law is stated with, times c
    chosen: Indices  # (K,)
    pushed: Array  # (m_casing,)
    S: Array  # (K d, K d) residual compliance at phi_n; rows of tips that are not solved for may be stale
    S_old: Array  # at phi_{n-1}


@jit_allocating
def work_space(s: RubState, rows: RubRows) -> Work:
    """Buffers; a residual compliance that does not turn is put there for good."""
    K, R, m = s.mu.size, s.lam.size, rows.start.size - 1
    S = rows.S_cos[0].copy()
    return Work(
        np.zeros((K, m)), np.zeros((R, m)), np.zeros((R, m)), np.zeros(K, dtype=np.int64), np.zeros(m), S, S.copy()
    )
