"""The orbit at the end of the run of a rotor."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from contact.base.arrays import Array

TURNS = 10  # at the end of a run of which the orbit is the mean


@dataclass(frozen=True, slots=True, kw_only=True)
class Orbit:
    """Averages over the last whole turns of a run, at most ten.

    `radius_end` [m] is the distance from the position at rest, `phase_deg_end` the lag of the synchronous part behind
    the unbalance, 0 to 360; nan without unbalance. `speed_hz_end` is the speed at the end, `turns` the number of
    averaged turns; without a whole turn all averages are nan.
    """

    radius_end: float
    phase_deg_end: float
    speed_hz_end: float
    turns: int

    def to_dict(self) -> dict[str, object]:
        """JSON-ready."""
        return {
            "radius_end": self.radius_end if math.isfinite(self.radius_end) else None,
            "phase_deg_end": self.phase_deg_end if math.isfinite(self.phase_deg_end) else None,
            "speed_hz_end": self.speed_hz_end, "turns": self.turns,
        }  # fmt: skip

    @property
    def words(self) -> str:
        """One line."""
        if not self.turns:
            return f"shorter than one turn; {self.speed_hz_end:.6g} Hz at the end"
        lag = f", {self.phase_deg_end:.3f} degrees behind the unbalance" if math.isfinite(self.phase_deg_end) else ""
        of = f"mean of the last {self.turns} turns" if self.turns > 1 else "mean of the last turn"
        return f"radius {self.radius_end:.6g} m{lag} ({of}); {self.speed_hz_end:.6g} Hz at the end"


def orbit_of_states(time: Array, disk: Array, angle: Array, hz: Array, unbalance: complex) -> Orbit:
    """The orbit from the disk's positions x + i y (ns,), its angle [rad] and speed [Hz] at stored times."""
    if len(time) < 2:
        return Orbit(radius_end=math.nan, phase_deg_end=math.nan, speed_hz_end=math.nan, turns=0)
    turn = np.floor(np.abs(angle) / (2.0 * math.pi)).astype(np.int64)
    rows = np.zeros((TURNS + 1, 5))
    side = np.where(hz >= 0.0, 1.0, -1.0)
    lead = disk.conj() * unbalance * np.exp(1j * angle)
    for k in range(max(0, int(turn[-1]) - TURNS), int(turn[-1]) + 1):
        own = turn == k
        rows[k % (TURNS + 1)] = (
            k, own.sum(), np.abs(disk[own]).sum(), lead[own].real.sum(), (side[own] * lead[own].imag).sum()
        )  # fmt: skip
    return orbit(rows, int(turn[-1]), float(hz[-1]), unbalance != 0.0)


def orbit(turns: Array, now: int, hz: float, unbalanced: bool) -> Orbit:
    """The orbit from sums by turn: rows (number of the turn, samples, sum of radii, cos and sin of the lag).

    `now` is the number of the current turn, which is incomplete and does not count.
    """
    whole = turns[(turns[:, 1] > 0.0) & (turns[:, 0] != now) & (turns[:, 0] >= now - TURNS)]
    if not len(whole):
        return Orbit(radius_end=math.nan, phase_deg_end=math.nan, speed_hz_end=hz, turns=0)
    _, count, radius, cos, sin = whole.sum(axis=0).tolist()
    lag = math.degrees(math.atan2(sin, cos)) % 360.0 if unbalanced else math.nan
    return Orbit(radius_end=radius / count, phase_deg_end=lag, speed_hz_end=hz, turns=len(whole))
