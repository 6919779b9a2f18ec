"""Progress in notebooks: one line that is overwritten, after two seconds; nothing elsewhere."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from typing import Any

PATIENCE, PACE = 2.0, 0.5  # s until the first text, and between two texts


def in_notebook() -> bool:
    """Whether this runs in the kernel of a notebook."""
    return "ipykernel" in sys.modules


def notebook_progress(what: str, words: Callable[..., str]) -> Callable[..., None] | None:
    """A `progress` callback for notebooks, which shows `words` of its arguments; None outside notebooks.

    >>> notebook_progress("run", "{:.0%}".format) is None
    True
    """
    return Line(what, words) if in_notebook() else None


class Line:
    """One line on stderr, overwritten each time."""

    def __init__(self, what: str, words: Callable[..., str]) -> None:
        self.what, self.words = what, words
        self.next = time.monotonic() + PATIENCE

    def __call__(self, *done: Any) -> None:
        """Show the progress, unless it was shown a moment ago."""
        now = time.monotonic()
        if now >= self.next:
            self.next = now + PACE
            print(f"\r{self.what}: {self.words(*done)}", end="", file=sys.stderr, flush=True)
