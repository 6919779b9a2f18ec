"""While loops are compiled: say so once when it takes long, and let the garbage be.

A first run waits for it, later ones do not. Compiling makes millions of objects that live; looking for cycles among
them again and again took a tenth of the time.
"""

from __future__ import annotations

import gc
import sys
import threading
from typing import Any

from numba.core import event

from contact.io.notebook import in_notebook

LONG = 2.0  # seconds until it is said
WORDS = "compiling the loops of this run for this processor; kept on disk, so that the next run starts at once"

listener: Any = event.Listener


def to_terminal(words: str) -> None:
    """Print on stderr where somebody reads it, a notebook's cell too; nothing into files and pipes."""
    if sys.stderr.isatty() or in_notebook():
        print(words, file=sys.stderr, flush=True)


class Announcement(listener):  # type: ignore[misc]
    """Calls `say` once when what is compiled, with all that it calls, takes longer than `after` seconds."""

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
    """Listen to numba from now on; it tells only what is compiled, not what is read from disk."""
    register: Any = event.register
    for one in listening:
        register("numba:compile", one)
