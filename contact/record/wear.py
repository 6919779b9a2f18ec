"""Wear of coatings: worn depth by angle, and its history."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from contact.base.arrays import Array, readonly
from contact.io.columns import Column
from contact.io.reported import Reported

WEAR_ARRAYS = ("angle", "made", "cut", "worn", "map_time", "map")
WEAR_NUMBERS = ("volume", "stated", "dissipated", "bare")


COLUMNS = (
    Column("angle_rad", "Angle of the bar in the casing's frame.", lambda wear: wear.angle, head="angle", unit="deg",
           format=".2f", scale=180.0 / np.pi),
    Column("made_m", "Deviation of the rim's radius before machining and wear.",
           lambda wear: wear.made, head="as made", unit="um",
           format=".3g", scale=1e6),
    Column("cut_m", "Depth machined before the run.", lambda wear: wear.cut, head="machined", unit="um", format=".3g",
           scale=1e6),
    Column("worn_m", "Depth worn by the run.", lambda wear: wear.worn, head="worn", unit="um", format=".3g",
           scale=1e6),
)  # fmt: skip


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Wear(Reported):
    """Worn depth of each bar of one track of a coating at the end of a run, and over time.

    `angle` (cells,) of the bars in the casing's frame [rad]; `made` is the deviation of the rim's radius as
    manufactured [m], `cut` the depth machined before the run, `worn` the depth worn by the run. `map` (times, cells):
    worn depth at `map_time` [s]. `volume` worn [m^3]; `dissipated` energy summed over the steps [J], `stated` the
    energy by the law for the same wear; they differ by round-off. `bare`: number of bars worn to the casing; `tips`
    wear this track.
    """

    COLUMNS: ClassVar = COLUMNS

    angle: Array
    made: Array
    cut: Array
    worn: Array
    map_time: Array
    map: Array
    volume: float
    stated: float
    dissipated: float
    bare: int
    tips: tuple[int, ...] = (0,)

    def __post_init__(self) -> None:
        for name in WEAR_ARRAYS:
            object.__setattr__(self, name, readonly(getattr(self, name)))

    @property
    def before(self) -> Array:
        """Deviation of the radius before the run [m], (cells,)."""
        return self.made + self.cut

    @property
    def after(self) -> Array:
        """Deviation of the radius after the run [m], (cells,)."""
        return self.made + self.cut + self.worn

    @property
    def residual(self) -> float:
        """Dissipated energy over the energy of the worn profile, minus 1; 0 without wear."""
        return self.dissipated / self.stated - 1.0 if self.stated else self.dissipated

    def columns(self) -> dict[str, Array]:
        """One row for each bar, as arrays."""
        return {column.name: np.asarray(column.values(self)) for column in self.COLUMNS}

    def to_dict(self) -> dict[str, object]:
        """JSON-ready: contacts, counted from 1, and sums."""
        return {
            "contacts": [j + 1 for j in self.tips], "volume_m3": self.volume, "deepest_m": float(self.worn.max()),
            "dissipated_J": self.dissipated, "stated_J": self.stated, "bare_bars": self.bare, "bars": self.worn.size,
        }  # fmt: skip

    def __repr__(self) -> str:
        return (
            f"worn {1e9 * self.volume:.4g} mm^3, at most {1e6 * float(self.worn.max()):.4g} um, {self.bare} of "
            f"{self.worn.size} bars worn through to the casing; {self.dissipated:.4g} J dissipated, residual "
            f"{self.residual:.1e}"
        )


def joined(tracks: Sequence[Wear]) -> Wear | None:
    """All tracks of a run as one: bars one after the other, volumes and energies summed; None without tracks."""
    if len(tracks) < 2:
        return tracks[0] if tracks else None

    def one(name: str) -> Array:
        return np.concatenate([getattr(track, name) for track in tracks], axis=-1)

    return Wear(
        angle=one("angle"), made=one("made"), cut=one("cut"), worn=one("worn"), map_time=tracks[0].map_time,
        map=one("map"), volume=sum(t.volume for t in tracks), stated=sum(t.stated for t in tracks),
        dissipated=sum(t.dissipated for t in tracks), bare=sum(t.bare for t in tracks),
        tips=tuple(sorted(j for t in tracks for j in t.tips)),
    )  # fmt: skip
