"""The coating of a run: tracks of bars and their tips, manufacture, maps of wear over time, results at the end."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from contact.base.arrays import Array, Indices, readonly
from contact.base.errors import InputError
from contact.base.remembered import remembered
from contact.model.gaps.rub import Rub
from contact.model.gaps.rub_laws import RimProfile
from contact.model.law import Abradable
from contact.record.wear import Wear

if TYPE_CHECKING:
    from contact.solver.abradable.tips import Coating, Coats

MOST_MAPS = 400  # stored maps: beyond, every second one is dropped
FIRST_EVERY = 100  # steps between maps at first
MOST_AROUND = 1_000_000  # bars of a track: the maps of more fill the memory


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Track:
    """Bars of a run: the compiled loop changes `coating`.

    `memory` (K, 3) is that of all tips, `tips` those of the track.
    """

    law: Abradable
    coating: Coating
    made: Array
    area: float  # of one bar [m^2]
    tips: tuple[int, ...]
    memory: Array

    @staticmethod
    def of(law: Abradable, radius: float, profile: RimProfile, tips: Sequence[int], memory: Array) -> Track:
        """The machined coating on a rim whose radius deviates by a `profile`.

        Raises InputError if the tip exceeds a quarter of the circumference, or is so short that bars are too many.
        """
        from contact.solver.abradable.tips import Coating

        if law.tip > 0.5 * math.pi * radius:
            raise InputError(
                f"tip: found {law.tip:g} m, expected at most a quarter of the circumference, "
                f"{0.5 * math.pi * radius:.4g} m"
            )
        around = 2.0 * math.pi * radius * law.bars / law.tip
        if around > MOST_AROUND:
            found = f"{law.tip:g} m with {law.bars} bars, which gives {around:.3g} bars around the rim"
            raise InputError(f"tip: found {found}, expected at most {MOST_AROUND}: use a longer tip or fewer bars")
        cells = round(around)
        radial = _around(profile, cells)
        mean = float(radial.mean())
        made, area = radial - mean, law.width * 2.0 * math.pi * radius / cells
        coating = Coating(
            worn=np.zeros(cells), round=float(made.min()) + law.machined if law.machined else -math.inf, mean=mean,
            thickness=law.thickness, stiffness=law.E * area / law.thickness, yield_force=law.yield_stress * area,
            hardening=law.hardening * area / law.thickness, under=law.bars, memory=memory[0],
        )  # fmt: skip
        return Track(law=law, coating=coating, made=made, area=area, tips=tuple(tips), memory=memory)

    def memorised(self, what: int) -> float:
        """Sum over its tips: 0 is dissipated energy, 1 elastic energy now [J]."""
        return float(self.memory[list(self.tips), what].sum())

    def wear(self, times: Array, depths: Array) -> Wear:
        """Wear so far, with intermediate maps: `times` (m,) [s], worn `depths` (m, bars) [m]."""
        worn, law = self.coating.worn, self.law
        cut = np.maximum(self.coating.round - self.made, 0.0)
        return Wear(
            angle=_angles(worn.size), made=self.made, cut=cut, worn=worn, map_time=times, map=depths,
            volume=self.area * float(worn.sum()), dissipated=self.memorised(0),
            stated=self.area * float(np.sum(law.dissipated(worn))),
            bare=int(np.count_nonzero(worn >= law.thickness - cut)), tips=self.tips,
        )  # fmt: skip


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Tracks:
    """All tracks of a run, and maps of their worn depths so far.

    `pace`: number of maps and steps between them; `times` and `depths` of the maps, the tracks one after the other.
    """

    tracks: tuple[Track, ...]
    pace: Indices = field(default_factory=lambda: np.array([0, FIRST_EVERY]))
    times: Array = field(default_factory=lambda: np.zeros(MOST_MAPS + 1))
    depths: Array = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "depths", np.zeros((MOST_MAPS + 1, len(self.worn))))

    @property
    def worn(self) -> Array:
        """Worn depth of each bar of all tracks now [m]."""
        return np.concatenate([track.coating.worn for track in self.tracks])

    @property
    def memory(self) -> tuple[Any, ...]:
        """Arrays that a run changes."""
        return self.pace, self.times, self.depths, *((track.coating.worn, track.memory) for track in self.tracks)

    @property
    def elastic(self) -> float:
        """Elastic energy of the bars under the tips now [J]."""
        return sum(track.memorised(1) for track in self.tracks)

    def watch(self, h: float, first: int, steps: int, loop: Callable[[int, int], int]) -> int:
        """Run the loop and store a map at regular intervals; returns -1, or the step that failed."""
        start, end = first, first + steps
        while start < end:
            every = int(self.pace[1])
            stop = min(end, (start // every + 1) * every)
            failed = loop(start, stop - start)
            if failed >= 0:
                return failed
            start = stop
            if start % every == 0:
                self._keep(start * h)
        return -1 if steps else loop(first, 0)

    def _keep(self, time: float) -> None:
        """Store a map; if there are too many, drop every second one and double the interval."""
        count = int(self.pace[0])
        self.times[count] = time
        np.concatenate([track.coating.worn for track in self.tracks], out=self.depths[count])
        count += 1
        if count > MOST_MAPS:
            half = count // 2
            for kept in range(half):  # in this order, without copies of maps that take megabytes
                self.times[kept], self.depths[kept] = self.times[2 * kept + 1], self.depths[2 * kept + 1]
            count, self.pace[1] = half, 2 * self.pace[1]
        self.pace[0] = count

    def wear(self) -> tuple[Wear, ...]:
        """Wear of each track so far."""
        count, ends = int(self.pace[0]), np.cumsum([track.coating.worn.size for track in self.tracks])
        maps = np.split(self.depths[:count], ends[:-1], axis=1)
        return tuple(track.wear(self.times[:count], part) for track, part in zip(self.tracks, maps, strict=True))


def _around(profile: RimProfile, cells: int) -> Array:
    """Deviation of the radius at each bar [m], (cells,)."""
    theta, depth = (None if part is None else part.tobytes() for part in (profile.theta, profile.depth))
    return _deviation(profile.terms, theta, depth, cells)


@remembered
def _deviation(
    terms: tuple[tuple[int, float, float], ...], theta: bytes | None, depth: bytes | None, cells: int
) -> Array:
    """The same for a profile given by values: copies of it, as worker processes get them, share one result."""
    measured = (None if part is None else np.frombuffer(part) for part in (theta, depth))
    profile = RimProfile(terms, *measured)
    return readonly([profile(float(phi)) for phi in _angles(cells)])


def _angles(cells: int) -> Array:
    """Middle of each bar [rad], (cells,)."""
    return 2.0 * np.pi * (np.arange(cells) + 0.5) / cells


def track_tips(rub: Rub, length: float) -> list[list[int]]:
    """Tips by the track they wear: one track for each rim line and track number.

    Without a track number, the index of the tip among its blade's tips on this line is used.

    Raises InputError if tips of one track are closer than the `length` of a tip [m].
    """
    found: dict[tuple[int, int], list[int]] = {}
    places: Counter[tuple[int, int]] = Counter()
    for j, tip in enumerate(rub.tips):
        place = places[tip.blade, tip.line]
        places[tip.blade, tip.line] += 1
        found.setdefault((tip.line, place if tip.track is None else tip.track), []).append(j)
    for (_, number), tips in found.items():
        _require_apart(rub, number, tips, length)
    return list(found.values())


def rub_tracks(rub: Rub, law: Abradable) -> tuple[Tracks, Coats]:
    """The tracks of a rub's tips, and the arrays that the loop changes.

    Raises the errors of `track_tips` and `Track.of`.
    """
    memory = np.zeros((len(rub.tips), 3))
    tracks = [
        Track.of(law, rub.casing.line_radius(rub.tips[tips[0]].line), rub.profile, tips, memory)
        for tips in track_tips(rub, law.tip)
    ]
    start = np.cumsum([0, *(track.coating.worn.size for track in tracks)])
    worn = np.zeros(start[-1])
    tracks = [
        replace(track, coating=track.coating._replace(worn=worn[a:b]))
        for track, a, b in zip(tracks, start[:-1], start[1:], strict=True)
    ]
    return Tracks(tracks=tuple(tracks)), _coats(tracks, worn, start.astype(np.int64), memory, law)


def _coats(tracks: list[Track], worn: Array, start: Indices, memory: Array, law: Abradable) -> Coats:
    from contact.solver.abradable.tips import Coats

    track = np.zeros(len(memory), dtype=np.int64)
    for k, one in enumerate(tracks):
        track[list(one.tips)] = k

    def of_each(name: str) -> Array:
        return np.array([getattr(one.coating, name) for one in tracks])

    return Coats(
        worn=worn, start=start, track=track, round=of_each("round"), mean=of_each("mean"), thickness=law.thickness,
        stiffness=of_each("stiffness"), yield_force=of_each("yield_force"), hardening=of_each("hardening"),
        under=law.bars, memory=memory, first=np.zeros(len(memory), dtype=np.int64), cut=np.zeros(len(memory)),
    )  # fmt: skip


def _require_apart(rub: Rub, number: int, tips: list[int], length: float) -> None:
    """Refuse two tips that may press one bar at once, for which there is no law."""
    radius = rub.casing.line_radius(rub.tips[tips[0]].line)
    around = sorted((rub.tips[j].angle_deg % 360.0, j) for j in tips)
    for (low, a), (high, b) in zip(around, [*around[1:], (around[0][0] + 360.0, around[0][1])], strict=True):
        apart = radius * math.radians(high - low)
        if apart < length * (1.0 - 1e-9):
            found = f"{apart:.3g} m to tips[{min(a, b)}] on the same track {number}"
            expected = f"at least the tip's length of {length:g} m, or another track"
            raise InputError(f"tips[{max(a, b)}].track: found {found}, expected {expected}")
