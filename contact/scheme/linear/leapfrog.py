"""Explicit schemes on linear problems: one leapfrog loop with four contact rules."""

from __future__ import annotations

from typing import TYPE_CHECKING

from contact.base.errors import InputError
from contact.model.bodies.band import combine
from contact.model.bodies.linear_system import omega_max
from contact.model.law import Law
from contact.scheme.linear.stepper import (
    LinearStepper,
    linear_stepper,
    parts_of,
    setup,
)
from contact.scheme.protocol import Problem

if TYPE_CHECKING:
    pass

CONSISTENT = 200  # coordinates up to which solving with M in every step is allowed


def prepare_leapfrog(
    name: str, words: str, rule: int, problem: Problem, law: Law, allowed: tuple[str, ...], dt: float | None,
    courant: float | None, restitution: float = 0.0,
) -> LinearStepper:  # fmt: skip
    """Stepper with one of the contact rules of `loop.leapfrog`; raises InputError, LimitError beyond dt omega_max = 2.

    Contact springs are included in the limit, with every contact closed.
    """
    from contact.loop.linear.leapfrog import advance_leapfrog

    run = setup(name, problem, law, allowed, dt, courant)
    system, h = run.system, run.h
    omega = omega_max(system, contact_stiffness=law.stiffness) if law.stiffness else run.omega
    if not system.M.lumped and system.size > CONSISTENT:
        raise InputError(f"M: found a consistent mass matrix, expected a lumped one for the explicit scheme {name}")
    parts = parts_of(system, combine((1.0 / h**2, system.M), (0.5 / h, system.C)), 1.0)
    method = (run.law, rule, restitution)
    return linear_stepper(run, parts, advance_leapfrog, method, words, limit=2.0, omega=omega, leapfrog=True)
