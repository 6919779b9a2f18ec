"""Threads of BLAS within the package's own calculations."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache, wraps
from typing import ParamSpec, TypeVar

import numpy as np  # noqa: F401  (loads one BLAS library; scipy.linalg loads another)
import scipy.linalg  # noqa: F401
from threadpoolctl import ThreadpoolController

from casingfem.io.side_by_side import ONE_THREAD

P = ParamSpec("P")
T = TypeVar("T")


@cache
def blas() -> ThreadpoolController:
    """The BLAS libraries of this process."""
    return ThreadpoolController().select(user_api="blas")


@contextmanager
def one_thread() -> Iterator[None]:
    """One BLAS thread within this context, unless a variable of the environment states a number.

    The matrices of a shell are small, so several threads mostly wait for each other: on a busy machine modes take more
    than ten times as long with them. Calculations outside the context keep their threads.
    """
    libraries = blas().lib_controllers
    if any(name in os.environ for name in ONE_THREAD) or all(library.get_num_threads() == 1 for library in libraries):
        yield
        return
    with blas().limit(limits=1):
        yield


def with_one_thread(function: Callable[P, T]) -> Callable[P, T]:
    """The function, run in `one_thread`."""

    @wraps(function)
    def limited(*args: P.args, **kwargs: P.kwargs) -> T:
        with one_thread():
            return function(*args, **kwargs)

    return limited
