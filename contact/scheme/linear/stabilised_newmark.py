"""Contact-stabilised Newmark: implicit contact, and a predictor that is projected onto the gap.

Predictor u* = u_n + h v_n + s with g(u*) >= 0, s smallest in the metric of M; then
u_{n+1} = u* + h^2/2 M^-1 (f - C v_m - K u_m + Q^T force), v_{n+1} = v_n + h M^-1 (...), u_m = (u_n + u_{n+1})/2,
g(u_{n+1}) >= 0, force >= 0, complementary (Deuflhard, Krause, Ertel, Int. J. Numer. Meth. Eng. 73, 2008, 1274).
Unconditionally stable, order 2 in smooth motion, no penetration, no oscillation of a resting contact; energy kept
without contact and never gained with it (the loss is in `numerical` and `lost_in_contact`).
A contact without an elastic side, as of a point mass and a wall, keeps the speed it closes with, because no spring
takes it up: take another scheme there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contact.model.bodies.band import combine, factor, solve
from contact.model.law import Law
from contact.scheme.linear.linear_stepper import LinearStepper, linear_stepper, parts_of, setup
from contact.scheme.protocol import Problem


@dataclass(frozen=True, slots=True)
class StabilisedNewmark:
    """Contact-stabilised Newmark (law: Unilateral).

    >>> StabilisedNewmark()
    StabilisedNewmark()
    """

    def prepare(self, problem: Problem, law: Law, *, dt: float | None, courant: float | None) -> LinearStepper:
        """Check law and step; raises InputError."""
        from contact.loop.linear.stabilised import advance_stabilised

        run = setup("StabilisedNewmark", problem, law, ("Unilateral",), dt, courant)
        system, h, Q = run.system, run.h, run.system.rows()
        parts = parts_of(system, combine((1.0, system.M), (0.5 * h, system.C), (0.25 * h * h, system.K)), h)
        parts = parts._replace(W=0.5 * h * parts.W)
        jump = np.ascontiguousarray(solve(factor(system.M, "M"), Q.T.copy()).T)
        method = (run.law, jump, np.ascontiguousarray(Q @ jump.T))
        return linear_stepper(run, parts, advance_stabilised, method, "contact-stabilised Newmark")
