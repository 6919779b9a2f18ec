"""Rates of quantities that vary in a run, for comparison with the time step and the end time."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

MOST, MANY = 0.5, 0.2  # of the Nyquist limit: four steps a period, and ten


@dataclass(frozen=True, slots=True, kw_only=True)
class Rate:
    """A quantity with a period or a time constant: its key, its frequency [Hz], and its name in words.

    A rate r [1/s] of decay has the frequency r/(2 pi), like an angular frequency. A run is refused if `hz` exceeds
    `most` times the Nyquist limit 1/(2 dt), and flagged if it exceeds `many` times that limit.

    >>> force = Rate(key="mass[1].force_hz", hz=50.0, words="50 Hz")
    >>> force.share(1e-3), force.step
    (0.1, 0.005)
    """

    key: str
    hz: float
    words: str
    most: float = MOST
    many: float = MANY
    decays: bool = False

    def share(self, dt: float) -> float:
        """Ratio of the frequency to the Nyquist limit of a step dt [s]."""
        return 2.0 * self.hz * dt

    @property
    def step(self) -> float:
        """Longest step that is not refused [s]."""
        return 0.5 * self.most / self.hz

    @staticmethod
    def of_decay(key: str, rate: float, words: str = "") -> Rate:
        """Rate of a quantity that decays to 1/e in 1/rate [s]."""
        return Rate(key=key, hz=rate / (2.0 * math.pi), words=words or f"{rate:.6g} 1/s", decays=True)

    @staticmethod
    def of_passage(key: str, seconds: float, words: str) -> Rate:
        """Rate of a passage that should last longer than a step; only flagged."""
        return Rate(key=key, hz=0.5 / seconds, words=words, most=math.inf, many=1.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """Start of a change at some time [s], and the key that gives it.

    >>> Change(key="closing.time", begins=2.0).begins
    2.0
    """

    key: str
    begins: float


def changes(key: str, time: list[float], values: list[float], unit: str) -> tuple[list[Rate], list[Change]]:
    """Rate and start of the changes in a piecewise linear table; empty if it is constant.

    The period is the time in which the steepest slope would pass through all values.

    >>> changes("closing", [0.0, 2.0], [0.0, 1e-4], "m")[1]
    [Change(key='closing', begins=0.0)]
    """
    steep = [abs(b - a) / (t - s) for s, t, a, b in zip(time, time[1:], values, values[1:], strict=False)]
    if not steep or not max(steep) > 0.0:
        return [], []
    seconds = (max(values) - min(values)) / max(steep)
    begins = next(s for s, one in zip(time, steep, strict=False) if one > 0.0)
    words = f"a change of {max(values) - min(values):.3g} {unit} within {seconds:.3g} s"
    return [Rate.of_decay(key, 1.0 / seconds, words)], [Change(key=key, begins=begins)]


@runtime_checkable
class Rated(Protocol):
    """Interface of a problem that lists its varying quantities; a problem of your own may implement it."""

    def rates(self) -> tuple[Rate | Change, ...]:
        """Every rate and change."""
