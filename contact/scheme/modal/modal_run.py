"""A modal run: the part that all laws share for the same exact propagation. A law adds its loop and its outputs."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from contact.base.arrays import Array, Indices
from contact.io.trust import Flag
from contact.model.gaps.modal_system import ModalSystem
from contact.record.energy import Stored
from contact.record.record import Samples, Tally
from contact.scheme.protocol import Block, Motion, Notes, PlainStepper, window

if TYPE_CHECKING:
    from contact.loop.modal.modal import EnergyState, ModalState


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class ModalRun(PlainStepper):
    """Modes of `system` under one law: its compiled loop, and functions for energy, velocity and failures."""

    system: ModalSystem
    dt: float
    sums: Tally
    label: str
    state: ModalState | EnergyState
    loop: Callable[[Tally, Samples, int, int], int]
    energy: Callable[[], Stored]
    velocity: Callable[[], Array]
    failure: Callable[[], Flag]
    steps: Indices  # taken so far, one entry
    gives_way: tuple[Any, ...] = ()  # state of a force-depth law
    slow: Callable[[], tuple[Flag, ...]] = tuple  # whether the step is too long for it

    @property
    def window(self) -> float:
        """Period of the highest mode [s]."""
        return window(float(self.system.omega.max(initial=0.0)), self.dt)

    @property
    def size(self) -> int:
        """Number of modes."""
        return self.system.omega.size

    @property
    def blocks(self) -> tuple[Block, ...]:
        """Name, first mode and one past the last mode of each body."""
        first = self.system.first.tolist()
        return tuple(zip(self.system.names, first[:-1], first[1:], strict=True))

    def advance(self, out: Samples, first: int, steps: int) -> int:
        """Advance by whole steps; returns -1, or the step that failed."""
        failed = self.loop(self.sums, out, first, steps)
        self.steps[0] = first + steps if failed < 0 else failed
        return failed

    @property
    def memory(self) -> tuple[Any, ...]:
        """Arrays that a step changes: state, sums and data of a force-depth law."""
        return self.state, self.sums, self.steps, self.gives_way

    def notes(self) -> Notes:
        """Flag if the step is too long for the law."""
        return Notes(flags=self.slow())

    def why(self) -> Flag:
        """Explain a failed step."""
        return self.failure()

    def stored(self) -> Stored:
        """Energy now."""
        return self.energy()

    def motions(self) -> tuple[Motion, ...]:
        """Mean velocity and momentum of each body from its mode of frequency zero; NaN without one."""
        return rigid_motions(self.blocks, self.system.masses, self.system.omega, self.velocity())


def rigid_motions(
    blocks: tuple[Block, ...], masses: tuple[float, ...], omega: Array, velocity: Array
) -> tuple[Motion, ...]:
    """Mean velocity and momentum of each body from its mode of frequency zero; NaN without one."""
    found = []
    for b, ((name, first, end), mass) in enumerate(zip(blocks, masses, strict=True)):
        rigid = omega[first:end] == 0.0
        speed = math.nan
        if mass > 0.0 and np.count_nonzero(rigid) == 1:
            speed = float(np.sum(velocity[first:end][rigid])) / math.sqrt(mass)
        found.append(Motion(kind=name, number=b, mean_velocity=speed, momentum=speed * mass))
    return tuple(found)
