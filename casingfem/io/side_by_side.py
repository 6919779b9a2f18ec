"""The same work on many items: in turn, or in processes of their own; how many cores there are for it."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import Protocol, TypeVar

ONE_THREAD = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")
A = TypeVar("A")
B = TypeVar("B")


def usable_cores() -> int:
    """Cores that the scheduler gives this process, maybe not all; where it does not state it, those of the machine."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class Each(Protocol):
    """Results of a function for each item, in the order of the items, like `map`."""

    def __call__(self, function: Callable[[A], B], items: Iterable[A], /) -> Iterator[B]:
        """One after the other, or several at once."""


@contextmanager
def side_by_side(workers: int) -> Iterator[Each]:
    """A number of processes that share the items; `map` of this process for a single worker.

    What they are given, and give back, is pickled. The result is the same as in turn, where this process has one BLAS
    thread: the others have one, and sums of several threads are rounded differently.
    """
    if workers < 2:
        yield map
        return
    from contact.io.workers import worker_pool  # loaded with the first processes, not by every command

    with one_thread(), worker_pool(workers) as pool:
        yield pool.map


def largest_first(
    each: Each, function: Callable[[A], B], items: Sequence[A], size: Callable[[A], float]
) -> Iterator[tuple[int, B]]:
    """Number and result of each item, the largest first: nobody waits at the end for one that began last."""
    order = sorted(range(len(items)), key=lambda k: -size(items[k]))
    yield from zip(order, each(function, [items[k] for k in order]), strict=True)


@contextmanager
def one_thread() -> Iterator[None]:
    """Processes started inside have one BLAS thread each."""
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
