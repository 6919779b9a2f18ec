"""Worker processes that end with whoever started them: when the work is broken off, and when their parent is killed."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import active_children, parent_process
from multiprocessing.process import BaseProcess


@contextmanager
def ended_on_failure() -> Iterator[None]:
    """Where the block is broken off, by Ctrl-C too, end the processes that were started inside."""
    before = set(active_children())
    try:
        yield
    except BaseException:
        for child in set(active_children()) - before:
            child.terminate()
        raise


def end_with_parent() -> None:
    """Let this worker end when its parent does, even if that was killed, and leave Ctrl-C to the parent."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent,), daemon=True).start()


def _end_with(parent: BaseProcess) -> None:
    """Wait for the parent's end, then end: what kill -9 leaves behind would wait for work for ever."""
    parent.join()
    os._exit(1)
