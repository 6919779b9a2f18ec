"""Eight lanes for rotating rims of one size: runs are loaded into lanes, advanced together, and read back.

The coefficients of all runs that will share the lanes are known from the start, so that their rows have one table of
harmonics; a run's own numbers fill a column when it enters a lane.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from contact.model.waves import Terms, terms
from contact.record import Record, Samples, Tally, samples, tally
from contact.scheme.modal_run import ModalRun

if TYPE_CHECKING:
    from contact.scheme.loop.lanes import LaneLeaps, Lanes, LaneSamples, LaneTerms

WIDTH = 8
BUDGET = 20_000  # steps a call takes at most: room for the events of so many
NEVER = 1 << 40
SUMS = (
    "impulse", "work", "rotation", "friction", "damping", "peak", "penetration", "residual", "closed",
    "contact_steps", "reversals",
)  # fmt: skip
OF_MODES = ("q", "d", "al", "be", "c", "weight")
STEPS = ("live", "step", "end", "retry", "failed")
NUMBERS = ("angle", "speed", "surface", "mu", "h", "averaged", "turns")
TERMS = ("normal", "tangent", "series")
AWAY = 1e300  # gap where there is no run


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """A run for the lanes: `steps` steps, stored as `record` says (every, state_every); its sums of waves."""

    run: ModalRun
    steps: int
    record: Record
    terms: tuple[Terms, Terms, Terms] = field(init=False)  # of TERMS

    def __post_init__(self) -> None:
        system = self.run.system
        table, parts = system.table, (system.clearance, system.S_nn, system.S_nt)
        assert table is not None
        series = terms(
            np.repeat(np.arange(len(parts)), [part.harmonic.size for part in parts]),
            np.concatenate([part.harmonic for part in parts]), np.concatenate([part.cos for part in parts]),
            np.concatenate([part.sin for part in parts]), len(parts),
        )  # fmt: skip
        rows = table.terms(table.q_cos, table.q_sin), table.terms(table.t_cos, table.t_sin)
        object.__setattr__(self, "terms", (*rows, series))


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Batch:
    """Lanes, their sums and what they store; `turns`: some S depends on the angle, `rubs`: some run has friction."""

    lanes: Lanes
    leaps: LaneLeaps
    sums: Tally
    events: Samples
    kept: LaneSamples
    rubs: bool
    turns: bool

    def advance(self) -> None:
        """Step until a lane is at its end, has failed, or the room for events is used up."""
        from contact.scheme.loop.lanes import advance_lanes

        self.sums.filled[:] = 0
        advance_lanes(
            self.lanes, self.leaps, self.sums, self.events, self.kept, self.rubs, self.turns, BUDGET
        )  # fmt: skip

    def load(self, k: int, job: Job) -> None:
        """Put a run at its start into lane k."""
        rim = job.run.rim
        assert rim is not None
        lanes = self.lanes
        for name in OF_MODES:
            getattr(lanes, name)[:, k] = getattr(rim.state, name)
        for name, found in zip(TERMS, job.terms, strict=True):
            _spread(getattr(lanes, name), found, k)
        own = {name: getattr(rim.rows, name) for name in ("angle", "speed", "surface", "mu")} | {"h": job.run.dt}
        own |= {"averaged": rim.averaged, "turns": rim.rows.S_turns, "away": 0.0}
        own |= {"live": 1, "step": 0, "end": job.steps, "retry": 0, "failed": 0}
        for name, value in own.items():
            getattr(lanes, name)[k] = value
        lanes.memory[:, k] = rim.state.memory
        self._load_leap(k, job)
        for name in SUMS:
            getattr(self.sums, name)[k] = 0
        states = job.record.state_every
        self.kept.every[:, k] = job.record.every, states or NEVER
        self.kept.due[:, k], self.kept.filled[:, k] = (0, 0 if states else NEVER), 0

    def _load_leap(self, k: int, job: Job) -> None:
        assert job.run.rim is not None
        leap = job.run.rim.leap
        for name in ("fade", "cos", "sin", "floor"):
            getattr(self.leaps, name)[k] = getattr(leap, name)
        if leap.powers.size:
            self.leaps.powers[k] = leap.powers
        else:
            self.lanes.retry[k] = NEVER
        self.leaps.row[k] = self.lanes.normal.value[:, k]
        self.leaps.taken[k] = 0

    def unload(self, k: int, job: Job, events: Samples) -> Samples:
        """Write lane k's state and sums back into its run; what it stored, with its `events`."""
        rim, lanes, kept = job.run.rim, self.lanes, self.kept
        assert rim is not None
        rim.state.q[:], rim.state.d[:], rim.state.memory[:] = lanes.q[:, k], lanes.d[:, k], lanes.memory[:, k]
        rim.leap.taken[:] = self.leaps.taken[k]
        for name in SUMS:
            getattr(job.run.sums, name)[0] = getattr(self.sums, name)[k]
        job.run.steps[0] = job.steps
        n, states = (int(value) for value in kept.filled[:, k])
        lanes.live[k], lanes.away[k] = 0, AWAY
        return events._replace(
            time=kept.time[:n, k].copy(), force=kept.force[:n, k, None].copy(), gap=kept.gap[:n, k, None].copy(),
            impulse=kept.impulse[:n, k, None].copy(), state_time=kept.state_time[:states, k].copy(),
            state=kept.state[:states, :, k].copy(),
        )  # fmt: skip


def batch(jobs: Sequence[Job]) -> Batch:
    """Empty lanes for runs of one number of modes."""
    from contact.scheme.loop.lanes import Lanes

    m = jobs[0].run.size
    found: dict[str, Any] = {name: _together([job.terms[i] for job in jobs]) for i, name in enumerate(TERMS)}
    top = max(int(part.wave.max(initial=0)) // 2 for part in found.values())
    arrays: dict[str, Any] = {name: np.zeros((m, WIDTH)) for name in (*OF_MODES, "old", "Q", "Q_next", "T")}
    arrays |= {name: np.zeros(WIDTH) for name in NUMBERS}
    arrays |= {name: np.zeros(WIDTH, dtype=np.int64) for name in STEPS}
    arrays |= {name: np.zeros((top + 1, 2, WIDTH)) for name in ("waves", "waves_next")}
    lanes = Lanes(away=np.full(WIDTH, AWAY), memory=np.zeros((5, WIDTH)), work=np.zeros((18, WIDTH)), **found, **arrays)
    return Batch(
        lanes=lanes, leaps=_leaps(jobs, lanes.normal), sums=tally(WIDTH)._replace(damping=np.zeros(WIDTH)),
        events=samples(Record(every=NEVER), BUDGET, WIDTH, 0), kept=_kept(jobs, m),
        rubs=any(job.run.rim is not None and job.run.rim.rows.mu > 0.0 for job in jobs),
        turns=any(job.run.rim is not None and job.run.rim.rows.S_turns for job in jobs),
    )  # fmt: skip


def _together(parts: Sequence[Terms]) -> LaneTerms:
    """Terms that any of the runs has, without values as yet."""
    from contact.scheme.loop.lanes import LaneTerms

    top = max(int(part.wave.max(initial=0)) for part in parts) + 1
    first, sums = parts[0], np.arange(parts[0].sums + 1)
    one = all(
        np.array_equal(part.start, first.start) and np.array_equal(part.wave, first.wave)
        and np.array_equal(part.value, first.value) for part in parts
    )  # fmt: skip
    common = np.unique(np.concatenate([part.owner * top + part.wave for part in ([first] if one else parts)]))
    start, wave = np.searchsorted(common, sums * top).astype(np.int64), (common % top).astype(np.int64)
    return LaneTerms(start, wave, np.zeros((wave.size, WIDTH)), first.value.copy() if one else np.zeros(0))


def _spread(lanes: LaneTerms, own: Terms, k: int) -> None:
    """One run's coefficients among the terms that all runs have in common."""
    top = max(int(lanes.wave.max(initial=0)), int(own.wave.max(initial=0))) + 1
    common = np.repeat(np.arange(lanes.start.size - 1), np.diff(lanes.start)) * top + lanes.wave
    lanes.value[:, k] = 0.0
    lanes.value[np.searchsorted(common, own.owner * top + own.wave), k] = own.value


def _leaps(jobs: Sequence[Job], normal: LaneTerms) -> LaneLeaps:
    from contact.scheme.loop.lanes import LaneLeaps

    kinds, m, size = [job.run.rim.leap for job in jobs if job.run.rim is not None], jobs[0].run.size, normal.wave.size
    bits = max(leap.powers.shape[0] for leap in kinds)
    arrays: dict[str, Any] = {name: np.zeros((WIDTH, m)) for name in ("fade", "cos", "sin")}
    return LaneLeaps(
        powers=np.zeros((WIDTH, bits, 4, m)), floor=np.zeros((WIDTH, kinds[0].floor.size)),
        reach=np.zeros(int(normal.wave.max(initial=0)) // 2 * 2 + 2), taken=np.zeros((WIDTH, 2), dtype=np.int64),
        row=np.zeros((WIDTH, size)), **arrays,
    )  # fmt: skip


def _kept(jobs: Sequence[Job], m: int) -> LaneSamples:
    from contact.scheme.loop.lanes import LaneSamples

    rows = max(job.steps // job.record.every + 1 for job in jobs)
    states = max(job.steps // job.record.state_every + 1 if job.record.state_every else 0 for job in jobs)
    arrays: dict[str, Any] = {name: np.zeros((rows, WIDTH)) for name in ("time", "force", "gap", "impulse")}
    arrays |= {name: np.zeros((2, WIDTH), dtype=np.int64) for name in ("due", "every", "filled")}
    return LaneSamples(state_time=np.zeros((states, WIDTH)), state=np.zeros((states, m, WIDTH)), **arrays)
