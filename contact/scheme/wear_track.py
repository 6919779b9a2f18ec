"""The coating of a run: bars made from the law, a map of their wear over time, and the reading at the end."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from contact.errors import InputError
from contact.model.arrays import Array
from contact.model.law import Abradable
from contact.model.modal_system import ModalSystem
from contact.wear import Wear

if TYPE_CHECKING:
    from contact.solver.abradable import Coating

MOST_MAPS = 400  # stored maps: beyond, every second one is dropped
FIRST_EVERY = 100  # steps between maps at first


def bare() -> Coating:
    """No coating."""
    from contact.solver.abradable import Coating

    return Coating(np.zeros(0), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1, np.zeros(3))


@dataclass(eq=False, slots=True, kw_only=True)
class Track:
    """Bars under way: `coating` is what the compiled loop changes, `maps` their worn depths at steps so far."""

    law: Abradable
    coating: Coating
    made: Array
    area: float  # of one bar [m^2]
    every: int = FIRST_EVERY
    maps: list[tuple[float, Array]] = field(default_factory=list)

    @staticmethod
    def of(system: ModalSystem, law: Abradable) -> Track:
        """The coating of a rim as it leaves the machine.

        Raises InputError when the tip is longer than a quarter of the rim.
        """
        from contact.solver.abradable import Coating

        if law.tip > 0.5 * math.pi * system.radius:
            raise InputError(f"tip: found {law.tip:g} m, expected at most a quarter of the rim of {system.radius:g} m")
        cells = round(2.0 * math.pi * system.radius * law.bars / law.tip)
        angle = _angles(cells)
        mean = float(system.clearance.cos[system.clearance.harmonic == 0].sum())
        made = np.array([system.clearance(float(phi)) for phi in angle]) - mean
        area = law.width * 2.0 * math.pi * system.radius / cells
        circle = float(made.min()) + law.machined if law.machined else -math.inf
        coating = Coating(
            worn=np.zeros(cells), round=circle, mean=mean, thickness=law.thickness,
            stiffness=law.E * area / law.thickness, yield_force=law.yield_stress * area,
            hardening=law.hardening * area / law.thickness, under=law.bars, memory=np.zeros(3),
        )  # fmt: skip
        return Track(law=law, coating=coating, made=made, area=area)

    @property
    def elastic(self) -> float:
        """Energy that the bars under the tip would give back now [J]."""
        return float(self.coating.memory[1])

    def watch(self, h: float, first: int, steps: int, loop: Callable[[int, int], int]) -> int:
        """Run the loop, keeping a map every so many steps; -1, or the step that failed."""
        start, end = first, first + steps
        while start < end:
            stop = min(end, (start // self.every + 1) * self.every)
            failed = loop(start, stop - start)
            if failed >= 0:
                return failed
            start = stop
            if start % self.every == 0:
                self.maps.append((start * h, self.coating.worn.copy()))
                if len(self.maps) > MOST_MAPS:
                    self.maps, self.every = self.maps[1::2], 2 * self.every
        return -1 if steps else loop(first, 0)

    def wear(self) -> Wear:
        """What was lost so far."""
        worn, law = self.coating.worn, self.law
        cut = np.maximum(self.coating.round - self.made, 0.0)
        times = [time for time, _ in self.maps]
        return Wear(
            angle=_angles(worn.size), made=self.made, cut=cut, worn=worn, map_time=np.array(times),
            map=np.array([depth for _, depth in self.maps]).reshape(len(times), worn.size),
            volume=self.area * float(worn.sum()), dissipated=float(self.coating.memory[0]),
            stated=self.area * float(np.sum(law.dissipated(worn))),
            bare=int(np.count_nonzero(worn >= law.thickness - cut)),
        )  # fmt: skip


def _angles(cells: int) -> Array:
    """Middle of each bar [rad], (cells,)."""
    return 2.0 * np.pi * (np.arange(cells) + 0.5) / cells
