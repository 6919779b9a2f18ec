"""Run of a linear problem: the state, loop and evaluations that all its schemes share."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from contact.base.arrays import Array, readonly, require_not_negative, require_positive
from contact.base.errors import InputError, LimitError, rounded_down
from contact.io.trust import Flag
from contact.model.bodies.band import Band, Factor, factor, pairs, solve
from contact.model.bodies.linear_system import Linear, LinearSystem, linear_system, omega_max
from contact.model.law import Law, kind
from contact.record.energy import Stored
from contact.record.record import Samples, Tally, tally
from contact.scheme.protocol import Block, Motion, PlainStepper, Problem

if TYPE_CHECKING:
    from contact.loop.linear.linear import Parts, State
    from contact.solver.unilateral.complementarity import LawNumbers

Advance = Callable[..., int]  # (parts, state, sums, out, amplitudes, h, first, steps, *method)


NOTHING = Stored(kinetic=0.0, strain=0.0, potential=0.0, residual=0.0, discrete=0.0)
FAINT = 1e-40  # of the largest response to a contact force: a smaller one is zero


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class LinearStepper(PlainStepper):
    """M u'' + C u' + K u = f + Q^T force by one scheme; `leapfrog`: energies are evaluated at half steps."""

    system: LinearSystem
    parts: Parts
    state: State
    sums: Tally
    loop: Advance
    method: tuple[Any, ...]  # further arguments of the loop: law, weights, arrays of the scheme
    dt: float
    window: float
    label: str
    leapfrog: bool
    energy_at_start: Stored
    fault: list[Flag]  # filled when a load fails, empty until then

    @property
    def start(self) -> Stored:
        """Energy of the given state; leapfrog schemes store that at half a step before."""
        return self.energy_at_start

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return self.system.size

    @property
    def blocks(self) -> tuple[Block, ...]:
        """Coordinates of each body, in the given order."""
        return tuple((part.name, part.start, part.end) for part in self.system.body.parts)

    def advance(self, out: Samples, first: int, steps: int) -> int:
        """Advance by whole steps; returns -1, or the step that failed."""
        amplitudes = self.system.amplitudes(first, steps, self.dt)
        rows, loads = np.nonzero(~np.isfinite(amplitudes))
        good = steps if rows.size == 0 else max(int(rows[0]) - 1, 0)
        whole = len(out.rows) == 0
        stored = out if whole else out._replace(rows=readonly(out.rows[:, self.system.order]))
        failed = self.loop(self.parts, self.state, self.sums, stored, amplitudes, self.dt, first, good, *self.method)
        if good < steps and failed < 0:
            value, at = amplitudes[rows[0], loads[0]], (first + int(rows[0])) * self.dt
            words = f"forcing {int(loads[0]) + 1}: found {value} at t = {at:.6g} s, expected a finite force"
            self.fault.append(Flag(words, "load-unknown", failed=True))
            failed = first + good
        if whole:
            states = int(self.sums.filled[1])
            out.state[:states] = out.state[:states, self.system.place]
        return failed

    @property
    def memory(self) -> tuple[Any, ...]:
        """Arrays that a step changes: state, sums and the arrays of the scheme."""
        return self.state, self.sums, self.method

    def why(self) -> Flag:
        """Explain a failed step."""
        if self.fault:
            return self.fault[-1]
        if not np.isfinite(self.state.u).all() or not np.isfinite(self.state.v).all():
            return Flag("the motion is not finite", "motion-overflow", failed=True)
        words = "no contact forces satisfy all contacts: the search cycles, or a gap is not finite. Reduce dt"
        return Flag(words, "unconverged", failed=True)

    def stored(self) -> Stored:
        """Kinetic, strain and potential energy, for leapfrog schemes in the discrete form at the half step."""
        u, v, old = self.state.u, self.state.v, self.state.u
        if self.leapfrog:
            old, v = u - v, v / self.dt
        with np.errstate(over="ignore", invalid="ignore"):  # a run that overflows is refused by its energy
            kinetic = 0.5 * float(v @ product(self.parts.M, v))
            strain = 0.5 * float(old @ product(self.parts.K, u))
        potential = self.system.body.potential - 0.5 * float(self.parts.load @ (u + old))
        total = kinetic + strain + potential
        return Stored(kinetic=kinetic, strain=strain, potential=potential, residual=0.0, discrete=total)

    def motions(self) -> tuple[Motion, ...]:
        """Momentum and mean velocity of each rigid part, for leapfrog schemes at the half step."""
        v = self.state.v / self.dt if self.leapfrog else self.state.v
        momentum, mass = (product(self.parts.M, x)[self.system.place] for x in (v, np.ones(v.size)))
        found = []
        for part in self.system.body.parts:
            what = part.name.partition(" ")[0]
            if what == "wall":
                continue
            total, weight = float(momentum[part.start : part.end].sum()), float(mass[part.start : part.end].sum())
            speed = total / weight if part.rigid else math.nan
            found.append(
                Motion(kind=_KINDS.get(what, what), number=part.number, mean_velocity=speed,
                       momentum=total if part.rigid else math.nan)
            )  # fmt: skip
        return tuple(found)


_KINDS = {"pointmass": "mass"}


def product(A: Band, u: Array) -> Array:
    """A u, in the order of operations of the loops."""
    total = A.ground * u
    rows, columns, values = pairs(A)
    pull = values * (u[columns] - u[rows])
    np.add.at(total, rows, pull)
    np.subtract.at(total, columns, pull)
    return np.asarray(total)


def require_restitution(e: float) -> None:
    """Raise InputError unless 0 <= e <= 1."""
    require_not_negative(restitution=e)
    if e > 1.0:
        raise InputError(f"restitution: found {e!r}, expected between 0 and 1")


@dataclass(frozen=True, slots=True, kw_only=True)
class Rebound:
    """A scheme with Newton's restitution e."""

    restitution: float = 0.0

    def __post_init__(self) -> None:
        require_restitution(self.restitution)


def linear_step(problem: Linear, dt: float | None, courant: float | None) -> float:
    """Time step from `dt`, or `courant` times the crossing time of the smallest element."""
    if (dt is None) == (courant is None):
        raise InputError("dt: found both or neither of dt and courant, expected one of them")
    if dt is not None:
        require_positive(dt=dt)
        return dt
    assert courant is not None
    require_positive(courant=courant)
    crossing = problem.crossing_time
    if math.isinf(crossing):
        raise InputError("courant: found a scene without rods, expected dt")
    return courant * crossing


def require_stable(h: float, omega: float, limit: float, name: str) -> str:
    """Text "dt omega_max = x (limit y)"; raises LimitError beyond the limit."""
    reached = h * omega
    if reached > limit * (1.0 + 1e-9):
        expected = f"<= {limit:.4g} (stability of {name}): use dt <= {rounded_down(limit * h / reached, 6)} s"
        raise LimitError(f"dt: found {h:.6g} s, dt * omega_max = {reached:.4g}, expected {expected}")
    bound = "no limit" if math.isinf(limit) else f"limit {limit:.4g}"
    return f"dt omega_max = {reached:.3g} ({bound})"


def parts_of(system: LinearSystem, A: Band, opening: float, *, factored: Factor | None = None) -> Parts:
    """Arrays of a run whose step solves with A; response = opening A^-1 Q^T."""
    from contact.loop.linear.linear import Parts

    factored = factored or factor(A, "M + h C + h^2 K")
    Q = system.rows()
    response = opening * solve(factored, Q.T.copy()).T
    response[np.abs(response) < FAINT * np.abs(response).max(initial=0.0)] = 0.0
    return Parts(
        M=system.M, C=system.C, K=system.K, damped=system.damped, A=factored, load=system.load,
        shapes=system.shapes, columns=system.columns, value=system.value, gap0=system.gap0,
        response=np.ascontiguousarray(response), W=np.ascontiguousarray(Q @ response.T),
    )  # fmt: skip


def start(system: LinearSystem) -> tuple[Array, Array, Array]:
    """u, v and a at t = 0, M a = f - C v - K u, in band order."""
    body = system.body
    assert body.displacement is not None
    assert body.velocity is not None
    u, v = body.displacement[system.order].copy(), body.velocity[system.order].copy()
    force = system.load - product(system.C, v) - product(system.K, u) + system.amplitudes(0, 0, 1.0)[0] @ system.shapes
    return u, v, solve(factor(system.M, "M"), force[:, None])[:, 0]


def energy_at_start(system: LinearSystem, discrete: float) -> Stored:
    """Energy of the given displacements and velocities [J], independent of the scheme."""
    body = system.body
    assert body.displacement is not None
    assert body.velocity is not None
    assert body.load is not None
    u, v = body.displacement, body.velocity
    with np.errstate(over="ignore", invalid="ignore"):
        kinetic, strain = 0.5 * float(v @ (body.M @ v)), 0.5 * float(u @ (body.K @ u))
        potential = body.potential - float(body.load @ u)
    return Stored(kinetic=kinetic, strain=strain, potential=potential, residual=0.0, discrete=discrete)


def leave_out_half_step(stepper: LinearStepper) -> float:
    """Remove the half step before t = 0 from the energies of a leapfrog scheme.

    Returns its discrete energy without it [J].

    The scheme evaluates its energy at half steps, first at -h/2. The work h/2 v^T (f(0) - C v) of damping and varying
    loads until t = 0 is not part of the run.
    """
    system, parts, sums = stepper.system, stepper.parts, stepper.sums
    assert system.body.velocity is not None
    v, half = system.body.velocity[system.order], 0.5 * stepper.dt
    with np.errstate(over="ignore", invalid="ignore"):
        damping = -half * float(v @ product(parts.C, v))
    external = half * float(system.amplitudes(0, 0, 1.0)[0] @ (parts.shapes @ v))
    sums.damping[0], sums.external[0] = -damping, -external
    return stepper.stored().discrete + damping + external


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Setup:
    """Common set-up of schemes on a linear problem: the packed system, the law's numbers, step and omega_max."""

    name: str
    system: LinearSystem
    law: LawNumbers
    h: float
    omega: float


def setup(
    name: str, problem: Problem, law: Law, allowed: tuple[str, ...], dt: float | None, courant: float | None
) -> Setup:
    """Pack the problem and check law and step; raises InputError."""
    from contact.solver.unilateral.complementarity import LawNumbers, Several

    if not hasattr(problem, "linear_form"):
        expected = "ExactModal; this scheme is for rods, masses and linear bodies"
        raise InputError(f"scheme: found {name} for {type(problem).__name__}, expected {expected}")
    found = cast(Linear, problem)
    system = linear_system(found)
    if kind(law) not in allowed:
        raise InputError(f"law: found {law!r}, expected {' or '.join(allowed)} with {name}")
    numbers = LawNumbers(law.stiffness, law.updates, law.tolerance, Several(used=system.gap0.size > 1))
    return Setup(name=name, system=system, law=numbers, h=linear_step(found, dt, courant), omega=omega_max(system))


def linear_stepper(
    run: Setup, parts: Parts, loop: Advance, method: tuple[Any, ...], words: str, *, limit: float = math.inf,
    omega: float | None = None, leapfrog: bool = False, begin: tuple[Array, Array, Array] | None = None,
) -> LinearStepper:  # fmt: skip
    """Stepper at t = 0; raises LimitError if h omega exceeds `limit`, with omega_max without contact or as given.

    Leapfrog schemes start from u_1 = u_0 + h v_0 + h^2 a_0/2.
    """
    from contact.loop.linear.linear import State

    h, contacts = run.h, run.system.gap0.size
    reached = require_stable(h, run.omega if omega is None else omega, limit, run.name)
    u, v, a = begin or start(run.system)
    if leapfrog:
        v = h * v - 0.5 * h * h * a
    force, gap, free, shifted, closed = np.zeros((5, contacts))
    square, width = np.zeros((contacts, contacts)), max(part.off.shape[0] for part in (parts.M, parts.C, parts.K))
    state = State(u, v, a, force, gap, free, shifted, closed, square, np.zeros((8, u.size)), np.zeros(u.size + width))
    window = 2.0 * math.pi / run.omega if run.omega > 0.0 else h
    stepper = LinearStepper(
        system=run.system, parts=parts, state=state, sums=tally(contacts), loop=loop, method=method, dt=h,
        window=max(window, h), label=f"{words}, {reached}", leapfrog=leapfrog, energy_at_start=NOTHING, fault=[],
    )  # fmt: skip
    return started(stepper)


def started(stepper: LinearStepper) -> LinearStepper:
    """The same stepper with its complete state at t = 0, so that it knows its initial energy."""
    discrete = leave_out_half_step(stepper) if stepper.leapfrog else stepper.stored().discrete
    return replace(stepper, energy_at_start=energy_at_start(stepper.system, discrete))
