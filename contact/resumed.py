"""The state of a run between two calls of its loop, from which it continues with identical bits."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from contact.base.arrays import Array
from contact.base.errors import InputError
from contact.half_step import Mark
from contact.io.stored import Packing, StoredError
from contact.record.energy import EnergyBudget
from contact.record.record import Samples
from contact.scheme.protocol import Stepper
from contact.version import versions


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Moment:
    """A run after `taken` steps: arrays of its stepper, samples so far, elapsed seconds, energies after the first call.

    `asked` is the digest of its run.
    """

    asked: str
    taken: int
    seconds: float
    memory: tuple[Array, ...]
    samples: tuple[Samples, ...]
    calm: EnergyBudget | None
    marks: tuple[Mark, ...] = ()


def arrays_in(memory: Any) -> Iterator[Array]:
    """Yield the writable arrays in nested tuples, in order."""
    if isinstance(memory, np.ndarray):
        if memory.flags.writeable:
            yield memory
    elif isinstance(memory, tuple):
        for part in memory:
            yield from arrays_in(part)


def asked(stepper: Stepper, *decisive: Any) -> str:
    """Digest of a run at t = 0: all input that decides it, step, arrays of its stepper, versions. Raises InputError.

    The error names a part of the problem that cannot be stored, such as a function.
    """
    packing = Packing()
    try:
        document = packing.packed(decisive, "")
    except StoredError as error:
        raise InputError(
            f"checkpoint: found {error}, which cannot be compared after a stop: run without a checkpoint"
        ) from error
    text = json.dumps([document, stepper.label, stepper.dt, versions()], sort_keys=True)
    digest = hashlib.sha256(text.encode())
    for array in (*packing.arrays.values(), *arrays_in(stepper.memory)):
        digest.update(str((array.dtype, array.shape)).encode())
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()


def moment(stepper: Stepper, asked: str, parts: list[Samples], taken: int, seconds: float,
           calm: EnergyBudget | None, marks: Sequence[Mark] = ()) -> Moment:  # fmt: skip
    """Copy the current state of a run."""
    memory = tuple(array.copy() for array in arrays_in(stepper.memory))
    return Moment(
        asked=asked, taken=taken, seconds=seconds, memory=memory, samples=tuple(parts), calm=calm, marks=tuple(marks)
    )


def restored(stepper: Stepper, at: Moment) -> None:
    """Set a stepper at t = 0 to a stored state of its run."""
    for array, kept in zip(arrays_in(stepper.memory), at.memory, strict=True):
        np.copyto(array, kept, casting="no")
