"""Threads of BLAS within the packages' own calculations."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache, wraps
from typing import TYPE_CHECKING, ParamSpec, TypeVar

if TYPE_CHECKING:
    from threadpoolctl import ThreadpoolController

ONE_THREAD = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")
P = ParamSpec("P")
T = TypeVar("T")


@cache
def blas(*loaded: bool) -> ThreadpoolController:
    """The BLAS libraries of this process, by whether numpy and scipy.linalg, which have one each, are loaded."""
    from threadpoolctl import ThreadpoolController

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

    The matrices of a shell and of a modal body are small, so several threads mostly wait for each other: on a busy
    machine modes take more than ten times, a table of dangerous speeds four times as long with them. Calculations
    outside the context keep their threads.
    """
    number, libraries = wanted(), blas("numpy" in sys.modules, "scipy.linalg" in sys.modules)
    if all(library.get_num_threads() == number for library in libraries.lib_controllers):
        yield
        return
    with libraries.limit(limits=number):
        yield


def with_one_thread(function: Callable[P, T]) -> Callable[P, T]:
    """The function, run in `one_thread`."""

    @wraps(function)
    def limited(*args: P.args, **kwargs: P.kwargs) -> T:
        with one_thread():
            return function(*args, **kwargs)

    return limited
