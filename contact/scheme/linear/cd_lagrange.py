"""CD-Lagrange: central differences with an impact law on velocities."""

from __future__ import annotations

from dataclasses import dataclass

from contact.model.law import Law
from contact.scheme.linear.leapfrog import prepare_leapfrog
from contact.scheme.linear.stepper import LinearStepper, Rebound
from contact.scheme.protocol import Problem


@dataclass(frozen=True, slots=True, kw_only=True)
class CDLagrange(Rebound):
    """CD-Lagrange: an impact law on velocities, Newton's restitution e (law: Unilateral).

    u_{n+1} = u_n + h v_{n+1/2}; M (v_{n+1/2} - v_{n-1/2}) = h (f - K u_n) + Q^T P_n; where g(u_n) <= 0: Q v_{n+1/2} + e
    Q v_{n-1/2} >= 0, P_n >= 0, complementary; force = P/h (Fekak, Brun, Gravouil, Depale, Comput. Mech. 60, 2017, 1; Di
    Stasio, Dureisseix, Gravouil, Georges, Homolle, Adv. Model. Simul. Eng. Sci. 6, 2019, 8). Explicit, dt omega_max <=
    2; second order in smooth motion, first across impacts; penetrates by at most h times the approach speed; e < 1
    dissipates energy, never adds it. `residual` is h times that of the velocity law.

    >>> CDLagrange(restitution=0.8).restitution
    0.8
    """

    def prepare(self, problem: Problem, law: Law, *, dt: float | None, courant: float | None) -> LinearStepper:
        """Check law and step; raises InputError, LimitError."""
        from contact.loop.linear.leapfrog import IMPULSE

        e = self.restitution
        return prepare_leapfrog("CDLagrange", f"CD-Lagrange, e = {e:g}", IMPULSE, problem, law, ("Unilateral",), dt,
                                courant, e)  # fmt: skip
