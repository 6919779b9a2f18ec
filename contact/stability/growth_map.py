"""Growth rate over speed, refined at its maximum and at the edges of the unstable bands."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from contact.base.arrays import Array, readonly
from contact.base.errors import InputError
from contact.io.columns import Column
from contact.io.reported import Reported
from contact.stability.together import maxima_between, roots

Growth = Callable[[Array], Array]
EDGE = 0.1  # of the least growth that counts: accuracy of the growth at the end of a band


COLUMNS = (
    Column("speed_hz", "Speed of rotation.", lambda found: found.speed_hz, head="speed", unit="Hz", format=".6g"),
    Column("growth_1_s", "Largest growth rate of the closed contact; a positive rate diverges.",
           lambda found: found.growth, head="growth", unit="1/s", format=".5g"),
)  # fmt: skip


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class StabilityMap(Reported):
    """Growth rate [1/s] over speed [Hz], (speeds,), its refined maximum, and the bands in which it is positive.

    `seen_hz`, `seen_growth`: all examined speeds, which are dense near coincidences, and their growth.

    >>> import contact as ct
    >>> pair = ct.gaps.HandPair(casing=ct.gaps.ModalPair(n=8, freq_hz=300.0, modal_mass=1.5),
    ...                         blade=ct.gaps.ModalPair(freq_hz=120.0, modal_mass=0.4), compliance=1e-4)
    >>> found = ct.stability.of_contact(pair.contact(), np.linspace(52.0, 54.0, 21))
    >>> found.diverges, round(found.peak_speed_hz, 2), round(found.peak_growth, 3)
    (True, 52.84, 3.788)
    """

    COLUMNS: ClassVar = COLUMNS

    speed_hz: Array
    growth: Array
    peak_speed_hz: float
    peak_growth: float
    bands_hz: tuple[tuple[float, float], ...]
    words: str = ""
    seen_hz: Array = field(default_factory=lambda: np.zeros(0))
    seen_growth: Array = field(default_factory=lambda: np.zeros(0))

    @property
    def diverges(self) -> bool:
        """Whether a vibration grows at any speed of the range."""
        return bool(self.bands_hz)

    def to_dict(self) -> dict[str, object]:
        """The document of `casingfem stability --json`."""
        return {
            "speed_hz": self.speed_hz.tolist(), "growth": self.growth.tolist(),
            "peak": {"speed_hz": self.peak_speed_hz, "growth": self.peak_growth},
            "bands_hz": [list(band) for band in self.bands_hz], "words": self.words,
        }  # fmt: skip

    def __repr__(self) -> str:
        lines = [f"largest growth {self.peak_growth:.5g} 1/s at {self.peak_speed_hz:.5g} Hz"]
        lines += [f"diverges from {low:.6g} to {high:.6g} Hz" for low, high in self.bands_hz]
        if not self.bands_hz:
            lines.append(f"no growth from {self.speed_hz[0]:.6g} to {self.speed_hz[-1]:.6g} Hz")
        return "\n".join([*lines, *([self.words] if self.words else [])])


def scan(rate: Growth, speed_hz: Array, *, floor: float, seeds: Array | None = None) -> StabilityMap:
    """Growth over speeds, refined: its maximum by bounded maximisation, the edges of its bands by root finding.

    `rate` gives growth [1/s] at speeds [Hz]; growth below `floor` counts as zero; `seeds` are further speeds to
    examine, so that a band narrower than the grid is found. Raises InputError unless there are two ascending speeds.

    >>> found = scan(lambda hz: 1.0 - (hz - 5.0) ** 2, np.linspace(0.0, 10.0, 8), floor=1e-9)
    >>> round(found.peak_speed_hz, 6), [tuple(round(end, 6) for end in band) for band in found.bands_hz]
    (5.0, [(4.0, 6.0)])
    """
    speed = ascending(speed_hz)
    extra = np.zeros(0) if seeds is None else np.asarray(seeds, dtype=float)
    every = np.union1d(speed, extra[(extra > speed[0]) & (extra < speed[-1])])
    values = rate(every)
    where, peak = _peak(rate, every, values, floor)
    if not np.any(every == where):
        place = int(np.searchsorted(every, where))
        every, values = np.insert(every, place, where), np.insert(values, place, peak)
    return StabilityMap(
        speed_hz=speed, growth=readonly(values[np.isin(every, speed)]), peak_speed_hz=where, peak_growth=peak,
        bands_hz=_bands(rate, every, values, floor), seen_hz=readonly(every), seen_growth=readonly(values),
    )  # fmt: skip


def ascending(speed_hz: Array) -> Array:
    """Speeds as a read-only row; raises InputError unless there are at least two and they ascend."""
    speed = readonly(speed_hz)
    if speed.ndim != 1 or speed.size < 2 or not np.all(np.diff(speed) > 0.0):
        raise InputError("speed_hz: found numbers that do not ascend, expected at least two ascending speeds")
    return speed


def _peak(rate: Growth, speed: Array, values: Array, floor: float) -> tuple[float, float]:
    """Speed and value of the largest growth, refined between the neighbours of the largest sample."""
    k = int(values.argmax())
    best = float(speed[k]), float(values[k])
    if best[1] <= floor:
        return best
    near = np.clip(np.arange(k - 1, k + 2), 0, speed.size - 1)[:, None]
    (found,) = maxima_between(rate, speed[near], values[near])
    return max(best, (float(found), float(rate(np.array([found]))[0])), key=lambda point: point[1])


def _bands(rate: Growth, speed: Array, values: Array, floor: float) -> tuple[tuple[float, float], ...]:
    """Intervals of speed with growth above `floor`; at their ends it is `floor` within a tenth."""
    above = values > floor
    k = np.flatnonzero(above[1:] != above[:-1])
    ends, apart = (speed[k], speed[k + 1]), (values[k] - floor, values[k + 1] - floor)
    edges = roots(lambda at, _: rate(at) - floor, ends, apart, EDGE * floor)
    return between(speed, above, edges.tolist())


def between(speed: Array, above: NDArray[np.bool_], edges: list[float]) -> tuple[tuple[float, float], ...]:
    """The bands between edges where speeds are `above`, cut at the ends of the range."""
    ends = [*([float(speed[0])] if above[0] else []), *edges, *([float(speed[-1])] if above[-1] else [])]
    return tuple(zip(ends[::2], ends[1::2], strict=True))
