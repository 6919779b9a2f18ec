"""Closed contact of a split casing: its coefficients are periodic in time in either frame, so growth is per turn.

In the casing's frame the modes vibrate freely and the contact point moves: q'' + 2 zeta omega q' + omega^2 q =
-W(phi)^T Q(phi) q/S(phi), phi = phi_0 - Omega t. The matrix of one turn (monodromy) has multipliers rho; growth =
max log|rho|/T, T = 2 pi/|Omega|.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np

from contact.base.arrays import Array, aligned
from contact.base.errors import InputError, LimitError
from contact.model.gaps.gap import RotatingRim
from contact.model.gaps.limits import motion_limits
from contact.model.gaps.modal_system import ModalSystem, rim_system
from contact.scheme.modal.propagator import free_motion

P = 1.0 / (4.0 - 4.0 ** (1.0 / 3.0))  # five steps of order two make one of order four (Suzuki, Phys. Lett. A 146, 1990)
KICKS = np.array([P, P, 1.0 - 4.0 * P, P, P])
PHASE = 0.4  # of the fastest vibration in one step, in radians
MOST_STEPS = 5_000_000


def floquet_growth(rim: RotatingRim, speed_hz: Array, *, mu: float = 0.0, phase: float = PHASE) -> Array:
    """Growth rates [1/s] of a rim and blade in closed contact at speeds [Hz], (speeds,).

    `phase` [rad] is the step in radians of the fastest vibration, loaded by the contact; the error falls with its
    fourth power. Raises InputError at rest (there is no turn to follow), LimitError beyond 5,000,000 steps a turn.
    """
    speeds = np.atleast_1d(np.asarray(speed_hz, dtype=float))
    return np.array([_growth(replace(rim, speed_hz=float(speed)), mu, phase) for speed in speeds])


def _growth(rim: RotatingRim, mu: float, phase: float) -> float:
    if rim.speed == 0.0:
        raise InputError("speed_hz: found 0 with a split casing, expected a speed: there is no turn to follow")
    turn = monodromy(rim_system(rim), math.copysign(mu, rim.speed), phase)
    return float(np.log(np.abs(np.linalg.eigvals(turn)).max()) * abs(rim.speed) / (2.0 * math.pi))


def monodromy(system: ModalSystem, mu: float, phase: float = PHASE) -> Array:
    """State (q, q'/scale) after one turn for each unit state before, (2 m, 2 m); `mu` with the sign of the speed."""
    from contact.loop.modal.floquet import revolve
    from contact.scheme.modal.modal_stepper import padded, rim_rows

    m, period = system.omega.size, 2.0 * math.pi / abs(system.speed)
    scale = float(system.omega.max())
    steps = math.ceil(period * fastest(system, mu) / phase)
    if steps > MOST_STEPS:
        raise LimitError(f"speed_hz: found {steps} steps a turn, expected at most {MOST_STEPS}: raise the speed")
    h = period / steps
    edges = np.concatenate(([0.0], KICKS, [0.0]))
    drifts = np.array([free_motion(system.omega, system.zeta, 0.5 * (a + b) * h)
                       for a, b in pairwise(edges)])  # fmt: skip
    q, v = np.hstack([np.eye(m), np.zeros((m, m))]), np.hstack([np.zeros((m, m)), scale * np.eye(m)])
    times = np.cumsum(KICKS) - 0.5 * KICKS
    rows = rim_rows(system, mu, *system.sums(), motion_limits(0.0, 0.0))
    Q, T = aligned(2, padded(m))
    revolve(q, v, rows, Q, T, np.zeros(2 * m), drifts, times, KICKS, h, steps)
    return np.vstack([q, v / scale])


def fastest(system: ModalSystem, mu: float) -> float:
    """Bound on the angular frequencies [rad/s] of the modes on the contact's spring, over a turn."""
    assert system.table is not None  # a rim's rows always turn
    stiffest = 0.0
    for phi in np.linspace(0.0, 2.0 * math.pi, 64, endpoint=False):
        Q, T = system.table.rows(float(phi))
        S = system.S_nn(float(phi)) - mu * system.S_nt(float(phi))
        if not S > 0.0:
            raise InputError(f"S: found compliance {S:g} m/N at the contact, expected > 0: it needs some give")
        stiffest = max(stiffest, float(np.linalg.norm(Q) * np.linalg.norm(Q - mu * T)) / S)
    return math.sqrt(float(system.omega.max()) ** 2 + stiffest)
