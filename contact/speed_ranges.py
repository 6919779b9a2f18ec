"""Ranges of dangerous speeds: one for each motion, from the runs at single speeds and the peaks of closed contact."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import groupby, pairwise

from contact.speed_verdict import SpeedRun, Verdict
from contact.stability.peaks import Peak

VERDICTS: tuple[Verdict, ...] = ("unstable", "not decided", "resonance", "safe")  # the worst first


@dataclass(frozen=True, slots=True, kw_only=True)
class DangerousSpeed:
    """One row of the table: a range of speeds [turns/s], the motion that grows there, and the run at speed `at` in it.

    `peak` is the peak of the growth of closed contact that proposed the speed, None where the runs alone show it.
    """

    from_hz: float
    to_hz: float
    at: SpeedRun
    peak: Peak | None

    @property
    def n(self) -> int | None:
        """Nodal diameters of the motion: from the run that decided, else from the pole of closed contact."""
        return self.at.n if self.peak is None or self.at.verdict != "safe" else self.peak.n

    @property
    def mode(self) -> int | None:
        """Number of the blade's mode that moves, for a motion mostly of blades without nodal diameters of their own."""
        return self.at.mode if self.peak is None or self.at.verdict != "safe" else self.peak.mode

    @property
    def mover(self) -> str:
        """The body, with the mode of a blade."""
        return f"blade mode {self.mode}" if self.body == "blades" and self.mode is not None else self.body

    @property
    def wave(self) -> str:
        """Travel of the wave around the casing; from the pole if the states of the run do not show it."""
        peak, run = self.peak, self.at
        if peak is None or (run.verdict != "safe" and (run.wave or run.n != peak.n)):
            return run.wave
        return peak.wave

    @property
    def body(self) -> str:
        """The body with the largest share of the energy."""
        if self.peak is None or self.at.verdict != "safe" or self.at.body == "rotor":
            return self.at.body
        return "casing" if self.peak.casing_share > 0.5 else "blades"


def by_poles(peak: Peak) -> DangerousSpeed:
    """A row for contact that is always closed."""
    none = math.nan
    body = "casing" if peak.casing_share > 0.5 else "blades"
    at = SpeedRun(
        speed_hz=peak.speed_hz, verdict="unstable", closed=peak.growth, growth=none, low=none, high=none,
        amplitude_m=none, half_wall_s=none, n=peak.n, wave=peak.wave, body=body,
    )  # fmt: skip
    return DangerousSpeed(from_hz=peak.from_hz, to_hz=peak.to_hz, at=at, peak=peak)


def ranges(runs: Sequence[SpeedRun], proposed: Sequence[Peak]) -> list[DangerousSpeed]:
    """Rows of the intervals of one verdict: one for each peak; without peaks one row, unless it is safe.

    A slow growth has its own interval.
    """
    by_speed = {peak.speed_hz: peak for peak in proposed}
    speed = [run.speed_hz for run in runs]
    found: list[DangerousSpeed] = []
    first = 0
    for (verdict, _), part in groupby(runs, key=lambda run: (run.verdict, run.slow)):
        stretch = list(part)
        last = first + len(stretch) - 1
        low = speed[0] if first == 0 else 0.5 * (speed[first - 1] + speed[first])
        high = speed[-1] if last == len(runs) - 1 else 0.5 * (speed[last] + speed[last + 1])
        inside = [(run, by_speed[run.speed_hz]) for run in stretch if run.speed_hz in by_speed]
        if inside:
            found += _merged(_of_peaks(stretch, inside, low, high))
        elif verdict != "safe":
            found.append(DangerousSpeed(from_hz=low, to_hz=high, at=_worst(stretch), peak=None))
        first = last + 1
    return found


def _of_peaks(
    stretch: Sequence[SpeedRun], inside: Sequence[tuple[SpeedRun, Peak]], low: float, high: float
) -> list[DangerousSpeed]:
    """One row for each peak in the interval from `low` to `high`.

    In a safe interval each row has the speeds at which closed contact grows. Elsewhere the rows divide the whole
    interval. It ends where closed contact stops growing, if that is between two runs. Each row has the worst run of its
    speeds.
    """
    found = [peak for _, peak in inside]
    if stretch[0].verdict == "safe":
        return [
            DangerousSpeed(from_hz=max(peak.from_hz, low), to_hz=min(peak.to_hz, high), at=run, peak=peak)
            for run, peak in inside
        ]
    begin = found[0].from_hz if low < found[0].from_hz <= stretch[0].speed_hz else low
    end = found[-1].to_hz if stretch[-1].speed_hz <= found[-1].to_hz < high else high
    rows = []
    for peak, (start, stop) in zip(found, pairwise([begin, *(peak.to_hz for peak in found[:-1]), end]), strict=True):
        own = [run for run in stretch if start <= run.speed_hz <= stop]
        rows.append(DangerousSpeed(from_hz=start, to_hz=stop, at=_worst(own), peak=peak))
    return rows


def _merged(rows: Sequence[DangerousSpeed]) -> list[DangerousSpeed]:
    """Join neighbouring rows with the same motion into one, with the worst run."""
    found: list[DangerousSpeed] = []
    for row in rows:
        last = found[-1] if found else None
        if last is not None and row.n is not None and (last.n, last.wave, last.body) == (row.n, row.wave, row.body):
            worst = last if _worst([last.at, row.at]) is last.at else row
            found[-1] = replace(worst, from_hz=last.from_hz, to_hz=row.to_hz)
        else:
            found.append(row)
    return found


def _worst(runs: Sequence[SpeedRun]) -> SpeedRun:
    """The worst of some runs with the same verdict; a growth without a known rate only if there is no other."""
    return max(runs, key=lambda run: (run.verdict != "unstable" or math.isfinite(run.growth), _badness(run)))


def _badness(run: SpeedRun) -> float:
    """Rank of a run among those with the same verdict, the worst highest."""
    if run.slow:
        return run.closed
    if run.verdict == "unstable":
        return run.growth if math.isfinite(run.growth) else math.inf
    return run.amplitude_m if run.verdict == "resonance" else run.closed


def ranked(rows: Sequence[DangerousSpeed]) -> tuple[DangerousSpeed, ...]:
    """Rows with the worst verdict first, and in it the worst run first, slow growth last."""

    def rank(row: DangerousSpeed) -> tuple[int, bool, float, float]:
        return VERDICTS.index(row.at.verdict), row.at.slow, -_badness(row.at), -row.at.closed

    return tuple(sorted(rows, key=rank))
