"""Speeds at which casing and blade can excite each other: f_c + f_b = n f and its difference forms.

In the frame of a blade that moves past it at f turns per second, a wave of n nodal diameters and frequency f_c has the
frequency |f_c -+ n f|. Sum: f_b = n f - f_c, both grow while they touch, even without friction. Difference: f_b = |f_c
-+ n f|, a resonance, which needs excitation unless friction drives the blade into the casing, mu > tan(lean). For a
bladed disk f_b belongs to n diameters, folded at half the number of blades (Legrand, Pierre, Cartraud, Lombard, J.
Sound Vib. 319, 2009, 366). Contact shifts all these frequencies; `casingfem stability` computes the shift.

If the casing rotates, Coriolis forces and centrifugal stress change f_c. Ring theory (G. F. Carrier, Quart. Appl. Math.
3, 1945, 235) gives sqrt(f_c^2 + a^2 f^2) -+ b f in the casing's frame, b = 2 n/(n^2 + 1), a = n - b, and in the blade's
frame sqrt(f_c^2 + a^2 f^2) +- a f. This is never below 0, so f_c + f_b = n f does not occur.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Literal, TypeAlias

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import FloatArray
from casingfem.modal.campbell import Campbell, zero_crossings
from casingfem.modal.mode_set import ModeSet
from contact.io.reported import Reported

Turning = Literal["casing", "blade"]
Branch = Literal["sum", "backward", "forward"]
BRANCHES: tuple[Branch, ...] = ("sum", "backward", "forward")
SPEEDS = 2001  # at which a turning casing's frequencies are compared with the blade's
CONDITION = {"sum": "f_c + f_b = n f", "backward": "f_b = f_c - n f", "forward": "f_b = f_c + n f"}
RESONANCE = "resonance; flutter if mu > tan(lean)"
EFFECT = {"sum": "flutter, even without friction", "backward": RESONANCE, "forward": RESONANCE}
WAVES = {
    "casing": {"backward": "backward", "forward": "forward"},
    "blade": {"sum": "forward, overtaken", "backward": "forward", "forward": "backward"},
}  # sense of the casing's wave, with the rotation or against it, by what turns


@dataclass(frozen=True, slots=True, kw_only=True)
class DiskFrequencies:
    """A disk of equal blades: frequencies [Hz] by nodal diameters 0 .. blades/2.

    >>> DiskFrequencies(blades=22, freq={3: (110.0,), 5: (120.0,)}).of(19)
    (110.0,)
    """

    blades: int
    freq: Mapping[int, Sequence[float]]

    def __post_init__(self) -> None:
        wrong = [k for k in self.freq if not 0 <= k <= self.blades // 2]
        if self.blades < 1 or wrong:
            found = f"{self.blades} blades and nodal diameters {wrong or 'none'}"
            raise ModelError("interaction-blade", f"interactions: found {found} beyond half the blades")

    def folded(self, n: int) -> int:
        """Nodal diameters of the disk that n diameters of the casing excite: n, folded at half the number of blades."""
        return min(n % self.blades, -n % self.blades)

    def of(self, n: int) -> tuple[float, ...]:
        """Frequencies [Hz] with which n diameters of the casing can coincide."""
        return tuple(self.freq.get(self.folded(n), ()))


Blade: TypeAlias = Sequence[float] | FloatArray | Campbell | DiskFrequencies


@dataclass(frozen=True, slots=True, kw_only=True)
class Meeting:
    """One coincidence: casing pair of n diameters and rank m; blade mode; speed; condition; wave."""

    n: int
    m: int
    blade: int
    branch: Branch
    wave: str
    speed_hz: float
    casing_hz: float
    blade_hz: float

    @property
    def effect(self) -> str:
        """Effect of contact at this coincidence."""
        return EFFECT[self.branch]


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Interactions(Reported):
    """Coincidences by speed; `pairs` (n, m, f_c) are those examined, `speed_hz` the range.

    >>> found = Interactions(meetings=(), pairs=((8, 1, 367.9),), speed_hz=(0.0, 60.0), turning="blade")
    >>> found.records(), found.speed_hz
    ([], (0.0, 60.0))
    """

    meetings: tuple[Meeting, ...]
    pairs: tuple[tuple[int, int, float], ...]
    speed_hz: tuple[float, float]
    turning: Turning

    def of(self, branch: Branch) -> tuple[Meeting, ...]:
        """Coincidences of one condition."""
        return tuple(meeting for meeting in self.meetings if meeting.branch == branch)

    def records(self) -> list[dict[str, object]]:
        """One plain dictionary for each coincidence."""
        return [asdict(c) | {"condition": CONDITION[c.branch], "effect": c.effect} for c in self.meetings]

    def __repr__(self) -> str:
        """Table by speed, and combinations that do not occur in the range."""
        head = f"{'speed [Hz]':>10} {'n':>3} {'m':>2} {'f_c [Hz]':>9} {'blade':>5} {'f_b [Hz]':>9}  "
        lines = [head + f"{'condition':<16} {'wave of the casing':<24} while they touch"]
        lines += [
            f"{c.speed_hz:>10.3f} {c.n:>3} {c.m:>2} {c.casing_hz:>9.2f} {c.blade:>5} {c.blade_hz:>9.2f}  "
            f"{CONDITION[c.branch]:<16} {c.wave:<24} {c.effect}"
            for c in self.meetings
        ]
        low, high = self.speed_hz
        if self.turning == "casing":
            lines.append(
                "f_c by ring theory. Blades overtake no wave of a rotating casing: f_c + f_b = n f is not possible"
            )
        lines.append(f"{len(self.meetings)} coincidences from {low:g} to {high:g} Hz, the {self.turning} turns")
        if self.turning == "blade" and self.pairs and all(n * high < freq for n, _, freq in self.pairs):
            n, _, freq = max(self.pairs, key=lambda pair: pair[0] * high / pair[2])
            below = f"n f = {n * high:.4g} Hz < f_c = {freq:.4g} Hz"
            lines.append(f"{below}, and likewise for every n of the table: f_c + f_b = n f is not possible")
        return "\n".join(lines)


def interactions(
    casing: ModeSet | Mapping[int, Sequence[float]],
    blade: Blade,
    *,
    speed_hz: tuple[float, float],
    turning: Turning = "blade",
) -> Interactions:
    """Every speed in a range at which a casing's pair coincides with a blade: f_b = |f_c -+ n f|, or f_c + f_b = n f.

    Parameters
    ----------
    casing
        Modes of a casing (with the mean frequency of each doublet), or frequencies [Hz] by nodal diameters.
    blade
        Frequencies [Hz] of one blade, which can coincide with every n; or over speed, from `campbell`; or a bladed
        disk, whose n diameters coincide only with those of the casing.
    speed_hz
        First and last speed f [Hz], 0 <= first < last; with a `Campbell` limited to its speeds.
    turning
        The rotating side: "blade" or "casing". A rotating casing has the frequencies of ring theory, from those at
        rest; `contact.stability.interactions` uses the matrices of its reduced basis.

    Raises
    ------
    ModelError
        `interaction-speed` for an invalid range, `interaction-blade` for frequencies that are not positive,
        `interaction-casing` for a casing without nodal diameters.

    Examples
    --------
    >>> found = interactions({8: [300.0]}, [120.0], speed_hz=(0.0, 100.0))
    >>> [(c.branch, c.speed_hz) for c in found.meetings]
    [('backward', 22.5), ('sum', 52.5)]
    """
    low, high = (float(value) for value in speed_hz)
    if not 0.0 <= low < high < np.inf:
        raise ModelError("interaction-speed", f"interactions: found speeds from {low:g} to {high:g} Hz")
    if turning not in WAVES:
        raise ModelError("interaction-speed", f"interactions: found turning = {turning!r}")
    pairs = casing_pairs(casing)
    met = [meeting for pair in pairs for meeting in _meetings(pair, blade, low, high, turning)]
    met.sort(key=lambda c: (c.speed_hz, c.n, c.blade))
    return Interactions(meetings=tuple(met), pairs=pairs, speed_hz=(low, high), turning=turning)


def casing_pairs(casing: ModeSet | Mapping[int, Sequence[float]]) -> tuple[tuple[int, int, float], ...]:
    """(n, m, f_c [Hz]) of every pair with n >= 1: the mean, or that of a mode without partner."""
    if isinstance(casing, ModeSet):
        upper = {high: low for low, high in casing.doublets}
        partner = {low: high for high, low in upper.items()}
        labels = list(zip(casing.nodal_diameters.tolist(), casing.meridional.tolist(), strict=True))
        found = [
            (n, m, float(casing.freq[[k, partner.get(k, k)]].mean()))
            for k, (n, m) in enumerate(labels)
            if k >= casing.rigid and n >= 1 and k not in upper
        ]
    else:
        found = [(n, m + 1, float(f)) for n, freq in casing.items() if n >= 1 for m, f in enumerate(sorted(freq))]
    if not found or min(freq for _, _, freq in found) <= 0.0:
        expected = "expected frequencies above 0 Hz for at least one mode of n = 1 or more nodal diameters"
        raise ModelError("interaction-casing", f"interactions: found {len(found)} such modes of the casing, {expected}")
    return tuple(found)


def blade_over_speed(blade: Blade, n: int, low: float, high: float) -> tuple[FloatArray, FloatArray]:
    """Speeds [Hz] (k,) and the blade's frequencies at them [Hz] (k, modes), for a casing pair of n diameters."""
    if isinstance(blade, Campbell):
        inside = (blade.speed_hz > low) & (blade.speed_hz < high)
        ends = np.clip([low, high], blade.speed_hz[0], blade.speed_hz[-1])
        speed = np.unique(np.concatenate([ends[:1], blade.speed_hz[inside], ends[1:]]))
        freq = np.array([np.interp(speed, blade.speed_hz, column) for column in blade.freq.T]).T
    else:
        speed = np.array([low, high])
        freq = np.tile(np.asarray(blade.of(n) if isinstance(blade, DiskFrequencies) else blade, dtype=float), (2, 1))
    if not np.all(np.isfinite(freq)) or freq.min(initial=1.0) <= 0.0:
        raise ModelError("interaction-blade", f"interactions: found blade frequencies {freq[0]}")
    return speed, freq


def wave_hz(n: int, still_hz: float, speed_hz: FloatArray, turning: Turning, sense: int) -> FloatArray:
    """Frequency [Hz] in the casing's frame of a wave with (1) or against (-1) the casing's rotation, by speed [Hz].

    `still_hz` is that of the pair at rest, which does not change if the blades rotate.

    >>> wave_hz(10, 422.0, np.array([0.0, 5.0]), "casing", -1).round(2).tolist()
    [422.0, 425.83]
    """
    if turning == "blade":
        return np.full(speed_hz.shape, still_hz)
    b = 2.0 * n / (n * n + 1.0)
    return np.asarray(np.hypot(still_hz, (n - b) * speed_hz) - sense * b * speed_hz)


def _meetings(
    pair: tuple[int, int, float], blade: Blade, low: float, high: float, turning: Turning
) -> Iterator[Meeting]:
    """Coincidences of one casing pair: zeros of n f - (f_c + f_b), n f - (f_c - f_b) and n f - (f_b - f_c)."""
    n, m, still = pair
    speed, f_b = blade_over_speed(blade, n, low, high)
    if turning == "casing":
        every = np.union1d(speed, np.linspace(speed[0], speed[-1], SPEEDS))
        columns = [np.interp(every, speed, column) for column in f_b.T]
        speed, f_b = every, np.array(columns).reshape(-1, every.size).T
    for branch, (sign_c, sign_b) in zip(BRANCHES, ((1, 1), (1, -1), (-1, 1)), strict=True):
        if branch not in WAVES[turning]:
            continue
        f_c = wave_hz(n, still, speed, turning, 1 if branch == "forward" else -1)
        gap = n * speed[:, None] - sign_c * f_c[:, None] - sign_b * f_b
        for mode, at in zero_crossings(speed, gap):
            yield Meeting(
                n=n, m=m, blade=mode + 1, branch=branch, wave=WAVES[turning][branch], speed_hz=at,
                casing_hz=float(np.interp(at, speed, f_c)), blade_hz=float(np.interp(at, speed, f_b[:, mode])),
            )  # fmt: skip
