"""Worker processes that end with their parent: when the work is interrupted, and when the parent is killed."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import active_children, get_context, parent_process
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any

from contact.io.interrupts import interrupts_held

THREADS = Path("/proc/self/task")  # one entry a thread, those of libraries too


@contextmanager
def worker_pool(count: int, set_up: Callable[..., None] | None = None, *values: Any) -> Iterator[ProcessPoolExecutor]:
    """Start `count` processes, each after `set_up(*values)`: copies of this one where it `forks`, else fresh ones.

    If the block is interrupted, also by Ctrl-C, they end at once.
    """
    before = set(active_children())
    pool = ProcessPoolExecutor(count, get_context("fork" if forks() else "spawn"), _begin, (set_up, values))
    try:
        with interrupts_held():  # their parent ends them
            for _ in range(count):  # each starts one process
                pool.submit(int)
        yield pool
    except BaseException:
        for process in set(active_children()) - before:
            process.terminate()
        raise
    finally:
        pool.shutdown(cancel_futures=True)


def forks() -> bool:
    """Whether workers start as copies of this process, with everything it has imported, loaded and compiled.

    A fresh process takes a second for the imports. Copies are made only on Linux and with one thread: a copy would have
    the locks of other threads without the threads.
    """
    return sys.platform == "linux" and THREADS.is_dir() and len(list(THREADS.iterdir())) == 1


def _begin(set_up: Callable[..., None] | None, values: tuple[Any, ...]) -> None:
    """Make this worker end with its parent, even if that is killed, and leave Ctrl-C to the parent."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent,), daemon=True).start()
    if set_up is not None:
        set_up(*values)


def _end_with(parent: BaseProcess) -> None:
    """End this process when the parent ends; after kill -9 a worker would otherwise wait for ever."""
    parent.join()
    os._exit(1)
