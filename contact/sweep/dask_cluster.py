"""Sweep tasks on a Dask cluster; the only module that imports `distributed`."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterator, Sequence
from typing import Any, TypeVar

from contact.base.errors import InputError

T = TypeVar("T")
R = TypeVar("R")
PATIENCE = "20s"  # for the scheduler to answer


def on_cluster(todo: Sequence[T], work: Callable[[T], R], address: str, tries: int) -> Iterator[R]:
    """Results in the order of completion; if workers are killed, others get the task, up to `tries` times.

    Raises InputError without the package, if no scheduler answers, or if a task's workers died too often.
    """
    try:
        dask: Any = importlib.import_module("distributed")
    except ImportError as error:
        raise InputError("scheduler: found no package distributed: pip install distributed") from error
    try:
        client = dask.Client(address, timeout=PATIENCE)
    except (OSError, ValueError) as error:
        raise InputError(
            f"scheduler: found no scheduler at {address!r}, expected an address such as tcp://host:8786"
        ) from error
    with client:
        futures = {client.submit(work, task, pure=False): (task, 1) for task in todo}
        answers = dask.as_completed(list(futures))
        for future in answers:
            task, tried = futures.pop(future)
            try:
                yield future.result()
            except dask.KilledWorker as error:
                if tried >= tries:
                    raise InputError(
                        f"scheduler: found a task whose worker died {tries} times, expected a result: check the memory "
                        "of the workers"
                    ) from error
                again = client.submit(work, task, pure=False)
                futures[again] = (task, tried + 1)
                answers.add(again)
