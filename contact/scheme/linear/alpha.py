"""Implicit schemes with contact enforced at the end of the step: Newmark, HHT and contact-stabilised Newmark."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from contact.base.arrays import require_positive
from contact.base.errors import InputError
from contact.model.bodies.band import combine, factor, solve
from contact.model.bodies.beam import BeamInCircle
from contact.model.law import Law
from contact.scheme.beam.beam_stepper import prepare_beam_newmark, require_rigid
from contact.scheme.linear.stepper import LinearStepper, linear_stepper, parts_of, setup
from contact.scheme.protocol import Problem, Stepper

if TYPE_CHECKING:
    from contact.loop.linear.alpha import Weights


def newmark_limit(beta: float, gamma: float) -> float:
    """Largest stable h omega of undamped Newmark with gamma >= 1/2.

    1/sqrt(gamma/2 - beta), infinite for 2 beta >= gamma.

    >>> newmark_limit(0.25, 0.5), round(newmark_limit(0.25, 0.55), 3)
    (inf, 6.325)
    """
    return math.inf if 2.0 * beta >= gamma else 1.0 / math.sqrt(0.5 * gamma - beta)


def prepare_alpha(
    name: str, words: str, w: Weights, limit: float, problem: Problem, law: Law, dt: float | None,
    courant: float | None,
) -> LinearStepper:  # fmt: skip
    """Stepper of the generalised-alpha family; raises InputError, LimitError beyond dt omega_max = `limit`."""
    from contact.loop.linear.alpha import advance_alpha

    run = setup(name, problem, law, ("Unilateral", "Penalty", "AugmentedLagrangian"), dt, courant)
    system, h, implicit = run.system, run.h, 1.0 - w.af
    A = combine((1.0 - w.am, system.M), (implicit * w.gamma * h, system.C), (implicit * w.beta * h * h, system.K))
    parts = parts_of(system, A, 1.0)
    parts = parts._replace(W=w.beta * h * h * parts.W)
    return linear_stepper(run, parts, advance_alpha, (run.law, w), f"{words} + {law.words}", limit=limit)


@dataclass(frozen=True, slots=True, kw_only=True)
class HHT:
    """HHT with contact enforced at the end of each step, by multipliers, penalty or augmented Lagrangian; alpha = 0.

    Newmark.

    M a_{n+1} = (1 + alpha) F_{n+1} - alpha F_n + Q^T force, F = f - C v - K u, alpha in [-1/3, 0], with Newmark's
    formulas at beta = (1 - alpha)^2/4, gamma = 1/2 - alpha (Hilber, Hughes, Taylor, Earthq. Eng. Struct. Dyn. 5, 1977,
    283). Order 2 in smooth motion, unconditionally stable, dissipates the highest frequencies. Like inertia, the
    contact force is not averaged.

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


@dataclass(frozen=True, slots=True, kw_only=True)
class Newmark:
    """Newmark (beta > 0, gamma >= 1/2) with contact enforced at each step's end.

    Multipliers, penalty, augmented Lagrangian.

    M a_{n+1} + C v_{n+1} + K u_{n+1} = f + Q^T force, u_{n+1} = u_n + h v_n + h^2 ((1/2 - beta) a_n + beta a_{n+1}),
    v_{n+1} = v_n + h ((1 - gamma) a_n + gamma a_{n+1}), g(u_{n+1}) >= 0 (J. Eng. Mech. Div. ASCE 85, 1959, 67).

    Smooth motion: order 2 for gamma = 1/2, else 1; (1/4, 1/2) keeps the energy. Limit: dt omega_max <= 1/sqrt(gamma/2 -
    beta), none for 2 beta >= gamma. At an impact the contact node gets an acceleration of order 1/h, which alternates
    from step to step. With gamma = 1/2 it never decays and impacts add energy; with (1/4, .55) it decays too slowly and
    the force does not converge; with (1/2, .55) the force converges. `reports.verification.schemes.rod_wall` shows
    them.

    >>> Newmark(beta=0.5, gamma=0.55)
    Newmark(beta=0.5, gamma=0.55)
    """

    beta: float = 0.25
    gamma: float = 0.5

    def __post_init__(self) -> None:
        require_positive(beta=self.beta, gamma=self.gamma)
        if self.beta > 1.0:
            raise InputError(f"beta: found {self.beta!r}, expected at most 1 (0: use CentralDifference)")
        if not 0.5 <= self.gamma <= 1.0:
            raise InputError(f"gamma: found {self.gamma!r}, expected between 1/2 and 1: below, energy grows")

    def prepare(self, problem: Problem, law: Law, *, dt: float | None, courant: float | None) -> Stepper:
        """Check law and step; raises InputError, LimitError."""
        from contact.loop.linear.alpha import Weights

        if isinstance(problem, BeamInCircle):
            require_rigid(law)
            return prepare_beam_newmark(problem, self.beta, self.gamma, dt)
        words = f"Newmark ({self.beta:g}, {self.gamma:g})"
        weights = Weights(0.0, 0.0, self.beta, self.gamma)
        return prepare_alpha("Newmark", words, weights, newmark_limit(self.beta, self.gamma), problem, law, dt, courant)


@dataclass(frozen=True, slots=True)
class StabilisedNewmark:
    """Contact-stabilised Newmark: implicit contact, with a predictor that is projected onto the gap (law: Unilateral).

    Predictor u* = u_n + h v_n + s with g(u*) >= 0, s smallest in the metric of M; then u_{n+1} = u* + h^2/2 M^-1 (f - C
    v_m - K u_m + Q^T force), v_{n+1} = v_n + h M^-1 (...), u_m = (u_n + u_{n+1})/2, g(u_{n+1}) >= 0, force >= 0,
    complementary (Deuflhard, Krause, Ertel, Int. J. Numer. Meth. Eng. 73, 2008, 1274). Unconditionally stable, order 2
    in smooth motion, no penetration, no oscillation of a resting contact; energy kept without contact and never gained
    with it (the loss is in `numerical` and `lost_in_contact`). A contact without an elastic side, such as a point mass
    and a wall, keeps its closing speed, since no spring absorbs it; use another scheme there.

    >>> StabilisedNewmark()
    StabilisedNewmark()
    """

    def prepare(self, problem: Problem, law: Law, *, dt: float | None, courant: float | None) -> LinearStepper:
        """Check law and step; raises InputError."""
        from contact.loop.linear.alpha import advance_stabilised

        run = setup("StabilisedNewmark", problem, law, ("Unilateral",), dt, courant)
        system, h, Q = run.system, run.h, run.system.rows()
        parts = parts_of(system, combine((1.0, system.M), (0.5 * h, system.C), (0.25 * h * h, system.K)), h)
        parts = parts._replace(W=0.5 * h * parts.W)
        jump = np.ascontiguousarray(solve(factor(system.M, "M"), Q.T.copy()).T)
        method = (run.law, jump, np.ascontiguousarray(Q @ jump.T))
        return linear_stepper(run, parts, advance_stabilised, method, "contact-stabilised Newmark")
