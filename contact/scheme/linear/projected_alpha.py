"""Projected nonsmooth generalised-alpha: the contact is closed in position and in velocity at once.

Smooth motion as in `nonsmooth_alpha`, u~, v~ and (1 - am) a_{n+1} + am a_n = M^-1 ((1 - af) F_{n+1} + af F_n) without
contact forces; then two corrections of their own,

    u_{n+1} = u~ + M^-1 Q^T nu,   0 <= gap0 + Q u_{n+1},  nu >= 0, complementary,
    v_{n+1} = v~ + M^-1 Q^T P,    where nu > 0: 0 <= Q (v_{n+1} + e v_n),  P >= 0, complementary;  force = P/h

(Bruels, Acary, Cardona, Comput. Methods Appl. Mech. Eng. 281, 2014, 131). No penetration at the end of a step, which
the velocity form alone leaves behind; nu does work, which the ledger counts as the scheme's own. Unconditionally
stable without contact; takes energy from high frequencies, more for a smaller rho_inf.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from contact.model.bodies.band import solve
from contact.model.bodies.linear_system import LinearSystem
from contact.model.law import Law
from contact.scheme.linear.linear_stepper import LinearStepper, linear_stepper, product, setup
from contact.scheme.linear.nonsmooth_alpha import ImpactAlpha, chung_hulbert, smooth_parts
from contact.scheme.protocol import Problem

if TYPE_CHECKING:
    from contact.loop.linear.alpha import Weights
    from contact.loop.linear.linear import Parts
    from contact.loop.linear.projected import Corrections


@dataclass(frozen=True, slots=True, kw_only=True)
class ProjectedAlpha(ImpactAlpha):
    """Projected nonsmooth generalised-alpha with spectral radius rho_inf in [0, 1] and restitution e (law: Unilateral).

    >>> ProjectedAlpha(rho_inf=0.9).restitution
    0.0
    """

    def prepare(self, problem: Problem, law: Law, *, dt: float | None, courant: float | None) -> LinearStepper:
        """Check law and step; raises InputError."""
        from contact.loop.linear.projected import advance_projected

        run, w = setup("ProjectedAlpha", problem, law, ("Unilateral",), dt, courant), chung_hulbert(self.rho_inf)
        parts, corrections = _parts(run.system, w, run.h)
        words = f"projected nonsmooth generalised-alpha, rho_inf = {self.rho_inf:g}, e = {self.restitution:g}"
        return linear_stepper(run, parts, advance_projected, (run.law, w, corrections, self.restitution), words)


def _parts(system: LinearSystem, w: Weights, h: float) -> tuple[Parts, Corrections]:
    """Arrays of the run; what unit corrections nu and P do to u, v and a, and so to gaps and their rates."""
    from contact.loop.linear.projected import Corrections

    parts, factored, jump = smooth_parts(system, w, h)
    jump, Q, implicit = np.ascontiguousarray(jump), system.rows(), 1.0 - w.af
    of_nu, of_impulse = (
        np.ascontiguousarray(-implicit * solve(factored, np.array([product(pull, row) for row in jump]).T.copy()).T)
        for pull in (system.K, system.C)
    )
    k, W = len(Q), Q @ jump.T
    return parts, Corrections(
        jump=jump, of_nu=of_nu, of_impulse=of_impulse,
        gap_nu=np.ascontiguousarray(W + w.beta * h * h * (Q @ of_nu.T)),
        gap_impulse=np.ascontiguousarray(w.beta * h * h * (Q @ of_impulse.T)),
        rate_nu=np.ascontiguousarray(w.gamma * h * (Q @ of_nu.T)),
        rate_impulse=np.ascontiguousarray(W + w.gamma * h * (Q @ of_impulse.T)),
        nu=np.zeros(k), impulse=np.zeros(k), rate=np.zeros(k), given=np.zeros(k), last=np.zeros(k),
    )  # fmt: skip
