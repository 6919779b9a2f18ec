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


def wanted() -> int:
    """The number of threads that a variable of the environment states (the first one of a list), otherwise one.

    BLAS reads these variables when it is loaded; one that is set later counts here too.
    """
    stated = (os.environ.get(name, "").partition(",")[0].strip() for name in ONE_THREAD)
    return next((int(number) for number in stated if number.isdecimal() and int(number) > 0), 1)


@contextmanager
def one_thread() -> Iterator[None]:
    """One BLAS thread within this context, or as many as a variable of the environment states.

    The matrices of a shell are small, so several threads mostly wait for each other: on a busy machine modes take more
    than ten times as long with them. Calculations outside the context keep their threads.
    """
    number = wanted()
    if all(library.get_num_threads() == number for library in blas().lib_controllers):
        yield
        return
    with blas().limit(limits=number):
        yield


def with_one_thread(function: Callable[P, T]) -> Callable[P, T]:
    """The function, run in `one_thread`."""

    @wraps(function)
    def limited(*args: P.args, **kwargs: P.kwargs) -> T:
        with one_thread():
            return function(*args, **kwargs)

    return limited
