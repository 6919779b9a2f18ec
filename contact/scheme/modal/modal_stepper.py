"""The forward, averaged and energy laws on the exact propagation: state, loop and evaluations; see `exact_modal`."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from contact.base.arrays import Array
from contact.base.errors import InputError
from contact.io.trust import Flag
from contact.model.gaps.modal_system import ModalSystem
from contact.model.law import Law
from contact.record.energy import Stored
from contact.record.record import Samples, Tally, tally
from contact.scheme.modal.gives_way import memory_of, stored_by, too_long, yielding_of
from contact.scheme.modal.modal_run import ModalRun
from contact.scheme.modal.propagator import Propagator

if TYPE_CHECKING:
    from contact.loop.modal.modal import EnergyState, ModalState
    from contact.solver.yielding.yields import Yielding

Loop = Callable[["ModalState", Tally, Samples, int, int], int]
CELLS = 720  # of the contact angle
POINTS = 8  # where the clearance is examined in each cell


def modal_stepper(system: ModalSystem, parts: Propagator, *, averaged: bool, law: Law, label: str) -> ModalRun:
    """Stepper at t = 0, with only the compiled loop that this scene needs."""
    q = np.zeros(system.omega.size)
    d = parts.backward(q, system.velocity)
    state = _state(system, parts, q, d)
    damped = bool(system.zeta.any())
    y = yielding_of(law, state.memory[:1], state.memory[1:2])
    loop = _point_loop(system, parts, averaged, damped, y)

    def advance(sums: Tally, out: Samples, first: int, steps: int) -> int:
        return loop(state, sums, out, first, steps)

    return ModalRun(
        system=system, dt=parts.h, sums=tally(1), label=label, loop=advance, steps=np.zeros(1, dtype=np.int64),
        state=state,
        energy=lambda: _stored(system, parts, state, stored_by(law, y)),
        velocity=lambda: state.d / parts.h,
        failure=lambda: _failure(state),
        gives_way=memory_of(y), slow=lambda: too_long(y, float(parts.c @ system.Q**2), parts.h),
    )  # fmt: skip


def _stored(system: ModalSystem, parts: Propagator, state: ModalState, at_rest: float) -> Stored:
    """Energy at t_n; lam^2 S/2 and energy stored in the contact count as residual."""
    force = float(state.memory[2])
    if force == 0.0 and not (state.q.any() or state.d.any() or parts.load.any()):  # as most runs start
        return Stored(kinetic=0.0, strain=0.0, potential=system.potential, residual=at_rest, discrete=system.potential)
    if force == 0.0:
        return parts.stored(state.q, state.d, np.zeros(state.q.size), at_rest, system.potential)
    residual = 0.5 * force**2 * system.S_nn(0.0)
    return parts.stored(state.q, state.d, system.Q * force, residual + at_rest, system.potential)


def _failure(state: ModalState) -> Flag:
    if np.isnan(state.q).any() or np.isnan(state.d).any():
        return Flag("the motion is not finite", "motion-overflow", failed=True)
    return Flag(
        "no force opens the gap, since the compliance H_d + S is not above 0: reduce dt", "unconverged", failed=True
    )


def _state(system: ModalSystem, parts: Propagator, q: Array, d: Array) -> ModalState:
    from contact.loop.modal.modal import ModalState

    clearance = system.clearance(0.0)
    gaps = [clearance + float(system.Q @ x) if x.any() else clearance for x in (q, q - d)]
    return ModalState(
        q=q, d=d, old=np.zeros(q.size), al=parts.al, be=parts.be, c=parts.c, kick=parts.c * system.load,
        weight=(1.0 - parts.al) / (2.0 * parts.c),
        memory=np.array([*gaps, 0.0]),
        force=np.zeros(1), gap=np.zeros(1),
    )  # fmt: skip


def _point_loop(system: ModalSystem, parts: Propagator, averaged: bool, damped: bool, y: Yielding | None) -> Loop:
    from contact.loop.modal.modal import advance_modal

    clearance, S, h, Q = system.clearance(0.0), system.S_nn(0.0), parts.h, system.Q

    def loop(state: ModalState, sums: Tally, out: Samples, first: int, steps: int) -> int:
        return advance_modal(state, Q, clearance, S, averaged, damped, y, sums, out, h, first, steps)

    return loop


def energy_stepper(system: ModalSystem, parts: Propagator) -> ModalRun:
    """Stepper of the discrete gradient law: energy exact to round-off at any step, at a fixed undamped contact point.

    Over one step the force is constant and the modes move exactly under it; lam = -(phi(g_1) - phi(g_0))/(g_1 - g_0),
    phi = <-g>^2/(2 S) the energy in the residual compliance (Gonzalez, J. Nonlinear Sci. 6, 1996, 449): a scalar
    quadratic. The phase is not exact: for some (modes, dt) it drifts after several impacts. In the step of
    closing or opening complementarity is satisfied on average only, which `Result.residual` shows.
    Raises InputError for damping, or S = 0.
    """
    from contact.loop.modal.modal import EnergyState, advance_energy

    S, h, Q = system.S_nn(0.0), parts.h, system.Q
    if system.zeta.any():
        raise InputError("law: found 'energy' with damped modes, expected zeta = 0 or another law")
    if S <= 0.0:
        raise InputError(f"law: found 'energy' with S = {S:g} m/N, expected residual compliance > 0")
    turn = parts.turn
    clearance, b = system.clearance(0.0), float(np.sum(0.5 * parts.c * Q * Q))
    state = EnergyState(
        q=np.zeros(Q.size), v=system.velocity.copy(), cos=np.cos(turn), drift=h * np.sinc(turn / np.pi),
        pull=-system.omega * np.sin(turn), lift=0.5 * parts.c, load=system.load, memory=np.array([clearance]),
        force=np.zeros(1), gap=np.zeros(1),
    )  # fmt: skip

    def loop(sums: Tally, out: Samples, first: int, steps: int) -> int:
        return advance_energy(state, Q, clearance, S, b, sums, out, h, first, steps)

    top = float(system.omega.max(initial=0.0))
    label = f"exact modal, energy law, dt omega_max = {h * top:.3g} (no limit)"
    return ModalRun(
        system=system, dt=h, sums=tally(1), label=label, loop=loop, steps=np.zeros(1, dtype=np.int64), state=state,
        energy=lambda: _energy_stored(system, state), velocity=lambda: state.v,
        failure=lambda: Flag("the gap is not finite", "motion-overflow", failed=True),
    )  # fmt: skip


def _energy_stored(system: ModalSystem, state: EnergyState) -> Stored:
    """Energy at t_n; phi(g) counts as residual."""
    q, v = state.q, state.v
    kinetic, strain = 0.5 * float(v @ v), 0.5 * float(np.sum((system.omega * q) ** 2))
    potential = system.potential - float(system.load @ q)
    residual = 0.5 * min(float(state.memory[0]), 0.0) ** 2 / system.S_nn(0.0)
    total = kinetic + strain + potential
    return Stored(kinetic=kinetic, strain=strain, potential=potential, residual=residual, discrete=total)
