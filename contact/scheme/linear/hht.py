"""Hilber-Hughes-Taylor's alpha method with Lagrange multipliers, the gap held at the end of each step.

M a_{n+1} = (1 + alpha) F_{n+1} - alpha F_n + Q^T force, F = f - C v - K u, alpha in [-1/3, 0], with Newmark's
formulas at beta = (1 - alpha)^2/4, gamma = 1/2 - alpha (Hilber, Hughes, Taylor, Earthq. Eng. Struct. Dyn. 5, 1977,
283). Order 2 in smooth motion, unconditionally stable, takes energy from the highest frequencies. The contact force
is not averaged, as inertia is not.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from contact.base.errors import InputError
from contact.model.law import Law
from contact.scheme.linear.alpha import prepare_alpha
from contact.scheme.linear.linear_stepper import LinearStepper
from contact.scheme.protocol import Problem


@dataclass(frozen=True, slots=True, kw_only=True)
class HHT:
    """HHT + Lagrange, penalty or augmented Lagrangian; alpha = 0 is Newmark (1/4, 1/2).

    >>> HHT(alpha=-0.1).alpha
    -0.1
    """

    alpha: float = -0.1

    def __post_init__(self) -> None:
        if not -1.0 / 3.0 <= self.alpha <= 0.0:
            raise InputError(f"alpha: found {self.alpha!r}, expected between -1/3 and 0")

    def prepare(self, problem: Problem, law: Law, *, dt: float | None, courant: float | None) -> LinearStepper:
        """Check law and step; raises InputError."""
        from contact.loop.linear.alpha import Weights

        alpha = self.alpha
        weights = Weights(0.0, -alpha, 0.25 * (1.0 - alpha) ** 2, 0.5 - alpha)
        return prepare_alpha("HHT", f"HHT ({alpha:g})", weights, math.inf, problem, law, dt, courant)
