"""Poles and growth rates of a contact that stays closed, over speed, without time stepping.

A perfect casing in the blade's frame has constant coefficients: its growth is the largest real part of the
eigenvalues. A split casing's coefficients are periodic in time in either frame: Floquet (`split_casing`).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from contact.base.arrays import Array
from contact.base.errors import InputError
from contact.io.progress import each
from contact.io.threads import with_one_thread
from contact.model.gaps.permanent import ClosedContact
from contact.stability.waves import FreePoles, waves_of

Complex = NDArray[np.complex128]
MOST = 60  # rounds
SETTLED = 1e-12  # of the largest pole: the next step would be none, convergence is cubic
COUPLED = 1e-14  # of the largest residue: below, contact does not see a mode
FLOOR = 1e-8  # of the highest frequency [rad/s]: growth below it is round-off of an undamped system
MANY = 30  # modes: with fewer, eigenvalues are equally fast
BATCH = 2_000_000  # entries of the state matrices formed at once


class FirstOrder(NamedTuple):
    """x' = A x + B lam, gap = C x + S lam of the bodies, x = (q, (D + Omega G) q/rates): (2 m, 2 m), (2 m, r), ..."""

    A: Array
    B: Array
    C: Array
    S: Array

    def closed(self) -> Array:
        """A - B S^-1 C: the system with all gaps closed."""
        return np.asarray(self.A - self.B @ np.linalg.solve(self.S, self.C))

    def receptance(self, s: complex) -> Complex:
        """Motion of each contact per force at each, C (s - A)^-1 B, (r, r) [m/N]: response of the bodies without S."""
        return np.asarray(self.C @ np.linalg.solve(s * np.eye(len(self.A)) - self.A, self.B.astype(complex)))


def first_order(contact: ClosedContact, speed: float) -> FirstOrder:
    """The bodies of a contact at a speed [rad/s], in the frame of the contact points."""
    m, rate, sense = contact.omega.size, contact.rates, math.copysign(1.0, speed) if speed else 0.0
    C, K = contact.matrices(speed)
    turn = -speed * contact.G
    A = np.block([
        [turn, np.diag(rate)], [-K / rate[:, None], (turn - C) * (rate / rate[:, None])],
    ])  # fmt: skip
    none = np.zeros((len(contact.Q), m))
    return FirstOrder(
        A, np.vstack([none.T, contact.pushes(sense).T / rate[:, None]]), np.hstack([contact.Q, none]),
        contact.compliance(sense),
    )  # fmt: skip


def closed_poles(free: FreePoles | None, compliance: float) -> Complex | None:
    """All poles s [1/s, rad/s] with one contact, (2 m,), from those of the free bodies; None without convergence.

    This takes a hundredth of the time of eigenvalues of all modes. The free bodies have poles p (N,) with residues a at
    the contact (`contact.stability.waves`), so that f(s) = S + sum_j a_j/(s - p_j) = 0. Aberth's iteration (Math. Comp.
    27, 1973, 339) finds its N roots together: Newton's step for f(s) prod (s - p_j), with the other roots divided out.
    """
    if free is None or not free.s.size:
        return None
    p, a = free.s[0], free.residues[0]
    coupled = np.abs(a) > COUPLED * float(np.abs(a).max(initial=0.0))
    roots = _roots(p[coupled], a[coupled], compliance)
    return None if roots is None else np.concatenate([roots, p[~coupled]])


def _roots(p: Complex, a: Complex, S: float) -> Complex | None:
    """Zeros of S + sum a/(s - p), (N,)."""
    from contact.loop.aberth import aberth, first_guess

    size = float(np.abs(p).max(initial=1.0))
    p_re, p_im, a_re, a_im = (np.ascontiguousarray(part) for part in (p.real, p.imag, a.real, a.imag))
    x, y, steps = np.empty(p.size), np.empty(p.size), np.full(p.size, math.inf)
    first_guess(p_re, p_im, a_re, a_im, S, x, y)
    s = x + 1j * y
    bad = ~np.isfinite(s) | (s == p)
    s[bad] = p[bad] + 1e-6 * size * np.exp(1j * np.arange(np.count_nonzero(bad)))
    x[:], y[:] = s.real, s.imag
    settled = aberth(p_re, p_im, a_re, a_im, S, x, y, steps, MOST, SETTLED * size)
    return x + 1j * y if settled else None


@with_one_thread
def poles(contact: ClosedContact, speed_hz: Array) -> Complex:
    """Poles s [1/s, rad/s] of a closed contact in the blade's frame, (speeds, 2 m): eigenvalues of `first_order`.

    Raises InputError for speeds that are not finite, and where the matrices of a body are not known.

    >>> from contact.model.gaps.permanent import HandPair, ModalPair
    >>> pair = HandPair(casing=ModalPair(n=8, freq_hz=300.0, modal_mass=1.5),
    ...                 blade=ModalPair(freq_hz=120.0, modal_mass=0.4), compliance=1e-4)
    >>> round(float(poles(pair.contact(), np.array([52.844])).real.max()), 4)
    3.7883
    """
    speed = np.atleast_1d(np.asarray(speed_hz, dtype=float))
    if speed.ndim != 1 or not np.all(np.isfinite(speed)):
        raise InputError("speed_hz: found speeds that are not finite, or not in one row, expected finite numbers")
    contact.require_known(2.0 * math.pi * speed)
    m = contact.omega.size
    found = np.empty((speed.size, 2 * m), dtype=complex)
    size = max(1, BATCH // (4 * m * m))
    for first in each(range(0, speed.size, size), "lot of speeds"):
        part = speed[first : first + size]
        closed = [first_order(contact, 2.0 * math.pi * hz).closed() for hz in part.tolist()]
        found[first : first + size] = np.linalg.eigvals(np.array(closed))
    return found


def growth(contact: ClosedContact, speed_hz: Array) -> Array:
    """Largest real part of the poles [1/s], (speeds,); positive: the motion grows."""
    return np.array([float(every.real.max()) for every in poles_each(contact, speed_hz)])


def poles_each(contact: ClosedContact, speed_hz: Array) -> list[Complex]:
    """Poles at each speed in no order; for one contact with many modes from its scalar equation."""
    speed = np.atleast_1d(np.asarray(speed_hz, dtype=float))
    if len(contact.Q) > 1 or contact.omega.size < MANY or not np.isfinite(speed).all():
        return list(poles(contact, speed))
    contact.require_known(2.0 * math.pi * speed)
    found: list[Complex] = [np.zeros(0, dtype=complex)] * speed.size
    for sense in np.unique(np.sign(speed)):
        S, own = float(contact.compliance(sense)[0, 0]), np.flatnonzero(np.sign(speed) == sense)
        frees = waves_of(contact).poles_each(2.0 * math.pi * speed[own], float(sense))
        for k, free in zip(each(own.tolist(), "speed"), frees, strict=True):
            every = closed_poles(free, S)
            found[k] = poles(contact, speed[k : k + 1])[0] if every is None else every
    return found


def floor_of(contact: ClosedContact) -> float:
    """Growth [1/s] below which poles differ from zero only by round-off."""
    return FLOOR * float(contact.omega.max(initial=0.0))
