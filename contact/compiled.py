"""The only doorway to numba: one typed decorator, imported when a run starts and not before."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar, cast

import numba

Function = TypeVar("Function", bound=Callable[..., object])


def jit(function: Function) -> Function:
    """Compile a step loop to machine code, cached on disk.

    Sums may be reassociated and products contracted, so that reductions vectorise; NaN keeps its meaning,
    so that a run that diverges is seen. The same input gives bit-identical results on one machine.
    """
    compiled = numba.njit(cache=True, error_model="numpy", fastmath={"reassoc", "contract", "nsz"})
    return cast(Function, compiled(function))
