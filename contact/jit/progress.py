"""Compilation of loops: announce it once if it takes long, pause the garbage collector, and avoid repeated look-ups.

Only a first run waits for compilation. It makes millions of long-lived objects; repeated garbage collection among them
takes a tenth of the time.
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

LONG = 2.0  # seconds of compilation until the line is printed
WORDS = "compiling the loops of this run for this processor; kept on disk, so that the next run starts at once"

listener: Any = event.Listener
Lock: Any = global_compiler_lock
Builtin: Any = types.Function
LOOK_UP: Any = Builtin.get_call_type
KNOWN: dict[tuple[int, Any], tuple[Any, Any]] = {}  # by function and arguments: the function, which so lives on, result
FRAMES = 140_000  # of 8 bytes: of 2 MiB then, which are only taken as they are used, almost half is left


def to_terminal(words: str) -> None:
    """Print on stderr if it is a terminal or a notebook; nothing into files and pipes."""
    if sys.stderr.isatty() or in_notebook():
        print(words, file=sys.stderr, flush=True)


class Announcement(listener):  # type: ignore[misc]
    """Call `say` once if compiling a function with all its callees takes longer than `after` seconds."""

    def __init__(self, after: float = LONG, say: Any = to_terminal) -> None:
        self.after, self.say = after, say
        self.said = False
        self.depth = 0
        self.timer: threading.Timer | None = None

    def on_start(self, _: Any) -> None:
        """Note that compilation of a function begins."""
        self.depth += 1
        if self.depth == 1 and not self.said:
            self.timer = threading.Timer(self.after, self._tell)
            self.timer.daemon = True
            self.timer.start()

    def on_end(self, _: Any) -> None:
        """Note that compilation of a function ends."""
        self.depth -= 1
        if self.depth == 0 and self.timer is not None:
            self.timer.cancel()
            self.timer = None

    def _tell(self) -> None:
        self.said = True
        self.say(WORDS)


class Uncollected(listener):  # type: ignore[misc]
    """Pause the garbage collector during compilation, if it was running."""

    def __init__(self) -> None:
        self.depth = 0
        self.paused = False

    def on_start(self, _: Any) -> None:
        """Note that compilation of a function begins."""
        self.depth += 1
        if self.depth == 1 and gc.isenabled():
            gc.disable()
            self.paused = True

    def on_end(self, _: Any) -> None:
        """Note that compilation of a function ends or fails."""
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
    """Signature of a call; None with keywords, which are looked up each time."""
    if kws:
        return LOOK_UP(function, context, args, kws)
    key = id(function), args
    found = KNOWN.get(key)
    if found is None:
        found = KNOWN[key] = function, LOOK_UP(function, context, args, kws)
    return found[1]


@contextmanager
def calls_looked_up_once() -> Iterator[None]:
    """Within this context, numba's overloads are looked up once for each operator and function with given types.

    At each call numba tries all overloads in turn. The loop of a rub has 8,079 calls, of which 239 are different. The
    first result applies to the others, since it depends on the types alone.
    """
    with Lock:
        before = Builtin.get_call_type
        Builtin.get_call_type = _known
        try:
            yield
        finally:
            Builtin.get_call_type = before


def with_room(function: Callable[..., Any], *args: Any) -> Any:
    """Call a function after reserving memory for the frames of some thousand nested calls.

    CPython keeps frames in chunks of 16 KiB. A call that needs the next chunk asks the system for one, its return gives
    it back: an inner loop at the end of a chunk does so in every iteration
    (https://github.com/python/cpython/issues/142183, fixed in the newest versions). The compiler recurses hundreds of
    levels deep: compiling the rub of many tips took 20 s, of which 3 s went into 375,000 chunks. A frame larger than a
    chunk gets its own chunk, the next power of two, and all frames above it share the rest.

    >>> with_room(max, 2, 3)
    3
    """
    return function(*args)


with_room.__code__ = with_room.__code__.replace(co_stacksize=FRAMES)
