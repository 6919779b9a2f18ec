"""Run of a hinged beam in a circle: central differences with forward increment Lagrange multipliers, or Newmark.

Explicit: M (x_{n+1} - 2 x_n + x_{n-1})/h^2 = f - f_int(x_n) + force_n, lumped M; a contact force along the radius puts
each node that would leave the circle exactly on the (moved) rim. Angular momentum about the hinge changes by the
impulse of the moments, to round-off, whatever the step: internal forces of co-rotational elements are in equilibrium.
Newmark, in a rigid circle: multipliers at t_{n+1}, Newton in each step. Unconditionally stable for linear motion when
gamma >= 1/2, beta >= gamma/2; second order for gamma = 1/2 only. Samples are at the step's end.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from contact.base.arrays import Array, require_positive
from contact.base.errors import InputError, LimitError, rounded_down
from contact.io.trust import Flag
from contact.model.bodies.beam import BeamInCircle, HingedBeam, ring_table
from contact.model.law import Law, kind
from contact.record.energy import Stored
from contact.record.record import Samples, Tally, tally
from contact.scheme.modal.propagator import Propagator, propagator
from contact.scheme.protocol import Block, Motion, PlainStepper

if TYPE_CHECKING:
    from contact.loop.beam.beam import BeamState, BeamWork
    from contact.loop.beam.implicit import ImplicitBeam, ImplicitWork


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class BeamRun(PlainStepper):
    """Scene, sums and step of the run; contacts are the nodes 1, 2, ... from the hinge outwards."""

    problem: BeamInCircle
    sums: Tally
    dt: float
    window: float
    label: str

    @property
    def start(self) -> Stored:
        """Energy of the straight beam at its start; leapfrog schemes evaluate their own energy half a step before."""
        x, mass, load, velocity = _start(self.problem.beam)
        return Stored(
            kinetic=0.5 * float(np.sum(mass * velocity**2)), strain=0.0, potential=-float(load[0, 2] * x[0, 2]),
            residual=0.0, discrete=self.stored().discrete,
        )  # fmt: skip

    @property
    def size(self) -> int:
        """Number of coordinates of the beam: x, y, theta of each node."""
        return 3 * (self.problem.beam.elements + 1)

    @property
    def blocks(self) -> tuple[Block, ...]:
        """The beam as the only block."""
        return (("beam 1", 0, self.size),)

    def motion(self, velocity: Array) -> tuple[Motion, ...]:
        """Momentum along x of nodes with these velocities (nodes, 3)."""
        mass = self.problem.beam.lumped()[:, 0]
        momentum = float(mass @ velocity[:, 0])
        return (Motion(kind="beam", number=0, mean_velocity=momentum / float(mass.sum()), momentum=momentum),)

    def spin(self, x: Array, velocity: Array) -> float:
        """Angular momentum about the hinge [kg m^2/s]."""
        mass = self.problem.beam.lumped()
        orbit = mass[:, 0] * (x[:, 0] * velocity[:, 1] - x[:, 1] * velocity[:, 0])
        return float((orbit + mass[:, 2] * velocity[:, 2]).sum())


def require_rigid(law: Law) -> None:
    """Raise InputError for any law except rigid contact without friction."""
    if kind(law) != "Unilateral":
        raise InputError(f"law: found {law!r}, expected Unilateral() for a beam in a circle")


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class BeamStepper(BeamRun):
    """State of an explicit beam run."""

    state: BeamState
    work: BeamWork
    ring: Propagator

    def advance(self, out: Samples, first: int, steps: int) -> int:
        """Advance by whole steps; returns -1, or the step that failed."""
        from contact.loop.beam.beam import advance_beam

        return advance_beam(self.state, self.work, self.sums, out, self.dt, first, steps)

    @property
    def memory(self) -> tuple[Any, ...]:
        """Arrays that a step changes: state, work arrays and sums."""
        return self.state, self.work, self.sums

    def why(self) -> Flag:
        """Explain a failed step."""
        return Flag("the motion is not finite: reduce dt", "motion-overflow", failed=True)

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
        """Angular momentum about the hinge at the half step, and impulse of the contacts' moment [kg m^2/s, N m s]."""
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
        expected = f"<= 2 (stability of central differences): use dt <= {rounded_down(limit, 11)} s"
        raise LimitError(f"dt: found {dt:.11g} s, dt * omega_max = {2.0 * dt / limit:.11g}, expected {expected}")
    return dt


def _start(beam: HingedBeam) -> tuple[Array, Array, Array, Array]:
    """Nodes, masses, loads and velocities at t = 0, (nodes, 3) each."""
    x = beam.nodes()
    load = np.zeros_like(x)
    load[0, 2] = beam.torque
    return x, beam.lumped(), load, beam.spin * np.stack([-x[:, 1], x[:, 0], np.ones(len(x))], axis=1)


def prepare_beam(problem: BeamInCircle, dt: float | None, courant: float | None) -> BeamStepper:
    """Stepper at t = 0."""
    from contact.loop.beam.beam import BeamState, beam_work

    beam, h = problem.beam, beam_step(problem, dt, courant)
    x, mass, load, velocity = _start(beam)
    rate = h * h / mass
    rate[0, :2] = 0.0
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


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class ImplicitBeamStepper(BeamRun):
    """State of an implicit beam run."""

    state: ImplicitBeam
    work: ImplicitWork

    def advance(self, out: Samples, first: int, steps: int) -> int:
        """Advance by whole steps; returns -1, or the step that failed."""
        from contact.loop.beam.implicit import advance_implicit

        return advance_implicit(self.state, self.work, self.sums, out, self.dt, first, steps)

    @property
    def memory(self) -> tuple[Any, ...]:
        """Arrays that a step changes: state, work arrays and sums."""
        return self.state, self.work, self.sums

    def why(self) -> Flag:
        """Explain a failed step."""
        words = "Newton's method found no state that satisfies the equations of motion and the contact law: reduce dt"
        return Flag(words, "unconverged", failed=True)

    def stored(self) -> Stored:
        """Energies at t_n; the discrete form omits the numerical energy of Newmark."""
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
        """Angular momentum about the hinge, and impulse of the contacts' moment so far [kg m^2/s, N m s]."""
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
    x, mass, load, velocity = _start(beam)
    gaps, n = problem.gaps(x)[1:], len(x)
    state = ImplicitBeam(
        x=x, v=velocity, a=load / mass, mass=mass, load=load, rest=beam.length / beam.elements,
        EA=beam.E * beam.area, EI=beam.E * beam.second_moment, beta=beta, gamma=gamma, radius=problem.radius,
        offset=problem.offset, force=np.zeros(n - 1), gap=gaps.copy(), last=np.zeros(n - 1), before=gaps.copy(),
        ledger=np.zeros(3),
    )  # fmt: skip
    label = f"Newmark({beta:g}, {gamma:g}) + Lagrange, dt omega_max = {dt * beam.omega_max():.3g} (no limit)"
    return ImplicitBeamStepper(
        problem=problem, state=state, work=implicit_work(n), sums=tally(n - 1), dt=dt, label=label,
        window=max(2.0 * np.pi / beam.omega_max(), dt),
    )  # fmt: skip
