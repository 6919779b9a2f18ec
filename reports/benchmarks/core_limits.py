"""Limits of one core: multiply-adds, cached memory, and the least time of some calls."""

import time
from collections.abc import Callable
from typing import TypeVar

import numpy as np

from contact.base.arrays import aligned
from contact.jit.compiled import jit_entry
from contact.jit.vector import WIDTH, load, put, same

Made = TypeVar("Made")


def best(task: Callable[[], object], repeats: int, clock: Callable[[], float] = time.thread_time) -> float:
    """Least seconds of some calls, of this thread's processor time unless another clock is given."""
    return best_of(lambda: None, lambda _: task(), repeats, clock)


def best_of(
    prepare: Callable[[], Made],
    task: Callable[[Made], object],
    repeats: int,
    clock: Callable[[], float] = time.thread_time,
) -> float:
    """Least seconds of some calls of `task` on an object that `prepare` makes for each call; `prepare` is not timed.

    By the thread's clock: under a limit of processor time the process's goes on in ticks, longer than a short loop.
    What BLAS may share among threads is timed with `process_time`.
    """
    times = []
    for _ in range(repeats):
        made = prepare()
        began = clock()
        task(made)
        times.append(clock() - began)
    return min(times)


@jit_entry
def multiply_add(factor: float, add: float, rounds: int, found: np.ndarray) -> None:
    """Ten independent chains of multiply-adds on vectors of eight numbers, which stay in the registers."""
    x, y = same(factor), same(add)
    a, b, c, d, e = same(0.10), same(0.11), same(0.12), same(0.13), same(0.14)
    f, g, h, i, j = same(0.15), same(0.16), same(0.17), same(0.18), same(0.19)
    for _ in range(rounds):
        a, b, c, d, e = a * x + y, b * x + y, c * x + y, d * x + y, e * x + y
        f, g, h, i, j = f * x + y, g * x + y, h * x + y, i * x + y, j * x + y
    put(found, 0, a + b + c + d + e + f + g + h + i + j)


@jit_entry
def triad(a: np.ndarray, b: np.ndarray, c: np.ndarray, rounds: int) -> None:
    """Repeat a = b + s c on vectors of eight numbers."""
    for r in range(rounds):
        s = same(1.0 + 1e-9 * r)
        for i in range(0, a.size, WIDTH):
            put(a, i, load(b, i) + s * load(c, i))


def limits(repeats: int) -> dict[str, float]:
    """Flops [GFlop/s], and bytes read and written [GB/s] in the first-level and second-level caches."""
    rounds, last = 1_000_000, np.zeros(WIDTH)
    seconds = best(lambda: multiply_add(0.999, 1e-3, rounds, last), repeats + 1)
    found = {"GFlop/s": 2e-9 * 10 * WIDTH * rounds / seconds}
    for name, size in (("GB/s, 12 kB", 512), ("GB/s, 400 kB", 16_384)):
        arrays = aligned(3, size)
        turns = 40_000_000 // size
        seconds = best(lambda arrays=arrays, turns=turns: triad(*arrays, turns), repeats + 1)
        found[name] = 24e-9 * size * turns / seconds
    return found
