"""Apply a function to many tasks, in processes that may be killed or on a cluster; results in order of completion."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

from contact.base.errors import InputError
from contact.io import workers

T = TypeVar("T")
R = TypeVar("R")


def on_workers(todo: Sequence[T], work: Callable[[T], R], jobs: int, scheduler: str | None) -> Iterator[R]:
    """Results from `jobs` processes, or from the workers of a Dask `scheduler` by its address."""
    if scheduler is None:
        return in_processes(todo, work, jobs)
    from contact.sweep.dask_cluster import on_cluster

    return on_cluster(todo, work, scheduler, workers.TRIES)


def in_processes(todo: Sequence[T], work: Callable[[T], R], jobs: int) -> Iterator[R]:
    """Results from worker processes; raises InputError when they are killed again and again."""
    try:
        yield from workers.in_processes(todo, work, jobs)
    except workers.KilledWorkersError as error:
        raise InputError(str(error)) from error
