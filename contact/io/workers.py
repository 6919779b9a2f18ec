"""Worker processes that end with whoever started them: when the work is broken off, and when their parent is killed."""

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
    """`count` processes, each after `set_up(*values)`: copies of this one where it `forks`, else fresh ones.

    Where the block is broken off, by Ctrl-C too, they end at once, whatever they were doing.
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
    """Whether workers start as copies of this process, with all that it has imported, loaded and compiled.

    A fresh one takes a second to come that far. Only on Linux, and only with one thread: a copy has the locks that
    other threads held, and not the threads.
    """
    return sys.platform == "linux" and THREADS.is_dir() and len(list(THREADS.iterdir())) == 1


def _begin(set_up: Callable[..., None] | None, values: tuple[Any, ...]) -> None:
    """Let this worker end when its parent does, even if that was killed, and leave Ctrl-C to the parent."""
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
