"""Periodic orbits by Newton's method on the map of one period, their Floquet multipliers and amplitudes."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from contact.base.arrays import Array, readonly, require_count, require_finite
from contact.base.errors import InputError, NumericsError
from contact.cycles.driven import Family
from contact.cycles.passage import Motion, Passage, beside, passage
from contact.io.threads import with_one_thread

SETTLED = 1e-9  # of the state: change over a period of a run that has come to rest
HUGE = 1e30  # change over a period of a run that diverges
CLOSE = 1e-8  # of the state: Newton's last step; the error is of the order of its square
REST = 1e-6  # of the guess: a smaller state counts as rest
EVEN = 1e-7  # of a multiplier from 1 in size: without damping it is 1, and rounding moves double ones by 1e-8
SHORT = 1e-3  # of a period: less time without rigid contact is none
NEWTON = 15
HALVINGS = 5


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Orbit:
    """A periodic motion.

    It starts at phase `start` of the forcing and repeats after `periods` of its periods, `period` s.

    `x` is its state there, `multipliers` (n,) the eigenvalues of the derivative of that map; `amplitude` max |u| [m] by
    channel; `gap`, `force` (k,) the least gap [m] and the largest force [N] of each contact, `closings` (k,) how often
    each closes in the period, `rests` (k,) how often a series of ever smaller hits ends; `touching` shows the contacts
    that are closed at the start.

    >>> import contact as ct
    >>> mass = ct.ModalBody(omega=[1.0], zeta=[0.025], channels=("x", "stop"), rows=[[1.0], [-1.0]], S=np.zeros((2, 2)))
    >>> patch = ct.Patch(body=mass, normal=("stop",), clearance=0.1)
    >>> driven = ct.cycles.DrivenBody(patch=patch, channel="x", amplitude=0.02, stiffness=100.0, shown=("x",))
    >>> one = ct.cycles.orbit(driven.over("freq_hz", freq_hz=0.1), 0.1)
    >>> one.stable, round(one.amplitude["x"], 4), one.contacts
    (True, 0.033, 0)
    """

    name: str
    value: float
    period: float
    periods: int
    start: float
    x: Array
    multipliers: NDArray[np.complex128]
    amplitude: dict[str, float]
    gap: Array
    force: Array
    closings: tuple[int, ...]
    rests: tuple[int, ...]
    touching: tuple[int, ...]
    M: Array
    iterations: int
    slope: Array | None = None

    @property
    def multiplier(self) -> float:
        """Largest |Floquet multiplier|; above 1 the orbit is unstable."""
        return float(np.abs(self.multipliers).max())

    @property
    def growth(self) -> float:
        """Growth of a small deviation from the orbit [1/s]: log of the largest |multiplier| over the period."""
        size = self.multiplier
        return math.log(size) / self.period if size > 0.0 else -math.inf

    @property
    def stable(self) -> bool:
        """Whether small deviations from the orbit decay; without damping they do not."""
        return self.multiplier < 1.0 - EVEN

    @property
    def contacts(self) -> int:
        """Number of contacts that touch during the period."""
        return sum(often > 0 or contact in self.touching for contact, often in enumerate(self.closings))

    def twice(self) -> Orbit:
        """The same motion as an orbit of twice the period."""
        return replace(
            self, periods=2 * self.periods, period=2.0 * self.period, M=readonly(self.M @ self.M), slope=None,
            multipliers=self.multipliers**2, closings=tuple(2 * often for often in self.closings),
            rests=tuple(2 * often for often in self.rests),
        )  # fmt: skip

    def __repr__(self) -> str:
        size = ", ".join(f"{name} {value:.6g} m" for name, value in self.amplitude.items())
        kept = "stable" if self.stable else "unstable"
        times = "" if self.periods == 1 else f", repeats after {self.periods} periods"
        return f"orbit at {self.name} {self.value:.8g}{times}: {size}; {kept}, |multiplier| {self.multiplier:.6g}"


class Map(NamedTuple):
    """The map over an orbit's period at one value of the parameter."""

    motion: Motion
    start: float
    period: float

    def __call__(self, x: Array, *, tangent: bool = True) -> Passage:
        """Follow x over one period."""
        return passage(self.motion, x, self.start, self.period, tangent=tangent, extremes=tangent)

    def beside(self, x: Array, found: Passage, period: float) -> Array:
        """The end of x under this map, from the phases `found` that x passes under a nearby map; for differences."""
        end = beside(self.motion, found, x, self.start, self.period / period)
        return self(x, tangent=False).x if end is None else end


def map_of(family: Family, value: float, start: float = 0.0, periods: int = 1) -> Map:
    """The map at a value of the parameter; `start` is a fraction of the forcing's period."""
    motion, period = family.at(value)
    return Map(motion, start * period, periods * period)


@with_one_thread
def orbit(
    family: Family, value: float, *, guess: Array | None = None, start: float | None = None, periods: int = 1,
    settle: int = 200,
) -> Orbit:  # fmt: skip
    """The orbit at a value of the parameter, from a guess of its state at `start`, or from a run over `settle` periods.

    Without a guess the orbit begins where no rigid contact is closed. Raises NumericsError where Newton's method finds
    none: the motion may not be periodic after `periods`, or there is no orbit.

    >>> import contact as ct
    >>> mass = ct.ModalBody(omega=[1.0], zeta=[0.025], channels=("x", "stop"), rows=[[1.0], [-1.0]], S=np.zeros((2, 2)))
    >>> patch = ct.Patch(body=mass, normal=("stop",), clearance=0.1)
    >>> driven = ct.cycles.DrivenBody(patch=patch, channel="x", amplitude=0.02, stiffness=100.0, shown=("x",))
    >>> one = ct.cycles.orbit(driven.over("freq_hz", freq_hz=0.16), 0.16)  # the motion that a run from rest settles on
    >>> one.stable, round(one.amplitude["x"], 3)
    (True, 0.105)
    """
    require_finite(value=value)
    require_count(periods=periods)
    if guess is None:
        guess, start = settled(family, value, settle, periods)
    start = start or 0.0
    map_ = map_of(family, value, start, periods)
    x, iterations = require_state(guess, family, "guess"), 0
    found = map_(x)
    eye, small = np.eye(x.size), REST * float(np.linalg.norm(x))
    while True:
        assert found.M is not None
        change = np.asarray(np.linalg.solve(found.M - eye, x - found.x))
        iterations += 1
        size = float(np.linalg.norm(change))
        if size <= CLOSE * max(float(np.linalg.norm(x)), small) or size == 0.0:
            return made(family, value, map_, periods, start, x + change, found, iterations)
        if iterations > NEWTON:
            raise NumericsError(
                f"{family.name} = {value:.8g}: found no orbit of {periods} periods after {NEWTON} Newton steps; the "
                f"last step is {size / np.linalg.norm(x):.2g} of the state, expected at most {CLOSE:g}: start from "
                "another state, or with another number of periods"
            )
        x, found = _nearer(map_, x, found, change)


def require_state(x: Array, family: Family, name: str) -> Array:
    """Check a state of a family's motion, or the sizes of one; raises InputError for anything else."""
    x = np.asarray(x, dtype=float)
    if x.shape != family.begin.shape:
        expected = f"{family.begin.shape}: displacements, then velocities"
        raise InputError(f"{name}: found shape {x.shape}, expected {expected}")
    if not np.all(np.abs(x) < HUGE):
        raise InputError(f"{name}: found entries that are NaN or infinite or huge, expected numbers below {HUGE:g}")
    return x


def _nearer(map_: Map, x: Array, found: Passage, change: Array) -> tuple[Array, Passage]:
    """Newton's step, halved until the motion repeats better than before; the full step if no half does."""
    before, last = np.linalg.norm(found.x - x), None
    for k in range(HALVINGS):
        trial = x + 0.5**k * change
        try:
            after = map_(trial)
        except NumericsError:
            continue
        if last is None:
            last = trial, after
        if np.linalg.norm(after.x - trial) < before:
            return trial, after
    if last is None:
        raise NumericsError("found no Newton step whose motion can be computed: start from another state")
    return last


def settled(
    family: Family, value: float, most: int, periods: int = 1, *, x: Array | None = None, at: float = 0.0
) -> tuple[Array, float]:
    """State after a run of at most `most` periods, fewer if it settles, and the phase of the forcing.

    The run starts at the family's start, or in state x at phase `at`. A run that does not settle returns the state that
    changed least over a period, since chaotic motion passes close to unstable orbits. No rigid contact is closed in the
    returned state.
    """
    motion, period = family.at(value)
    x = family.begin if x is None else x
    near: Passage | None = None
    apart = np.inf
    for _ in range(most):
        found = passage(motion, x, at * period, periods * period, tangent=False, extremes=False)
        change, size = float(np.linalg.norm(found.x - x)), float(np.linalg.norm(found.x))
        x = found.x
        if not change < HUGE:
            raise NumericsError(
                f"{family.name} = {value:.8g}: found a motion that grows without bound: start from another state"
            )
        if near is None or change < apart * size:
            near, apart = found, change / size if size > 0.0 else 0.0
        if change <= SETTLED * size:
            break
    if near is None:
        return x, at
    free = _free_time(near, motion, periods * period)
    x = passage(motion, near.x, at * period, free, tangent=False, extremes=False).x if free > 0.0 else near.x
    return x, (at + free / period) % 1.0


def _free_time(found: Passage, motion: Motion, period: float) -> float:
    """Time to the middle of the longest interval without a closed rigid contact [s]; 0 without such contacts."""
    events = [event for event in found.events if motion.plant.rigid[event.contact]]
    if not events:
        return 0.0
    closed: set[int] = set()
    last, longest, middle = found.start, 0.0, found.start
    for time, event in [*((event.time, event) for event in events), (found.start + period, None)]:
        if not closed and time - last > longest:
            longest, middle = time - last, 0.5 * (last + time)
        last = time
        if event is not None and event.stays:
            closed.add(event.contact)
        elif event is not None:
            closed.discard(event.contact)
    if longest < SHORT * period:
        raise NumericsError(
            "found a rigid contact that never opens, expected an opening in each period: give the contacts a compliance"
        )
    return middle - found.start


def made(
    family: Family, value: float, map_: Map, periods: int, start: float, x: Array, found: Passage, iterations: int,
    slope: Array | None = None,
) -> Orbit:  # fmt: skip
    """The orbit of a passage that returns to its start."""
    assert found.M is not None
    closings, rests = [0] * len(found.force), [0] * len(found.force)
    for event in found.events:
        closings[event.contact] += event.closes
        rests[event.contact] += event.rests
    return Orbit(
        name=family.name, value=float(value), period=map_.period, periods=periods, start=start, x=readonly(x),
        multipliers=np.linalg.eigvals(found.M).astype(complex), gap=readonly(found.gap), force=readonly(found.force),
        amplitude={name: float(size) for name, size in zip(family.channels, found.amplitude, strict=True)},
        closings=tuple(closings), rests=tuple(rests), touching=found.first, M=readonly(found.M), iterations=iterations,
        slope=slope,
    )  # fmt: skip
