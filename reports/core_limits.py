"""What one core can do: multiply-adds and cached memory, and the least time of some calls."""

import time
from collections.abc import Callable
from typing import TypeVar

import numba
import numpy as np

Made = TypeVar("Made")


def best(task: Callable[[], object], repeats: int, clock: Callable[[], float] = time.process_time) -> float:
    """Least seconds of some calls, of the processor unless another clock is given."""
    return best_of(lambda: None, lambda _: task(), repeats, clock)


def best_of(
    prepare: Callable[[], Made],
    task: Callable[[Made], object],
    repeats: int,
    clock: Callable[[], float] = time.process_time,
) -> float:
    """Least seconds of some calls of `task` on what `prepare` makes anew for each; making it is not counted."""
    times = []
    for _ in range(repeats):
        made = prepare()
        began = clock()
        task(made)
        times.append(clock() - began)
    return min(times)


@numba.njit(fastmath={"contract", "nsz"})
def multiply_add(x: float, y: float, rounds: int) -> float:
    """Sixty-four independent chains of multiply-adds."""
    a = np.linspace(0.1, 0.2, 64)
    for _ in range(rounds):
        for i in range(64):
            a[i] = a[i] * x + y
    return float(a.sum())


@numba.njit(fastmath={"contract", "nsz"})
def triad(a: np.ndarray, b: np.ndarray, c: np.ndarray, rounds: int) -> None:
    """A = b + s c, again and again."""
    for r in range(rounds):
        s = 1.0 + 1e-9 * r
        for i in range(a.size):
            a[i] = b[i] + s * c[i]


def limits(repeats: int) -> dict[str, float]:
    """Flops [GFlop/s], and bytes read and written [GB/s] in the first-level cache and in the second."""
    rounds = 400_000
    found = {"GFlop/s": 128e-9 * rounds / best(lambda: multiply_add(0.999, 1e-3, rounds), repeats + 1)}
    for name, size in (("GB/s, 12 kB", 500), ("GB/s, 400 kB", 16_000)):
        arrays = [np.full(size, 0.5) for _ in range(3)]
        turns = 40_000_000 // size
        seconds = best(lambda arrays=arrays, turns=turns: triad(*arrays, turns), repeats + 1)
        found[name] = 24e-9 * size * turns / seconds
    return found
