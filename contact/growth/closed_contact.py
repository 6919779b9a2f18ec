"""Does a contact that stays closed diverge? Poles and growth rates over speed, no time stepping.

A perfect casing in the blade's frame has constant coefficients: its growth is the largest real part of the
eigenvalues. A split casing's coefficients are periodic in time in either frame: Floquet (`split_casing`).
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from contact.base.arrays import Array
from contact.base.errors import InputError
from contact.growth.coincidence import Waves, close_speeds, coincidences, in_words, waves
from contact.growth.growth_map import StabilityMap, scan
from contact.model.gaps.gap import RotatingRim
from contact.model.gaps.permanent import ClosedContact, SplitError, rim_contact

Complex = NDArray[np.complex128]
MOST = 60  # rounds
SETTLED = 1e-12  # of the largest pole: the next step would be none, convergence is cubic
COUPLED = 1e-14  # of the largest residue: below, contact does not see a mode
FLOOR = 1e-8  # of the highest frequency [rad/s]: growth below it is round-off of an undamped system
MANY = 30  # modes: with fewer, eigenvalues are as quick
BATCH = 2_000_000  # entries of the state matrices formed at once


def closed_poles(seen: Waves, compliance: float, speed: float) -> Complex | None:
    """All poles s [1/s, rad/s] at one speed [rad/s], (2 m,); None where the iteration does not settle, or for omega 0.

    In a hundredth of what eigenvalues take: waves of order n and standing modes (n = 0) are met at one point, so that
    their poles without contact p (N,) and residues a give f(s) = S + sum_j a_j/(s - p_j) = 0. Aberth's iteration (Math.
    Comp. 27, 1973, 339) finds its N roots together: Newton's step for f(s) prod (s - p_j), the others divided out.
    (s + i n Omega)^2 + 2 zeta omega (s + i n Omega) + omega^2 is what stands below each product r of rows.
    """
    if seen.omega.size == 0 or float(seen.omega.min()) <= 0.0:
        return None
    damped = seen.omega * np.sqrt(1.0 - seen.zeta**2)
    centre = -seen.zeta * seen.omega - 1j * seen.order * speed
    p = np.concatenate([centre + 1j * damped, centre - 1j * damped])
    a = np.concatenate([seen.product / (2j * damped), -seen.product / (2j * damped)])
    coupled = np.abs(a) > COUPLED * float(np.abs(a).max(initial=0.0))
    roots = _roots(p[coupled], a[coupled], compliance)
    return None if roots is None else np.concatenate([roots, p[~coupled]])


def _roots(p: Complex, a: Complex, S: float) -> Complex | None:
    """Zeros of S + sum a/(s - p), (N,)."""
    size = float(np.abs(p).max(initial=1.0))
    gaps = p[:, None] - p
    np.fill_diagonal(gaps, math.inf)
    with np.errstate(all="ignore"):
        s = p - a / (S + np.sum(a / gaps, axis=1))  # what the others' share there leaves of each
        bad = ~np.isfinite(s) | (s == p)
        s[bad] = p[bad] + 1e-6 * size * np.exp(1j * np.arange(np.count_nonzero(bad)))
        active = np.arange(p.size)
        for _ in range(MOST):
            near = 1.0 / (s[active, None] - p)
            apart = s[active, None] - s
            apart[np.arange(active.size), active] = math.inf
            f = S + near @ a
            ratio = -(near**2 @ a) / f + near.sum(axis=1)  # g'/g of g = f prod (s - p)
            step = 1.0 / (ratio - np.sum(1.0 / apart, axis=1))
            if not np.isfinite(step).all():
                return None
            s[active] -= step
            active = active[np.abs(step) > SETTLED * size]
            if not active.size:
                return np.asarray(s)
    return None


def poles(contact: ClosedContact, speed_hz: Array) -> NDArray[np.complex128]:
    """Poles s [1/s, rad/s] of a closed contact in the blade's frame, (speeds, 2 m).

    x' = [[-Omega G, I], [-omega^2 - W^T S^-1 Q, -Omega G - 2 zeta omega]] x, x = (q, (D + Omega G) q); all speeds
    in one batch. Raises InputError for speeds that are not finite.

    >>> from contact.model.gaps.permanent import HandPair, ModalPair
    >>> pair = HandPair(casing=ModalPair(n=8, freq_hz=300.0, modal_mass=1.5),
    ...                 blade=ModalPair(freq_hz=120.0, modal_mass=0.4), compliance=1e-4)
    >>> round(float(poles(pair.contact(), np.array([52.844])).real.max()), 4)
    3.7883
    """
    speed = np.atleast_1d(np.asarray(speed_hz, dtype=float))
    if speed.ndim != 1 or not np.all(np.isfinite(speed)):
        raise InputError("speed_hz: found speeds that are not finite, or not in one row, expected finite numbers")
    m = contact.omega.size
    found = np.empty((speed.size, 2 * m), dtype=complex)
    size = max(1, BATCH // (4 * m * m))
    for first in range(0, speed.size, size):
        part = slice(first, first + size)
        found[part] = np.linalg.eigvals(_states(contact, speed[part]))
    return found


def _states(contact: ClosedContact, speed_hz: Array) -> Array:
    """State matrices (speeds, 2 m, 2 m), velocities scaled by the highest frequency."""
    m = contact.omega.size
    scale = float(contact.omega.max(initial=0.0)) or 1.0
    turn = -2.0 * np.pi * speed_hz[:, None, None] * contact.G
    A = np.zeros((speed_hz.size, 2 * m, 2 * m))
    A[:, :m, :m] = turn
    A[:, :m, m:] = scale * np.eye(m)
    A[:, m:, m:] = turn - np.diag(2.0 * contact.zeta * contact.omega)
    for sense in np.unique(np.sign(speed_hz)):
        A[np.sign(speed_hz) == sense, m:, :m] = -(np.diag(contact.omega**2) + contact.joined(sense)) / scale
    return A


def state_matrix(contact: ClosedContact, speed_hz: float) -> tuple[Array, float]:
    """Matrix of x' = A x at one speed, x = (q, (D + Omega G) q/scale), and that scale [rad/s]."""
    scale = float(contact.omega.max(initial=0.0)) or 1.0
    return _states(contact, np.array([speed_hz]))[0], scale


def growth(contact: ClosedContact, speed_hz: Array) -> Array:
    """Largest real part of the poles [1/s], (speeds,): positive diverges."""
    return np.array([float(every.real.max()) for every in poles_each(contact, speed_hz)])


def poles_each(contact: ClosedContact, speed_hz: Array) -> list[NDArray[np.complex128]]:
    """Poles at each speed in no order: of one contact with many modes by its equation."""
    speed = np.atleast_1d(np.asarray(speed_hz, dtype=float))
    if len(contact.Q) > 1 or contact.omega.size < MANY or not np.isfinite(speed).all():
        return list(poles(contact, speed))
    seen = {
        sense: (waves(contact, sense), float(contact.compliance(sense)[0, 0])) for sense in np.unique(np.sign(speed))
    }
    found = (closed_poles(*seen[np.sign(hz)], 2.0 * np.pi * hz) for hz in speed)
    return [poles(contact, speed[k : k + 1])[0] if every is None else every for k, every in enumerate(found)]


def stability(contact: ClosedContact, speed_hz: Array) -> StabilityMap:
    """Growth map of a perfect casing, with the coincidences of one contact looked at closely and put in words."""
    speed = np.asarray(speed_hz, dtype=float)
    met = coincidences(contact) if len(contact.Q) == 1 else ()
    found = scan(lambda at: growth(contact, at), speed, floor=floor_of(contact), seeds=close_speeds(met))
    return replace(found, words=in_words(contact, met, found))


def rim_stability(rim: RotatingRim, speed_hz: Array, *, mu: float = 0.0) -> StabilityMap:
    """Growth map of a rim against its blade in closed contact; the rim's own speed is not used.

    A perfect casing by eigenvalues; a split one by Floquet's theory, which follows every turn and takes longer.
    """
    try:
        contact = rim_contact(rim, mu=mu)
    except SplitError:
        from contact.growth.split_casing import floquet_growth

        floor = FLOOR * float(max(rim.casing.omega.max(initial=0.0), rim.blade.omega.max(initial=0.0)))
        found = scan(lambda at: floquet_growth(rim, at, mu=mu), np.asarray(speed_hz, dtype=float), floor=floor)
        return replace(found, words="A split casing: growth per turn by Floquet's theory. " + in_words(None, (), found))
    return stability(contact, speed_hz)


def floor_of(contact: ClosedContact) -> float:
    """Growth [1/s] that is none: round-off of the poles."""
    return FLOOR * float(contact.omega.max(initial=0.0))
