"""What the implicit schemes with the gap held at the end of the step share."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from contact.model.band import combine
from contact.model.law import AugmentedLagrangian, Law, Penalty, Unilateral
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
    from contact.scheme.loop_alpha import Weights
    from contact.scheme.loop_linear import Parts, State


def newmark_limit(beta: float, gamma: float) -> float:
    """Largest stable h omega of undamped Newmark with gamma >= 1/2: 1/sqrt(gamma/2 - beta), infinite from there on.

    >>> newmark_limit(0.25, 0.5), round(newmark_limit(0.25, 0.55), 3)
    (inf, 6.325)
    """
    return math.inf if 2.0 * beta >= gamma else 1.0 / math.sqrt(0.5 * gamma - beta)


def prepare_alpha(
    name: str, words: str, w: Weights, limit: float, problem: Problem, law: Law, dt: float | None,
    courant: float | None,
) -> LinearStepper:  # fmt: skip
    """Stepper of the family; raises InputError, LimitError beyond dt omega_max = `limit`."""
    from contact.scheme.loop_alpha import advance_alpha

    system = require_linear(problem, name)
    numbers = require_law(law, name, Unilateral, Penalty, AugmentedLagrangian)
    h = linear_step(problem, dt, courant)
    omega = omega_max(system)
    words = f"{words} + {_law_words(law)}, {require_stable(h, omega, limit, name)}"
    implicit = 1.0 - w.af
    A = combine((1.0 - w.am, system.M), (implicit * w.gamma * h, system.C), (implicit * w.beta * h * h, system.K))
    parts = parts_of(system, A, 1.0)
    parts = parts._replace(W=w.beta * h * h * parts.W)

    def loop(p: Parts, s: State, sums: Tally, out: Samples, amplitudes: Array, h: float, first: int, steps: int) -> int:
        return advance_alpha(p, s, numbers, w, sums, out, amplitudes, h, first, steps)

    return linear_stepper(system, parts, loop, h, words, omega=omega)


def _law_words(law: Law) -> str:
    if isinstance(law, Penalty):
        return f"penalty {law.stiffness:.3g} N/m"
    return "augmented Lagrangian" if isinstance(law, AugmentedLagrangian) else "Lagrange"
