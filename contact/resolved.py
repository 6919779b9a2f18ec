"""Whether a run resolves its problem: rates against the step, step against the end, number of steps.

A harmonic with N steps a period is sampled without ambiguity from N = 2 on (Nyquist). A force that is constant within a
step has sin(pi/N)/(pi/N) of its amplitude: it loses 10 % at N = 4, where a run is refused, and 1.6 % at N = 10, below
which it is flagged. The stability of a scheme is a separate limit (`require_stable`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from contact.base.arrays import Array
from contact.base.errors import InputError, LimitError, rounded_down
from contact.io.trust import Flag
from contact.model.bodies.body import PointMass
from contact.model.bodies.chain import Chain
from contact.model.gaps.rub import rub_of
from contact.model.law import Law
from contact.model.rate import Change, Rate, Rated
from contact.scheme.linear.stepper import LinearStepper
from contact.scheme.protocol import Problem, Stepper

MOST_STEPS = 10**8  # minutes to an hour of computing: a run of more is asked for by `most_steps`
A_STEP, A_COORDINATE = 2e-7, 1e-8  # seconds of computing: of the cheapest step, and of each coordinate beside
WINDOWS, WINDOW = 64, 64  # places along a run at which a load is examined, steps in each
BETWEEN, MUCH_BETWEEN = 1.0 - math.cos(math.pi / 10.0), 1.0 - math.cos(math.pi / 4.0)  # of harmonics of 10, 4 steps


def resolved(problem: Problem, law: Law, stepper: Stepper, t_end: float, given: str = "") -> tuple[Flag, ...]:
    """Compare a problem's rates, changes and loads with step and end.

    `given` states the source of the step ("courant = 1e7"). Raises LimitError, which lists everything that the step
    does not resolve, with the longest permitted step for each.
    """
    dt = stepper.dt
    rates = (*(problem.rates() if isinstance(problem, Rated) else ()), *_contacts(problem, law))
    step = f"{dt:.6g} s{f' ({given})' if given else ''}"
    if dt > t_end * (1.0 + 1e-9):
        raise LimitError(f"dt: found {step}, expected at most t_end = {t_end:g} s: use a shorter step or a later end")
    problems = [_refusal(rate, dt) for rate in rates if isinstance(rate, Rate) and rate.share(dt) > rate.most]
    flags = [_flag(rate, dt) for rate in rates if isinstance(rate, Rate) and rate.many < rate.share(dt) <= rate.most]
    flags += [_late(one, t_end) for one in rates if isinstance(one, Change) and one.begins >= t_end]
    for words, refused in () if isinstance(problem, Chain) else _loads(stepper, t_end):
        problems += [words] if refused else []
        flags += [] if refused else [Flag(words, "step-too-long")]
    if problems:
        raise LimitError(f"dt: found {step}, " + "; ".join(problems))
    return tuple(flags)


def _contacts(problem: Problem, law: Law) -> Iterator[Rate]:
    """Passages of a contact: of a mass on the contact's spring, of a tip over its own length of coating."""
    bodies = problem.bodies if isinstance(problem, Chain) else ()
    masses = [body.mass for body in bodies if isinstance(body, PointMass)]
    if law.stiffness > 0.0 and masses:
        time = math.pi * math.sqrt(min(masses) / law.stiffness)
        yield Rate.of_passage("the contact of a mass on the contact spring", time, f"{time:.4g} s")
    rub = rub_of(problem)
    if law.coating is not None and rub is not None and rub.speed.fastest > 0.0:
        time = law.coating.tip / (rub.casing.radius * rub.speed.fastest)
        yield Rate.of_passage("the passage of a tip over its own length of coating", time, f"{time:.4g} s")


def _refusal(rate: Rate, dt: float) -> str:
    take = f"use dt <= {rounded_down(rate.step, 4)} s"
    if rate.decays:
        most = f"expected at most {0.5 * math.pi:.3g}: {take}"
        return f"{rate.key} = {rate.words} makes a step {math.pi * rate.share(dt):.3g} time constants long, {most}"
    said = f"{rate.key} = {rate.words} has {1.0 / (rate.hz * dt):.3g} steps a period"
    if rate.share(dt) > 1.0:
        said += f" and would appear at {abs(rate.hz - round(rate.hz * dt) / dt):.3g} Hz"
    expected = f"expected at least {2.0 / rate.most:.3g}"
    return f"{said}, {expected}: {take}"


def _flag(rate: Rate, dt: float) -> Flag:
    longest = rounded_down(0.5 * rate.many / rate.hz, 4)
    if math.isinf(rate.most):
        return Flag(f"dt = {dt:.4g} s is longer than {rate.key}, {rate.words}: use dt <= {longest} s", "step-too-long")
    if rate.decays:
        words = f"{rate.key} = {rate.words} makes a step {math.pi * rate.share(dt):.3g} time constants long"
        return Flag(f"{words}, more than {0.2 * math.pi:.2g}: use dt <= {longest} s", "step-too-long")
    steps = 1.0 / (rate.hz * dt)
    words = f"{rate.key} = {rate.words} has {steps:.3g} steps a period, fewer than {2.0 / rate.many:.3g}"
    return Flag(f"{words}: use dt <= {longest} s", "step-too-long")


def _late(change: Change, t_end: float) -> Flag:
    words = f"{change.key} begins to change at {change.begins:g} s, but the run ends at {t_end:g} s: increase t_end"
    return Flag(words, "never-begins")


def _loads(stepper: Stepper, t_end: float) -> Iterator[tuple[str, bool]]:
    """Findings on loads given as functions that vary within a step, and whether the run is refused."""
    for j, forcing in enumerate(stepper.system.body.forcing if isinstance(stepper, LinearStepper) else ()):
        left = between(forcing.amplitude, stepper.dt, t_end)
        if left > BETWEEN:
            words = f"forcing {j + 1} varies within a step by {100.0 * left:.3g} % of its largest value"
            asked = (
                f"expected at most {100.0 * MUCH_BETWEEN:.2g} % (a harmonic with 4 steps a period): use a shorter dt"
            )
            yield f"{words}, {asked}", left > MUCH_BETWEEN


def between(amplitude: Callable[[Array], Any], dt: float, t_end: float) -> float:
    """Relative error (rms) at half steps if a load is interpolated linearly between steps.

    For a harmonic with N steps a period it is 1 - cos(pi/N).

    >>> round(between(lambda t: np.cos(2 * np.pi * 5.0 * t), 0.02, 3.0), 4)  # ten steps a period
    0.0489
    """
    count = max(1, round(t_end / dt))
    first = np.unique(np.linspace(0, max(count - WINDOW, 0), WINDOWS).astype(np.int64))
    step = first[:, None] + np.arange(min(WINDOW, count) + 1)
    whole, middle = np.ravel(step * dt), np.ravel((step[:, :-1] + 0.5) * dt)
    at = np.asarray(amplitude(whole.astype(np.float64)), dtype=np.float64)
    half = np.asarray(amplitude(middle.astype(np.float64)), dtype=np.float64)
    if not (np.isfinite(at).all() and np.isfinite(half).all()):
        return 0.0  # the run names the place
    at = np.broadcast_to(at, step.size).reshape(step.shape)
    off = np.broadcast_to(half, step.size - len(step)).reshape(len(step), -1) - (0.5 * at[:, 1:] + 0.5 * at[:, :-1])
    largest = max(float(np.abs(at).max()), float(np.abs(half).max()))
    if not largest > 0.0:
        return 0.0
    steps, halves, left = (float(np.sqrt(np.mean((part / largest) ** 2))) for part in (at, half, off))
    return left / max(steps, halves)


def count_of(t_end: float, dt: float, most: int = MOST_STEPS, coordinates: int = 0) -> int:
    """Number of steps to the first one at or after `t_end`.

    Raises InputError beyond `most`, with the expected run time.
    """
    ratio = t_end / dt * (1.0 - 1e-12) - 1e-9
    if ratio > most:
        seconds = ratio * (A_STEP + A_COORDINATE * coordinates)
        found = f"{t_end:g} s with dt = {dt:.4g} s, {ratio:.4g} steps or about {_duration(seconds)} of computing time"
        shorter = f"reduce t_end to {most * dt:.4g} s, use a longer dt"
        raise InputError(f"t_end: found {found}, expected at most {most:.4g} steps: {shorter}, or set most_steps")
    return max(1, math.ceil(ratio))


def _duration(seconds: float) -> str:
    for unit, size in (("days", 86400.0), ("hours", 3600.0), ("minutes", 60.0)):
        if seconds > 2.0 * size:
            return f"{seconds / size:.2g} {unit}"
    return f"{seconds:.2g} s"


def require_steps(value: object) -> None:
    """Raise InputError unless the number is whole and at least 1."""
    if isinstance(value, bool) or not isinstance(value, int) or value < 1:
        raise InputError(f"most_steps: found {value!r}, expected a whole number >= 1")
