"""Table of dangerous speeds: closed contact proposes them, runs of the scene decide.

The growth of closed contact (`contact.stability.peaks`) states at which speeds contact can feed a motion, and which
one. Clearance, out-of-roundness and impacts decide whether it does: the scene is run at each peak, at its own speed, at
speeds evenly over the range, and midway between runs that disagree. There contact that opens may feed a motion that
closed contact does not (`contact.speed_runs`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from contact.base.arrays import Array
from contact.base.errors import InputError
from contact.io.columns import WIDE, Column, table_lines
from contact.io.outfiles import finite
from contact.io.progress import tell
from contact.io.reported import Reported
from contact.io.threads import with_one_thread
from contact.model.gaps.gap import RotatingRim
from contact.model.gaps.permanent import HandPair
from contact.model.gaps.rub import Rub, rub_of
from contact.model.law import Unilateral
from contact.model.rotor.rotor import Rotor
from contact.model.rotor.rotor_rub import rotor_of
from contact.model.rotor.whirl import critical_speeds, growth
from contact.prepared import Scene
from contact.speed_ranges import VERDICTS, DangerousSpeed, by_poles, ranges, ranked
from contact.speed_runs import speed_runs
from contact.speed_verdict import SpeedRun, Verdict
from contact.stability.peaks import Peaks, growth_at, peaks
from contact.stability.rotor import rotor_peaks
from contact.stability.split_casing import AVERAGED

RUNS = 60  # speeds evenly over the range
ALIKE = 1e-9  # of the highest speed: critical speeds and peaks of a rotor that are the same
AROUND, STEPS = 2.0, 200  # without a stated range: its end in the scene's highest speeds; its number of steps


def _rows(found: Any, value: str) -> list[Any]:
    return [getattr(row, value) for row in found.rows]


def _runs(found: Any, value: str) -> list[Any]:
    return [getattr(row.at, value) for row in found.rows]


def _ranges(found: Any, factor: float, form: str) -> list[str]:
    return [f"{factor * row.from_hz:{form}}-{factor * row.to_hz:{form}}" for row in found.rows]


COLUMNS = (
    Column("from_hz", "First speed of the range.", lambda found: _rows(found, "from_hz"), where="files"),
    Column("to_hz", "Last speed of the range.", lambda found: _rows(found, "to_hz"), where="files"),
    Column("range_rpm", "The same range in rpm.", lambda found: _ranges(found, 60.0, ".0f"), head="range", unit="rpm",
           format=str),
    Column("range_hz", "The same range in Hz.", lambda found: _ranges(found, 1.0, ".4g"), head="range", unit="Hz",
           format=str),
    Column("at_hz", "Speed of the run and of the closed-contact growth.",
           lambda found: _runs(found, "speed_hz"), head="at", unit="Hz", format=".4f", where="files"),
    Column("n", "Nodal diameters of the motion.", lambda found: _rows(found, "n"), format="d"),
    Column("pole_n", "Nodal diameters of the unstable pole with the contact closed.",
           lambda found: [None if row.peak is None else row.peak.n for row in found.rows], head="n of the pole",
           format="d", where="pages"),
    Column("wave", "Direction of the wave: with the blades, against them, or standing; for a rotor, its whirl.",
           lambda found: [row.wave or None for row in found.rows], format=str),
    Column("body", "Body that has most of the energy of the motion.", lambda found: _rows(found, "body"),
           where="files"),
    Column("blade_mode", "Number of the mode of the blades, if they have most of the energy.",
           lambda found: [row.mode if row.body == "blades" else None for row in found.rows], where="files"),
    Column("mover", "The body with the number of the blade's mode.", lambda found: _rows(found, "mover"), head="body",
           format=str),
    Column("closed_1_s", "Growth rate from the poles, with the contact always closed; for a rotor, without contact.",
           lambda found: _runs(found, "closed"), head="pole", unit="1/s", format=".3g"),
    Column("growth_1_s", "Growth rate of the run.", lambda found: _runs(found, "growth"), head="run", unit="1/s",
           format=".3g"),
    Column("growth_low_1_s", "Lower end of the 95 % interval of the run's growth rate.",
           lambda found: _runs(found, "low"), where="files"),
    Column("growth_high_1_s", "Upper end of the 95 % interval of the run's growth rate.",
           lambda found: _runs(found, "high"), where="files"),
    Column("force_N", "Largest contact force of a step of the run.", lambda found: _runs(found, "force_n"),
           head="force", unit="N", format=".4g", where="pages"),
    Column("amplitude_m", "Largest deflection of the rim at the end of the run; for a rotor, of its disk.",
           lambda found: _runs(found, "amplitude_m"), where="files"),
    Column("deflection_mm", "The same in mm; for a stopped run, > and the limit that it passed.",
           lambda found: [row.at.deflection or None for row in found.rows], head="motion", unit="mm", format=str),
    Column("half_wall_s", "Time at which the rim deflects by half its wall, from the start of the run.",
           lambda found: _runs(found, "half_wall_s"), where="files"),
    Column("verdict", "Safe, resonance, unstable or not decided.", lambda found: _runs(found, "verdict"), format=str),
    Column("check", "Result at half the step for a growing run: converged, numerical, irregular, depends on the step.",
           lambda found: [row.at.check or None for row in found.rows], format=str, where="files"),
    Column("seconds", "Length of the run.", lambda found: _runs(found, "seconds"), where="files"),
    Column("note", "Reason why the verdict differs from the closed-contact growth, or why there is no verdict.",
           lambda found: _runs(found, "note"), where="files"),
)  # fmt: skip


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Interactions(Reported):
    """The table of dangerous speeds, the worst first; `runs` at all speeds, `peaks` of the growth of closed contact.

    A row is a range of speeds with one verdict and one motion. Speeds outside all rows are safe: nothing grows there,
    neither with closed contact nor in the runs.
    """

    COLUMNS: ClassVar = COLUMNS

    rows: tuple[DangerousSpeed, ...]
    runs: tuple[SpeedRun, ...]
    peaks: Peaks

    def of(self, verdict: Verdict) -> tuple[DangerousSpeed, ...]:
        """Rows with one verdict."""
        return tuple(row for row in self.rows if row.at.verdict == verdict)

    @property
    def words(self) -> str:
        """Sentences on the runs and the conclusions."""
        low, high = (float(hz) for hz in self.peaks.map.speed_hz[[0, -1]])
        span = f"{low:.4g} to {high:.4g} Hz ({60.0 * low:,.0f} to {60.0 * high:,.0f} rpm)"
        pairs = AVERAGED if self.peaks.averaged else ""
        if not self.runs:
            grows = "The motion grows in the ranges above." if self.rows else "No motion grows."
            return f"{grows} The speeds are {span}. In a pair the contact is always closed: its poles decide."
        count = {verdict: sum(run.verdict == verdict for run in self.runs) for verdict in VERDICTS}
        ended = ", ".join(f"{number} {verdict}" for verdict, number in count.items() if number)
        words = [f"{len(self.runs)} runs of the scene at constant speeds from {span}: {ended}."]
        if count["safe"] == len(self.runs):
            words.append("Every speed is safe.")
        elif count["safe"]:
            words.append("Speeds outside the rows are safe.")
        words.append(_spacing(self.runs))
        open_ = [run for run in self.runs if run.verdict == "not decided"]
        words += [f"The first undecided run is at {run.speed_hz:.4g} Hz: {run.why}." for run in open_[:1]]
        return " ".join(filter(None, [*words, pairs]))

    def __repr__(self) -> str:
        table = table_lines(COLUMNS, self.records(), width=WIDE) if self.rows else []
        notes = [f"{row.from_hz:.5g}-{row.to_hz:.5g} Hz: {row.at.note}" for row in self.rows if row.at.note]
        return "\n".join([*table, *notes, self.words])

    def to_dict(self) -> dict[str, object]:
        """The document of `casingfem interactions --json`."""
        names = tuple(SpeedRun.__dataclass_fields__)
        return {
            "interactions": [finite(row) for row in self.records()],
            "runs": [finite({name: getattr(run, name) for name in names}) for run in self.runs],
            "closed_contact": self.peaks.map.to_dict() | {"peaks": self.peaks.records()},
            "words": self.words,
        }  # fmt: skip


def _spacing(runs: Sequence[SpeedRun]) -> str:
    """Sentence on the largest distance between neighbouring runs."""
    apart = float(np.diff([run.speed_hz for run in runs]).max())
    return (
        f"Neighbouring runs are at most {apart:.3g} Hz ({60.0 * apart:,.0f} rpm) apart. A range ends where closed "
        "contact stops growing, or midway between two runs, which are closer there."
    )


def speeds_of(scene: Scene | HandPair) -> Array:
    """Speeds [turns/s] up to AROUND times the highest speed of a scene, in STEPS steps.

    Left out are speeds at which a run takes less than a turn, at which a body is not known (`ModalBody.known_speeds`),
    or at which the rim would be faster than `contact.io.plausible` allows, unless the scene itself is faster.

    Raises InputError for a pair, and for a scene that does not turn.
    """
    if isinstance(scene, HandPair):
        raise InputError("speed_hz: found none for a pair of modes, expected the speeds to examine")
    what = scene.what
    rotor = rotor_of(what)
    if rotor is not None:
        hz = np.abs(rotor.speed.hz)
    else:
        hz = rub_of(what).speed.hz if isinstance(what, RotatingRim | Rub) else np.zeros(1)
    top = float(np.max(hz))
    if isinstance(what, RotatingRim | Rub | Rotor) and not top > 0.0:
        raise InputError("speed_hz: found none for a scene at rest, expected the speeds to examine")
    low, high = top * AROUND / STEPS, top * AROUND
    if scene.t_end is not None and low < 1.0 / scene.t_end < high:
        low = 1.0 / scene.t_end
    if isinstance(what, RotatingRim | Rub):
        from contact.io.plausible import fastest_hz  # pydantic is loaded when it is needed

        high = min(high, max(top, fastest_hz(rub_of(what).casing.line_radius(0))))
    for body in () if rub_of(what) is None else rub_of(what).bodies:
        if body.known_speeds is not None:
            known = np.asarray(body.known_speeds) / (2.0 * math.pi)
            low, high = max(low, float(known[0])), min(high, float(known[1]))
    return np.linspace(low, high, STEPS)


@with_one_thread
def interactions(
    scene: Scene | HandPair, speed_hz: ArrayLike | None = None, *, runs: int = RUNS,
    closed: RotatingRim | Rub | None = None, processes: int = 1,
) -> Interactions:  # fmt: skip
    """Find the dangerous speeds of a scene within a range.

    Parameters
    ----------
    scene
        A scene whose `what` is a RotatingRim, a Rub or a Rotor, with `t_end`; or a pair by hand, of which nothing is
        run. A rotor, alone or in its casing, is run at its critical speeds too; its poles are those without contact.
    speed_hz
        Speeds [turns/s] at which the growth of closed contact is computed, ascending from above 0. If left out, 200
        speeds up to twice the highest speed of the scene, at which all bodies are known, and 600 m/s of the rim.
    runs
        Number of runs evenly over the range, at least 2, beside one at each peak and at the scene's own speeds. Where
        neighbouring runs disagree, runs are added midway, to an eighth of the spacing.
    closed
        The same bodies with the springs of a law at the tips (`ct.stability.on_springs`); the scene's if left out.
    processes
        Number of processes that share long runs; the table is the same. A script that asks for more than one needs
        ``if __name__ == "__main__":``, as for `multiprocessing`.

    Raises
    ------
    InputError
        For speeds that do not ascend from above 0, a scene of another kind, without `t_end`, or fewer runs.

    Examples
    --------
    >>> from contact.model.gaps.permanent import ModalPair
    >>> pair = HandPair(casing=ModalPair(n=8, freq_hz=300.0, modal_mass=1.5),
    ...                 blade=ModalPair(freq_hz=120.0, modal_mass=0.4), compliance=1e-4)
    >>> (row,) = interactions(pair, np.linspace(40.0, 60.0, 41)).rows
    >>> row.at.verdict, row.n, row.wave, round(row.from_hz, 2), round(row.to_hz, 2)
    ('unstable', 8, 'with', 52.69, 52.99)
    """
    if isinstance(scene, HandPair):
        proposed = peaks(scene, speeds_of(scene) if speed_hz is None else speed_hz)
        return Interactions(rows=ranked([by_poles(peak) for peak in proposed.rows]), runs=(), peaks=proposed)
    rotor = rotor_of(scene.what)
    if rotor is not None:
        _require_runs(scene, runs)
        speeds = np.asarray(speeds_of(scene) if speed_hz is None else speed_hz)
        return _of_rotor(scene, rotor, speeds, runs, processes)
    what = _turning(scene, runs)
    mu = (scene.law or Unilateral()).mu
    tell("growth of closed contact")
    proposed = peaks(closed or what, speeds_of(scene) if speed_hz is None else speed_hz, mu=mu)
    low, high = (float(hz) for hz in proposed.map.speed_hz[[0, -1]])
    own = [hz for hz in np.unique(rub_of(what).speed.hz).tolist() if low <= hz <= high]
    even = np.linspace(low, high, runs)
    at = np.concatenate([even, [peak.speed_hz for peak in proposed.rows], own])

    def poles(speeds: Array) -> Array:
        return _above_floor(growth_at(closed or what, speeds, mu=mu), speeds, proposed)

    taken = speed_runs(
        scene, at, poles, even=even, bands_hz=_bands(proposed), exact=_decide(scene, proposed), processes=processes
    )
    return Interactions(rows=ranked(ranges(taken, proposed.rows)), runs=taken, peaks=proposed)


def _of_rotor(scene: Scene, rotor: Rotor, speed_hz: Array, runs: int, processes: int) -> Interactions:
    """Runs of a rotor: evenly over the speeds, at the peaks of its growth without contact, and at critical speeds."""
    tell("growth of the rotor")
    proposed = rotor_peaks(rotor, speed_hz)
    low, high = (float(hz) for hz in proposed.map.speed_hz[[0, -1]])
    if not low > 0.0:
        raise InputError(f"speed_hz: found {low:g} Hz, expected speeds above 0")
    own = [one["speed_hz"] for one in critical_speeds(rotor)] + np.abs(rotor.speed.hz).tolist()
    even = np.linspace(low, high, runs)
    at = np.unique([*(peak.speed_hz for peak in proposed.rows), *(hz for hz in own if low <= hz <= high)])
    at = at[np.diff(at, prepend=-math.inf) > ALIKE * high]
    at = at[np.abs(at[:, None] - even).min(axis=1) > ALIKE * high]

    def poles(speeds: Array) -> Array:
        return _above_floor(growth(rotor, speeds), speeds, proposed)

    exact = True if isinstance(scene.what, Rotor) else None
    at = np.concatenate([even, at])
    taken = speed_runs(scene, at, poles, even=even, bands_hz=_bands(proposed), exact=exact, processes=processes)
    return Interactions(rows=ranked(ranges(taken, proposed.rows)), runs=taken, peaks=proposed)


def _bands(proposed: Peaks) -> list[tuple[float, float]]:
    """Ranges of speeds [turns/s] around the peaks in which closed contact grows."""
    return [(peak.from_hz, peak.to_hz) for peak in proposed.rows]


def _above_floor(poles: Array, speed_hz: Array, proposed: Peaks) -> Array:
    """Growth rates at speeds [turns/s]; outside the bands of the map a positive rate is round-off, and is left out."""
    low, high = np.reshape(np.array(proposed.map.bands_hz), (-1, 2)).T
    grows = np.any((speed_hz[:, None] >= low) & (speed_hz[:, None] <= high), axis=1)
    return np.where(grows, poles, np.minimum(poles, 0.0))


def _decide(scene: Scene, proposed: Peaks) -> bool | None:
    """Whether the poles hold for closed contact of the scene: exactly, on average over time, or not at all (None)."""
    law = scene.law or Unilateral()
    return None if law.coating is not None else law.response is None and not proposed.averaged


def _turning(scene: Scene, runs: int) -> RotatingRim | Rub:
    what = scene.what
    if not isinstance(what, RotatingRim | Rub):
        raise InputError(f"scene: found {type(what).__name__}, expected a scene with a RotatingRim, a Rub or a Rotor")
    _require_runs(scene, runs)
    return what


def _require_runs(scene: Scene, runs: int) -> None:
    if scene.t_end is None:
        raise InputError("t_end: found none, expected the end of the runs in seconds")
    if runs < 2:
        raise InputError(f"runs: found {runs}, expected at least 2: one at each end of the range")
