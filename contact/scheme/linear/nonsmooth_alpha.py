"""Schemes with an impact law on velocities: Moreau-Jean, nonsmooth generalised-alpha, and its projected form."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from contact.base.errors import InputError
from contact.model.bodies.band import combine, factor, solve
from contact.model.bodies.linear_system import LinearSystem
from contact.model.law import Law
from contact.scheme.linear.stepper import LinearStepper, linear_stepper, parts_of, product, require_restitution, setup
from contact.scheme.protocol import Problem

if TYPE_CHECKING:
    from contact.base.arrays import Array
    from contact.loop.linear.alpha import Weights
    from contact.loop.linear.linear import Parts
    from contact.loop.linear.moreau import Corrections
    from contact.model.bodies.band import Factor


@dataclass(frozen=True, slots=True, kw_only=True)
class MoreauJean:
    """Moreau-Jean: impulses, weight theta in [1/2, 1] and Newton's restitution e (law: Unilateral).

    M (v_{n+1} - v_n) = h (theta F_{n+1} + (1 - theta) F_n) + Q^T P,
    u_{n+1} = u_n + h (theta v_{n+1} + (1 - theta) v_n); where g_n + h Q v_n/2 <= 0: Q v_{n+1} + e Q v_n >= 0,
    P >= 0, complementary; force = P/h (Moreau, in Nonsmooth Mechanics and Applications, CISM 302, 1988, 1; Jean,
    Comput. Methods Appl. Mech. Eng. 177, 1999, 235). Unconditionally stable for theta >= 1/2; order 2 in smooth motion
    at 1/2, else 1; theta = 1/2 keeps the energy between impacts, and through them with e = 1 (Acary, Z. Angew. Math.
    Mech. 96, 2016, 585). Penetrates by part of a step.

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
        from contact.loop.linear.moreau import advance_moreau

        run = setup("MoreauJean", problem, law, ("Unilateral",), dt, courant)
        system, step = run.system, run.h * self.theta
        parts = parts_of(system, combine((1.0, system.M), (step, system.C), (step**2, system.K)), 1.0)
        words = f"Moreau-Jean, theta = {self.theta:g}, e = {self.restitution:g}"
        return linear_stepper(run, parts, advance_moreau, (run.law, self.theta, self.restitution), words)


@dataclass(frozen=True, slots=True, kw_only=True)
class ImpactAlpha:
    """Parameters of generalised-alpha schemes with impacts: spectral radius rho_inf in [0, 1], restitution e."""

    rho_inf: float = 0.8
    restitution: float = 0.0

    def __post_init__(self) -> None:
        require_restitution(self.restitution)
        if not 0.0 <= self.rho_inf <= 1.0:
            raise InputError(f"rho_inf: found {self.rho_inf!r}, expected between 0 and 1")


@dataclass(frozen=True, slots=True, kw_only=True)
class NonsmoothAlpha(ImpactAlpha):
    """Nonsmooth generalised-alpha: order 2 between impacts, with an impact law on velocities (law: Unilateral).

    Smooth: (1 - am) a_{n+1} + am a_n = M^-1 ((1 - af) F_{n+1} + af F_n), with Chung and Hulbert's weights for the
    spectral radius rho_inf in [0, 1] at high frequency (J. Appl. Mech. 60, 1993, 371). Impact: M w = Q^T P, v_{n+1} =
    ... + w, u_{n+1} = ... + h w/2; where the free step closes the gap: Q v_{n+1} + e Q v_n >= 0, P >= 0, complementary;
    force = P/h (Chen, Acary, Virlez, Bruels, Int. J. Numer. Meth. Eng. 96, 2013, 487: the gap is fixed by velocities
    only; `ProjectedAlpha` also projects positions). Unconditionally stable; dissipates high frequencies, more for a
    smaller rho_inf.

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
    """Weights of second order with spectral radius rho_inf at infinite frequency (Chung and Hulbert).

    >>> chung_hulbert(1.0)
    Weights(am=0.5, af=0.5, beta=0.25, gamma=0.5)
    """
    from contact.loop.linear.alpha import Weights

    am, af = (2.0 * rho_inf - 1.0) / (rho_inf + 1.0), rho_inf / (rho_inf + 1.0)
    gamma = 0.5 + af - am
    return Weights(am, af, 0.25 * (gamma + 0.5) ** 2, gamma)


def smooth_parts(system: LinearSystem, w: Weights, h: float) -> tuple[Parts, Factor, Array]:
    """Arrays of motion without contact, its factored matrix, and velocity jumps M^-1 Q^T of unit impulses (k, N)."""
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
    parts = parts._replace(response=np.ascontiguousarray(response), W=np.ascontiguousarray(W))
    return parts, np.ascontiguousarray(jump)


@dataclass(frozen=True, slots=True, kw_only=True)
class ProjectedAlpha(ImpactAlpha):
    """Nonsmooth generalised-alpha that enforces contact in position and velocity (law: Unilateral).

    Smooth motion as in `NonsmoothAlpha`, u~, v~ and (1 - am) a_{n+1} + am a_n = M^-1 ((1 - af) F_{n+1} + af F_n)
    without contact forces; then two separate corrections,

        u_{n+1} = u~ + M^-1 Q^T nu,   0 <= gap0 + Q u_{n+1},  nu >= 0, complementary,
        v_{n+1} = v~ + M^-1 Q^T P,    where nu > 0: 0 <= Q (v_{n+1} + e v_n),  P >= 0, complementary;  force = P/h

    (Bruels, Acary, Cardona, Comput. Methods Appl. Mech. Eng. 281, 2014, 131). There is no penetration at the end of a
    step, unlike with the velocity form alone. The work of nu counts as that of the scheme. Unconditionally stable
    without contact; dissipates high frequencies, more for a smaller rho_inf.

    >>> ProjectedAlpha(rho_inf=0.9).restitution
    0.0
    """

    def prepare(self, problem: Problem, law: Law, *, dt: float | None, courant: float | None) -> LinearStepper:
        """Check law and step; raises InputError."""
        from contact.loop.linear.moreau import advance_projected

        run, w = setup("ProjectedAlpha", problem, law, ("Unilateral",), dt, courant), chung_hulbert(self.rho_inf)
        parts, corrections = _projected(run.system, w, run.h)
        words = f"projected nonsmooth generalised-alpha, rho_inf = {self.rho_inf:g}, e = {self.restitution:g}"
        return linear_stepper(run, parts, advance_projected, (run.law, w, corrections, self.restitution), words)


def _projected(system: LinearSystem, w: Weights, h: float) -> tuple[Parts, Corrections]:
    """Arrays of the run; effect of unit corrections nu and P on u, v and a, and on gaps and their rates."""
    from contact.loop.linear.moreau import Corrections

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
