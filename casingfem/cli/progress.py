"""Progress of a long command on stderr: current work, elapsed time, estimated remaining time.

On a terminal one line changes. A file or a pipe gets whole lines, the first after two seconds, then less and less
often. `CASINGFEM_PROGRESS=off` turns both off. A command states its steps; what a step reports (`contact.io.progress`)
is shown after it, with the remaining time of that step.
"""

import os
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from types import TracebackType
from typing import Any

from contact.io.progress import listening, pausable

PATIENCE = 1.0  # seconds until a terminal shows what takes so long
TICK = 0.08  # seconds between two pictures of a terminal's line
FIRST, LONGEST = 2.0, 60.0  # seconds until the first line in a file, and between two lines at most
SWITCH = "CASINGFEM_PROGRESS"


def duration(seconds: float) -> str:
    """A time in words.

    >>> duration(7.4), duration(200.0), duration(7500.0)
    ('7 s', '3 min 20 s', '2 h 5 min')
    """
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    return f"{whole // 60} min {whole % 60} s" if whole < 3600 else f"{whole // 3600} h {whole % 3600 // 60} min"


class ProgressMessage:
    """Progress display of a long command; `say` changes the text and the finished share.

    The remaining time is the time since the first reported share, divided by the progress since then, times the rest.
    If `say` gives no share, the share that the computation reports to `tell` is used.

    >>> with ProgressMessage("modes") as working:
    ...     working.say("modes: assembling")
    ...     working.say("modes: 3 of 4 parts", 0.75)
    """

    def __init__(self, what: str) -> None:
        self.what = what
        self.started = time.perf_counter()
        self._whole = False  # whether the share is that of the command, not of a step
        self._detail, self._most = "", False
        self._done: float | None = None
        self._since: tuple[float, float] | None = None  # time of the first share, and that share
        self._stack = ExitStack()
        self._ended = threading.Event()
        self._thread: threading.Thread | None = None
        self._next = FIRST  # seconds from the start until the next line in a file

    def __enter__(self) -> "ProgressMessage":
        if os.environ.get(SWITCH, "") != "off":
            self._show()
            self._stack.enter_context(listening(self.tell))
            self._stack.enter_context(pausable(self._paused))
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._stack.close()
        self._hide()

    def _show(self) -> None:
        """Begin to show the text, in a thread."""
        self._ended.clear()
        self._thread = threading.Thread(target=self._on_terminal if sys.stderr.isatty() else self._in_lines)
        self._thread.daemon = True
        self._thread.start()

    def _hide(self) -> None:
        """End the thread, if there is one."""
        thread, self._thread = self._thread, None
        if thread is not None:
            self._ended.set()
            thread.join()

    @contextmanager
    def _paused(self) -> Iterator[None]:
        """Within this context the display has no thread."""
        shown = self._thread is not None
        self._hide()
        try:
            yield
        finally:
            if shown:
                self._show()

    @property
    def seconds(self) -> float:
        """Time since the start."""
        return time.perf_counter() - self.started

    def say(self, what: str, done: float | None = None) -> None:
        """Change the text; `done` is the finished share of the work, 0 to 1, None if unknown."""
        if not self._whole:  # a share of a step is none of the command
            self._since = None
        self.what, self._detail, self._most, self._whole = what, "", False, done is not None
        self._reach(done)

    def tell(self, words: str, done: float | None = None, most: bool = False) -> None:
        """Show the progress of the current step; its share counts if that of the command is unknown.

        `most`: the share refers to the largest possible number of steps, so that less time may remain.
        """
        self._detail, self._most = words, most
        if not self._whole:
            self._reach(done)

    def _reach(self, done: float | None) -> None:
        """Store the share; a smaller share belongs to another step, which is timed from now on."""
        if done is None:
            self._since = None
        elif self._since is None or self._done is None or done < self._done:
            self._since = self.seconds, done
        self._done = done

    @property
    def text(self) -> str:
        """The current progress text, with elapsed time and estimated remaining time."""
        words, done, since, now = self.what, self._done, self._since, self.seconds
        words += f", {self._detail}" if self._detail else ""
        share = "" if done is None else f": {done:.0%}"
        if done is None or since is None or done <= since[1]:
            return f"{words}{share}, {duration(now)} so far"
        left = (now - since[0]) * (1.0 - done) / (done - since[1])
        about = "at most" if self._most and not self._whole else "about"
        part = "" if self._whole else " of this part"
        return f"{words}{share}, {duration(now)} so far, {about} {duration(left)} left{part}"

    def _on_terminal(self) -> None:
        if self._ended.wait(max(PATIENCE - self.seconds, 0.0)):
            return
        from rich.console import Console
        from rich.live import Live
        from rich.spinner import Spinner

        spinner = Spinner("dots", self.text, style="status.spinner")
        with Live(spinner, console=Console(stderr=True), auto_refresh=False, transient=True) as line:
            while not self._ended.wait(TICK):  # without a thread of its own, which would end some time after this one
                spinner.update(text=self.text)
                line.refresh()

    def _in_lines(self) -> None:
        stream: Any = sys.stderr
        while not self._ended.wait(max(self._next - self.seconds, 0.0)):
            print(self.text, file=stream, flush=True)
            self._next = self.seconds + min(max(self.seconds, FIRST), LONGEST)
