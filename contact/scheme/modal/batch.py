"""Eight slots for rotating rims of one size: runs are loaded into slots, advanced together, and unloaded.

The coefficients of all runs that will share the slots are known from the start, so that their rows have one table of
harmonics. A run fills a column with its own numbers when it enters a slot.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from contact.base.arrays import Array, Indices, aligned
from contact.base.remembered import remembered
from contact.model.gaps.deflection import RimRows, places
from contact.model.trig import Terms
from contact.record.record import Record, Samples, Tally, samples, tally
from contact.scheme.modal.blocks import whole
from contact.scheme.modal.coupled_flight import no_pairs
from contact.scheme.modal.rub_stepper import RubStepper
from contact.scheme.modal.slot import Slot, give_back, slot_of

if TYPE_CHECKING:
    from contact.loop.batch.waves import BatchFreeFlight, BatchSamples, BatchState, BatchTerms
    from contact.loop.rub.deflection import RimWaves
    from contact.loop.rub.state import RubState

WIDTH = 8
BUDGET = 20_000  # steps of a call at most: the buffers have space for their events
NEVER = 1 << 40
SUMS = (
    "impulse", "work", "rotation", "friction", "damping", "peak", "penetration", "residual", "closed",
    "stuck", "contact_steps", "reversals",
)  # fmt: skip
SHARED = ("al", "be", "c", "weight")
OF_MODES = ("q", "d", *SHARED)
STEPS = ("live", "step", "end", "retry", "failed", "casing")
NUMBERS = ("angle", "speed", "surface", "mu", "h", "averaged", "turns", "peaks")
TERMS = ("normal", "tangent")
FOUR = 4  # rows that are summed at once where slots share their coefficients
NONE = np.array([np.inf, np.inf, 0.0, 0.0, np.inf, 0.0])  # limits there
AWAY = 1e300  # gap where there is no run
Shape = int
Events = tuple[Indices, Array]  # kinds, times
NO_EVENTS: Events = (np.zeros(0, dtype=np.int64), np.zeros(0))


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """A run of a batch: `steps` steps; `record` states every how many steps samples and states are stored."""

    run: RubStepper
    steps: int
    record: Record
    slot: Slot = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "slot", slot_of(self.run))

    @property
    def mu(self) -> float:
        """Coefficient of friction."""
        return float(self.run.state.mu[0])


def shape_of(run: RubStepper) -> Shape | None:
    """Number of modes of a run, equal for all runs in the slots; None for a run that slots do not support."""
    return None if run.rim is None else run.system.omega.size


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Layout:
    """Positions, in the blocks of `BatchTerms`, of all terms that occur in some runs; keys show sum and wave."""

    top: int  # waves
    keys: Indices
    place: Indices
    row: Indices
    start: Indices
    wave: Indices
    alike: bool

    @staticmethod
    def of(parts: Sequence[Terms]) -> Layout:
        """The layout of the sums of these runs."""
        return _layout(*{id(part): part for part in parts}.values())

    def empty(self, one: Terms) -> BatchTerms:
        """Terms with the values that all runs share, or still without values."""
        from contact.loop.batch.waves import BatchTerms

        if not self.alike:
            return BatchTerms(self.row, self.start, self.wave, aligned(self.wave.size, WIDTH), np.zeros(0))
        alike = np.zeros(FOUR * self.wave.size)
        alike[self.place] = one.value
        return BatchTerms(self.row, self.start, self.wave, aligned(0, WIDTH), alike)

    def load(self, slots: BatchTerms, own: Terms, k: int) -> None:
        """Put one run's coefficients into slot k, if slots differ."""
        if self.alike:
            return
        slots.value[:, k] = 0.0
        slots.value[self.place[np.searchsorted(self.keys, own.owner * self.top + own.wave)], k] = own.value


@remembered
def _layout(*parts: Terms) -> Layout:
    """The layout of different sums."""
    top, one = max(int(part.wave.max(initial=0)) for part in parts) + 1, parts[0]
    alike = all(part.equals(one) for part in parts[1:])
    keys = np.unique(np.concatenate([part.owner * top + part.wave for part in ([one] if alike else parts)]))
    has = np.zeros((one.sums, top), dtype=bool)
    has[keys // top, keys % top] = True
    many = FOUR if alike else 1
    blocks = _blocks(has, many)
    row = np.full((len(blocks), many), one.sums, dtype=np.int64)  # where there is none: the row past the last
    place, waves = np.zeros(has.shape, dtype=np.int64), [np.flatnonzero(has[block].any(axis=0)) for block in blocks]
    start = np.concatenate(([0], np.cumsum([part.size for part in waves]))).astype(np.int64)
    for b, (block, part) in enumerate(zip(blocks, waves, strict=True)):
        place[block[:, None], part] = (start[b] + np.arange(part.size)) * many + np.arange(block.size)[:, None]
        row[b, : block.size] = block
    return Layout(
        top=top, keys=keys, place=place[keys // top, keys % top], row=row.ravel() * WIDTH, start=start,
        wave=np.concatenate(waves).astype(np.int64) * WIDTH, alike=alike,
    )  # fmt: skip


def _blocks(has: NDArray[np.bool_], many: int) -> list[Indices]:
    """Groups of `many` rows that add the fewest waves to the first; `has` (rows, waves) shows a row's waves."""
    blocks, size = [], has.sum(axis=1)
    left = np.argsort(-size, kind="stable").tolist()  # those with most waves first: others fit in
    while left:
        block = [left.pop(0)]
        while left and len(block) < many:
            more = (has[left] & ~has[block].any(axis=0)).sum(axis=1)
            block.append(left.pop(int(np.lexsort((-size[left], more))[0])))
        blocks.append(np.array(block))
    return blocks


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Batch:
    """State, sums and stored samples of all slots; `rubs`: some run has friction."""

    slots: BatchState
    layouts: dict[str, Layout]
    flights: BatchFreeFlight
    sums: Tally
    events: Samples
    kept: BatchSamples
    rubs: bool
    given: list[Any] = field(default_factory=list)  # arguments of the loop, bundled once

    def advance(self) -> dict[int, Events]:
        """Step until a slot ends, fails, or has no space for events; returns the events of slots that have some."""
        from contact.jit.bundle import bundled
        from contact.loop.batch.batch import advance_batch

        if not self.given:
            self.given.extend(map(bundled, (self.slots, self.flights, self.sums, self.events, self.kept)))
        self.sums.filled[:] = 0
        slots, flights, sums, events, kept = self.given
        advance_batch(slots, flights, sums, events, kept, self.rubs, BUDGET)
        return self._events()

    def _events(self) -> dict[int, Events]:
        """Kinds and times of the events in the last call, for each slot that had some."""
        out, n = self.events, int(self.sums.filled[2])
        slot, kind, when = out.event_contact[:n], out.event_kind[:n], out.event_time[:n]
        return {k: (kind[slot == k], when[slot == k]) for k in set(slot.tolist())}

    def load(self, k: int, job: Job, most: int = NEVER) -> None:
        """Put a run at its start into slot k, at first for `most` steps."""
        slot, run, system, slots = job.slot, job.run, job.slot.system, self.slots
        for name in OF_MODES:
            getattr(slots, name)[:, k] = getattr(run.state, name)
        for name, layout in self.layouts.items():
            layout.load(getattr(slots, name), getattr(slot, name), k)
        own = {"angle": system.angle, "speed": system.speed, "surface": system.radius * system.speed, "mu": job.mu}
        own |= {"h": run.dt, "averaged": run.averaged, "turns": system.compliance_turns, "away": 0.0}
        own |= {"live": 1, "step": 0, "end": min(job.steps, most), "retry": 0, "failed": 0}
        own |= {"casing": system.first[1], "peaks": 0.0}
        for name, value in own.items():
            getattr(slots, name)[k] = value
        slots.memory[:, k], slots.limits[:, k], slots.reach[:, k] = slot.memory, run.limits, slot.reach
        self._load_rim(k, slot.rim)
        self._load_free_flight(k, job)
        for name in SUMS:
            getattr(self.sums, name)[k] = 0
        states = job.record.state_every
        self.kept.every[:, k] = job.record.every, states or NEVER
        self.kept.due[:, k], self.kept.filled[:, k] = (0, 0 if states else NEVER), 0

    def _load_rim(self, k: int, rim: RimRows) -> None:
        """Load the arrays for the deflection of the rim into slot k."""
        slots, (_, size, m), d = self.slots, rim.rows.shape, rim.soft.shape[1]
        own, place = min(k, len(slots.rim.rows) - 1), _waves(size, slots.rim.z.size)
        slots.soft[:, k], slots.rim.rows[own] = 0.0, 0.0
        slots.soft[:d, k], slots.rim.rows[own, place, :m] = rim.soft[0], rim.rows[0]
        if slots.rim.S.size:
            slots.rim.S[own] = 0.0
            for i in range(d if rim.S.size else 0):
                slots.rim.S[own, place[:, None], i, place] = rim.S[0, :, i]

    def _load_free_flight(self, k: int, job: Job) -> None:
        flight = job.run.flight
        self.flights.taken[k], self.flights.open[k] = 0, 0
        if not flight.powers.size:
            self.slots.retry[k] = NEVER
            return
        for name in ("fade", "cos", "sin", "floor", "start"):
            getattr(self.flights, name)[k] = getattr(flight, name)
        if len(self.flights.powers) == WIDTH:
            self.flights.powers[k] = flight.powers
        self.flights.wave[k, : flight.wave.size], self.flights.row[k, : flight.row.size] = flight.wave, flight.row

    def go_on(self, k: int, job: Job, steps: int) -> None:
        """Let slot k take more steps, at most to the end of its run."""
        self.slots.end[k] = min(job.steps, int(self.slots.step[k]) + steps)

    def read(self, k: int, job: Job) -> None:
        """Copy the state and the sums of slot k into its run."""
        run, slots = job.run, self.slots
        run.flight.taken[:], run.limits[:] = self.flights.taken[k], slots.limits[:, k]
        for name in SUMS:
            getattr(run.sums, name)[0] = getattr(self.sums, name)[k]
        run.steps[0], run.state.peaks[0] = int(slots.step[k]), slots.peaks[k]
        give_back(run, job.slot, slots.q[:, k], slots.d[:, k], slots.memory[:, k])

    def unload(self, k: int, job: Job, events: Sequence[Events]) -> Samples:
        """End the run of slot k, as `read`; returns its samples (views until the next load) with `events`."""
        self.read(k, job)
        run, slots, kept = job.run, self.slots, self.kept
        n, states = (int(value) for value in kept.filled[:, k])
        slots.live[k], slots.away[k], slots.limits[:, k] = 0, AWAY, NONE
        kind, when = (np.concatenate(part) for part in zip(NO_EVENTS, *events, strict=True))
        return self.events._replace(  # its contact is number 0 of its own run
            event_contact=np.zeros(kind.size, dtype=np.int64), event_kind=kind, event_time=when,
            time=kept.time[k, :n], force=kept.force[k, :n, None], gap=kept.gap[k, :n, None],
            impulse=kept.impulse[k, :n, None], state_time=kept.state_time[k, :states],
            state=kept.state[k, :states, : run.size],
        )  # fmt: skip


def batch(jobs: Sequence[Job]) -> Batch:
    """Empty slots for runs with this number of modes."""
    from contact.loop.batch.waves import BatchState

    m = jobs[0].run.system.omega.size
    layouts = {name: Layout.of([getattr(job.slot, name) for job in jobs]) for name in TERMS}
    arrays: dict[str, Any] = {name: layout.empty(getattr(jobs[0].slot, name)) for name, layout in layouts.items()}
    arrays |= {name: aligned(m, WIDTH) for name in (*OF_MODES, "old", "reach")}
    arrays["alike"] = _alike([job.run.state for job in jobs])
    arrays |= {"Q": aligned(m + 5, WIDTH), "Q_next": aligned(m + 5, WIDTH), "T": aligned(m + 1, WIDTH)}
    arrays |= {name: aligned(WIDTH) for name in NUMBERS}
    arrays |= {name: np.zeros(WIDTH, dtype=np.int64) for name in STEPS}
    waves = max(layout.top for layout in layouts.values()) // 2 + 1
    arrays |= {name: aligned(waves, 2, WIDTH) for name in ("waves", "waves_next")}
    arrays |= {"memory": aligned(10, WIDTH), "limits": aligned(6, WIDTH), "work": aligned(18, WIDTH)}
    arrays |= {"soft": aligned(2, WIDTH), "rim": _rims(jobs)}
    slots = BatchState(away=np.full(WIDTH, AWAY), **arrays)
    slots.limits[:] = NONE[:, None]
    return Batch(
        slots=slots, layouts=layouts, flights=_free_flights(jobs, m),
        sums=tally(WIDTH)._replace(damping=np.zeros(WIDTH)),
        events=samples(Record(every=BUDGET), BUDGET, WIDTH, 0), kept=_kept(jobs),
        rubs=any(job.mu > 0.0 for job in jobs),
    )  # fmt: skip


def _rims(jobs: Sequence[Job]) -> RimWaves:
    """Arrays for the rims of the slots; a single one if all runs have the same rim."""
    from contact.loop.rub.deflection import RimWaves

    rims = list({id(job.slot.rim): job.slot.rim for job in jobs}.values())
    slots, size = 1 if len(rims) == 1 else WIDTH, max(rim.rows.shape[1] for rim in rims)
    d, angle = max(rim.soft.shape[1] for rim in rims), places(size)
    strains = any(rim.S.size for rim in rims)
    return RimWaves(
        reach=np.zeros((0, 0)), soft=np.zeros((0, 0)), rows=np.zeros((slots, size, jobs[0].run.system.omega.size)),
        S=aligned(slots, size, d, whole(size)) if strains else np.zeros((0, 0, 0, 0)),
        places=np.array([np.cos(angle), np.sin(angle)]),
        force=aligned(d, whole(size)), z=np.zeros(size), top=aligned(WIDTH),
    )  # fmt: skip


def _waves(size: int, largest: int) -> Indices:
    """Positions of N waves, 1, cos .. cos N, sin .. sin N, in a longer list of waves.

    >>> _waves(5, 9).tolist()
    [0, 1, 2, 5, 6]
    """
    n = np.arange(size)
    return np.where(n <= size // 2, n, n - size // 2 + largest // 2)


def _alike(states: Sequence[RubState]) -> Array:
    """Coefficients of the modes (4, m) if all runs share them; None if they differ."""
    parts = [[getattr(state, name) for name in SHARED] for state in states]
    if all(np.array_equal(a, b) for part in parts[1:] for a, b in zip(part, parts[0], strict=True)):
        return np.array(parts[0])
    return np.zeros((len(SHARED), 0))


def _free_flights(jobs: Sequence[Job], m: int) -> BatchFreeFlight:
    from contact.loop.batch.waves import BatchFreeFlight

    kinds = [job.run.flight for job in jobs]
    size, powers = max(flight.row.size for flight in kinds), [flight.powers for flight in kinds if flight.powers.size]
    alike = all(one is powers[0] for one in powers)
    shared = np.array([powers[0]] * (1 if alike else WIDTH) if powers else np.zeros((1, 0, 4, m)))
    arrays: dict[str, Any] = {name: np.zeros((WIDTH, m)) for name in ("fade", "cos", "sin")}
    return BatchFreeFlight(
        powers=shared, floor=np.zeros((WIDTH, max(flight.floor.size for flight in kinds))),
        start=np.zeros((WIDTH, m + 1), dtype=np.int64), wave=np.zeros((WIDTH, size), dtype=np.int64),
        row=np.zeros((WIDTH, size)), reach=np.zeros(max(flight.reach.size for flight in kinds)),
        taken=np.zeros((WIDTH, 2), dtype=np.int64), open=np.zeros(WIDTH, dtype=np.int64), pairs=no_pairs(), **arrays,
    )  # fmt: skip


def _kept(jobs: Sequence[Job]) -> BatchSamples:
    from contact.loop.batch.waves import BatchSamples

    rows, size = max(job.steps // job.record.every + 1 for job in jobs), max(job.run.size for job in jobs)
    states = max(job.steps // job.record.state_every + 1 if job.record.state_every else 0 for job in jobs)
    arrays: dict[str, Any] = {name: np.zeros((WIDTH, rows)) for name in ("time", "force", "gap", "impulse")}
    arrays |= {name: np.zeros((2, WIDTH), dtype=np.int64) for name in ("due", "every", "filled")}
    return BatchSamples(state_time=np.zeros((WIDTH, states)), state=np.zeros((WIDTH, states, size)), **arrays)
