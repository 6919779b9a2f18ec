"""Worker processes that end with their parent: when the work is interrupted, and when the parent is killed."""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack, contextmanager, suppress
from multiprocessing import active_children, get_context, parent_process
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import TypeVar, cast

from contact.io.interrupts import interrupts_held
from contact.io.progress import paused

T = TypeVar("T")
R = TypeVar("R")
TRIES = 5  # of a task whose workers die
REMOVED = 0.1  # s: within so long a thread that ended is removed
THREADS = Path("/proc/self/task")  # one entry a thread, those of libraries too


class KilledWorkersError(Exception):
    """Workers that were killed again and again, so that tasks are left."""


@contextmanager
def worker_pool(count: int) -> Iterator[ProcessPoolExecutor]:
    """Start `count` processes: copies of this one where it `forks`, else fresh ones.

    If the block is interrupted, also by Ctrl-C, they end at once.
    """
    before = set(active_children())
    with ExitStack() as starting:
        starting.enter_context(paused())
        pool = ProcessPoolExecutor(count, get_context("fork" if forks() else "spawn"), _begin)
        try:
            with interrupts_held():  # their parent ends them
                for _ in range(count):  # each starts one process
                    pool.submit(int)
            starting.close()
            yield pool
        except BaseException:
            for process in set(active_children()) - before:
                process.terminate()
            raise
        finally:
            pool.shutdown(cancel_futures=True)


@contextmanager
def parts_aside() -> Iterator[Callable[[Callable[[], R]], Callable[[], R]]]:
    """Start parts in one more process each; the result of such a start waits for the part's result or error.

    They start as those of `worker_pool`, and end with the block. A part whose process is killed runs in this one.
    """
    started: list[BaseProcess] = []

    def start(part: Callable[[], R]) -> Callable[[], R]:
        with paused():
            context = get_context("fork") if forks() else get_context("spawn")
            receiver, sender = context.Pipe(duplex=False)
            process = context.Process(target=_answer, args=(sender, part))
            with interrupts_held():  # its parent ends it
                process.start()
        sender.close()
        started.append(process)

        def result() -> R:
            try:
                error, found = receiver.recv()
            except EOFError:
                return part()
            if error is not None:
                raise error
            return cast(R, found)

        return result

    try:
        yield start
    finally:
        for process in started:
            process.terminate()
            process.join()


def _answer(sender: Connection, part: Callable[[], R]) -> None:
    """Send a part's error and result from its process; or the error of sending them."""
    _begin()
    try:
        sender.send((None, part()))
    except Exception as error:
        sender.send((error, None))


def forks() -> bool:
    """Whether workers start as copies of this process, with everything it has imported, loaded and compiled.

    A fresh process takes a second for the imports. Copies are made only on Linux and with one thread: a copy would have
    the locks of other threads without the threads. The thread of a display (`contact.io.progress.pausable`) does not
    count: it ends while workers start.
    """
    if sys.platform != "linux" or not THREADS.is_dir():
        return False
    with paused() as ended:  # the system removes a thread some time after its last line
        latest = time.monotonic() + (REMOVED if ended else 0.0)
        while len(list(THREADS.iterdir())) > 1:
            if time.monotonic() > latest or threading.active_count() > 1:
                return False
            time.sleep(1e-3)
    return True


def _begin() -> None:
    """Make this worker end with its parent, even if that is killed, and leave Ctrl-C to the parent."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent,), daemon=True).start()


def _end_with(parent: BaseProcess) -> None:
    """End this process when the parent ends; after kill -9 a worker would otherwise wait for ever."""
    parent.join()
    os._exit(1)


def in_processes(todo: Sequence[T], work: Callable[[T], R], jobs: int) -> Iterator[R]:
    """Results from worker processes; if one is killed, new ones get the unfinished tasks.

    Raises KilledWorkersError when that happens `TRIES` times in succession without a finished task.
    """
    waiting, deaths = dict(enumerate(todo)), 0
    while waiting:
        if deaths == TRIES:
            raise KilledWorkersError(
                f"workers: found {len(waiting)} unfinished tasks after their process was killed {TRIES} times in a "
                "row; "
                "use fewer workers if the memory is full"
            )
        deaths += 1
        with suppress(BrokenProcessPool), worker_pool(min(jobs, len(waiting))) as pool:
            futures = _given_out(pool, waiting, work)
            for future in as_completed(futures):
                try:
                    found = future.result()
                except BrokenProcessPool:
                    continue
                del waiting[futures[future]]
                deaths = 0
                yield found


def _given_out(pool: ProcessPoolExecutor, waiting: dict[int, T], work: Callable[[T], R]) -> dict[Future[R], int]:
    """Futures of the submitted tasks; if a worker dies meanwhile, of the tasks submitted before."""
    futures: dict[Future[R], int] = {}
    with suppress(BrokenProcessPool):
        for number, task in waiting.items():
            futures[pool.submit(work, task)] = number
    return futures
