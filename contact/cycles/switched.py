"""Linear motion that contacts switch: one linear system with periodic forcing for each set of closed contacts.

x' = A x + b(t) + B lam,  gap = C x + c(t) + S lam,  0 <= gap, lam, complementary; b, c periodic, given by harmonics.
With a compliance S (residual compliance, an obstacle's stiffness), lam = -S^-1 (C x + c) on the closed contacts. A
contact without compliance has C B = 0. It is rigid and hits with Newton's restitution. While it stays closed, lam
satisfies gap'' + (p + r) gap' + p r gap = 0, so that a gap that is zero at the start stays zero.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from contact.base.arrays import Array
from contact.base.errors import InputError, NumericsError

Complex = NDArray[np.complex128]
PULLS = (1.0, 1.7)  # p and r over the system's rate: two, so that the closed contact's poles stay apart
DEFECT = 1e11  # condition of eigenvectors beyond which they are none


class Forcing(NamedTuple):
    """A vector that is periodic in time: rest (n,) + Re sum of wave (n, harmonics) e^{i h w t}."""

    rest: Array
    wave: Complex

    def seen(self, rows: Array) -> Forcing:
        """Product of rows with the vector."""
        return Forcing(rows @ self.rest, rows @ self.wave)

    def plus(self, other: Forcing) -> Forcing:
        """Sum with another forcing."""
        return Forcing(self.rest + other.rest, self.wave + other.wave)

    def at(self, angle: Array) -> Array:
        """Value (n,) at these angles of the harmonics [rad]."""
        return np.asarray(self.rest + (self.wave @ np.exp(1j * angle)).real)

    def rate(self, w: Array) -> Forcing:
        """Derivative in time, for harmonics at w [rad/s]."""
        return Forcing(np.zeros_like(self.rest), 1j * w * self.wave)


@dataclass(frozen=True, eq=False, kw_only=True)
class Plant:
    """Quantities constant along a branch: A (n, n), B (n, k), C (k, n), S (k, k), outputs D (o, n), E (o, k).

    `rate` [rad/s] is a typical rate, used for closed rigid contacts; `restitution` (k,). The last `hidden` outputs are
    internal: `slips` gives contacts with the row of their slip. It must stay positive while the contact is closed, else
    friction would change its direction.
    """

    A: Array
    B: Array
    C: Array
    S: Array
    D: Array
    E: Array
    restitution: Array
    rate: float
    slips: tuple[tuple[int, int], ...] = ()
    hidden: int

    @cached_property
    def rigid(self) -> NDArray[np.bool_]:
        """Contacts without compliance of their own, (k,)."""
        return np.asarray(np.diag(self.S) == 0.0)

    @cached_property
    def soft(self) -> NDArray[np.intp]:
        """Indices of the contacts with a compliance."""
        return np.flatnonzero(~self.rigid)

    @cached_property
    def soft_S(self) -> Array:
        """The block of S of the contacts with a compliance."""
        return np.asarray(self.S[np.ix_(self.soft, self.soft)])

    @cached_property
    def shift(self) -> Array:
        """S, then E: gaps and outputs for unit forces at the contacts, (k + o, k)."""
        return np.vstack([self.S, self.E])

    @cached_property
    def gap_rates(self) -> Array:
        """C A: rate of each gap per unit of each state, (k, n)."""
        return np.asarray(self.C @ self.A)

    @cached_property
    def impulse(self) -> Array:
        """H = C A B: velocity of each gap for a unit impulse at each contact, (k, k)."""
        return np.asarray(self.gap_rates @ self.B)


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Drive:
    """Quantities that change along a branch: base frequency w [rad/s], harmonics, forcing of x, gaps and outputs."""

    w: float
    harmonics: Array
    b: Forcing
    c: Forcing
    d: Forcing


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Phase:
    """One set of closed contacts: lam = K x + G (forcing), x' = A x + ..., and its eigenvectors, one of each pair."""

    closed: tuple[int, ...]
    K: Array  # (closed, n)
    solve: Array  # (closed, closed)
    A: Array
    lam: Complex
    V: Complex  # (n, half), pairs counted twice
    U: Complex  # (half, n)
    rows: Array  # (k + o, n): watched quantities per unit of x


def phase_of(plant: Plant, closed: tuple[int, ...]) -> Phase:
    """Matrices and eigenvectors; raises InputError for rigid contacts that are not independent."""
    A, C = plant.A, plant.C
    chosen = list(closed)
    seen, L = C.copy(), plant.S[np.ix_(chosen, chosen)].copy()
    for row, i in enumerate(chosen):
        if plant.rigid[i]:
            p, r = (pull * plant.rate for pull in PULLS)
            velocity = C[i] @ A
            seen[i] = velocity @ A + (p + r) * velocity + p * r * C[i]
            L[row] = plant.impulse[i, chosen]
    if chosen and not np.linalg.cond(_balanced(L)) < 1e12:
        names = ", ".join(str(i + 1) for i in chosen)
        raise InputError(f"contact: rigid contacts {names} are not independent, expected a compliance (S or stiffness)")
    solve = np.asarray(np.linalg.inv(L))
    K = -solve @ seen[chosen]
    joined = A + plant.B[:, chosen] @ K
    lam, V = np.linalg.eig(joined)
    if not np.linalg.cond(V) < DEFECT:
        raise NumericsError(
            f"contacts closed {closed}: found two modes with the same frequency, expected distinct frequencies"
        )
    upper = np.flatnonzero(lam.imag >= 0.0)
    U = np.linalg.inv(V)[upper]
    V = V[:, upper] * np.where(lam[upper].imag > 0.0, 2.0, 1.0)
    rows = np.vstack([C, plant.D]) + plant.shift[:, chosen] @ K
    rows[chosen] = K
    return Phase(closed=closed, K=K, solve=solve, A=joined, lam=lam[upper], V=V, U=U, rows=rows)


def _balanced(L: Array) -> Array:
    """Rows, then columns, divided by their largest entry, so that contacts of any scale can be compared.

    Zeros stay zeros.
    """
    for axis in (1, 0):
        largest = np.abs(L).max(axis=axis, keepdims=True)
        L = L / np.where(largest > 0.0, largest, 1.0)
    return L


def pulls(plant: Plant, drive: Drive) -> Forcing:
    """Fourier terms of c(t) in the equation of each contact while it is closed, (k,)."""
    if not plant.rigid.any():
        return drive.c
    w = drive.w * drive.harmonics
    p, r = (pull * plant.rate for pull in PULLS)
    velocity = drive.c.rate(w).plus(drive.b.seen(plant.C))
    pull = drive.b.seen(plant.gap_rates).plus(velocity.rate(w))
    rigid = Forcing(
        pull.rest + (p + r) * velocity.rest + p * r * drive.c.rest,
        pull.wave + (p + r) * velocity.wave + p * r * drive.c.wave,
    )
    return Forcing(
        np.where(plant.rigid, rigid.rest, drive.c.rest), np.where(plant.rigid[:, None], rigid.wave, drive.c.wave)
    )
