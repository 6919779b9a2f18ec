"""Compilation of loops: announce it once if it takes long, pause the garbage collector, and avoid repeated look-ups.

A first run waits for it, later ones do not. Compiling makes millions of objects that live; looking for cycles among
them again and again took a tenth of the time.
"""

from __future__ import annotations

import gc
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from numba.core import event, types
from numba.core.compiler_lock import global_compiler_lock

from contact.io.notebook import in_notebook

LONG = 2.0  # seconds until it is said
WORDS = "compiling the loops of this run for this processor; kept on disk, so that the next run starts at once"

listener: Any = event.Listener
Lock: Any = global_compiler_lock
Builtin: Any = types.Function
LOOK_UP: Any = Builtin.get_call_type
KNOWN: dict[tuple[int, Any], tuple[Any, Any]] = {}  # by function and arguments: the function, which so lives on, result
FRAMES = 140_000  # of 8 bytes: of 2 MiB then, which are only taken as they are used, almost half is left


def to_terminal(words: str) -> None:
    """Print on stderr where somebody reads it, a notebook's cell too; nothing into files and pipes."""
    if sys.stderr.isatty() or in_notebook():
        print(words, file=sys.stderr, flush=True)


class Announcement(listener):  # type: ignore[misc]
    """Calls `say` once if the compilation of a function, with all that it calls, takes longer than `after` seconds."""

    def __init__(self, after: float = LONG, say: Any = to_terminal) -> None:
        self.after, self.say = after, say
        self.said = False
        self.depth = 0
        self.timer: threading.Timer | None = None

    def on_start(self, _: Any) -> None:
        """A function begins to be compiled."""
        self.depth += 1
        if self.depth == 1 and not self.said:
            self.timer = threading.Timer(self.after, self._tell)
            self.timer.daemon = True
            self.timer.start()

    def on_end(self, _: Any) -> None:
        """It is compiled."""
        self.depth -= 1
        if self.depth == 0 and self.timer is not None:
            self.timer.cancel()
            self.timer = None

    def _tell(self) -> None:
        self.said = True
        self.say(WORDS)


class Uncollected(listener):  # type: ignore[misc]
    """Pauses the garbage collector while something is compiled, where it was running."""

    def __init__(self) -> None:
        self.depth = 0
        self.paused = False

    def on_start(self, _: Any) -> None:
        """A function begins to be compiled."""
        self.depth += 1
        if self.depth == 1 and gc.isenabled():
            gc.disable()
            self.paused = True

    def on_end(self, _: Any) -> None:
        """It is compiled, or was refused."""
        self.depth -= 1
        if self.depth == 0 and self.paused:
            gc.enable()
            self.paused = False


def announce(*listening: Any) -> None:
    """Listen to numba from now on; it reports compiled functions, not functions read from disk."""
    register: Any = event.register
    for one in listening:
        register("numba:compile", one)


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
    """Within this context, look up calls of numba's operators and functions once.

    At each place of a call numba tries all overloads in turn: in the loop of a rub at 8,079 places, which are 239
    different calls. What it found the first time holds for the others, since it depends on the types alone.
    """
    with Lock:
        before = Builtin.get_call_type
        Builtin.get_call_type = _known
        try:
            yield
        finally:
            Builtin.get_call_type = before


def with_room(function: Callable[..., Any], *args: Any) -> Any:
    """Call a function with room for the frames of some thousand calls within it.

    CPython keeps frames in chunks of 16 KiB. A call that needs the next chunk asks the system for one, its return gives
    it back: an inner loop that stands where a chunk ends does so at every turn
    (https://github.com/python/cpython/issues/142183, mended in the newest versions). The compiler calls itself to
    hundreds of depths and meets such places: of the 20 s in which the rub of many tips is compiled it spent 3 on
    375,000 chunks. A frame larger than a chunk is given one of its own, the next power of two, and all frames above it
    share what is left.

    >>> with_room(max, 2, 3)
    3
    """
    return function(*args)


with_room.__code__ = with_room.__code__.replace(co_stacksize=FRAMES)
