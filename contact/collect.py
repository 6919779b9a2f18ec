"""Combine the samples of all chunks and the sums of a run into its result."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contact.base.arrays import Array, readonly
from contact.record.energy import EnergyBudget
from contact.record.record import Record, Samples
from contact.result import Intervals, Result, coordinates_and_forces
from contact.scheme.protocol import Stepper
from contact.version import versions


def collect(
    stepper: Stepper, parts: Sequence[Samples], energy: EnergyBudget, steps: int, seconds: float,
    source: dict[str, str], record: Record,
) -> Result:  # fmt: skip
    """Join the samples of all chunks with the sums of the run."""
    sums = stepper.sums

    def joined(name: str) -> Array:
        found = [getattr(part, name) for part in parts]
        if len(found) == 1:
            return readonly(found[0])
        whole = np.concatenate(found)  # a copy by itself
        whole.setflags(write=False)
        return whole

    contact, kind, when = joined("event_contact"), joined("event_kind"), joined("event_time")
    end = steps * stepper.dt
    here = [contact == k for k in range(sums.closed.size)]
    intervals = tuple(_intervals(kind[own], when[own], end) for own in here)
    sticking = tuple(_intervals(kind[own] - 2.0, when[own], end) for own in here) if np.any(kind > 1.0) else ()
    return Result(
        time=joined("time"), force=joined("force"), gap=joined("gap"), impulse_history=joined("impulse"),
        intervals=intervals, sticking=sticking, impulse=readonly(sums.impulse), peak_force=readonly(sums.peak),
        max_penetration=readonly(np.maximum(sums.penetration, 0.0)), residual=readonly(sums.residual),
        contact_steps=readonly(sums.contact_steps), reversals=readonly(sums.reversals),
        state_time=joined("state_time"), energy=energy,
        motions=tuple(sorted(stepper.motions(), key=lambda m: (m.kind == "rod", m.number))),
        **coordinates_and_forces(joined("state"), stepper.blocks, whole=record.channels is None),
        steps=steps, dt=stepper.dt, window=stepper.window, seconds=seconds,
        scheme=stepper.label,
        source={**versions(), **source}, every=record.every if record.at is None else 0,
        channels=readonly(record.rows(stepper.size)), tracks=stepper.wear(),
        notes=stepper.notes(),
    )  # fmt: skip


def _intervals(kind: Array, time: Array, end: float) -> Intervals:
    """Pair closing times with opening times; a contact that is still closed ends with the run."""
    starts, ends = time[kind == 1].tolist(), time[kind == 0].tolist()
    if len(ends) < len(starts):
        ends.append(end)
    return tuple((a, max(a, b)) for a, b in zip(starts, ends, strict=True))
