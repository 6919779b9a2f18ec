"""Which tips of a rub wear the same bars, and the arrays that the compiled loop wears."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from contact.base.arrays import Array, Indices
from contact.base.errors import InputError
from contact.model.gaps.rub import Rub
from contact.model.gaps.rub_laws import hermite
from contact.model.law import Abradable
from contact.scheme.modal.wear_track import Track, Tracks

if TYPE_CHECKING:
    from contact.solver.abradable.tips import Coats


def track_tips(rub: Rub, length: float) -> list[list[int]]:
    """Tips by the track they wear: one track for each rim line and number, which a tip names.

    Else its number is its place among its blade's tips on this line.

    Raises InputError where tips of one track stand nearer to one another than the `length` of a tip [m].
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
    """The tracks of a rub's tips, and what the compiled loop changes of them. Raises as `track_tips` and `Track.of`."""
    memory, table = np.zeros((len(rub.tips), 3)), rub.profile.table

    def profile(phi: float) -> float:
        return rub.profile.smooth(phi) + hermite(table, phi)

    tracks = [
        Track.of(law, rub.casing.line_radius(rub.tips[tips[0]].line), profile, tips, memory)
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
    """Two tips that press one bar at once have no law."""
    radius = rub.casing.line_radius(rub.tips[tips[0]].line)
    around = sorted((rub.tips[j].angle_deg % 360.0, j) for j in tips)
    for (low, a), (high, b) in zip(around, [*around[1:], (around[0][0] + 360.0, around[0][1])], strict=True):
        apart = radius * math.radians(high - low)
        if apart < length * (1.0 - 1e-9):
            raise InputError(
                f"tips[{max(a, b)}].track: found {apart:.3g} m to tips[{min(a, b)}] on one track {number}, expected "
                f"at least the tip's length of {length:g} m, or another track"
            )
