"""Reliability of a finished run: energy, penetration and solver residuals against one table of limits."""

from __future__ import annotations

import numpy as np

from contact.io.trust import DEEP, MADE, MUCH_LEFT, MUCH_MADE, OPEN, TOO_DEEP, UNSETTLED, Flag
from contact.model.bodies.beam import BeamInCircle
from contact.model.bodies.chain import Chain
from contact.model.gaps.gap import RotatingRim
from contact.model.gaps.rub import Rub
from contact.model.law import Law
from contact.result import Result
from contact.scheme.protocol import Problem


def judged(problem: Problem, law: Law, result: Result) -> tuple[Flag, ...]:
    """Flags of a run from its sums over all steps, in the order of the table of codes."""
    return (*_energy(law, result), *_penetration(problem, law, result), *_slip(result), *_updates(result))


def energy_made(result: Result) -> tuple[float, float]:
    """Energy that contact and scheme have made [J], and the largest energy of the run for comparison [J].

    The latter is the largest of: the initial energy plus the work of gravity, loads, drive and friction; the kinetic
    and strain energy at the end; an impact of the mean impulse at the largest approach speed. A scheme with a numerical
    gain of its own enters errors of contact and damping there, so the three are added.
    """
    energy = result.energy
    with np.errstate(over="ignore", invalid="ignore"):
        own = energy.algorithmic + energy.damping if energy.algorithmic else 0.0
        made = own - energy.lost_in_contact - energy.explained
        largest = max(energy.others, energy.end.kinetic + energy.end.strain, result.impact_energy)
    return made, largest


def too_much(law: Law, result: Result) -> tuple[float, float] | None:
    """Energy made [J] and the largest allowed energy [J], if it is exceeded; else None.

    With a coating this is no fault: the rotating rim presses further bars against the tip, and the work of its drive
    counts as that of the contact.
    """
    made, largest = energy_made(result)
    return (made, MUCH_MADE * largest) if law.coating is None and made > MUCH_MADE * largest > 0.0 else None


def _energy(law: Law, result: Result) -> tuple[Flag, ...]:
    made, largest = energy_made(result)
    found = []
    if law.coating is None and made > MADE * largest > 0.0 and too_much(law, result) is None:
        words = f"contact and scheme added {made:.3g} J, {100.0 * made / largest:.2g} % of the largest energy"
        found.append(Flag(f"{words}; reduce dt, or use {_other(result.scheme)}", "energy-grows"))
    energy = result.energy
    if abs(energy.unaccounted) > OPEN * energy.scale:
        words = (
            f"energy balance: {energy.unaccounted:.2g} J of {energy.scale:.3g} J are not accounted for, expected "
            f"{OPEN:g} of it"
        )
        found.append(Flag(words, "energy-open"))
    return tuple(found)


def _other(scheme: str) -> str:
    """Methods without numerical energy, other than that of the run."""
    if "Newmark (" in scheme or "HHT (" in scheme:
        return "Newmark (.5, .55) or Moreau-Jean, whose forces do not oscillate"
    if "averaged law" in scheme:
        return "the forward law"
    return "forward Lagrange (CentralDifference with the law Unilateral)" if "penalty" in scheme else "fewer modes"


def _penetration(problem: Problem, law: Law, result: Result) -> tuple[Flag, ...]:
    size, of = _size(problem)
    deepest = float(result.max_penetration.max(initial=0.0))
    if not deepest > DEEP * size > 0.0:
        return ()
    words = f"bodies overlapped by {deepest:.3g} m, {100.0 * deepest / size:.3g} % of {of} ({size:.3g} m): reduce dt"
    words += ", or use a stiffer contact spring" if law.stiffness > 0.0 else ""
    return (Flag(words, "penetration", failed=deepest > TOO_DEEP * size),)


def _size(problem: Problem) -> tuple[float, str]:
    """Length with which a penetration is compared [m], also in words; 0 for a problem without one."""
    if isinstance(problem, Chain):
        lengths = [body.end - body.x for body in problem.bodies if body.end > body.x]
        return (min(lengths), "the shortest rod") if lengths else (0.0, "")
    if isinstance(problem, BeamInCircle):
        return problem.beam.length, "the beam"
    return (problem.casing.radius, "the radius") if isinstance(problem, RotatingRim | Rub) else (0.0, "")


def _slip(result: Result) -> tuple[Flag, ...]:
    count = int(result.reversals.sum())
    words = (
        f"the slip of the tip changed its sign in {count} steps: the tip moved faster along the rim than the rim itself"
    )
    return (Flag(words, "slip-reverses"),) if count else ()


def _updates(result: Result) -> tuple[Flag, ...]:
    """Whether the updates of an augmented Lagrangian converged."""
    worst, largest = float(result.residual.max(initial=0.0)), float(np.abs(result.gap).max(initial=0.0))
    if "augmented Lagrangian" not in result.scheme or not worst > UNSETTLED * largest:
        return ()
    words = (
        f"the augmented Lagrangian did not converge; its law is violated by up to {worst:.1e} m: allow more updates, "
    )
    words += "use a stiffer spring, or use plain Lagrange"
    return (Flag(words, "unconverged", failed=worst > MUCH_LEFT * largest),)


def once(flags: tuple[Flag, ...]) -> tuple[Flag, ...]:
    """The flags without those whose code also occurs in a flag of a failed run."""
    failed = {flag.code for flag in flags if flag.failed}
    return tuple(flag for flag in flags if flag.failed or flag.code not in failed)
