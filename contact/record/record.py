"""Storage of a run: how often or when, which combinations of coordinates, and the buffers for one chunk of steps."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from contact.base.arrays import Array, Indices, readonly, require_count
from contact.base.errors import InputError
from contact.io.brief import brief
from contact.io.keys import Key

MOST_SAMPLES = 1_000_000  # samples that a run stores by default
STATES = 2048  # states that a modal run stores by default, with at most STATE_NUMBERS numbers
STATE_NUMBERS = 4_000_000
BUFFER = 8_000_000  # numbers that the buffers of one chunk may contain, 64 MB
NO_STEPS = np.zeros(0, dtype=np.int64)


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Record:
    """Store force, gap and impulse every `every` steps, and displacements u every `state_every` (0: never).

    `at` [s] instead: samples and displacements at the steps nearest to these times, nothing between. No value is
    interpolated; each has the time of its own step. `channels` R (c, N): R u is stored in place of u. Impulse,
    intervals, penetration, residual and energy are summed at every step whatever is stored.

    Raises InputError for counts that are not whole or below one, both `at` and `every`, channels that are not
    a finite matrix.

    >>> Record(every=10, state_every=100).every
    10
    >>> Record(at=[0.1, 0.26], channels=[[1.0, -1.0]]).steps(dt=0.1, count=5).tolist()
    [1, 3]
    """

    every: Annotated[int, Key("number of steps from one stored sample to the next")] = 1
    state_every: Annotated[int, Key("number of steps from one stored state to the next; 0 for no states", least=0)] = 0
    at: ArrayLike | None = None
    channels: ArrayLike | None = None

    __repr__ = brief

    def __post_init__(self) -> None:
        if self.at is not None:
            self._require_instants()
        if self.channels is not None:
            rows = readonly(np.atleast_2d(np.asarray(self.channels, dtype=float)))
            if rows.ndim != 2 or rows.size == 0 or not np.isfinite(rows).all():
                raise InputError(f"channels: found shape {rows.shape}, expected finite rows, one for each channel")
            if self.at is None and self.state_every == 0:
                raise InputError("channels: found neither state_every nor at, expected one of them with channels")
            object.__setattr__(self, "channels", rows)
        require_count(every=self.every)
        require_count(0, state_every=self.state_every)
        if self.state_every % self.every:
            expected = f"0 or a multiple of every = {self.every}"
            raise InputError(f"state_every: found {self.state_every!r}, expected {expected}")

    def _require_instants(self) -> None:
        instants = readonly(np.atleast_1d(np.asarray(self.at, dtype=float)))
        if instants.ndim != 1 or instants.size == 0 or not np.isfinite(instants).all() or instants.min() < 0.0:
            raise InputError(f"at: found {self.at!r}, expected instants >= 0 [s]")
        if self.every != 1 or self.state_every:
            raise InputError("at: found with every or state_every, expected only at")
        object.__setattr__(self, "at", instants)

    def steps(self, *, dt: float, count: int) -> Indices:
        """Steps n nearest to the requested times, n dt, ascending, each once; empty without `at`.

        Raises InputError for times beyond the run of `count` steps.
        """
        if self.at is None:
            return NO_STEPS
        instants = np.asarray(self.at)
        if instants.max() > count * dt * (1.0 + 1e-9):
            raise InputError(f"at: found {instants.max():g} s, expected at most {count * dt:g} s, the end of the run")
        return np.unique(np.minimum(np.rint(instants / dt), count - 1).astype(np.int64))

    def rows(self, coordinates: int) -> Array:
        """Channel rows (c, N), None if whole displacements are stored; raises InputError unless N fits."""
        if self.channels is None:
            return readonly(np.zeros((0, coordinates)))  # as channels are: the same type compiles once
        rows = np.asarray(self.channels)
        if rows.shape[1] != coordinates:
            expected = f"{coordinates}, one for each coordinate of the run"
            raise InputError(f"channels: found rows of {rows.shape[1]} numbers, expected {expected}")
        return rows

    def chunk(self, contacts: int, coordinates: int) -> int:
        """Steps whose buffers fit into BUFFER numbers, at least one."""
        width = coordinates if self.channels is None else len(np.asarray(self.channels))
        stored = 1.0 + 3.0 * contacts, 1.0 + width
        events = 6.0 * contacts
        if self.at is None:
            a_step = events + stored[0] / self.every + (stored[1] / self.state_every if self.state_every else 0.0)
        else:
            a_step = events + sum(stored)
        return max(1, int(BUFFER / a_step))


def sparse(steps: int, modes: int = 0) -> Record:
    """The densest record of a run of `steps` steps that stores at most MOST_SAMPLES.

    For a modal run it also stores about STATES states, at an interval that is no multiple of a turn or a period.

    >>> sparse(1_000_000).every, sparse(2_000_001).every, sparse(100_000, 70).state_every
    (1, 3, 47)
    """
    every = max(1, -(-steps // MOST_SAMPLES))
    if not modes:
        return Record(every=every)
    states = max(1, min(STATES, STATE_NUMBERS // modes))
    return Record(every=every, state_every=every * prime_stride(max(1, steps // every), states))


@cache
def prime_stride(steps: int, states: int) -> int:
    """Largest prime stride that still stores at least this many of the steps.

    >>> prime_stride(20_000, 256), prime_stride(100, 256)
    (73, 1)
    """
    stride = max(1, steps // states)
    while stride > 3 and any(stride % k == 0 for k in range(2, math.isqrt(stride) + 1)):
        stride -= 1
    return stride


class Samples(NamedTuple):
    """Buffers of one chunk: K contacts, N coordinates, c channels.

    The steps `at` are stored, or every `every`-th one if that is not 0. An event closes (1) or opens (0) a contact, or
    begins (3) or ends (2) its sticking.
    """

    every: int
    state_every: int
    at: Indices  # steps of this chunk, ascending
    rows: Array  # (c, N), empty when the state is stored whole
    time: Array
    force: Array  # (samples, K)
    gap: Array  # (samples, K)
    impulse: Array  # (samples, K), up to half a step after the sample
    state_time: Array
    state: Array  # (states, N or c)
    event_contact: Indices
    event_kind: Indices
    event_time: Array


class Tally(NamedTuple):
    """Sums over all steps so far, one entry per contact. Work is positive when it enters the bodies."""

    impulse: Array
    work: Array  # along the gap: minus what impacts lose
    rotation: Array  # by the moving contact point
    friction: Array
    damping: Array  # (1,)
    external: Array  # (1,), by loads that vary in time
    body_force: Array  # (1,), by gravity on what turns, and by frames that whirl
    algorithmic: Array  # (1,), the scheme's own gain, from its formulas
    peak: Array
    penetration: Array
    residual: Array
    closed: Indices
    stuck: Indices
    contact_steps: Indices
    reversals: Indices
    filled: Indices  # (3,): samples, states and events in the present chunk


def tally(contacts: int) -> Tally:
    """Empty sums for this many contacts."""
    whole, one = ("closed", "stuck", "contact_steps", "reversals"), ("damping", "external", "body_force", "algorithmic")
    arrays: dict[str, Any] = {name: np.zeros(1 if name in one else contacts) for name in Tally._fields}
    arrays |= {name: np.zeros(contacts, dtype=np.int64) for name in whole}
    return Tally(**arrays | {"filled": np.zeros(3, dtype=np.int64)})


def samples(record: Record, steps: int, contacts: int, size: int, at: Indices = NO_STEPS) -> Samples:
    """Buffers for the largest output of `steps` steps; `at`: those that `record` stores by time."""
    rows, channels = steps // record.every + 1, record.rows(size)
    states = steps // record.state_every + 1 if record.state_every else 0
    every = record.every
    if record.at is not None:
        every, rows, states = 0, at.size, at.size
    events = 2 * steps * contacts  # a contact opens or closes, and begins or ends to stick; filled as far as read
    return Samples(
        every=every, state_every=record.state_every, at=at, rows=channels, time=np.zeros(rows),
        force=np.zeros((rows, contacts)), gap=np.zeros((rows, contacts)), impulse=np.zeros((rows, contacts)),
        state_time=np.zeros(states), state=np.zeros((states, len(channels) or size)),
        event_contact=np.empty(events, dtype=np.int64), event_kind=np.empty(events, dtype=np.int64),
        event_time=np.empty(events),
    )  # fmt: skip
