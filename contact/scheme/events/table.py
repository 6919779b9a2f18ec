"""Phases of a run as arrays of the compiled loop; each is computed when the run first enters it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from contact.base.arrays import Array, Indices
from contact.scheme.events.phase import Complex, Phase, phase_of
from contact.scheme.events.system import EventSystem

if TYPE_CHECKING:
    from contact.loop.certified import Phases

ANGLE = 0.5  # of the fastest mode over the shortest step from table to table [rad]
LEVELS = 24
ROOM = 2  # phases at first
PADDED = -1.0  # pole [1/s] that fills up phases with fewer of them


class Known:
    """The phases met so far, by their closed contacts, and their arrays."""

    __slots__ = ("arrays", "h", "phases", "system")

    def __init__(self, system: EventSystem, h: float) -> None:
        self.system, self.h = system, h
        self.phases = [phase_of(system, ())]
        self.arrays = self._filled(ROOM)

    def add(self, closed: Indices) -> bool:
        """Add the phase of these closed contacts; returns whether the number of poles has changed."""
        self.phases.append(phase_of(self.system, tuple(np.flatnonzero(closed).tolist())))
        a, number = self.arrays, len(self.phases) - 1
        room, levels, _, m = a.factor.shape
        if number < room and self.poles <= m and self.levels <= levels:
            _fill(a, number, self.phases[-1], self.h)
            return False
        self.arrays = self._filled(2 * room)
        return bool(self.poles > m)

    @property
    def poles(self) -> int:
        """Largest number of poles of a phase."""
        return max(phase.lam.size for phase in self.phases)

    @property
    def levels(self) -> int:
        """Number of steps h, h/2, ... for which the motion of the poles is in a table."""
        fastest = max(float(np.abs(phase.lam).max(initial=0.0)) for phase in self.phases)
        return min(max(math.ceil(math.log2(max(self.h * fastest / ANGLE, 1.0))) + 1, 1), LEVELS)

    def _filled(self, room: int) -> Phases:
        from contact.loop.certified import Phases

        (k, n), m, r = self.system.N.shape, self.poles, self.phases[0].R.shape[1]
        d = m if self.phases[0].damping is not None or self.system.C.any() else 0
        sizes = {
            "lam": (2, m), "factor": (self.levels, 2, m), "V": (2, n, m), "U": (2, m, 2 * n), "R": (n, r), "rest": (n,),
            "pull": (r,), "level": (k,), "terms": (k,), "moved": (k, r), "rows": (3, 2, k, m),
            "sizes": (3, k, m), "loss": (4, d, d),
        }  # fmt: skip
        a = Phases(
            known=np.zeros(1, int), closed=np.full((room, k), -1), flying=np.zeros(room, int),
            **{name: np.zeros((room, *shape)) for name, shape in sizes.items()},
        )  # fmt: skip
        for number, phase in enumerate(self.phases):
            _fill(a, number, phase, self.h)
        return a


def _fill(a: Phases, number: int, phase: Phase, h: float) -> None:
    """Write a phase into the arrays."""
    m, r, chosen = phase.lam.size, phase.R.shape[1], list(phase.closed)
    a.closed[number] = 0
    a.closed[number, chosen] = 1
    a.flying[number] = not chosen
    a.lam[number, 0], a.lam[number, 1] = PADDED, 0.0
    rho = phase.place @ phase.V + phase.speed @ (phase.V * phase.lam)
    steps = h * 0.5 ** np.arange(a.factor.shape[1])
    for part, of in enumerate((np.real, np.imag)):
        a.lam[number, part, :m], a.V[number, part, :, :m] = of(phase.lam), of(phase.V)
        a.U[number, part, :m] = of(phase.U)
        a.factor[number, :, part, :m] = of(np.exp(np.outer(steps, phase.lam)))
        for kind, row in enumerate((rho, rho * phase.lam, rho / phase.lam)):
            a.rows[number, kind, part, :, :m] = of(row)
    for kind in range(3):
        a.sizes[number, kind, :, :m] = np.abs(rho * phase.lam**kind)
    a.R[number, :, :r], a.rest[number], a.pull[number, :r] = phase.R, phase.rest, phase.pull
    a.level[number], a.terms[number] = phase.level, phase.terms
    a.moved[number, :, :r] = phase.place @ phase.R
    a.moved[number, chosen] = 0.0  # round-off
    if phase.damping is not None:
        a.loss[number, :, :m, :m] = _loss(phase.V * phase.lam, phase.damping)
    a.known[0] = number + 1


def _loss(V: Complex, C: Array) -> Array:
    """V^T C V and V^T C conj(V), each with its real and its imaginary part."""
    one, other = V.T @ C @ V, V.T @ C @ V.conj()
    return np.array([one.real, one.imag, other.real, other.imag])
