"""Exact coefficients of damped modes over one step, and the energy of a two-step state.

D <- al D - be q + c f;  q <- q + D, with a = zeta omega, w_d = omega sqrt(1 - zeta^2), al = exp(-2 a h),
be = (1 - e^{-a h})^2 + 4 e^{-a h} sin^2(w_d h/2), c = be/omega^2 (h^2 if omega = 0): Gautschi's form (Numer.
Math. 3, 1961, 381). Free motion and statics are exact for any h.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from contact.base.arrays import Array, readonly, require_positive
from contact.base.errors import InputError
from contact.base.remembered import remembered
from contact.record.energy import Stored
from contact.record.record import Tally
from contact.scheme.modal.coupled import Coupled
from contact.scheme.protocol import PlainStepper, window

SYMMETRIC = 1e-12  # relative


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Propagator:
    """Coefficients (m,) each for a step h; `fade` = e^{-a h}, `turn` = w_d h.

    `stiff` is omega^2, 1 for rigid modes; `stay` = cos(w_d h) - a/w_d sin(w_d h), `drift` = sin(w_d h)/w_d. `rigid`:
    whether there are rigid modes. `coupled` modes have separate coefficients; their entries in `al`, `be`, `c` and
    `omega` are zero.
    """

    h: float
    omega: Array
    load: Array
    al: Array
    be: Array
    c: Array
    fade: Array
    turn: Array
    stiff: Array
    stay: Array
    drift: Array
    rigid: bool
    coupled: Coupled | None = None

    @property
    def top(self) -> float:
        """Highest frequency [rad/s]."""
        own = float(self.omega.max(initial=0.0))
        return own if self.coupled is None else max(own, self.coupled.top)

    @property
    def weight(self) -> Array:
        """(1 - al)/(2 c), for the work of damping; zero for coupled modes."""
        return np.divide(1.0 - self.al, 2.0 * self.c, out=np.zeros(self.c.size), where=self.c > 0.0)

    def yields(self, rows: Array) -> Array:
        """Rows (R, m) times the matrix c: the response of a step to forces along them."""
        found = rows * self.c
        if self.coupled is not None:
            found[:, self.coupled.modes] = rows[:, self.coupled.modes] @ self.coupled.c
        return found

    def roots(self, rows: Array) -> Array | None:
        """Rows (R, m) times a root L of c = L L^T; None if c is not symmetric."""
        found = rows * np.sqrt(self.c)
        if self.coupled is not None:
            c, own = self.coupled.c, self.coupled.modes
            if np.abs(c - c.T).max() > SYMMETRIC * np.abs(c).max():
                return None
            found[:, own] = rows[:, own] @ np.linalg.cholesky(0.5 * (c + c.T))
        return np.asarray(found)

    def push(self, force: Array) -> Array:
        """Response c f of a step to forces on the modes."""
        found = self.c * force
        if self.coupled is not None:
            found[self.coupled.modes] = self.coupled.c @ force[self.coupled.modes]
        return np.asarray(found)

    def backward(self, q: Array, velocity: Array) -> Array:
        """D = q(0) - q(-h) of the motion through (q, velocity) under the load."""
        rest = self._rest(self.load)
        before = (self.stay * (q - rest) - self.drift * velocity) / self.fade
        elastic = q - (rest + before)
        rigid = self.h * velocity - 0.5 * self.h**2 * self.load
        found = np.where(self.omega > 0.0, elastic, rigid)
        if self.coupled is not None:
            own = self.coupled.modes
            found[own] = self.coupled.backward(q[own], velocity[own], self.load[own])
        return np.asarray(found)

    def velocity(self, q: Array, d: Array, force: Array) -> Array:
        """Velocity at t_n of the motion through q_{n-1}, q_n with constant `force` (load and contact)."""
        rest = self._rest(force)
        elastic = 1.0 / self.drift * (self.stay * (q - rest) - self.fade * (q - d - rest))
        if not self.rigid:
            return np.asarray(elastic)
        found = np.where(self.omega > 0.0, elastic, d / self.h + 0.5 * self.h * force)
        if self.coupled is not None:
            own = self.coupled.modes
            found[own] = self.coupled.velocity(q[own], d[own], force[own])
        return np.asarray(found)

    def _rest(self, force: Array) -> Array:
        """Static displacement of elastic modes, zero for rigid ones."""
        return np.asarray(np.where(self.omega > 0.0, force / self.stiff, 0.0) if self.rigid else force / self.stiff)

    def stored(self, q: Array, d: Array, contact: Array, residual: float, potential: float) -> Stored:
        """Energies at t_n; discrete form D^T D/(2 c) + omega^2 q_{n-1} q_n/2 - f (q_{n-1} + q_n)/2."""
        v = self.velocity(q, d, self.load + contact)
        old = q - d
        strain = 0.5 * float(np.sum((self.omega * q) ** 2))
        if self.coupled is None:
            discrete = 0.5 * np.sum(d * d / self.c) + 0.5 * np.sum(self.omega**2 * old * q)
        else:
            single, own = self.c > 0.0, self.coupled.modes
            discrete = 0.5 * np.sum(d[single] ** 2 / self.c[single]) + 0.5 * np.sum(self.omega**2 * old * q)
            discrete += self.coupled.discrete(q[own], d[own])
            strain += 0.5 * float(q[own] @ self.coupled.stiff @ q[own])
        return Stored(
            kinetic=0.5 * float(v @ v), strain=strain,
            potential=potential - float(self.load @ q), residual=residual,
            discrete=float(potential + discrete - 0.5 * self.load @ (q + old)),
        )  # fmt: skip


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class ExactRun(PlainStepper):
    """Base of exact-modal runs with several contacts."""

    parts: Propagator
    sums: Tally
    label: str

    @property
    def dt(self) -> float:
        """Time step [s]."""
        return self.parts.h

    @property
    def window(self) -> float:
        """Period of the highest mode [s]."""
        return window(self.parts.top, self.dt)


@remembered
def propagator(omega: Array, zeta: Array, load: Array, h: float) -> Propagator:
    """Coefficients of the modes (omega [rad/s], zeta) under a constant load, for a step h [s].

    >>> p = propagator(np.array([0.0, 10.0]), np.zeros(2), np.zeros(2), 0.1)
    >>> [round(float(x), 6) for x in p.c]
    [0.01, 0.009194]
    """
    a = zeta * omega
    turn = omega * np.sqrt(1.0 - zeta**2) * h
    fade = np.exp(-a * h)
    be = np.expm1(-a * h) ** 2 + 4.0 * fade * np.sin(turn / 2.0) ** 2
    elastic = omega > 0.0
    stiff = np.where(elastic, omega, 1.0) ** 2
    c = np.where(elastic, be / stiff, h * h)
    slope = zeta / np.sqrt(1.0 - zeta**2)
    return Propagator(
        h=h, omega=omega, load=load, al=readonly(fade**2), be=readonly(be), c=readonly(c),
        fade=readonly(fade),
        turn=readonly(turn), stiff=readonly(stiff), stay=readonly(np.cos(turn) - slope * np.sin(turn)),
        drift=readonly(h * np.sinc(turn / np.pi)), rigid=not elastic.all(),
    )  # fmt: skip


def with_coupled(omega: Array, zeta: Array, load: Array, h: float, part: Coupled) -> Propagator:
    """Coefficients if some of the modes are coupled; `omega` and `zeta` of these are not used."""
    own = np.zeros(omega.size, dtype=bool)
    own[part.modes] = True
    found = propagator(np.where(own, 0.0, omega), np.where(own, 0.0, zeta), load, h)
    al, be, c = (readonly(np.where(own, 0.0, values)) for values in (found.al, found.be, found.c))
    return replace(found, al=al, be=be, c=c, rigid=True, coupled=part)


def step_of(top: float, dt: float | None, courant: float | None) -> float:
    """Time step: dt, or 2 courant over the highest frequency `top` [rad/s], or 0.8 over it; raises InputError.

    >>> step_of(100.0, None, 0.5), step_of(100.0, 1e-3, None), step_of(100.0, None, None)
    (0.01, 0.001, 0.008)
    """
    if dt is not None and courant is not None:
        raise InputError("dt: found both dt and courant, expected one of them")
    if dt is not None:
        require_positive(dt=dt)
        return dt
    if top == 0.0:
        raise InputError("dt: found none with rigid bodies only, expected a time step")
    product = 0.8 if courant is None else 2.0 * courant
    require_positive(courant=product)
    return product / top
