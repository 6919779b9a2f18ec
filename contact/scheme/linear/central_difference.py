"""Central differences with forward increment Lagrange multipliers."""

from __future__ import annotations

from dataclasses import dataclass

from contact.model.bodies.beam import BeamInCircle
from contact.model.law import Law
from contact.scheme.beam.beam_stepper import prepare_beam, require_rigid
from contact.scheme.linear.leapfrog import prepare_leapfrog
from contact.scheme.protocol import Problem, Stepper


@dataclass(frozen=True, slots=True)
class CentralDifference:
    """Central differences + forward increment Lagrange multipliers (law: Unilateral).

    M (u_{n+1} - 2 u_n + u_{n-1})/h^2 + C (u_{n+1} - u_{n-1})/(2 h) + K u_n = f + Q^T force_n, g(u_{n+1}) >= 0, force_n
    >= 0, complementary (Carpenter, Taylor, Katona, Int. J. Numer. Meth. Eng. 32, 1991, 103). Explicit, dt omega_max <=
    2, also with contact; second order in smooth motion; no penetration. At each impact the contact nodes lose the
    energy of their own mass, and the first force is a spike of order 1/h.

    >>> CentralDifference()
    CentralDifference()
    """

    def prepare(self, problem: Problem, law: Law, *, dt: float | None, courant: float | None) -> Stepper:
        """Check law and step; raises InputError, LimitError."""
        from contact.loop.linear.leapfrog import FORWARD

        if isinstance(problem, BeamInCircle):
            require_rigid(law)
            return prepare_beam(problem, dt, courant)
        words = "central difference + forward Lagrange"
        return prepare_leapfrog("CentralDifference", words, FORWARD, problem, law, ("Unilateral",), dt, courant)
