"""The three ways a run can refuse: bad input, a limit exceeded, numerics that failed."""

from __future__ import annotations

from typing import Any


class InputError(ValueError):
    """What was given cannot be run: the message names the field, what was found and what is expected."""


class LimitError(InputError):
    """A scheme was asked to run beyond its limit: the message carries both numbers and what to change."""


class NumericsError(RuntimeError):
    """A run failed midway: `result`, a Result, keeps everything recorded up to the step that failed."""

    result: Any = None


class DivergedError(NumericsError):
    """A motion outgrew what its model carries: `result.divergence` says which limit, when and how fast."""
