"""The package `contact` once more, its step loops as plain Python: their parts are run on small arrays, uncompiled."""

import importlib
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from types import ModuleType, SimpleNamespace
from typing import Any

import numba


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
