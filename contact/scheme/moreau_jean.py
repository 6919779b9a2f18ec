"""Moreau-Jean's theta scheme: impulses, and an impact law on velocities.

M (v_{n+1} - v_n) = h (theta F_{n+1} + (1 - theta) F_n) + Q^T P,  u_{n+1} = u_n + h (theta v_{n+1} + (1 - theta) v_n);
where g_n + h Q v_n/2 <= 0: Q v_{n+1} + e Q v_n >= 0, P >= 0, complementary; force = P/h
(Moreau, in Nonsmooth Mechanics and Applications, CISM 302, 1988, 1; Jean, Comput. Methods Appl. Mech. Eng. 177, 1999,
235). Unconditionally stable for theta >= 1/2; order 2 in smooth motion at 1/2, else 1; theta = 1/2 keeps the energy
between impacts, and through them with e = 1 (Acary, Z. Angew. Math. Mech. 96, 2016, 585). Penetrates by part of a step.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from contact.errors import InputError
from contact.model.band import combine
from contact.model.law import Law, Unilateral
from contact.model.linear_system import omega_max
from contact.record import Samples, Tally
from contact.scheme.linear_stepper import (
    LinearStepper,
    linear_step,
    linear_stepper,
    parts_of,
    require_law,
    require_linear,
    require_restitution,
    require_stable,
)
from contact.scheme.protocol import Problem

if TYPE_CHECKING:
    from contact.model.arrays import Array
    from contact.scheme.loop_linear import Parts, State


@dataclass(frozen=True, slots=True, kw_only=True)
class MoreauJean:
    """Moreau-Jean with weight theta in [1/2, 1] and Newton's restitution e (law: Unilateral).

    >>> MoreauJean(restitution=0.5).theta
    0.5
    """

    theta: float = 0.5
    restitution: float = 0.0

    def __post_init__(self) -> None:
        require_restitution(self.restitution)
        if not 0.5 <= self.theta <= 1.0:
            raise InputError(f"theta: found {self.theta!r}, expected between 1/2 and 1: below, energy grows")

    def prepare(self, problem: Problem, law: Law, *, dt: float | None, courant: float | None) -> LinearStepper:
        """Check law and step; raises InputError."""
        from contact.scheme.loop_moreau import advance_moreau

        system, numbers = require_linear(problem, "MoreauJean"), require_law(law, "MoreauJean", Unilateral)
        h, theta, e = linear_step(problem, dt, courant), self.theta, self.restitution
        omega = omega_max(system)
        A = combine((1.0, system.M), (h * theta, system.C), ((h * theta) ** 2, system.K))
        reached = require_stable(h, omega, math.inf, "MoreauJean")

        def loop(
            p: Parts, s: State, sums: Tally, out: Samples, amplitudes: Array, h: float, first: int, steps: int
        ) -> int:
            return advance_moreau(p, s, numbers, theta, e, sums, out, amplitudes, h, first, steps)

        label = f"Moreau-Jean, theta = {theta:g}, e = {e:g}, {reached}"
        return linear_stepper(system, parts_of(system, A, 1.0), loop, h, label, omega=omega)
