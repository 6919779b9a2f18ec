"""One table of dangerous speeds: closed contact proposes them, runs of the scene decide.

The growth of closed contact (`contact.growth.peaks`) says at which speeds contact can feed a motion, and which motion.
Clearance, out-of-roundness and impacts decide whether it does: the scene is run at each peak, and at speeds evenly over
the range, where contact that opens may feed a motion that closed contact does not. The growth of each run
(`contact.growth.of_run`) is its verdict. A run that grows where closed contact does not is repeated with half the step.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import singledispatch
from itertools import groupby, pairwise
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike

from contact.base.arrays import Array
from contact.base.errors import InputError, NumericsError
from contact.growth.peaks import Peak, Peaks, growth_at, peaks
from contact.io.columns import Column, table_lines
from contact.io.progress import tell
from contact.io.reported import Reported
from contact.model.gaps.gap import RotatingRim
from contact.model.gaps.permanent import HandPair
from contact.model.gaps.rub import Rub, rub_of
from contact.model.gaps.rub_laws import Speed
from contact.model.law import Unilateral
from contact.record.growth import STANDS, RunGrowth
from contact.record.record import Record, prime_stride
from contact.run import Scene, run
from contact.run_many import Outcome, run_many

Verdict = Literal["unstable", "not decided", "resonance", "safe"]
VERDICTS: tuple[Verdict, ...] = ("unstable", "not decided", "resonance", "safe")  # the worst first
RUNS = 60  # speeds evenly over the range
STATES = 512  # stored of a run
LONGER = 4.0  # times t_end, for runs that are too short to decide
RESONANT = 3.0  # times the median amplitude of the runs that do not grow
TURN = 0.299  # radians of the highest harmonic in a step, below the scheme's limit of 0.3
LINE = 100  # characters of a printed line
SHORT = "the run is too short for its growth: lengthen t_end"
NUMERICAL = "the growth is numerical: reduce dt"


@dataclass(frozen=True, slots=True, kw_only=True)
class SpeedRun:
    """The scene at one constant speed: `speed_hz` [turns/s], its verdict, and the motion.

    `closed` growth of closed contact [1/s]; `growth` of the run with its interval of 95 %, nan where it has none;
    `amplitude_m` the largest deflection of the rim, `half_wall_s` the time at which it reaches half the wall; `n` None
    where nothing moves or blades have no nodal diameters. `seconds` is the length of the run, `why` the reason where it
    does not decide.
    """

    speed_hz: float
    verdict: Verdict
    closed: float
    growth: float
    low: float
    high: float
    amplitude_m: float
    half_wall_s: float
    n: int | None
    wave: str
    body: str
    seconds: float = 0.0
    why: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class DangerousSpeed:
    """One row of the table: a range of speeds [turns/s], what grows there, and the run at `at` in it.

    `peak` is the peak of the growth of closed contact that proposed the speed, None where the runs alone show it.
    """

    from_hz: float
    to_hz: float
    at: SpeedRun
    peak: Peak | None

    @property
    def n(self) -> int | None:
        """Nodal diameters of the motion: of the run where it decided, else of the closed contact's pole."""
        return self.at.n if self.peak is None or self.at.verdict != "safe" else self.peak.n

    @property
    def wave(self) -> str:
        """How it travels around the casing; by the pole where the states of the run do not show it."""
        peak, run = self.peak, self.at
        if peak is None or (run.verdict != "safe" and (run.wave or run.n != peak.n)):
            return run.wave
        return peak.wave

    @property
    def body(self) -> str:
        """The body that has most of the energy."""
        if self.peak is None or self.at.verdict != "safe":
            return self.at.body
        return "casing" if self.peak.casing_share > 0.5 else "blades"


def _rows(found: Any, value: str) -> list[Any]:
    return [getattr(row, value) for row in found.rows]


def _runs(found: Any, value: str) -> list[Any]:
    return [getattr(row.at, value) for row in found.rows]


def _rpm(found: Any) -> list[str]:
    return [f"{60.0 * row.from_hz:.0f}-{60.0 * row.to_hz:.0f}" for row in found.rows]


COLUMNS = (
    Column("from_hz", "First speed of the range.", lambda found: _rows(found, "from_hz"), head="from", unit="Hz",
           format=".3f"),
    Column("to_hz", "Last speed of the range.", lambda found: _rows(found, "to_hz"), head="to", unit="Hz",
           format=".3f"),
    Column("range_rpm", "The same range in turns a minute.", _rpm, head="range", unit="rpm", format=str),
    Column("at_hz", "Speed of the run, and of the growth of closed contact.",
           lambda found: _runs(found, "speed_hz"), head="at", unit="Hz", format=".4f", where="files"),
    Column("n", "Nodal diameters of the motion.", lambda found: _rows(found, "n"), format="d"),
    Column("pole_n", "Nodal diameters that grow by the pole of closed contact.",
           lambda found: [None if row.peak is None else row.peak.n for row in found.rows], head="n of the pole",
           format="d", where="pages"),
    Column("wave", "Travels around the casing with the blades' direction, against it, or stands.",
           lambda found: _rows(found, "wave"), format=str),
    Column("body", "Body that has most of the energy of the motion.", lambda found: _rows(found, "body"), format=str),
    Column("closed_1_s", "Growth of a contact that stays closed, by its poles.",
           lambda found: _runs(found, "closed"), head="pole", unit="1/s", format=".3g"),
    Column("growth_1_s", "Growth of the run.", lambda found: _runs(found, "growth"), head="run", unit="1/s",
           format=".3g"),
    Column("growth_low_1_s", "Lower end of the 95 % interval of the growth of the run.",
           lambda found: _runs(found, "low"), where="files"),
    Column("growth_high_1_s", "Upper end of the 95 % interval of the growth of the run.",
           lambda found: _runs(found, "high"), where="files"),
    Column("amplitude_m", "Largest deflection of the rim at the end of the run.",
           lambda found: _runs(found, "amplitude_m"), head="rim", unit="mm", format=".3g", scale=1e3),
    Column("half_wall_s", "Time at which the rim deflects by half its wall, from the start of the run.",
           lambda found: _runs(found, "half_wall_s"), where="files"),
    Column("verdict", "Safe, resonance, unstable or not decided.", lambda found: _runs(found, "verdict"), format=str),
    Column("seconds", "Length of the run.", lambda found: _runs(found, "seconds"), where="files"),
    Column("why", "Reason of a run that does not decide.", lambda found: _runs(found, "why"), where="files"),
)  # fmt: skip


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Interactions(Reported):
    """The table of dangerous speeds, the worst first; `runs` at all speeds, `peaks` of the growth of closed contact.

    A row is a range of speeds of one verdict and one motion. Speeds of the range that no row has are safe: nothing
    grows there, neither by closed contact nor in the runs.
    """

    COLUMNS: ClassVar = COLUMNS

    rows: tuple[DangerousSpeed, ...]
    runs: tuple[SpeedRun, ...]
    peaks: Peaks

    def of(self, verdict: Verdict) -> tuple[DangerousSpeed, ...]:
        """Rows of one verdict."""
        return tuple(row for row in self.rows if row.at.verdict == verdict)

    @property
    def words(self) -> str:
        """What was run, and what follows, in sentences."""
        low, high = (float(hz) for hz in self.peaks.map.speed_hz[[0, -1]])
        span = f"{low:.4g} to {high:.4g} Hz ({60.0 * low:.0f} to {60.0 * high:.0f} rpm)"
        pairs = "Pairs of the casing are split: the poles are those of their mean." if self.peaks.averaged else ""
        if not self.runs:
            grows = "Closed contact grows in the ranges above." if self.rows else "Nothing grows."
            return f"{grows} The range is {span}. The contact of a pair is closed by definition: its poles decide."
        count = {verdict: sum(run.verdict == verdict for run in self.runs) for verdict in VERDICTS}
        ended = ", ".join(f"{number} {verdict}" for verdict, number in count.items() if number)
        words = [f"{len(self.runs)} runs of the scene at constant speeds from {span}: {ended}."]
        if count["safe"] == len(self.runs):
            words.append("Every speed is safe.")
        elif count["safe"]:
            words.append("Speeds that no row has are safe.")
        open_ = [run for run in self.runs if run.why]
        words += [f"The first run that does not decide, at {run.speed_hz:.4g} Hz: {run.why}." for run in open_[:1]]
        return " ".join(filter(None, [*words, pairs]))

    def __repr__(self) -> str:
        table = table_lines(COLUMNS, self.records(), width=LINE) if self.rows else []
        return "\n".join([*table, self.words])

    def to_dict(self) -> dict[str, object]:
        """The document of `casingfem interactions --json`."""
        from contact.io.outfiles import finite

        names = tuple(SpeedRun.__dataclass_fields__)
        return {
            "interactions": [finite(row) for row in self.records()],
            "runs": [finite({name: getattr(run, name) for name in names}) for run in self.runs],
            "closed_contact": self.peaks.map.to_dict() | {"peaks": self.peaks.records()},
            "words": self.words,
        }  # fmt: skip


def interactions(
    scene: Scene | HandPair, speed_hz: ArrayLike, *, runs: int = RUNS, closed: RotatingRim | Rub | None = None
) -> Interactions:
    """Find the dangerous speeds of a scene within a range.

    Parameters
    ----------
    scene
        A scene whose `what` is a RotatingRim or a Rub, with `t_end`; or a pair by hand, of which nothing is run.
    speed_hz
        Speeds [turns/s] at which the growth of closed contact is computed, ascending from above 0.
    runs
        Number of runs evenly over the range, at least 2, beside one at each peak.
    closed
        The same bodies with the springs of a law at the tips (`ct.growth.on_springs`); the scene's if left out.

    Raises
    ------
    InputError
        For speeds that do not ascend from above 0, a scene of another kind, without `t_end`, or fewer runs.

    Examples
    --------
    >>> from contact.model.gaps.permanent import ModalPair
    >>> pair = HandPair(casing=ModalPair(n=8, freq_hz=300.0, modal_mass=1.5),
    ...                 blade=ModalPair(freq_hz=120.0, modal_mass=0.4), compliance=1e-4)
    >>> (row,) = interactions(pair, np.linspace(20.0, 60.0, 41)).rows
    >>> row.at.verdict, row.n, row.wave, round(row.from_hz, 2), round(row.to_hz, 2)
    ('unstable', 8, 'with', 52.69, 52.99)
    """
    if isinstance(scene, HandPair):
        proposed = peaks(scene, speed_hz)
        return Interactions(rows=_ranked([_by_poles(peak) for peak in proposed.rows]), runs=(), peaks=proposed)
    what = _turning(scene, runs)
    mu = (scene.law or Unilateral()).mu
    proposed = peaks(closed or what, speed_hz, mu=mu)
    low, high = (float(hz) for hz in proposed.map.speed_hz[[0, -1]])
    at = np.unique([*np.linspace(low, high, runs), *(peak.speed_hz for peak in proposed.rows)])
    poles = growth_at(closed or what, at, mu=mu)
    taken = _decided(_checked(scene, _longer(scene, _ran(scene, at, poles))))
    return Interactions(rows=_ranked(_table(taken, proposed.rows)), runs=taken, peaks=proposed)


def _turning(scene: Scene, runs: int) -> RotatingRim | Rub:
    what = scene.what
    if not isinstance(what, RotatingRim | Rub):
        raise InputError(f"scene: found {type(what).__name__}, expected a scene with a RotatingRim or a Rub")
    if scene.t_end is None:
        raise InputError("t_end: found none, expected the end of the runs in seconds")
    if runs < 2:
        raise InputError(f"runs: found {runs}, expected at least 2: one at each end of the range")
    return what


def _by_poles(peak: Peak) -> DangerousSpeed:
    """A row of a contact that is closed by definition."""
    none = math.nan
    body = "casing" if peak.casing_share > 0.5 else "blades"
    at = SpeedRun(
        speed_hz=peak.speed_hz, verdict="unstable", closed=peak.growth, growth=none, low=none, high=none,
        amplitude_m=none, half_wall_s=none, n=peak.n, wave=peak.wave, body=body,
    )  # fmt: skip
    return DangerousSpeed(from_hz=peak.from_hz, to_hz=peak.to_hz, at=at, peak=peak)


def _ran(scene: Scene, speed_hz: Array, poles: Array) -> list[SpeedRun]:
    """The scene at each speed; every motion that does not grow is a resonance until all are known."""
    scenes = [at_speed(scene, hz) for hz in speed_hz.tolist()]
    ended = 0

    def note(_: int, __: Outcome) -> None:
        nonlocal ended
        ended += 1
        tell(f"run {ended} of {len(scenes)}", ended / len(scenes))

    outcomes = run_many(scenes, record=_record, ended=note)
    return [
        _speed_run(outcome, hz, pole)
        for outcome, hz, pole in zip(outcomes, speed_hz.tolist(), poles.tolist(), strict=True)
    ]


def _longer(scene: Scene, runs: Sequence[SpeedRun]) -> list[SpeedRun]:
    """Runs of which those that are too short were repeated, `LONGER` times as long."""
    short = [run for run in runs if run.why == SHORT]
    if not short or scene.t_end is None:
        return list(runs)
    speed, poles = (np.array([getattr(run, name) for run in short]) for name in ("speed_hz", "closed"))
    again = _ran(replace(scene, t_end=LONGER * scene.t_end), speed, poles)
    better = {run.speed_hz: run for run in again if run.seconds > 0.0}
    return [better.get(run.speed_hz, run) for run in runs]


def _checked(scene: Scene, runs: Sequence[SpeedRun]) -> list[SpeedRun]:
    """Runs of which those that grow where closed contact does not were repeated, with half the step at their end."""
    return [
        _speed_run(_alone(at_speed(scene, run.speed_hz), run.seconds), run.speed_hz, run.closed)
        if run.verdict == "unstable" and not run.closed > 0.0 else run
        for run in runs
    ]  # fmt: skip


def _alone(scene: Scene, seconds: float) -> Outcome:
    """One run of at least these seconds, its growth checked at half the step."""
    try:
        return run(scene, t_end=max(seconds, scene.t_end or 0.0))
    except (InputError, NumericsError) as error:
        return error


def _record(steps: int) -> Record:
    """States of a run, in step with no turn and no mode."""
    stride = prime_stride(steps, STATES)
    return Record(every=stride, state_every=stride)


def at_speed(scene: Scene, speed_hz: float) -> Scene:
    """The same scene at one constant speed [turns/s], with a smaller step where the scene's is too long for it.

    >>> from contact.model.gaps.bladed_disk import BladedDisk, pair_rim
    >>> from contact.model.gaps.permanent import ModalPair
    >>> disk = BladedDisk(blades=9, freq_hz=115.0, modal_mass=0.1, compliance=5e-5)
    >>> rim = pair_rim(ModalPair(n=3, freq_hz=290.0, modal_mass=2.0), radius=0.5)
    >>> scene = Scene(what=Rub(rim, (disk.body(),), disk.tips(), clearance=1e-4), t_end=1.0, dt=1e-3)
    >>> fast = at_speed(scene, 100.0)
    >>> fast.what.speed.hz.tolist(), round(fast.dt * 3 * 2 * np.pi * 100.0, 3)
    ([100.0], 0.299)
    """
    rub = rub_of(scene.what)
    highest = max([rub.casing.n_max, *(p for p, _, _ in rub.profile.terms)])
    dt = scene.dt
    if dt is not None and highest:
        dt = min(dt, TURN / (2.0 * math.pi * highest * speed_hz))
    return replace(scene, what=_turned(scene.what, speed_hz), dt=dt, record=None)


@singledispatch
def _turned(what: object, speed_hz: float) -> Any:
    """A rim or a rub at another, constant speed."""
    raise InputError(f"scene: found {type(what).__name__}, expected a RotatingRim or a Rub")


@_turned.register
def _(what: RotatingRim, speed_hz: float) -> RotatingRim:
    return replace(what, speed_hz=speed_hz)


@_turned.register
def _(what: Rub, speed_hz: float) -> Rub:
    return replace(what, speed=Speed.constant(speed_hz))


def _speed_run(outcome: Outcome, speed_hz: float, pole: float) -> SpeedRun:
    """The verdict of one run."""
    none = math.nan
    run = SpeedRun(
        speed_hz=speed_hz, verdict="not decided", closed=pole, growth=none, low=none, high=none, amplitude_m=none,
        half_wall_s=none, n=None, wave="", body="",
    )  # fmt: skip
    if isinstance(outcome, InputError):
        return replace(run, why=f"the scene is refused: {outcome}")
    result = outcome.result if isinstance(outcome, NumericsError) else outcome
    if result is None:
        return replace(run, why=f"the numerics failed: {outcome}")
    run = replace(run, seconds=result.steps * result.dt)
    growth = result.growth
    if growth is not None:
        run = replace(
            run, growth=growth.rate, low=growth.low, high=growth.high, amplitude_m=growth.amplitude,
            half_wall_s=growth.time_to_half_wall, n=growth.nodal_diameters, body=growth.body,
            wave="" if growth.cause is None else _wave(growth.cause.travel),
        )  # fmt: skip
    passed = result.divergence is not None and result.divergence.limit in ("wall", "radius")
    if isinstance(outcome, NumericsError) and not passed:
        return replace(run, why=f"the numerics failed: {outcome}")
    verdict, why = _of_growth(growth, passed=passed)
    return replace(run, verdict=verdict, why=why)


def _wave(travel: float) -> str:
    if not math.isfinite(travel):
        return ""
    return "standing" if abs(travel) < STANDS else "with" if travel > 0.0 else "against"


def _of_growth(growth: RunGrowth | None, *, passed: bool) -> tuple[Verdict, str]:
    """Verdict of a run, and why it has none; `passed` whether the rim moved beyond half its wall."""
    if growth is not None and growth.converged is False:
        return "not decided", NUMERICAL
    if passed or (growth is not None and growth.state == "grows"):
        return "unstable", ""
    if growth is None or growth.state == "undecided":
        return "not decided", SHORT
    return ("safe" if growth.state == "at rest" else "resonance"), ""


def _decided(runs: Sequence[SpeedRun]) -> tuple[SpeedRun, ...]:
    """Runs whose motion does not grow: a resonance beyond `RESONANT` times the median amplitude, else safe."""
    calm = [run.amplitude_m for run in runs if run.verdict in ("resonance", "safe")]
    limit = RESONANT * float(np.median(calm)) if calm else math.inf
    return tuple(
        replace(run, verdict="safe") if run.verdict == "resonance" and not run.amplitude_m > limit else run
        for run in runs
    )


def _table(runs: Sequence[SpeedRun], proposed: Sequence[Peak]) -> list[DangerousSpeed]:
    """Rows of stretches of one verdict: one for each peak in it; of none, one where it is not safe."""
    by_speed = {peak.speed_hz: peak for peak in proposed}
    speed = [run.speed_hz for run in runs]
    found: list[DangerousSpeed] = []
    first = 0
    for verdict, part in groupby(runs, key=lambda run: run.verdict):
        stretch = list(part)
        last = first + len(stretch) - 1
        low = speed[0] if first == 0 else 0.5 * (speed[first - 1] + speed[first])
        high = speed[-1] if last == len(runs) - 1 else 0.5 * (speed[last] + speed[last + 1])
        inside = [(run, by_speed[run.speed_hz]) for run in stretch if run.speed_hz in by_speed]
        if inside:
            found += _merged(_of_peaks(inside, low, high, speed[first], speed[last], verdict))
        elif verdict != "safe":
            found.append(DangerousSpeed(from_hz=low, to_hz=high, at=max(stretch, key=_badness), peak=None))
        first = last + 1
    return found


def _of_peaks(
    inside: Sequence[tuple[SpeedRun, Peak]], low: float, high: float, first: float, last: float, verdict: Verdict
) -> list[DangerousSpeed]:  # fmt: skip
    """One row for each peak of a stretch from `low` to `high`, whose first and last runs are at `first` and `last`.

    In a safe stretch each row has the speeds at which closed contact grows. Elsewhere the rows share the whole stretch;
    it ends where closed contact ceases to grow, if that lies between two runs.
    """
    found = [peak for _, peak in inside]
    if verdict == "safe":
        ranges = [(max(peak.from_hz, low), min(peak.to_hz, high)) for peak in found]
    else:
        begin = found[0].from_hz if low < found[0].from_hz <= first else low
        end = found[-1].to_hz if last <= found[-1].to_hz < high else high
        ranges = list(pairwise([begin, *(peak.to_hz for peak in found[:-1]), end]))
    return [
        DangerousSpeed(from_hz=begin, to_hz=end, at=run, peak=peak)
        for (run, peak), (begin, end) in zip(inside, ranges, strict=True)
    ]


def _merged(rows: Sequence[DangerousSpeed]) -> list[DangerousSpeed]:
    """Neighbours with one motion are one row, that of the worst run."""
    found: list[DangerousSpeed] = []
    for row in rows:
        last = found[-1] if found else None
        if last is not None and row.n is not None and (last.n, last.wave, last.body) == (row.n, row.wave, row.body):
            worst = max(last, row, key=lambda one: _badness(one.at))
            found[-1] = replace(worst, from_hz=last.from_hz, to_hz=row.to_hz)
        else:
            found.append(row)
    return found


def _badness(run: SpeedRun) -> float:
    """How bad a run is among those of its verdict."""
    if run.verdict == "unstable":
        return run.growth if math.isfinite(run.growth) else math.inf
    return run.amplitude_m if run.verdict == "resonance" else run.closed


def _ranked(rows: Sequence[DangerousSpeed]) -> tuple[DangerousSpeed, ...]:
    """The worst verdict first, in it the worst run."""
    return tuple(sorted(rows, key=lambda row: (VERDICTS.index(row.at.verdict), -_badness(row.at), -row.at.closed)))
