"""A hinged beam in a circle, in progress: central differences with forward increment Lagrange multipliers.

M (x_{n+1} - 2 x_n + x_{n-1})/h^2 = f - f_int(x_n) + force_n, lumped M; each node that would leave the circle is pushed
back along its radius until it lies on the (moved) rim exactly. Angular momentum about the hinge changes by the impulse
of the moments, to round-off, whatever the step: internal forces of co-rotational elements are in equilibrium.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from contact.base.arrays import require_positive
from contact.base.errors import InputError, LimitError, rounded_down
from contact.model.bodies.beam import BeamInCircle, ring_table
from contact.record.energy import Stored
from contact.record.record import Samples, tally
from contact.scheme.beam.beam_run import BeamRun
from contact.scheme.modal.propagator import Propagator, propagator
from contact.scheme.protocol import Motion

if TYPE_CHECKING:
    from contact.loop.beam.beam import BeamState, BeamWork


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class BeamStepper(BeamRun):
    """State of an explicit beam run."""

    state: BeamState
    work: BeamWork
    ring: Propagator

    def advance(self, out: Samples, first: int, steps: int) -> int:
        """Advance by whole steps; -1, or the step that failed."""
        from contact.loop.beam.beam import advance_beam

        return advance_beam(self.state, self.work, self.sums, out, self.dt, first, steps)

    def why(self) -> str:
        """Explain a failed step."""
        return "the motion is not a number: reduce dt"

    def stored(self) -> Stored:
        """Kinetic energy at the half step, strain energy at t_n, the torque's potential, the ring's energies."""
        from contact.loop.beam.beam import INTERNAL, strain_energy_and_forces

        s, h = self.state, self.dt
        mass = self.problem.beam.lumped()
        kinetic = 0.5 * float(np.sum(mass * (s.d / h) ** 2))
        middle = s.x - 0.5 * s.d
        strain = strain_energy_and_forces(middle, s.rest, s.EA, s.EI, np.zeros_like(s.x))
        potential = -self.problem.beam.torque * float(middle[0, 2])
        contact = s.phi[1:].T @ s.force if s.q.size else np.zeros(0)
        residual = self._residual()
        ring = self.ring.stored(s.q, s.dq, contact, residual, 0.0)
        return Stored(
            kinetic=kinetic + ring.kinetic, strain=strain + ring.strain, potential=potential, residual=residual,
            discrete=kinetic + float(s.ledger[INTERNAL]) + potential + ring.discrete,
        )  # fmt: skip

    def _residual(self) -> float:
        pressed = self.state.waves[1:].T @ self.state.force if self.state.q.size else np.zeros(1)
        return 0.5 * float(pressed @ self.state.S @ pressed)

    def motions(self) -> tuple[Motion, ...]:
        """Momentum of the beam along x, at the half step."""
        return self.motion(self.state.d / self.dt)

    def angular_momentum(self) -> tuple[float, float]:
        """About the hinge, at the half step, and the impulse of the contacts' moment so far [kg m^2/s, N m s]."""
        from contact.loop.beam.beam import MOMENT

        s = self.state
        return self.spin(s.x, s.d / self.dt), float(s.ledger[MOMENT]) * self.dt


def beam_step(problem: BeamInCircle, dt: float | None, courant: float | None) -> float:
    """Time step from `dt`, or `courant` times 2/omega_max; raises LimitError beyond the limit."""
    if (dt is None) == (courant is None):
        raise InputError("dt: found both or neither of dt and courant, expected one of them")
    limit = 2.0 / problem.beam.omega_max()
    if courant is not None:
        require_positive(courant=courant)
        dt = courant * limit
    assert dt is not None
    require_positive(dt=dt)
    if dt > limit * (1.0 + 1e-9):
        raise LimitError(
            f"dt: found {dt:.11g} s, dt * omega_max = {2.0 * dt / limit:.11g}, expected <= 2 (stability of central "
            f"differences): take dt <= {rounded_down(limit, 11)} s"
        )
    return dt


def prepare_beam(problem: BeamInCircle, dt: float | None, courant: float | None) -> BeamStepper:
    """Stepper at t = 0."""
    from contact.loop.beam.beam import BeamState, beam_work

    beam, h = problem.beam, beam_step(problem, dt, courant)
    x, mass = beam.nodes(), beam.lumped()
    rate = h * h / mass
    rate[0, :2] = 0.0
    load = np.zeros_like(x)
    load[0, 2] = beam.torque
    velocity = beam.spin * np.stack([-x[:, 1], x[:, 0], np.ones(len(x))], axis=1)
    rows, S = ring_table(problem.ring)
    m, n = rows.shape[1], len(x)
    omega, zeta = (np.zeros(0), np.zeros(0)) if problem.ring is None else (problem.ring.omega, problem.ring.zeta)
    ring = propagator(omega, zeta, np.zeros(m), h)
    gaps = problem.gaps(x)
    state = BeamState(
        x=x, d=h * velocity - 0.5 * rate * load, rate=rate, load=load, rest=beam.length / beam.elements,
        EA=beam.E * beam.area, EI=beam.E * beam.second_moment, inner=np.zeros_like(x), q=np.zeros(m), dq=np.zeros(m),
        al=ring.al, be=ring.be, c=ring.c, rows=rows, S=S, radius=problem.radius, offset=problem.offset,
        push=np.zeros((n, 2)), waves=np.zeros((n, rows.shape[0])), phi=np.zeros((n, m)),
        rim=np.zeros(rows.shape[0]), free=gaps.copy(), before=gaps[1:].copy(), force=np.zeros(n - 1),
        gap=gaps[1:].copy(), scale=rate[1:, 0].copy(), ledger=np.zeros(2),
    )  # fmt: skip
    product = h * beam.omega_max()
    label = f"central difference + forward Lagrange, dt omega_max = {product:.3g} (limit 2)"
    return BeamStepper(
        problem=problem, state=state, work=beam_work(state), ring=ring, sums=tally(n - 1), dt=h, label=label,
        window=max(2.0 * math.pi / beam.omega_max(), h),
    )  # fmt: skip
