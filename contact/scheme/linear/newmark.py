"""Newmark's method with Lagrange multipliers, the gap held at the end of each step.

M a_{n+1} + C v_{n+1} + K u_{n+1} = f + Q^T force, u_{n+1} = u_n + h v_n + h^2 ((1/2 - beta) a_n + beta a_{n+1}),
v_{n+1} = v_n + h ((1 - gamma) a_n + gamma a_{n+1}), g(u_{n+1}) >= 0 (Newmark, J. Eng. Mech. Div. ASCE 85, 1959, 67).

Smooth motion: order 2 for gamma = 1/2, else 1; (1/4, 1/2) keeps the energy. Limit: dt omega_max <=
1/sqrt(gamma/2 - beta), none for 2 beta >= gamma. Contact: the node that meets takes an acceleration of the order 1/h,
which alternates from step to step: with gamma = 1/2 it never fades and impacts add energy, with (1/4, .55) it fades too
slowly and the force does not converge, with (1/2, .55) it does. `reports.contact.rod_wall` shows them.
"""

from __future__ import annotations

from dataclasses import dataclass

from contact.base.arrays import require_positive
from contact.base.errors import InputError
from contact.model.bodies.beam import BeamInCircle
from contact.model.law import Law
from contact.scheme.beam.beam_implicit import ImplicitBeamStepper, prepare_beam_newmark
from contact.scheme.beam.beam_run import require_rigid
from contact.scheme.linear.alpha import newmark_limit, prepare_alpha
from contact.scheme.linear.linear_stepper import LinearStepper
from contact.scheme.protocol import Problem


@dataclass(frozen=True, slots=True, kw_only=True)
class Newmark:
    """Newmark (beta > 0, gamma >= 1/2) + Lagrange, penalty or augmented Lagrangian.

    >>> Newmark(beta=0.5, gamma=0.55)
    Newmark(beta=0.5, gamma=0.55)
    """

    beta: float = 0.25
    gamma: float = 0.5

    def __post_init__(self) -> None:
        require_positive(beta=self.beta, gamma=self.gamma)
        if self.beta > 1.0:
            raise InputError(f"beta: found {self.beta!r}, expected at most 1 (0: use CentralDifference)")
        if not 0.5 <= self.gamma <= 1.0:
            raise InputError(f"gamma: found {self.gamma!r}, expected between 1/2 and 1: below, energy grows")

    def prepare(
        self, problem: Problem, law: Law, *, dt: float | None, courant: float | None
    ) -> LinearStepper | ImplicitBeamStepper:
        """Check law and step; raises InputError, LimitError."""
        from contact.loop.linear.alpha import Weights

        if isinstance(problem, BeamInCircle):
            require_rigid(law)
            return prepare_beam_newmark(problem, self.beta, self.gamma, dt)
        words = f"Newmark ({self.beta:g}, {self.gamma:g})"
        weights = Weights(0.0, 0.0, self.beta, self.gamma)
        return prepare_alpha("Newmark", words, weights, newmark_limit(self.beta, self.gamma), problem, law, dt, courant)
