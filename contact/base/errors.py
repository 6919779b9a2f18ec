"""The three ways a run can refuse: bad input, a limit exceeded, numerics that failed."""

from __future__ import annotations

import math
from typing import Any


class InputError(ValueError):
    """The input cannot be run: the message names the field, what was found and what is expected.

    >>> import contact as ct
    >>> try:
    ...     ct.Penalty(stiffness=-1.0)
    ... except ct.InputError as error:
    ...     print(error)
    stiffness: found -1.0, expected a finite number > 0
    """


class LimitError(InputError):
    """A scheme was asked to run beyond its limit: the message has both numbers and the remedy.

    >>> import contact as ct
    >>> rod = ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, elements=10, x=0.1)
    >>> try:
    ...     ct.run([ct.Wall(), rod], scheme=ct.CentralDifference(), t_end=1.0, dt=0.5)
    ... except ct.LimitError as error:
    ...     print(error)
    dt: found 0.5 s, dt * omega_max = 10, expected <= 2 (stability of CentralDifference): use dt <= 0.099999 s
    """


class NumericsError(RuntimeError):
    """A run failed midway: `result`, a Result, keeps everything recorded up to the step that failed.

    >>> raised = NumericsError("step 8: found nan")
    >>> raised.result is None
    True
    """

    result: Any = None


class DivergedError(NumericsError):
    """A motion passed a limit of its model: `result.divergence` has the limit, the time and the growth."""


def rounded_down(limit: float, digits: int) -> str:
    """A limit > 0 rounded down to a number of digits, so that the advised value is within the limit.

    >>> rounded_down(1.23456789e-4, 6), rounded_down(3.00001e-4, 4)
    ('0.000123456', '0.0003')
    """
    nearest = f"{limit:.{digits}g}"
    unit = 10.0 ** (math.floor(math.log10(limit)) + 1 - digits)
    # what is made of a limit that is round itself may round up
    return nearest if float(nearest) <= limit * (1.0 - 1e-12) else f"{limit - unit:.{digits}g}"
