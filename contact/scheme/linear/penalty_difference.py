"""Central differences with an explicit contact spring."""

from __future__ import annotations

from dataclasses import dataclass

from contact.model.law import Law
from contact.scheme.linear.leapfrog import prepare_leapfrog
from contact.scheme.linear.stepper import LinearStepper
from contact.scheme.protocol import Problem


@dataclass(frozen=True, slots=True)
class PenaltyDifference:
    """Central differences with an explicit contact spring (law: Penalty).

    M (u_{n+1} - 2 u_n + u_{n-1})/h^2 + K u_n = f + Q^T force_n,  force_n = stiffness <-g(u_n)>. The spring
    counts in the stability limit dt omega_max <= 2, taken with every contact closed. The force error does not
    fall with the mesh, and energy grows at the limit: kept for comparison.

    >>> PenaltyDifference()
    PenaltyDifference()
    """

    def prepare(self, problem: Problem, law: Law, *, dt: float | None, courant: float | None) -> LinearStepper:
        """Check law and step, contact spring included; raises InputError, LimitError."""
        from contact.loop.linear.leapfrog import SPRING

        words = f"central difference + {law.words}"
        return prepare_leapfrog("PenaltyDifference", words, SPRING, problem, law, ("Penalty",), dt, courant)
