"""Eight lanes for rotating rims of one size: runs are loaded into lanes, advanced together, and read back.

The coefficients of all runs that will share the lanes are known from the start, so that their rows have one table of
harmonics; a run's own numbers fill a column when it enters a lane.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from contact.model.arrays import Array, Indices
from contact.model.modal_system import RowTable
from contact.model.trig import Trig
from contact.record import Record, Samples, Tally, samples, tally
from contact.scheme.modal_run import ModalRun

if TYPE_CHECKING:
    from contact.scheme.loop.lanes import LaneLeaps, LaneRows, Lanes, LaneSamples, LaneSeries

WIDTH = 8
BUDGET = 20_000  # steps a call takes at most: room for the events of so many
NEVER = 1 << 40
SUMS = (
    "impulse", "work", "rotation", "friction", "damping", "peak", "penetration", "residual", "closed",
    "contact_steps", "reversals",
)  # fmt: skip
OF_MODES = ("q", "d", "al", "be", "c", "weight")
STEPS = ("averaged", "turns", "live", "step", "end", "retry", "failed")
POLYNOMIALS = ("clearance", "S_nn", "S_nt")


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """A run for the lanes: `steps` steps, stored as `record` says (every, state_every)."""

    run: ModalRun
    steps: int
    record: Record


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
        lanes, system = self.lanes, job.run.system
        for name in OF_MODES:
            getattr(lanes, name)[:, k] = getattr(rim.state, name)
        table = system.table
        assert table is not None
        for rows, cos, sin in ((lanes.normal, table.q_cos, table.q_sin), (lanes.tangent, table.t_cos, table.t_sin)):
            _spread(rows, table, cos, sin, k)
        for name in POLYNOMIALS:
            series, terms = getattr(lanes, name), getattr(system, name)
            place = np.searchsorted(series.harmonic, terms.harmonic)
            series.cos[:, k], series.sin[:, k] = 0.0, 0.0
            series.cos[place, k], series.sin[place, k] = terms.cos, terms.sin
        own = {name: getattr(rim.rows, name) for name in ("angle", "speed", "surface", "mu")} | {"h": job.run.dt}
        own |= {
            "averaged": rim.averaged,
            "turns": rim.rows.S_turns,
            "live": 1,
            "step": 0,
            "end": job.steps,
            "retry": 0,
            "failed": 0,
        }
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
        self.leaps.row_cos[k], self.leaps.row_sin[k] = self.lanes.normal.cos[:, k], self.lanes.normal.sin[:, k]
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
        lanes.live[k] = 0
        return events._replace(
            time=kept.time[:n, k].copy(), force=kept.force[:n, k, None].copy(), gap=kept.gap[:n, k, None].copy(),
            impulse=kept.impulse[:n, k, None].copy(), state_time=kept.state_time[:states, k].copy(),
            state=kept.state[:states, :, k].copy(),
        )  # fmt: skip


def batch(jobs: Sequence[Job]) -> Batch:
    """Empty lanes for runs of one number of modes."""
    from contact.scheme.loop.lanes import Lanes

    systems = [job.run.system for job in jobs]
    m = systems[0].omega.size
    tables = [system.table for system in systems if system.table is not None]
    start, harmonic = _union(tables, m)
    clearance, S_nn, S_nt = (_series([getattr(system, name) for system in systems]) for name in POLYNOMIALS)
    top = max(int(h.max(initial=0)) for h in (harmonic, clearance.harmonic, S_nn.harmonic, S_nt.harmonic))
    arrays: dict[str, Any] = {name: np.zeros((m, WIDTH)) for name in (*OF_MODES, "old", "Q", "Q_next", "T")}
    arrays |= {name: np.zeros(WIDTH) for name in ("angle", "speed", "surface", "mu", "h")}
    arrays |= {name: np.zeros(WIDTH, dtype=np.int64) for name in STEPS}
    arrays |= {name: np.zeros((2, top + 2 - top % 2, WIDTH)) for name in ("waves", "waves_next")}
    lanes = Lanes(
        normal=_rows(start, harmonic, tables, "q"), tangent=_rows(start, harmonic, tables, "t"),
        clearance=clearance, S_nn=S_nn, S_nt=S_nt,
        memory=np.zeros((5, WIDTH)), work=np.zeros((16, WIDTH)), **arrays,
    )  # fmt: skip
    return Batch(
        lanes=lanes, leaps=_leaps(jobs, m, start, harmonic), sums=tally(WIDTH)._replace(damping=np.zeros(WIDTH)),
        events=samples(Record(every=NEVER), BUDGET, WIDTH, 0), kept=_kept(jobs, m),
        rubs=any(job.run.rim is not None and job.run.rim.rows.mu > 0.0 for job in jobs),
        turns=any(job.run.rim is not None and job.run.rim.rows.S_turns for job in jobs),
    )  # fmt: skip


def _union(tables: Sequence[RowTable], m: int) -> tuple[Indices, Indices]:
    """Harmonics of each mode in any of the tables."""
    distinct = {(t.start.tobytes(), t.harmonic.tobytes()): t for t in tables}.values()
    parts = [
        np.unique(np.concatenate([t.harmonic[t.start[i] : t.start[i + 1]] for t in distinct])) for i in range(m)
    ]  # fmt: skip
    start = np.concatenate(([0], np.cumsum([part.size for part in parts]))).astype(np.int64)
    return start, np.concatenate(parts).astype(np.int64)


def _rows(start: Indices, harmonic: Indices, tables: Sequence[RowTable], kind: str) -> LaneRows:
    from contact.scheme.loop.lanes import LaneRows

    pairs = [(getattr(table, f"{kind}_cos"), getattr(table, f"{kind}_sin")) for table in tables]
    one = pairs[0][0].size == harmonic.size and all(
        np.array_equal(cos, pairs[0][0]) and np.array_equal(sin, pairs[0][1]) for cos, sin in pairs
    )
    alike = np.ascontiguousarray(np.stack(pairs[0], axis=1)) if one else np.zeros((0, 2))
    return LaneRows(start, harmonic, np.zeros((harmonic.size, WIDTH)), np.zeros((harmonic.size, WIDTH)), alike)


def _series(terms: Sequence[Trig]) -> LaneSeries:
    from contact.scheme.loop.lanes import LaneSeries

    harmonic = np.unique(np.concatenate([p.harmonic for p in terms])).astype(np.int64)
    return LaneSeries(harmonic, np.zeros((harmonic.size, WIDTH)), np.zeros((harmonic.size, WIDTH)))


def _spread(rows: LaneRows, table: RowTable, cos: Array, sin: Array, k: int) -> None:
    """One run's coefficients among the entries that all runs have in common."""
    top = int(rows.harmonic.max(initial=0)) + 1
    modes = np.arange(rows.start.size - 1)
    common = np.repeat(modes, np.diff(rows.start)) * top + rows.harmonic
    place = np.searchsorted(common, np.repeat(modes, np.diff(table.start)) * top + table.harmonic)
    rows.cos[:, k], rows.sin[:, k] = 0.0, 0.0
    rows.cos[place, k], rows.sin[place, k] = cos, sin


def _leaps(jobs: Sequence[Job], m: int, start: Indices, harmonic: Indices) -> LaneLeaps:
    from contact.scheme.loop.lanes import LaneLeaps

    kinds = [job.run.rim.leap for job in jobs if job.run.rim is not None]
    bits = max(leap.powers.shape[0] for leap in kinds)
    arrays: dict[str, Any] = {name: np.zeros((WIDTH, m)) for name in ("fade", "cos", "sin")}
    arrays |= {name: np.zeros((WIDTH, harmonic.size)) for name in ("row_cos", "row_sin")}
    return LaneLeaps(
        powers=np.zeros((WIDTH, bits, 4, m)), floor=np.zeros((WIDTH, kinds[0].floor.size)),
        reach=np.zeros((2, int(harmonic.max(initial=0)) + 1)), taken=np.zeros((WIDTH, 2), dtype=np.int64), **arrays,
    )  # fmt: skip


def _kept(jobs: Sequence[Job], m: int) -> LaneSamples:
    from contact.scheme.loop.lanes import LaneSamples

    rows = max(job.steps // job.record.every + 1 for job in jobs)
    states = max(job.steps // job.record.state_every + 1 if job.record.state_every else 0 for job in jobs)
    arrays: dict[str, Any] = {name: np.zeros((rows, WIDTH)) for name in ("time", "force", "gap", "impulse")}
    arrays |= {name: np.zeros((2, WIDTH), dtype=np.int64) for name in ("due", "every", "filled")}
    return LaneSamples(state_time=np.zeros((states, WIDTH)), state=np.zeros((states, m, WIDTH)), **arrays)
