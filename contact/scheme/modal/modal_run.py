"""A modal run in progress: what the laws on one exact propagation share. A law brings its loop and its readings."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from contact.base.arrays import Array, Indices, readonly
from contact.io.trust import Flag
from contact.model.gaps.limits import REACHED, RIM, wall_flags
from contact.model.gaps.modal_system import ModalSystem
from contact.model.trig import Terms
from contact.record.energy import Stored
from contact.record.record import Samples, Tally
from contact.record.wear import Wear
from contact.scheme.modal.propagator import window
from contact.scheme.modal.wear_track import Tracks
from contact.scheme.protocol import Block, Motion, Notes

if TYPE_CHECKING:
    from contact.loop.modal.free_flight import FreeFlight
    from contact.loop.modal.modal import EnergyState, ModalState


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class RimRun:
    """What the compiled loop of a rotating rim works on: one run's, or a lane's of many runs at once."""

    state: ModalState  # views of `wide`
    wide: ModalState  # in whole blocks of eight
    mu: float
    reach: Array  # how far each of the casing's modes moves the rim at most
    limits: Array  # of `motion_limits`
    normal: Terms  # what the rows are sums of: Q, clearance, S_nn, S_nt and S_tt
    tangent: Terms
    flight: FreeFlight
    averaged: bool
    damped: bool


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class ModalRun:
    """Modes of `system` under one law: its compiled loop, and how to read energy, velocity and a failure."""

    system: ModalSystem
    dt: float
    sums: Tally
    label: str
    state: ModalState | EnergyState
    loop: Callable[[Tally, Samples, int, int], int]
    energy: Callable[[int], Stored]  # after this many steps
    velocity: Callable[[], Array]
    failure: Callable[[], Flag]
    steps: Indices  # taken so far, one entry
    rim: RimRun | None = None
    tracks: Tracks | None = None
    gives_way: tuple[Any, ...] = ()  # what a force-depth law needs to go on
    slow: Callable[[], tuple[Flag, ...]] = tuple  # whether the step is too long for it

    @property
    def window(self) -> float:
        """Period of the highest mode [s]."""
        return window(float(self.system.omega.max(initial=0.0)), self.dt)

    @property
    def size(self) -> int:
        """Modes, then, on a rim, the forces."""
        return self.system.omega.size + (0 if self.rim is None else 2 if self.rim.mu > 0.0 else 1)

    @property
    def blocks(self) -> tuple[Block, ...]:
        """Name, first and one past the last mode of each body."""
        first = self.system.first.tolist()
        found = tuple(zip(self.system.names, first[:-1], first[1:], strict=True))
        return found if self.rim is None else (*found, ("tips", first[-1], self.size))

    def advance(self, out: Samples, first: int, steps: int) -> int:
        """Advance by whole steps; -1, or the step that failed."""
        failed = self.loop(self.sums, out, first, steps)
        self.steps[0] = first + steps if failed < 0 else failed
        return failed

    @property
    def memory(self) -> tuple[Any, ...]:
        """State, sums, what skipping and limits hold, and the coating."""
        rim = () if self.rim is None else (self.rim.wide, self.rim.limits, self.rim.flight)
        coating = () if self.tracks is None else self.tracks.memory
        return self.state, self.sums, self.steps, rim, coating, self.gives_way

    @property
    def limits(self) -> Array | None:
        """Those of `motion_limits`; a fixed point has none."""
        return None if self.rim is None else self.rim.limits

    @property
    def overlap(self) -> float:
        """How far the tip stands inside the rim now [m]; a fixed point's bodies never overlap."""
        return 0.0 if self.rim is None else max(0.0, -float(self.rim.state.memory[0]))

    def notes(self) -> Notes:
        """How far the rim went; heat and drive of friction."""
        if self.rim is None:
            return Notes(flags=self.slow())
        flags = wall_flags(float(self.rim.limits[REACHED + RIM]), self.system.thickness)
        if not self.rim.mu > 0.0:
            return Notes(flags=flags)
        heat, drive = self.rim.state.memory[8:10]
        return Notes(flags=flags, heat=readonly([heat]), drive=readonly([drive]))

    def wear(self) -> tuple[Wear, ...]:
        """What a coating has lost so far; none without one."""
        return () if self.tracks is None else self.tracks.wear()

    def why(self) -> Flag:
        """Explain a failed step."""
        return self.failure()

    def stored(self) -> Stored:
        """Energy now."""
        return self.energy(int(self.steps[0]))

    def motions(self) -> tuple[Motion, ...]:
        """Mean velocity and momentum of each body from its mode of frequency zero, NaN unless it has one."""
        found, system = [], self.system
        for b, (name, mass) in enumerate(zip(system.names, system.masses, strict=True)):
            modes = slice(int(system.first[b]), int(system.first[b + 1]))
            rigid = system.omega[modes] == 0.0
            speed = math.nan
            if mass > 0.0 and np.count_nonzero(rigid) == 1:
                speed = float(np.sum(self.velocity()[modes][rigid])) / math.sqrt(mass)
            found.append(Motion(kind=name, number=b, mean_velocity=speed, momentum=speed * mass))
        return tuple(found)
