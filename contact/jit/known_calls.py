"""What an operator or a function of numba gives for arguments of some types, looked up once.

At each place of a call numba tries all overloads in turn: in the loop of a rub at 8,079 places, which are 239 different
calls. What it found the first time holds for the others, since it depends on the types alone.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from numba.core import types
from numba.core.compiler_lock import global_compiler_lock

Lock: Any = global_compiler_lock
Builtin: Any = types.Function
LOOK_UP: Any = Builtin.get_call_type
KNOWN: dict[tuple[int, Any], tuple[Any, Any]] = {}  # by function and arguments: the function, which so lives on, result


def _known(function: Any, context: Any, args: Any, kws: Any) -> Any:
    """Signature of a call; those with keywords are looked up each time."""
    if kws:
        return LOOK_UP(function, context, args, kws)
    key = id(function), args
    found = KNOWN.get(key)
    if found is None:
        found = KNOWN[key] = function, LOOK_UP(function, context, args, kws)
    return found[1]


@contextmanager
def calls_looked_up_once() -> Iterator[None]:
    """While this lasts calls are looked up once; what others compile is as numba has it."""
    with Lock:
        before = Builtin.get_call_type
        Builtin.get_call_type = _known
        try:
            yield
        finally:
            Builtin.get_call_type = before
