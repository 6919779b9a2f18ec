"""Room for the frames of Python while numba compiles.

CPython keeps frames in chunks of 16 KiB. A call that needs the next chunk asks the system for one, its return gives it
back: an inner loop that stands where a chunk ends does so at every turn (https://github.com/python/cpython/issues/142183,
mended in the newest versions). The compiler calls itself to hundreds of depths and meets such places: of the 20 s in
which the rub of many tips is compiled it spent 3 on 375,000 chunks. A frame larger than a chunk is given one of its
own, the next power of two, and all frames above it share what is left.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

WORDS = 140_000  # of 8 bytes: of 2 MiB then, which are only taken as they are used, almost half is left


def with_room(function: Callable[..., Any], *args: Any) -> Any:
    """Call a function with room for the frames of some thousand calls within it.

    >>> with_room(max, 2, 3)
    3
    """
    return function(*args)


with_room.__code__ = with_room.__code__.replace(co_stacksize=WORDS)
