"""Paoli-Schatzman: central differences with the gap constraint at an average of two positions."""

from __future__ import annotations

from dataclasses import dataclass

from contact.model.law import Law
from contact.scheme.linear.leapfrog import prepare_leapfrog
from contact.scheme.linear.stepper import LinearStepper, Rebound
from contact.scheme.protocol import Problem


@dataclass(frozen=True, slots=True, kw_only=True)
class PaoliSchatzman(Rebound):
    """Paoli-Schatzman: gap constraint at an average of the next and last position, restitution e (law: Unilateral).

    M (u_{n+1} - 2 u_n + u_{n-1})/h^2 + K u_n = f + Q^T force_n;  g((u_{n+1} + e u_{n-1})/(1 + e)) >= 0, force_n >= 0,
    complementary (Paoli, Schatzman, SIAM J. Numer. Anal. 40, 2002, 702 and 734). The weights make e Newton's
    restitution; e = 0 is the forward increment. Explicit, dt omega_max <= 2; second order in smooth motion, first
    across impacts; penetrates by a step of the motion when e > 0.

    >>> PaoliSchatzman(restitution=1.0).restitution
    1.0
    """

    def prepare(self, problem: Problem, law: Law, *, dt: float | None, courant: float | None) -> LinearStepper:
        """Check law and step; raises InputError, LimitError."""
        from contact.loop.linear.leapfrog import AVERAGED

        e = self.restitution
        return prepare_leapfrog("PaoliSchatzman", f"Paoli-Schatzman, e = {e:g}", AVERAGED, problem, law,
                                ("Unilateral",), dt, courant, e)  # fmt: skip
