"""Moreau-Jean's theta scheme: impulses, and an impact law on velocities.

M (v_{n+1} - v_n) = h (theta F_{n+1} + (1 - theta) F_n) + Q^T P,  u_{n+1} = u_n + h (theta v_{n+1} + (1 - theta) v_n);
where g_n + h Q v_n/2 <= 0: Q v_{n+1} + e Q v_n >= 0, P >= 0, complementary; force = P/h
(Moreau, in Nonsmooth Mechanics and Applications, CISM 302, 1988, 1; Jean, Comput. Methods Appl. Mech. Eng. 177, 1999,
235). Unconditionally stable for theta >= 1/2; order 2 in smooth motion at 1/2, else 1; theta = 1/2 keeps the energy
between impacts, and through them with e = 1 (Acary, Z. Angew. Math. Mech. 96, 2016, 585). Penetrates by part of a step.
"""

from __future__ import annotations

from dataclasses import dataclass

from contact.base.errors import InputError
from contact.model.bodies.band import combine
from contact.model.law import Law
from contact.scheme.linear.linear_stepper import LinearStepper, linear_stepper, parts_of, require_restitution, setup
from contact.scheme.protocol import Problem


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
        from contact.loop.linear.moreau import advance_moreau

        run = setup("MoreauJean", problem, law, ("Unilateral",), dt, courant)
        system, step = run.system, run.h * self.theta
        parts = parts_of(system, combine((1.0, system.M), (step, system.C), (step**2, system.K)), 1.0)
        words = f"Moreau-Jean, theta = {self.theta:g}, e = {self.restitution:g}"
        return linear_stepper(run, parts, advance_moreau, (run.law, self.theta, self.restitution), words)
