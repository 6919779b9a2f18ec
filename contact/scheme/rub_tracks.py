"""Which tips of a rub wear the same bars, and the arrays that the compiled loop wears."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from contact.errors import InputError
from contact.model.arrays import Array, Indices
from contact.model.law import Abradable
from contact.model.rub import Rub
from contact.model.rub_laws import hermite
from contact.scheme.wear_track import Track, Tracks

if TYPE_CHECKING:
    from contact.solver.abradable_tips import Coats


def track_numbers(rub: Rub) -> list[int]:
    """Track of each tip: the one it names, else its place among the tips of its blade."""
    counts: dict[int, int] = {}
    numbers = []
    for tip in rub.tips:
        place = counts.get(tip.blade, 0)
        counts[tip.blade] = place + 1
        numbers.append(place if tip.track is None else tip.track)
    return numbers


def rub_tracks(rub: Rub, law: Abradable) -> tuple[Tracks, Coats]:
    """The tracks of a rub's tips by ascending number, and what the compiled loop changes of them.

    Raises InputError where tips of one track stand on different rim lines, or nearer to one another than a tip is long.
    """
    numbers, memory = track_numbers(rub), np.zeros((len(rub.tips), 3))
    tracks = [_track(rub, law, numbers, number, memory) for number in sorted(set(numbers))]
    start = np.cumsum([0, *(track.coating.worn.size for track in tracks)])
    worn = np.zeros(start[-1])
    tracks = [
        replace(track, coating=track.coating._replace(worn=worn[a:b]))
        for track, a, b in zip(tracks, start[:-1], start[1:], strict=True)
    ]
    return Tracks(tracks=tuple(tracks)), _coats(tracks, worn, start.astype(np.int64), memory, law)


def _coats(tracks: list[Track], worn: Array, start: Indices, memory: Array, law: Abradable) -> Coats:
    from contact.solver.abradable_tips import Coats

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


def _track(rub: Rub, law: Abradable, numbers: list[int], number: int, memory: Array) -> Track:
    tips = [j for j, own in enumerate(numbers) if own == number]
    line = rub.tips[tips[0]].line
    for j in tips:
        if rub.tips[j].line != line:
            raise InputError(
                f"tips[{j}].track: found track {number} on rim line {rub.tips[j].line}, expected the line {line} of "
                f"tips[{tips[0]}], or another track"
            )
    radius = rub.casing.line_radius(line)
    _require_apart(rub, law, number, tips, radius)
    table = rub.profile.table
    return Track.of(law, radius, lambda phi: rub.profile.smooth(phi) + hermite(table, phi), tips, memory)


def _require_apart(rub: Rub, law: Abradable, number: int, tips: list[int], radius: float) -> None:
    """Two tips that press one bar at once have no law."""
    around = sorted((rub.tips[j].angle_deg % 360.0, j) for j in tips)
    for (low, a), (high, b) in zip(around, [*around[1:], (around[0][0] + 360.0, around[0][1])], strict=True):
        apart = radius * math.radians(high - low)
        if apart < law.tip * (1.0 - 1e-9):
            raise InputError(
                f"tips[{b}].track: found {apart:.3g} m from tips[{a}] on track {number} of both, expected at least the "
                f"tip's length of {law.tip:g} m, or another track"
            )
