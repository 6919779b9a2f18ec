"""Closed contact of a split casing: growth per turn by Floquet's theory, and the perfect casing nearest to it.

In the casing's frame the modes vibrate freely and the contact point moves: q'' + 2 zeta omega q' + omega^2 q =
-W(phi)^T Q(phi) q/S(phi), phi = phi_0 - Omega t. The matrix of one turn (monodromy) has multipliers rho; growth =
max log|rho|/T, T = 2 pi/|Omega|.
Its coefficients are periodic in time in either frame. The nearest perfect casing has each pair's mean, seen as cos and
sin of its own n.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np

from contact.base.arrays import Array, aligned
from contact.base.errors import InputError, LimitError
from contact.model.bodies.modal_body import ModalBody
from contact.model.gaps.gap import RotatingRim
from contact.model.gaps.limits import motion_limits
from contact.model.gaps.modal_system import ModalSystem, rim_system
from contact.model.gaps.permanent import ClosedContact, SplitError, rub_contact
from contact.model.gaps.rub import Rub, Start, rub_of
from contact.scheme.modal.propagator import free_motion

P = 1.0 / (4.0 - 4.0 ** (1.0 / 3.0))  # five steps of order two make one of order four (Suzuki, Phys. Lett. A 146, 1990)
KICKS = np.array([P, P, 1.0 - 4.0 * P, P, P])
PHASE = 0.4  # of the fastest vibration in one step, in radians
MOST_STEPS = 5_000_000


def perfect_mean(casing: ModalBody) -> ModalBody:
    """A rim whose pairs are equal and turn into themselves; what has no partner is left to the compliance.

    Modes belong to the n that most of their radial and tangential motion has; those of one n are paired in order of
    frequency. Of a perfect casing it is the casing itself but for the turn of its pairs.

    >>> from contact.model.gaps.bladed_disk import pair_rim
    >>> from contact.model.gaps.permanent import ModalPair
    >>> split = pair_rim(ModalPair(n=2, freq_hz=100.0, modal_mass=1.0), radius=0.5).detuned(1e-3, seed=3)
    >>> np.ptp(split.omega) > 0.0, np.ptp(perfect_mean(split).omega)
    (np.True_, np.float64(0.0))
    """
    N, size = casing.n_max, 2 * casing.n_max + 1
    rows = casing.rows.reshape(-1, size, casing.omega.size)  # blocks of lines and directions
    content = np.sum(rows**2, axis=0)
    content[1 : N + 1] += content[N + 1 :]  # cosine and sine
    order = content[: N + 1].argmax(axis=0)
    kept: list[tuple[float, float, Array]] = []
    gone = []
    for n in range(N + 1):
        own = np.flatnonzero(order == n)
        if n == 0:
            alone = [np.where(np.arange(size)[:, None] == 0, rows[:, :, i].T, 0.0).T.ravel() for i in own]
            kept += [(casing.omega[i], casing.zeta[i], row) for i, row in zip(own, alone, strict=True)]
            continue
        own = own[np.argsort(casing.omega[own], kind="stable")]
        gone += own[own.size - own.size % 2 :].tolist()
        for i, j in zip(own[: own.size - own.size % 2 : 2], own[1::2], strict=True):
            omega, zeta = float(casing.omega[[i, j]].mean()), float(casing.zeta[[i, j]].mean())
            kept += [(omega, zeta, row) for row in _pair(rows[:, :, i], rows[:, :, j], n, N)]
    S = casing.S + sum((np.outer(casing.rows[:, i], casing.rows[:, i]) / casing.omega[i] ** 2 for i in gone), 0.0)
    kept.sort(key=lambda mode: mode[0])
    return replace(
        casing, omega=np.array([mode[0] for mode in kept]), zeta=np.array([mode[1] for mode in kept]),
        rows=np.array([mode[2] for mode in kept]).reshape(len(kept), -1).T, S=_mean_compliance(np.asarray(S), size, N),
        recovery=None, recovery_S=None, recovery_points=None, recovery_cells=None, outputs=(), output_rows=None,
        output_S=None, gyroscopic=None, stiffness_by_speed=None, damping=None, stiffness=None, participation=None,
        out_of_roundness=None,
    )  # fmt: skip


def mean_contact(rub: RotatingRim | Rub, *, mu: float = 0.0) -> tuple[ClosedContact, bool]:
    """What stays of a rim or rub with every contact closed, and whether its pairs had to be averaged for that."""
    try:
        return rub_contact(rub, mu=mu), False
    except SplitError:
        # neither how it starts nor what loads it matters to growth, and both belong to the casing's own modes
        mean = replace(rub_of(rub), casing=perfect_mean(rub.casing), casing_start=Start(), forces=())
        return rub_contact(mean, mu=mu), True


def _pair(first: Array, second: Array, n: int, N: int) -> tuple[Array, Array]:
    """Rows of cos n and sin n whose complex amplitudes in every block are the two modes' mean, seen from the first's.

    A wave of the pair moves block b by z_b: first z_b e^{-i alpha}, second -+i times that. alpha is taken from the
    radial motion, which is then real: what a perfect pair has.
    """
    waves = []
    for mode in (first, second):
        z = mode[:, n] - 1j * mode[:, N + n]  # Re z e^{i n theta}
        waves.append(z * np.exp(-1j * np.angle(z[0])))
    z = 0.5 * (waves[0] + waves[1])
    cosine, sine = np.zeros_like(first), np.zeros_like(first)
    cosine[:, n], cosine[:, N + n] = z.real, -z.imag
    sine[:, n], sine[:, N + n] = z.imag, z.real
    return cosine.ravel(), sine.ravel()


def _mean_compliance(S: Array, size: int, N: int) -> Array:
    """S averaged over the angle: between cos n and sin n of equal n alone, the same for both but for a quarter turn."""
    blocks = S.reshape(len(S) // size, size, len(S) // size, size)
    found = np.zeros_like(blocks)
    found[:, 0, :, 0] = blocks[:, 0, :, 0]
    for n in range(1, N + 1):
        c, s = n, N + n
        even = 0.5 * (blocks[:, c, :, c] + blocks[:, s, :, s])
        odd = 0.5 * (blocks[:, c, :, s] - blocks[:, s, :, c])
        found[:, c, :, c] = found[:, s, :, s] = even
        found[:, c, :, s], found[:, s, :, c] = odd, -odd
    full = found.reshape(S.shape)
    return np.asarray(0.5 * (full + full.T))


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
    from contact.loop.modal.rows import revolve
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
