"""Explicit schemes on linear problems: one leapfrog loop, four rules of contact."""

from __future__ import annotations

from dataclasses import dataclass

from contact.base.errors import InputError
from contact.model.bodies.band import combine
from contact.model.bodies.beam import BeamInCircle
from contact.model.bodies.linear_system import omega_max
from contact.model.law import Law
from contact.scheme.beam.beam_stepper import BeamStepper, prepare_beam, require_rigid
from contact.scheme.linear.linear_stepper import LinearStepper, linear_stepper, parts_of, require_restitution, setup
from contact.scheme.protocol import Problem

CONSISTENT = 200  # coordinates up to which solving with M in every step is let pass


def prepare_leapfrog(
    name: str, words: str, rule: int, problem: Problem, law: Law, allowed: tuple[str, ...], dt: float | None,
    courant: float | None, restitution: float = 0.0,
) -> LinearStepper:  # fmt: skip
    """Stepper with one of the rules of `loop.leapfrog`; raises InputError, LimitError beyond dt omega_max = 2.

    A contact spring counts in the limit, taken with every contact closed.
    """
    from contact.loop.linear.leapfrog import advance_leapfrog

    run = setup(name, problem, law, allowed, dt, courant)
    system, h = run.system, run.h
    omega = omega_max(system, contact_stiffness=law.stiffness) if law.stiffness else run.omega
    if not system.M.lumped and system.size > CONSISTENT:
        raise InputError(f"M: found a consistent mass matrix, expected a lumped one for {name} (it is explicit)")
    parts = parts_of(system, combine((1.0 / h**2, system.M), (0.5 / h, system.C)), 1.0)
    method = (run.law, rule, restitution)
    return linear_stepper(run, parts, advance_leapfrog, method, words, limit=2.0, omega=omega, leapfrog=True)


@dataclass(frozen=True, slots=True)
class CentralDifference:
    """Central differences + forward increment Lagrange multipliers (law: Unilateral).

    M (u_{n+1} - 2 u_n + u_{n-1})/h^2 + C (u_{n+1} - u_{n-1})/(2 h) + K u_n = f + Q^T force_n,
    g(u_{n+1}) >= 0, force_n >= 0, complementary
    (Carpenter, Taylor, Katona, Int. J. Numer. Meth. Eng. 32, 1991, 103). Explicit, dt omega_max <= 2, which contact
    does not lower; second order in smooth motion; no penetration. The nodes that meet lose the energy of their own
    mass at each impact, and the first force is a spike that grows as 1/h.

    >>> CentralDifference()
    CentralDifference()
    """

    def prepare(
        self, problem: Problem, law: Law, *, dt: float | None, courant: float | None
    ) -> LinearStepper | BeamStepper:
        """Check law and step; raises InputError, LimitError."""
        from contact.loop.linear.leapfrog import FORWARD

        if isinstance(problem, BeamInCircle):
            require_rigid(law)
            return prepare_beam(problem, dt, courant)
        words = "central difference + forward Lagrange"
        return prepare_leapfrog("CentralDifference", words, FORWARD, problem, law, ("Unilateral",), dt, courant)


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


@dataclass(frozen=True, slots=True, kw_only=True)
class CDLagrange:
    """CD-Lagrange: an impact law on velocities, Newton's restitution e (law: Unilateral).

    u_{n+1} = u_n + h v_{n+1/2};  M (v_{n+1/2} - v_{n-1/2}) = h (f - K u_n) + Q^T P_n;  where g(u_n) <= 0:
    Q v_{n+1/2} + e Q v_{n-1/2} >= 0, P_n >= 0, complementary; force = P/h
    (Fekak, Brun, Gravouil, Depale, Comput. Mech. 60, 2017, 1; Di Stasio, Dureisseix, Gravouil, Georges, Homolle,
    Adv. Model. Simul. Eng. Sci. 6, 2019, 8). Explicit, dt omega_max <= 2; second order in smooth motion, first across
    impacts; penetrates by at most h times the speed of approach; e < 1 takes energy out, never in. `residual` is
    that of the velocity law times h.

    >>> CDLagrange(restitution=0.8).restitution
    0.8
    """

    restitution: float = 0.0

    def __post_init__(self) -> None:
        require_restitution(self.restitution)

    def prepare(self, problem: Problem, law: Law, *, dt: float | None, courant: float | None) -> LinearStepper:
        """Check law and step; raises InputError, LimitError."""
        from contact.loop.linear.leapfrog import IMPULSE

        e = self.restitution
        return prepare_leapfrog("CDLagrange", f"CD-Lagrange, e = {e:g}", IMPULSE, problem, law, ("Unilateral",), dt,
                                courant, e)  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class PaoliSchatzman:
    """Paoli-Schatzman: the gap kept at an average of next and last position, restitution e (law: Unilateral).

    M (u_{n+1} - 2 u_n + u_{n-1})/h^2 + K u_n = f + Q^T force_n;  g((u_{n+1} + e u_{n-1})/(1 + e)) >= 0, force_n >= 0,
    complementary (Paoli, Schatzman, SIAM J. Numer. Anal. 40, 2002, 702 and 734). The weights make e Newton's
    restitution; e = 0 is the forward increment. Explicit, dt omega_max <= 2; second order in smooth motion, first
    across impacts; penetrates by a step of the motion when e > 0.

    >>> PaoliSchatzman(restitution=1.0).restitution
    1.0
    """

    restitution: float = 0.0

    def __post_init__(self) -> None:
        require_restitution(self.restitution)

    def prepare(self, problem: Problem, law: Law, *, dt: float | None, courant: float | None) -> LinearStepper:
        """Check law and step; raises InputError, LimitError."""
        from contact.loop.linear.leapfrog import AVERAGED

        e = self.restitution
        return prepare_leapfrog("PaoliSchatzman", f"Paoli-Schatzman, e = {e:g}", AVERAGED, problem, law,
                                ("Unilateral",), dt, courant, e)  # fmt: skip
