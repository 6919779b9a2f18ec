"""What the explicit schemes on linear problems share: limit, matrices and start of the leapfrog loop."""

from __future__ import annotations

from typing import TYPE_CHECKING

from contact.errors import InputError
from contact.model.band import combine
from contact.model.law import Law, Penalty
from contact.model.linear_system import omega_max
from contact.record import Samples, Tally
from contact.scheme.linear_stepper import (
    LinearStepper,
    linear_step,
    linear_stepper,
    parts_of,
    require_law,
    require_linear,
    require_stable,
)
from contact.scheme.protocol import Problem

if TYPE_CHECKING:
    from contact.model.arrays import Array
    from contact.scheme.loop_linear import Parts, State


def prepare_leapfrog(
    name: str, words: str, rule: int, problem: Problem, law: Law, allowed: tuple[type, ...], dt: float | None,
    courant: float | None, restitution: float = 0.0,
) -> LinearStepper:  # fmt: skip
    """Stepper with one of the rules of `loop_leapfrog`; raises InputError, LimitError beyond dt omega_max = 2.

    A contact spring counts in the limit, taken with every contact closed.
    """
    from contact.scheme.loop_leapfrog import advance_leapfrog

    system, numbers = require_linear(problem, name), require_law(law, name, *allowed)
    h = linear_step(problem, dt, courant)
    omega = omega_max(system)
    spring = law.stiffness if isinstance(law, Penalty) else 0.0
    reached = require_stable(
        h, omega_max(system, contact_stiffness=spring) if spring else omega, 2.0, "central differences"
    )
    if system.M.off.shape[0] and system.size > 200:
        raise InputError(f"M: found a consistent mass matrix, expected a lumped one for {name} (it is explicit)")
    parts = parts_of(system, combine((1.0 / h**2, system.M), (0.5 / h, system.C)), 1.0)

    def loop(p: Parts, s: State, sums: Tally, out: Samples, amplitudes: Array, h: float, first: int, steps: int) -> int:
        return advance_leapfrog(p, s, numbers, rule, restitution, sums, out, amplitudes, h, first, steps)

    return linear_stepper(system, parts, loop, h, f"{words}, {reached}", omega=omega, leapfrog=True)
