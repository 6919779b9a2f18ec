"""The discrete gradient law: energy kept to round-off at any step, at a fixed undamped contact point.

Over one step the force is constant and the modes move exactly under it; lam = -(phi(g_1) - phi(g_0))/(g_1 - g_0),
phi = <-g>^2/(2 S) the energy in the residual compliance (Gonzalez, J. Nonlinear Sci. 6, 1996, 449): a scalar
quadratic. Exact energy is not exact phase: some (modes, dt) drift in phase after several impacts. In the step of
closing or opening complementarity holds on average only, which `Result.residual` shows.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contact.base.errors import InputError
from contact.model.gaps.modal_system import ModalSystem
from contact.record.energy import Stored
from contact.record.record import Samples, Tally, tally
from contact.scheme.modal.modal_run import ModalRun
from contact.scheme.modal.propagator import Propagator

if TYPE_CHECKING:
    from contact.loop.modal.energy import EnergyState


def energy_stepper(system: ModalSystem, parts: Propagator) -> ModalRun:
    """Stepper at t = 0; raises InputError for a rim, damping, or S = 0."""
    from contact.loop.modal.energy import EnergyState, advance_energy

    S, h, Q = system.S_nn(0.0), parts.h, system.Q
    if system.table is not None:
        raise InputError("law: found 'energy' on a rotating rim, expected 'averaged' or 'forward'")
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
        system=system, dt=h, sums=tally(1), label=label, loop=loop, steps=[0], energy=lambda _: _stored(system, state),
        velocity=lambda: state.v, failure=lambda: "the gap is not a number",
    )  # fmt: skip


def _stored(system: ModalSystem, state: EnergyState) -> Stored:
    """Energy at t_n; phi(g) counts as residual."""
    q, v = state.q, state.v
    kinetic, strain = 0.5 * float(v @ v), 0.5 * float(np.sum((system.omega * q) ** 2))
    potential = system.potential - float(system.load @ q)
    residual = 0.5 * min(float(state.memory[0]), 0.0) ** 2 / system.S_nn(0.0)
    total = kinetic + strain + potential
    return Stored(kinetic=kinetic, strain=strain, potential=potential, residual=residual, discrete=total)
