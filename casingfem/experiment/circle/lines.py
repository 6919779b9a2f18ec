"""Where the lines of a circle scan stand, and whether a record tells them apart."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from casingfem.errors import InputError
from casingfem.io.arrays import FloatArray, IntArray

TURNS = 1.5  # of the spot in a record, at least
RESOLVED = 1.0  # bins (1/T) between two lines, at least
TRIED = np.linspace(0.7, 1.4, 281)  # rates tried, over the one that failed


def line_frequencies(tones: Sequence[float], n: IntArray, rate: float, runout: int = 0) -> FloatArray:
    """|f + n W| of all tones and orders, then k W of the run-out [Hz].

    >>> line_frequencies([100.0], np.array([-2, 2]), 3.0, runout=1).tolist()
    [94.0, 106.0, 0.0, 3.0]
    """
    waves = np.add.outer(np.asarray(tones, np.float64), n * rate).ravel()
    return np.asarray(np.abs(np.r_[waves, np.arange(runout + 1) * rate if runout else []]))


def closest(freq: FloatArray) -> tuple[int, int, float]:
    """The two lines that are closest together, and their distance [Hz]."""
    rank = np.argsort(freq, kind="stable")
    gaps = np.diff(freq[rank])
    k = int(gaps.argmin()) if len(gaps) else 0
    return (int(rank[k]), int(rank[k + 1]), float(gaps[k])) if len(gaps) else (0, 0, np.inf)


def clear_rate(
    tones: Sequence[float], n: IntArray, rate: float, seconds: float, fs: float, runout: int = 0
) -> float | None:
    """The rate nearest to `rate` at which all lines stand at least two bins apart, None if there is none nearby."""
    for factor in sorted(TRIED, key=lambda f: abs(np.log(f))):
        freq = line_frequencies(tones, n, rate * factor, runout)
        if closest(freq)[2] * seconds >= 2.0 * RESOLVED and freq.max() < 0.5 * fs:
            return float(rate * factor)
    return None


def require_clear(tones: Sequence[float], n: IntArray, rate: float, seconds: float, fs: float, runout: int) -> None:
    """Refuse a record whose lines cannot be told apart, with what would help.

    Raises
    ------
    InputError
        Too few turns; lines above fs/2; two lines closer than one bin.
    """
    turns = abs(rate) * seconds
    if turns < TURNS:
        need = f"{TURNS / abs(rate):.3g} s" if rate else "a spot that turns"
        raise InputError(f"the record is too short: found {turns:.2f} turns of the spot, expected {TURNS} ({need})")
    freq = line_frequencies(tones, n, rate, runout)
    if freq.max() >= 0.5 * fs:
        raise InputError(
            f"found a line at {freq.max():.2f} Hz, expected all below fs/2 = {0.5 * fs:g} Hz: lower orders"
        )
    low, high, gap = closest(freq)
    if gap * seconds >= RESOLVED:
        return
    one, other = (name(k, tones, n) for k in sorted((low, high)))
    better = clear_rate(tones, n, rate, seconds, fs, runout)
    help_ = f"turn at {better:.4g} turns/s" if better else "excite fewer tones at a time, or look for fewer orders"
    raise InputError(
        f"lines fall together: {one} and {other} stand {gap:.3g} Hz apart at {freq[low]:.3f} Hz, "
        f"a record of {seconds:g} s tells {RESOLVED / seconds:.3g} Hz: {help_}"
    )


def name(line: int, tones: Sequence[float], n: IntArray) -> str:
    """A line in words."""
    if line >= len(tones) * len(n):
        return f"the run-out's harmonic {line - len(tones) * len(n)}"
    order = int(n[line % len(n)])
    return f"n = {abs(order)} of {tones[line // len(n)]:.3f} Hz ({'+' if order >= 0 else '-'}nW)"
