"""Apply a function to many tasks, in processes that may be killed or on a cluster; results in order of completion."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from typing import TypeVar

from contact.base.errors import InputError
from contact.io.workers import worker_pool

T = TypeVar("T")
R = TypeVar("R")
TRIES = 5  # of a task whose workers die


def on_workers(todo: Sequence[T], work: Callable[[T], R], jobs: int, scheduler: str | None) -> Iterator[R]:
    """Results from `jobs` processes, or from the workers of a Dask `scheduler` by its address."""
    if scheduler is None:
        return in_processes(todo, work, jobs)
    from contact.sweep.dask_cluster import on_cluster

    return on_cluster(todo, work, scheduler, TRIES)


def in_processes(todo: Sequence[T], work: Callable[[T], R], jobs: int) -> Iterator[R]:
    """Results from worker processes; if one is killed, new ones get the unfinished tasks.

    Raises InputError when workers are killed `TRIES` times in succession without a finished task.
    """
    waiting, deaths = dict(enumerate(todo)), 0
    while waiting:
        if deaths == TRIES:
            raise InputError(f"workers: {len(waiting)} tasks ended with their worker killed, {TRIES} times over")
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
