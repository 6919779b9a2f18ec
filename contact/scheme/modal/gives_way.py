"""Contacts with a force-depth law in an exact-modal run: arguments of loops, stored energy, suitable step."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from contact.base.arrays import Array
from contact.base.errors import InputError
from contact.io.trust import Flag
from contact.model.law import Law
from contact.model.laws.force_law import Response

if TYPE_CHECKING:
    from contact.solver.yielding.yields import Yielding

TRIED = 1e-6  # depth [m] and rate [m/s] at which a function is tried before the run


def yielding_of(law: Law, now: Array, before: Array) -> Yielding | None:
    """Work arrays of a law's response, None for rigid contact; gaps (K,) at t_0 and a step before.

    Raises InputError for an invalid function.
    """
    if law.response is None:
        return None
    from contact.solver.yielding.yields import ByDepth, yielding

    require_usable(law.response)
    found = ByDepth(law.response.function)
    try:
        found.compile()
    except Exception as error:  # numba's own, of many kinds
        reason = str(error).strip().splitlines()[0]
        expected = "a function that numba compiles, which uses only math and the array values"
        raise InputError(
            f"response: found {law.words}, which does not compile ({reason}), expected {expected}"
        ) from error
    return yielding(found, np.array(law.response.values), now, before)  # which loops may write


def require_usable(response: Response) -> None:
    """Try a response in Python; raises InputError unless it returns two finite numbers with slope >= 0."""
    try:
        force, slope = response(TRIED, TRIED)
    except Exception as error:
        found = f"{type(error).__name__}: {error}"
        raise InputError(f"response: found {found}, expected (force, slope) from (depth, rate, values)") from error
    if not (np.isfinite([force, slope]).all() and slope >= 0.0):
        found = f"force {force:g} N and slope {slope:g} N/m at a depth of {TRIED:g} m"
        raise InputError(f"response: found {found}, expected finite numbers and a force that does not fall")


def stored_by(law: Law, y: Yielding | None) -> float:
    """Energy stored in the contacts now [J]."""
    if y is None or law.response is None:
        return 0.0
    return sum(law.response.energy(float(depth)) for depth in y.past[:, 0])


def memory_of(y: Yielding | None) -> tuple[Any, ...]:
    """State that a resumed run needs."""
    return () if y is None else (y.past, y.depth, y.steepest)


def too_long(y: Yielding | None, H: float, dt: float) -> tuple[Flag, ...]:
    """Flag if the step is too long for the contact's largest stiffness; H [m/N] is the motion of the modes in a step.

    For a mass m on a spring k, H k = (omega dt)^2.
    """
    if y is None or not H * y.steepest[0] > 1.0:
        return ()
    ratio = float(np.sqrt(H * y.steepest[0]))
    words = (
        f"dt = {dt:.4g} s is {ratio:.3g} time constants of the contact at its largest stiffness, {y.steepest[0]:.3g} "
        f"N/m: use dt <= {dt / ratio:.2g} s"
    )
    return (Flag(words, "step-too-long"),)
