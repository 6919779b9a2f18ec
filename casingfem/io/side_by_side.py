"""The same work on many items in turn or in worker processes, a part beside another one; the number of usable cores."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import Protocol, TypeVar

A = TypeVar("A")
B = TypeVar("B")


def usable_cores() -> int:
    """Number of cores that the scheduler gives this process; if unknown, that of the machine."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class Each(Protocol):
    """Interface of `map`: results of a function for each item, in order."""

    def __call__(self, function: Callable[[A], B], items: Iterable[A], /) -> Iterator[B]:
        """Apply the function, in turn or in parallel."""


@contextmanager
def side_by_side(workers: int) -> Iterator[Each]:
    """A number of processes that share the items; the built-in `map` for a single worker.

    Arguments and results are pickled. The results equal those in turn if this process has one BLAS thread, as the
    workers have: sums of several threads are rounded differently.
    """
    if workers < 2:
        yield map
        return
    from contact.io.workers import worker_pool  # loaded with the first processes, not by every command

    with one_thread_for_children(), worker_pool(workers) as pool:
        yield pool.map


class Aside(Protocol):
    """Interface of `aside`: starts a part, returns a function that waits for its result."""

    def __call__(self, part: Callable[[], B], /) -> Callable[[], B]:
        """Start the part now or, without a second process, when its result is asked for."""


@contextmanager
def aside(second: bool) -> Iterator[Aside]:
    """A further process for each part of which this process needs the result later; this one goes on meanwhile."""
    if not second:
        yield lambda part: part
        return
    from contact.io.workers import parts_aside

    with one_thread_for_children(), parts_aside() as start:
        yield start


@contextmanager
def one_thread_for_children() -> Iterator[None]:
    """Within this context, new processes have one BLAS thread each."""
    from contact.io.threads import ONE_THREAD

    before = {name: os.environ.get(name) for name in ONE_THREAD}
    os.environ.update(dict.fromkeys(ONE_THREAD, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
