"""Result of a continuation: branches of orbits and special points; as a table, JSON and npz."""

from __future__ import annotations

import os
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np

from contact.cycles.columns import point_columns
from contact.cycles.shooting import Orbit
from contact.io.brief import brief
from contact.io.columns import Columns, records_of
from contact.io.outfiles import finite
from contact.io.reported import Reported
from contact.io.stored import save_value

FORMAT = "casingfem-cycles-1"
FEW = 4  # grazing points that are listed one by one


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Special:
    """A special point of a branch: "fold", "flip", "Neimark-Sacker", "branch point" or "grazing".

    `orbit` is the first orbit after the change, `before` the last one before it, 1e-5 of a step apart.

    >>> import contact as ct
    >>> mass = ct.ModalBody(omega=[1.0], zeta=[0.025], channels=("x", "stop"), rows=[[1.0], [-1.0]], S=np.zeros((2, 2)))
    >>> patch = ct.Patch(body=mass, normal=("stop",), clearance=0.1)
    >>> driven = ct.cycles.DrivenBody(patch=patch, channel="x", amplitude=0.02, stiffness=100.0, shown=("x",))
    >>> before, after = (ct.cycles.orbit(driven.over("freq_hz", freq_hz=0.1), at) for at in (0.100, 0.101))
    >>> Special(kind="fold", orbit=after, before=before).orbit.value
    0.101
    """

    kind: str
    orbit: Orbit
    before: Orbit

    __repr__ = brief


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Branch:
    """Orbits in the order of the branch, its special points, and why it ended inside the range, if it did.

    >>> import numpy as np
    >>> import contact as ct
    >>> mass = ct.ModalBody(omega=[1.0], zeta=[0.025], channels=("x", "stop"), rows=[[1.0], [-1.0]], S=np.zeros((2, 2)))
    >>> patch = ct.Patch(body=mass, normal=("stop",), clearance=0.1)
    >>> driven = ct.cycles.DrivenBody(patch=patch, channel="x", amplitude=0.02, stiffness=100.0, shown=("x",))
    >>> points = [ct.cycles.orbit(driven.over("freq_hz", freq_hz=0.1), at) for at in (0.10, 0.11)]
    >>> Branch(points=tuple(points), specials=()).value.tolist()
    [0.1, 0.11]
    """

    points: tuple[Orbit, ...]
    specials: tuple[Special, ...]
    end: str = ""

    __repr__ = brief

    @property
    def value(self) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
        """Parameter of each point."""
        return np.array([point.value for point in self.points])

    @property
    def stable(self) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
        """Whether each point is stable."""
        return np.array([point.stable for point in self.points])

    @property
    def multiplier(self) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
        """Largest |Floquet multiplier| of each point."""
        return np.array([point.multiplier for point in self.points])

    def amplitude(self, channel: str) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
        """Amplitude of a channel at each point [m]."""
        return np.array([point.amplitude[channel] for point in self.points])

    def of(self, kind: str) -> tuple[Special, ...]:
        """Special points of one kind."""
        return tuple(special for special in self.specials if special.kind == kind)

    @property
    def stretches(self) -> tuple[tuple[bool, float, float], ...]:
        """Intervals of stable and unstable orbits with their parameter values, in the order of the branch."""
        spans = [(kept, list(part)) for kept, part in groupby(self.points, key=lambda point: point.stable)]
        return tuple((kept, part[0].value, part[-1].value) for kept, part in spans)


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Cycles(Reported):
    """Branches of periodic orbits over a parameter: the branch that was followed first, then the branches from it.

    >>> import contact as ct
    >>> mass = ct.ModalBody(omega=[1.0], zeta=[0.025], channels=("x", "stop"), rows=[[1.0], [-1.0]], S=np.zeros((2, 2)))
    >>> patch = ct.Patch(body=mass, normal=("stop",), clearance=0.1)
    >>> driven = ct.cycles.DrivenBody(patch=patch, channel="x", amplitude=0.02, stiffness=100.0, shown=("x",))
    >>> points = tuple(ct.cycles.orbit(driven.over("freq_hz", freq_hz=0.1), at) for at in (0.10, 0.11))
    >>> found = Cycles(name="freq_hz", branches=(Branch(points=points, specials=()),))  # as `ct.cycles.follow` returns
    >>> [row["freq_hz"] for row in found.records()]
    [0.1, 0.11]
    """

    name: str
    branches: tuple[Branch, ...]
    seconds: float = 0.0

    def __repr__(self) -> str:
        lines = []
        for number, part in enumerate(self.branches, 1):
            first = part.points[0]
            times = "" if first.periods == 1 else f", repeating after {first.periods} periods"
            lines.append(f"branch {number}: {len(part.points)} orbits over {self.name}{times}")
            for kept, start, stop in part.stretches:
                lines.append(f"  {'stable' if kept else 'UNSTABLE':8} {start:.8g} to {stop:.8g}")
            grazings = len(part.of("grazing"))
            for special in part.specials:
                if special.kind == "grazing" and grazings > FEW:
                    continue
                size = ", ".join(f"{name} {value:.6g} m" for name, value in special.orbit.amplitude.items())
                lines.append(f"  {special.kind} at {special.orbit.value:.8g}: {size}")
            if grazings > FEW:
                lines.append(f"  {grazings} grazing events: a contact begins or ceases to close")
            if part.end:
                lines.append(f"  ends at {part.points[-1].value:.8g}: {part.end}")
        return "\n".join(lines)

    def described(self) -> Columns:
        """The columns of the points: the parameter and the channels have names of the scene."""
        return point_columns(self.name, tuple(self.branches[0].points[0].amplitude))

    def records(self) -> list[dict[str, Any]]:
        """One plain dictionary for each point, branch by branch."""
        points = [(number, point) for number, part in enumerate(self.branches, 1) for point in part.points]
        return records_of(self.described(), points)

    def marks(self) -> list[dict[str, object]]:
        """One row for each special point: kind, branch, parameter and amplitudes."""
        return [
            {"kind": special.kind, "branch": number, self.name: special.orbit.value,
             **{f"amplitude_{name}": size for name, size in special.orbit.amplitude.items()}}
            for number, part in enumerate(self.branches, 1)
            for special in part.specials
        ]  # fmt: skip

    def to_dict(self) -> dict[str, object]:
        """The document of `casingfem cycles --json`: the first branch, then the others."""
        main, *others = self.branches
        return {
            "parameter": self.name, **self._branch(main),
            "branches": [{"periods": part.points[0].periods, **self._branch(part)} for part in others],
            "seconds": self.seconds,
        }  # fmt: skip

    def _branch(self, part: Branch) -> dict[str, object]:
        folds = [self._point(special.orbit) for special in part.of("fold")]
        return {
            "points": [self._point(point) for point in part.points], "folds": folds,
            "events": [{"kind": special.kind, **self._point(special.orbit)} for special in part.specials],
            "end": part.end,
        }  # fmt: skip

    def _point(self, point: Orbit) -> dict[str, object]:
        return {
            self.name: point.value, "amplitude": point.amplitude, "multiplier": point.multiplier,
            "growth_1_s": finite(point.growth), "stable": point.stable, "contacts": point.contacts,
        }  # fmt: skip

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write an npz file without pickle.

        States, multipliers and amplitudes of all points are separate arrays for other programs.
        """
        points = [point for part in self.branches for point in part.points]
        specials = [(number, special) for number, part in enumerate(self.branches, 1) for special in part.specials]
        return save_value(path, self, {
            "format": FORMAT, "parameter": self.name, "channels": np.array(list(points[0].amplitude)),
            "branch": np.array([n for n, part in enumerate(self.branches, 1) for _ in part.points]),
            "value": np.array([p.value for p in points]), "period": np.array([p.period for p in points]),
            "start": np.array([p.start for p in points]), "x": np.array([p.x for p in points]),
            "multipliers": np.array([p.multipliers for p in points]),
            "amplitude": np.array([list(p.amplitude.values()) for p in points]),
            "gap": np.array([p.gap for p in points]), "force": np.array([p.force for p in points]),
            "special": np.array([special.kind for _, special in specials], dtype=np.str_),
            "special_branch": np.array([number for number, _ in specials], dtype=np.int64),
            "special_value": np.array([special.orbit.value for _, special in specials]),
        })  # fmt: skip
