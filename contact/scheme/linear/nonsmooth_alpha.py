"""Nonsmooth generalised-alpha: second order between impacts, an impact law on velocities at them.

Smooth: (1 - am) a_{n+1} + am a_n = M^-1 ((1 - af) F_{n+1} + af F_n), with Chung and Hulbert's weights for the spectral
radius rho_inf at high frequency (J. Appl. Mech. 60, 1993, 371). Impact: M w = Q^T P, v_{n+1} = ... + w,
u_{n+1} = ... + h w/2; where the free step closes the gap: Q v_{n+1} + e Q v_n >= 0, P >= 0, complementary; force = P/h
(Chen, Acary, Virlez, Bruels, Int. J. Numer. Meth. Eng. 96, 2013, 487: the gap is held by velocities only;
`projected_alpha` also projects positions).
Unconditionally stable; takes energy from high frequencies, more for a smaller rho_inf.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from contact.base.errors import InputError
from contact.model.bodies.band import combine, factor, solve
from contact.model.bodies.linear_system import LinearSystem
from contact.model.law import Law
from contact.scheme.linear.linear_stepper import (
    LinearStepper,
    linear_stepper,
    parts_of,
    product,
    require_restitution,
    setup,
)
from contact.scheme.protocol import Problem

if TYPE_CHECKING:
    from contact.base.arrays import Array
    from contact.loop.linear.alpha import Weights
    from contact.loop.linear.linear import Parts
    from contact.model.bodies.band import Factor


@dataclass(frozen=True, slots=True, kw_only=True)
class ImpactAlpha:
    """What generalised-alpha schemes with impacts take: the spectral radius rho_inf in [0, 1], and restitution e."""

    rho_inf: float = 0.8
    restitution: float = 0.0

    def __post_init__(self) -> None:
        require_restitution(self.restitution)
        if not 0.0 <= self.rho_inf <= 1.0:
            raise InputError(f"rho_inf: found {self.rho_inf!r}, expected between 0 and 1")


@dataclass(frozen=True, slots=True, kw_only=True)
class NonsmoothAlpha(ImpactAlpha):
    """Nonsmooth generalised-alpha with spectral radius rho_inf in [0, 1] and restitution e (law: Unilateral).

    >>> NonsmoothAlpha(rho_inf=0.8).restitution
    0.0
    """

    def prepare(self, problem: Problem, law: Law, *, dt: float | None, courant: float | None) -> LinearStepper:
        """Check law and step; raises InputError."""
        from contact.loop.linear.moreau import advance_nonsmooth

        run, w = setup("NonsmoothAlpha", problem, law, ("Unilateral",), dt, courant), chung_hulbert(self.rho_inf)
        parts, jump = _parts(run.system, w, run.h)
        words = f"nonsmooth generalised-alpha, rho_inf = {self.rho_inf:g}, e = {self.restitution:g}"
        return linear_stepper(run, parts, advance_nonsmooth, (run.law, w, jump, self.restitution), words)


def chung_hulbert(rho_inf: float) -> Weights:
    """Weights of second order with spectral radius rho_inf at infinite frequency.

    >>> chung_hulbert(1.0)
    Weights(am=0.5, af=0.5, beta=0.25, gamma=0.5)
    """
    from contact.loop.linear.alpha import Weights

    am, af = (2.0 * rho_inf - 1.0) / (rho_inf + 1.0), rho_inf / (rho_inf + 1.0)
    gamma = 0.5 + af - am
    return Weights(am, af, 0.25 * (gamma + 0.5) ** 2, gamma)


def smooth_parts(system: LinearSystem, w: Weights, h: float) -> tuple[Parts, Factor, Array]:
    """Arrays of motion without contact, its factored matrix, velocity jumps M^-1 Q^T of unit impulses (k, N)."""
    implicit = 1.0 - w.af
    A = combine((1.0 - w.am, system.M), (implicit * w.gamma * h, system.C), (implicit * w.beta * h * h, system.K))
    factored = factor(A, "M + h C + h^2 K")
    jump = solve(factor(system.M, "M"), system.rows().T.copy()).T
    return parts_of(system, A, 1.0, factored=factored), factored, jump


def _parts(system: LinearSystem, w: Weights, h: float) -> tuple[Parts, Array]:
    """Arrays of the run, and the velocity jumps of unit impulses."""
    (parts, factored, jump), Q, implicit = smooth_parts(system, w, h), system.rows(), 1.0 - w.af
    pull = np.array([product(system.C, row) + 0.5 * h * product(system.K, row) for row in jump])
    response = -implicit * solve(factored, pull.T.copy()).T
    W = Q @ jump.T + w.gamma * h * (Q @ response.T)
    return parts._replace(response=np.ascontiguousarray(response), W=np.ascontiguousarray(W)), np.ascontiguousarray(
        jump
    )
