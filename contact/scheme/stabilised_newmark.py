"""Contact-stabilised Newmark: implicit contact, and a predictor that is projected onto the gap.

Predictor u* = u_n + h v_n + s with g(u*) >= 0, s smallest in the metric of M; then
u_{n+1} = u* + h^2/2 M^-1 (f - C v_m - K u_m + Q^T force), v_{n+1} = v_n + h M^-1 (...), u_m = (u_n + u_{n+1})/2,
g(u_{n+1}) >= 0, force >= 0, complementary (Deuflhard, Krause, Ertel, Int. J. Numer. Meth. Eng. 73, 2008, 1274).
Unconditionally stable, order 2 in smooth motion, no penetration, no oscillation of a resting contact; energy kept
without contact and never gained with it (the loss is in `numerical` and `lost_in_contact`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from contact.model.band import combine, factor, solve
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
    require_stable,
)
from contact.scheme.protocol import Problem

if TYPE_CHECKING:
    from contact.model.arrays import Array
    from contact.scheme.loop_linear import Parts, State


@dataclass(frozen=True, slots=True)
class StabilisedNewmark:
    """Contact-stabilised Newmark (law: Unilateral).

    >>> StabilisedNewmark()
    StabilisedNewmark()
    """

    def prepare(self, problem: Problem, law: Law, *, dt: float | None, courant: float | None) -> LinearStepper:
        """Check law and step; raises InputError."""
        from contact.scheme.loop_stabilised import advance_stabilised

        name = "StabilisedNewmark"
        system, numbers = require_linear(problem, name), require_law(law, name, Unilateral)
        h = linear_step(problem, dt, courant)
        omega = omega_max(system)
        parts = parts_of(system, combine((1.0, system.M), (0.5 * h, system.C), (0.25 * h * h, system.K)), h)
        parts = parts._replace(W=0.5 * h * parts.W)
        Q = system.rows()
        jump = np.ascontiguousarray(solve(factor(system.M, "M"), Q.T.copy()).T)
        opening = np.ascontiguousarray(Q @ jump.T)

        def loop(
            p: Parts, s: State, sums: Tally, out: Samples, amplitudes: Array, h: float, first: int, steps: int
        ) -> int:
            return advance_stabilised(p, s, numbers, jump, opening, sums, out, amplitudes, h, first, steps)

        label = f"contact-stabilised Newmark, {require_stable(h, omega, math.inf, name)}"
        return linear_stepper(system, parts, loop, h, label, omega=omega)
