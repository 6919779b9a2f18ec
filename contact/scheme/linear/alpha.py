"""What the implicit schemes with the gap held at the end of the step share."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from contact.model.bodies.band import combine
from contact.model.law import Law
from contact.scheme.linear.linear_stepper import LinearStepper, linear_stepper, parts_of, setup
from contact.scheme.protocol import Problem

if TYPE_CHECKING:
    from contact.loop.linear.alpha import Weights


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
    from contact.loop.linear.alpha import advance_alpha

    run = setup(name, problem, law, ("Unilateral", "Penalty", "AugmentedLagrangian"), dt, courant)
    system, h, implicit = run.system, run.h, 1.0 - w.af
    A = combine((1.0 - w.am, system.M), (implicit * w.gamma * h, system.C), (implicit * w.beta * h * h, system.K))
    parts = parts_of(system, A, 1.0)
    parts = parts._replace(W=w.beta * h * h * parts.W)
    return linear_stepper(run, parts, advance_alpha, (run.law, w), f"{words} + {law.words}", limit=limit)
