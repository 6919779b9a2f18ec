"""What a run stores: how often, and the buffers one chunk of steps fills."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from contact.errors import InputError
from contact.model.arrays import Array, Indices

MOST_SAMPLES = 1_000_000  # what a run stores when nobody says how often


@dataclass(frozen=True, slots=True, kw_only=True)
class Record:
    """Store force, gap and impulse every `every` steps, and all displacements every `state_every` (0: never).

    Impulse, intervals, penetration, residual and energy are summed at every step whatever is stored.

    >>> Record(every=10, state_every=100)
    Record(every=10, state_every=100)
    """

    every: int = 1
    state_every: int = 0

    def __post_init__(self) -> None:
        if self.every < 1:
            raise InputError(f"every: found {self.every!r}, expected a whole number >= 1")
        if self.state_every < 0 or self.state_every % self.every:
            raise InputError(
                f"state_every: found {self.state_every!r}, expected 0 or a multiple of every = {self.every}"
            )


def sparse(steps: int) -> Record:
    """Return the densest record of a run of `steps` steps that stores at most MOST_SAMPLES.

    >>> sparse(1_000_000), sparse(2_000_001)
    (Record(every=1, state_every=0), Record(every=3, state_every=0))
    """
    return Record(every=max(1, -(-steps // MOST_SAMPLES)))


class Samples(NamedTuple):
    """Buffers of one chunk: K contacts, N coordinates.

    An event closes (1) or opens (0) a contact, or begins (3) or ends (2) its sticking.
    """

    every: int
    state_every: int
    time: Array
    force: Array  # (samples, K)
    gap: Array  # (samples, K)
    impulse: Array  # (samples, K), up to half a step after the sample
    state_time: Array
    state: Array  # (states, N)
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

    def real() -> Array:
        return np.zeros(contacts)

    def whole() -> Indices:
        return np.zeros(contacts, dtype=np.int64)

    return Tally(
        impulse=real(), work=real(), rotation=real(), friction=real(), damping=np.zeros(1),
        external=np.zeros(1), algorithmic=np.zeros(1), peak=real(),
        penetration=real(), residual=real(), closed=whole(), stuck=whole(), contact_steps=whole(), reversals=whole(),
        filled=np.zeros(3, dtype=np.int64),
    )  # fmt: skip


def samples(record: Record, steps: int, contacts: int, size: int) -> Samples:
    """Buffers that hold whatever `steps` steps can produce."""
    rows = steps // record.every + 1
    states = steps // record.state_every + 1 if record.state_every else 0
    events = 2 * steps * contacts  # a contact opens or closes, and begins or ends to stick
    return Samples(
        every=record.every, state_every=record.state_every, time=np.zeros(rows),
        force=np.zeros((rows, contacts)), gap=np.zeros((rows, contacts)), impulse=np.zeros((rows, contacts)),
        state_time=np.zeros(states), state=np.zeros((states, size)),
        event_contact=np.zeros(events, dtype=np.int64), event_kind=np.zeros(events, dtype=np.int64),
        event_time=np.zeros(events),
    )  # fmt: skip
