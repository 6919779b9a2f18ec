"""Phases of a plant, computed when a motion first enters them, and their arrays for the compiled passage."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from contact.base.arrays import Array
from contact.base.errors import NumericsError
from contact.cycles.switched import Complex, Drive, Forcing, Phase, Plant, phase_of, pulls

Closed = tuple[int, ...]
EVENTS = 4000  # in one period: more are chatter
ROOM = 4  # phases at first
PADDED = -1.0  # pole [1/s] that fills up phases with fewer of them


class DrivenPhase(NamedTuple):
    """A phase under a drive."""

    phase: Phase
    b: Forcing  # of x, the contacts' share included
    watched: Forcing
    X: Complex  # x of the forced vibration, (n, harmonics)


class Known:
    """Phases of a plant met so far, in the arrays of the compiled passage, and their forcing under the last drive."""

    __slots__ = ("arrays", "bundle", "drive", "numbers", "phases", "plant")

    def __init__(self, plant: Plant) -> None:
        self.plant = plant
        self.phases: list[Phase] = []
        self.numbers: dict[Closed, int] = {}
        self.drive: Drive | None = None
        self.arrays: Any = None
        self.bundle: Any = None

    def __reduce__(self) -> tuple[type[Known], tuple[Plant]]:
        """A copy begins without phases, because addresses of arrays are valid only in one process."""
        return Known, (self.plant,)

    def number(self, closed: Closed) -> int:
        """Number of the phase with these contacts closed; raises as `phase_of`."""
        found = self.numbers.get(closed)
        if found is None:
            phase = phase_of(self.plant, closed)
            found = self.numbers[closed] = len(self.phases)
            self.phases.append(phase)
            if self.arrays is not None:
                self._add(phase, found)
        return found

    @property
    def open_phase(self) -> Phase:
        """The phase without closed contacts."""
        return self.phases[self.number(())]

    def under(self, drive: Drive) -> Any:
        """The bundle of the compiled passage under a drive."""
        from contact.jit.bundle import bundled

        if self.arrays is None or self.arrays.drive.harmonic.size != drive.harmonics.size:
            self.drive = None
            self.number(())
            self._make(ROOM, drive.harmonics.size)
            self.bundle = bundled(self.arrays)
        if self.drive is not drive:
            self._take(drive)
        return self.bundle

    def driven(self, closed: Closed, drive: Drive) -> DrivenPhase:
        """A phase under a drive; raises NumericsError at resonance."""
        from contact.loop.period import DONE, drive_alone

        number = self.number(closed)
        if drive_alone(self.under(drive), number) != DONE:
            raise resonance()
        d = self.arrays.drive
        return DrivenPhase(
            self.phases[number], Forcing(d.drive_rest[number].copy(), _joined(d.drive_wave[number])),
            Forcing(d.rest[number].copy(), _joined(d.wave[number])), _joined(d.X[number]),
        )  # fmt: skip

    def closed_of(self, number: int) -> Closed:
        """Contacts closed in a phase."""
        return self.phases[number].closed

    def _take(self, drive: Drive) -> None:
        table, before = self.arrays.drive, self.drive
        table.harmonic[:], table.base[0] = drive.w * drive.harmonics, drive.w
        table.made[:] = 0
        self.drive = drive
        if before is not None and drive.b is before.b and drive.c is before.c and drive.d is before.d:
            if not self.plant.rigid.any():
                return  # at another frequency alone
        pulled, moved = pulls(self.plant, drive), drive.b.seen(self.plant.gap_rates)
        table.reach[:] = (np.abs(moved.rest) + np.abs(moved.wave).sum(axis=1)) / drive.w**2
        table.b_rest[:], table.pull_rest[:] = drive.b.rest, pulled.rest
        k = drive.c.rest.size
        table.watched_rest[:k], table.watched_rest[k:] = drive.c.rest, drive.d.rest
        waves = {"b": drive.b, "pull": pulled, "c": drive.c, "d": drive.d}
        places = {
            "b": table.b_wave, "pull": table.pull_wave, "c": table.watched_wave[:, :k], "d": table.watched_wave[:, k:]
        }  # fmt: skip
        for name, into in places.items():
            wave = waves[name].wave
            into[0], into[1] = wave.real, wave.imag

    def _make(self, room: int, harmonics: int) -> None:
        """Arrays with space for more phases, filled with the known ones; a passage in progress continues in them."""
        from contact.loop.period_arrays import PlantArrays, period_of, phase_table

        plant, before = self.plant, self.arrays
        (k, n), m = plant.C.shape, max(phase.lam.size for phase in self.phases)
        S = plant.S[~plant.rigid][:, ~plant.rigid]
        fixed = PlantArrays(
            push=np.ascontiguousarray(plant.B), shift=plant.shift, gaps=np.ascontiguousarray(plant.C),
            rigid=plant.rigid.astype(np.int64), slips=np.array(plant.slips, dtype=np.int64).reshape(-1, 2),
            coupled=np.array([np.any(S != np.diag(np.diag(S)))], dtype=np.int64),
        )  # fmt: skip
        table = phase_table(k, n, k + len(plant.D), max(room, len(self.phases)), m, fixed)
        self.arrays = period_of(table, harmonics, EVENTS)
        for number, phase in enumerate(self.phases):
            self._fill(phase, number)
        if before is not None and self.drive is not None:
            work, drive = self.arrays.work, self.drive
            self.arrays = self.arrays._replace(work=before.work._replace(half=work.half, sides=work.sides))
            self.drive = None
            self._take(drive)

    def _add(self, phase: Phase, number: int) -> None:
        """Add a phase."""
        from contact.jit.bundle import bundled

        room, _, m = self.arrays.phases.lam.shape
        if number < room and phase.lam.size <= m:
            self._fill(phase, number)
            return
        self._make(2 * room, self.arrays.drive.harmonic.size)
        self.bundle = bundled(self.arrays)

    def _fill(self, phase: Phase, number: int) -> None:
        table, m, chosen = self.arrays.phases, phase.lam.size, list(phase.closed)
        table.closed[number] = 0
        table.closed[number, chosen] = 1
        table.lam[number, 0], table.lam[number, 1] = PADDED, 0.0
        seen = phase.rows @ phase.V
        for part, of in enumerate((np.real, np.imag)):
            table.lam[number, part, :m], table.V[number, part, :, :m] = of(phase.lam), of(phase.V)
            table.U[number, part, :m], table.seen[number, part, :, :m] = of(phase.U), of(seen)
        table.rows[number] = phase.rows
        table.solve[number][np.ix_(chosen, chosen)] = phase.solve
        table.known[0] = number + 1


def resonance() -> NumericsError:
    """The error at an undamped mode's resonance."""
    return NumericsError("found a drive at the resonance of an undamped mode, expected damping or another frequency")


def _joined(parts: Array) -> Complex:
    return np.asarray(parts[0] + 1j * parts[1])
