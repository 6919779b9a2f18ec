"""The package `contact` once more, its step loops as plain Python: their parts are run on small arrays, uncompiled."""

import importlib
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from types import ModuleType, SimpleNamespace
from typing import Any

import numba
import numpy as np

WIDTH = 8


def total(v):
    """Sum of eight numbers, by halves as the compiled one."""
    while v.size > 1:
        v = v[: v.size // 2] + v[v.size // 2 :]
    return float(v[0])


def put(array, k, v):
    """Write eight numbers from entry k on, counted flat."""
    array.ravel()[k : k + WIDTH] = v
    if not np.shares_memory(array, array.ravel()):
        raise TypeError("found strides, expected a contiguous array")


VECTORS: dict[str, Any] = {
    "load": lambda array, k: array.ravel()[k : k + WIDTH].copy(),
    "put": put,
    "same": lambda x: np.full(WIDTH, float(x)),
    "eight": lambda *numbers: np.array(numbers, dtype=float),
    "total": total,
    "larger": lambda v, w: np.where(v > w, v, w),
    "below_zero": lambda v: not (v >= 0.0).all(),
    "entry": lambda array, k: array.ravel()[k],
}


def ours(name: str) -> bool:
    """Whether a module belongs to the package, or makes bodies of it for tests."""
    return name == "contact" or name.startswith(("contact.", "tests.contact.synthetic"))


@cache
def modules() -> dict[str, ModuleType]:
    """Those of the second package, by name."""
    return {}


@contextmanager
def plain() -> Iterator[Callable[[str], Any]]:
    """While this lasts, `contact` is the second package, what it imports as it runs too; yields its import."""
    config: Any = numba.config
    kept = {each: sys.modules.pop(each) for each in list(sys.modules) if ours(each)}
    sys.modules.update(modules())
    before, config.DISABLE_JIT = config.DISABLE_JIT, True
    try:
        vars(importlib.import_module("contact.jit.vector")).update(VECTORS)
        vars(importlib.import_module("contact.jit.bundle"))["bundled"] = lambda value: value
        called = importlib.import_module("contact.jit.compiled").ByAddress
        called.__call__ = lambda self, *arguments: type(self).function(*arguments)
        room = importlib.import_module("contact.solver.friction.room").Otherwise
        room.__call__ = lambda self, *arguments: self.call(*arguments)
        yield importlib.import_module
    finally:
        config.DISABLE_JIT = before
        modules().update({each: module for each, module in sys.modules.items() if ours(each)})
        for each in modules():
            del sys.modules[each]
        sys.modules.update(kept)


def names(*which: str) -> SimpleNamespace:
    """All names of several modules in one place, as plain Python."""
    found: dict[str, Any] = {}
    with plain() as module:
        for each in which:
            found.update(vars(module(each)))
    return SimpleNamespace(**found)
