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

    M (u_{n+1} - 2 u_n + u_{n-1})/h^2 + K u_n = f + Q^T force_n, force_n = stiffness <-g(u_n)>. The stability limit dt
    omega_max <= 2 includes the spring, with every contact closed. The force error does not decrease with the mesh size,
    and energy grows at the limit. The scheme is provided for comparison.

    >>> PenaltyDifference()
    PenaltyDifference()
    """

    def prepare(self, problem: Problem, law: Law, *, dt: float | None, courant: float | None) -> LinearStepper:
        """Check law and step, with the contact spring; raises InputError, LimitError."""
        from contact.loop.linear.leapfrog import SPRING

        words = f"central difference + {law.words}"
        return prepare_leapfrog("PenaltyDifference", words, SPRING, problem, law, ("Penalty",), dt, courant)
