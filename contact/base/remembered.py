"""Cache of results of pure functions for the last few arguments, which runs of a sweep share."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar

P = ParamSpec("P")
R = TypeVar("R")
KEPT = 16  # results of a function


def remembered(function: Callable[P, R]) -> Callable[P, R]:
    """Cache the last results of a pure function of frozen values, numbers and arrays, passed by position.

    Arrays, and values that contain arrays, are compared by identity, numbers by value. With a writable array nothing is
    cached.

    >>> import numpy as np
    >>> calls, array = [], np.arange(3.0)
    >>> total = remembered(lambda values, power: calls.append(power) or float(values.sum()) ** power)
    >>> total(array, 2), total(array, 2), calls
    (9.0, 9.0, [2, 2])
    >>> array.setflags(write=False)
    >>> total(array, 2), total(array, 2), total(array, 1), calls
    (9.0, 9.0, 3.0, [2, 2, 2, 1])
    """
    kept: dict[tuple[object, ...], tuple[tuple[object, ...], R]] = {}

    @wraps(function)
    def found(*args: P.args, **kwargs: P.kwargs) -> R:
        flags = [getattr(value, "flags", None) for value in args]  # arrays have them
        if kwargs or any(own is not None and own.writeable for own in flags):
            return function(*args, **kwargs)
        key = tuple(value if own is None else id(value) for value, own in zip(args, flags, strict=True))
        if key not in kept:
            while len(kept) >= KEPT:
                kept.pop(next(iter(kept)), None)
            kept[key] = args, function(*args, **kwargs)  # with the arguments, so that their identities stay unique
        return kept[key][1]

    return found
