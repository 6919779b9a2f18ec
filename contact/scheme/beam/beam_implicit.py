"""A hinged beam in a rigid circle, in progress: Newmark with Lagrange multipliers at t_{n+1}, Newton in each step.

Unconditionally stable for linear motion when gamma >= 1/2, beta >= gamma/2; second order for gamma = 1/2 only. Samples
stand at the end of their step.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from contact.base.arrays import require_positive
from contact.base.errors import InputError
from contact.model.bodies.beam import BeamInCircle
from contact.record.energy import Stored
from contact.record.record import Samples, tally
from contact.scheme.beam.beam_run import BeamRun
from contact.scheme.protocol import Motion

if TYPE_CHECKING:
    from contact.loop.beam.implicit import ImplicitBeam, ImplicitWork


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class ImplicitBeamStepper(BeamRun):
    """State of an implicit beam run."""

    state: ImplicitBeam
    work: ImplicitWork

    def advance(self, out: Samples, first: int, steps: int) -> int:
        """Advance by whole steps; -1, or the step that failed."""
        from contact.loop.beam.implicit import advance_implicit

        return advance_implicit(self.state, self.work, self.sums, out, self.dt, first, steps)

    def why(self) -> str:
        """Explain a failed step."""
        return "Newton's method found no state that satisfies motion and contact: reduce dt"

    def stored(self) -> Stored:
        """Energies at t_n; the discrete form leaves out what Newmark itself added or took."""
        from contact.loop.beam.beam import strain_energy_and_forces

        s = self.state
        kinetic = 0.5 * float(np.sum(s.mass * s.v**2))
        strain = strain_energy_and_forces(s.x, s.rest, s.EA, s.EI, np.zeros_like(s.x))
        potential = -self.problem.beam.torque * float(s.x[0, 2])
        discrete = kinetic + strain + potential - float(s.ledger[0])
        return Stored(kinetic=kinetic, strain=strain, potential=potential, residual=0.0, discrete=discrete)

    def motions(self) -> tuple[Motion, ...]:
        """Momentum of the beam along x."""
        return self.motion(self.state.v)

    def angular_momentum(self) -> tuple[float, float]:
        """About the hinge, and the impulse of the contacts' moment so far [kg m^2/s, N m s]."""
        return self.spin(self.state.x, self.state.v), float(self.state.ledger[1])


def prepare_beam_newmark(problem: BeamInCircle, beta: float, gamma: float, dt: float | None) -> ImplicitBeamStepper:
    """Stepper at t = 0; raises InputError for a flexible ring or a missing dt."""
    from contact.loop.beam.implicit import ImplicitBeam, implicit_work

    if problem.ring is not None:
        raise InputError("ring: found a flexible ring with Newmark, expected CentralDifference or a rigid circle")
    if dt is None:
        raise InputError("dt: found none, expected a time step in seconds (an implicit scheme has no Courant number)")
    require_positive(dt=dt)
    beam = problem.beam
    x, mass = beam.nodes(), beam.lumped()
    load = np.zeros_like(x)
    load[0, 2] = beam.torque
    velocity = beam.spin * np.stack([-x[:, 1], x[:, 0], np.ones(len(x))], axis=1)
    acceleration = load / mass
    gaps = problem.gaps(x)[1:]
    n = len(x)
    state = ImplicitBeam(
        x=x, v=velocity, a=acceleration, mass=mass, load=load, rest=beam.length / beam.elements,
        EA=beam.E * beam.area, EI=beam.E * beam.second_moment, beta=beta, gamma=gamma, radius=problem.radius,
        offset=problem.offset, force=np.zeros(n - 1), gap=gaps.copy(), last=np.zeros(n - 1), before=gaps.copy(),
        ledger=np.zeros(3),
    )  # fmt: skip
    label = f"Newmark({beta:g}, {gamma:g}) + Lagrange, dt omega_max = {dt * beam.omega_max():.3g} (no limit)"
    return ImplicitBeamStepper(
        problem=problem, state=state, work=implicit_work(n), sums=tally(n - 1), dt=dt, label=label,
        window=max(2.0 * np.pi / beam.omega_max(), dt),
    )  # fmt: skip
