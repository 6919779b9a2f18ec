"""Basins of attraction: runs from random starts at one value of the parameter."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from contact.base.arrays import Array, require_count, require_positive
from contact.base.errors import NumericsError
from contact.cycles.driven import Family
from contact.cycles.passage import Motion, passage
from contact.cycles.shooting import require_state
from contact.io.brief import brief
from contact.io.columns import Column, Columns, table_lines
from contact.io.reported import Reported
from contact.io.threads import with_one_thread

SAME = 1e-4  # of the state: nearer motions are one
CLOSES = 1e-6  # of the state: largest difference of a run from its state some periods before


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Attractor:
    """A periodic motion on which runs settle: its states after each period of the forcing, (periods, n), and its share.

    `amplitude` max |u| [m] by channel, over all its periods; `share` the part of the starts that reach it.

    >>> import numpy as np
    >>> Attractor(states=np.zeros((2, 4)), amplitude={"x": 0.01}, share=0.4).periods
    2
    """

    states: Array
    amplitude: dict[str, float]
    share: float

    __repr__ = brief

    @property
    def periods(self) -> int:
        """Periods of the forcing until the motion repeats."""
        return len(self.states)


MOTIONS = (
    Column("share", "Share of the random starts that reach the motion.",
           lambda found: [one.share for one in found.attractors],
           unit="%", format=".1f", scale=100.0),
    Column("periods", "Number of forcing periods after which the motion repeats.",
           lambda found: [one.periods for one in found.attractors], format="d"),
)  # fmt: skip


def amplitude(channel: str) -> Column:
    """Largest motion of a channel."""
    return Column(f"amplitude_{channel}_m", f"Largest displacement of the channel {channel}.",
                  lambda found: [one.amplitude.get(channel) for one in found.attractors],
                  head=f"amplitude {channel}", unit="m", format=".6g")  # fmt: skip


@dataclass(frozen=True, eq=False, slots=True, kw_only=True, repr=False)
class Basins(Reported):
    """Periodic motions reached from random starts, the most frequent first; `reached` (starts,) their number or -1.

    -1: the run had not settled on a motion of so few periods, or grew without bound.

    >>> import numpy as np
    >>> low = Attractor(states=np.zeros((1, 2)), amplitude={"x": 0.01}, share=0.75)
    >>> found = Basins(name="freq_hz", value=0.2, attractors=(low,), starts=np.zeros((4, 2)), reached=(0, 0, -1, 0))
    >>> found.attractors[0].share, sum(one == -1 for one in found.reached)
    (0.75, 1)
    """

    name: str
    value: float
    attractors: tuple[Attractor, ...]
    starts: Array
    reached: tuple[int, ...]

    def described(self) -> Columns:
        """Share and periods of each motion, and its amplitude by channel."""
        channels = dict.fromkeys(name for one in self.attractors for name in one.amplitude)
        return (*MOTIONS, *map(amplitude, channels))

    def __repr__(self) -> str:
        lines = [f"{len(self.reached)} starts at {self.name} {self.value:.8g}"]
        if self.attractors:
            lines += table_lines(self.described(), self.records())
        lost = self.reached.count(-1)
        return "\n".join(
            [*lines, f"{lost / len(self.reached):.1%} of the starts reach no periodic motion"] if lost else lines
        )


@with_one_thread
def basins(
    family: Family, value: float, size: Array, *, starts: int = 100, seed: int, settle: int = 300, longest: int = 4,
    progress: Callable[[int], None] | None = None,
) -> Basins:  # fmt: skip
    """Run from `starts` random states: normal deviates of size (n,) around 0, the components those of an orbit's state.

    After `settle` periods each run is checked for a motion that repeats after 1 to `longest` periods. Starts
    inside a rigid contact are drawn anew. Raises InputError.

    >>> import contact as ct
    >>> mass = ct.ModalBody(omega=[1.0], zeta=[0.025], channels=("x", "stop"), rows=[[1.0], [-1.0]], S=np.zeros((2, 2)))
    >>> patch = ct.Patch(body=mass, normal=("stop",), clearance=0.1)
    >>> driven = ct.cycles.DrivenBody(patch=patch, channel="x", amplitude=0.02, stiffness=100.0, shown=("x",))
    >>> family = driven.over("freq_hz", freq_hz=0.1)
    >>> found = ct.cycles.basins(family, 0.1, np.array([0.01, 0.01]), starts=2, seed=1, settle=80)
    >>> found.reached, [one.periods for one in found.attractors]
    ((0, 0), [1])
    """
    require_count(starts=starts, settle=settle, longest=longest)
    size = require_state(size, family, "size")
    require_positive(size=float(np.abs(size).max(initial=0.0)))
    motion, period = family.at(value)
    draw = np.random.default_rng(seed)
    found: list[tuple[Array, Array]] = []  # states and amplitudes
    begun, reached = [], []
    for k in range(starts):
        begun.append(_start(motion, np.abs(size), draw))
        try:
            states, amplitude = _settled(motion, begun[-1], period, settle, longest)
        except NumericsError:
            reached.append(-1)
            continue
        reached.append(_number(found, states, amplitude) if len(states) else -1)
        if progress is not None:
            progress(k + 1)
    order = sorted(range(len(found)), key=lambda i: -reached.count(i))
    attractors = tuple(
        Attractor(
            states=found[i][0], share=reached.count(i) / starts,
            amplitude={name: float(u) for name, u in zip(family.channels, found[i][1], strict=True)},
        )
        for i in order
    )  # fmt: skip
    place = {number: new for new, number in enumerate(order)} | {-1: -1}
    return Basins(
        name=family.name, value=value, attractors=attractors, starts=np.array(begun),
        reached=tuple(place[number] for number in reached),
    )  # fmt: skip


def _start(motion: Motion, size: Array, draw: np.random.Generator) -> Array:
    """A random state outside the rigid contacts."""
    for _ in range(1000):
        x = size * draw.standard_normal(size.size)
        try:
            motion.closed_at(x, 0.0)
        except NumericsError:
            continue
        return np.asarray(x)
    raise NumericsError("size: found no start outside the rigid contacts in 1,000 draws, expected one: reduce size")


def _settled(motion: Motion, x: Array, period: float, settle: int, longest: int) -> tuple[Array, Array]:
    """States of the motion on which a run has settled, and its amplitudes; no states if the motion does not repeat."""
    for _ in range(settle):
        x = passage(motion, x, 0.0, period, tangent=False, extremes=False).x
    states, amplitudes, size = [x], [], np.linalg.norm(x)
    for _ in range(longest):
        after = passage(motion, states[-1], 0.0, period, tangent=False)
        amplitudes.append(after.amplitude)
        if np.linalg.norm(after.x - x) <= CLOSES * size:  # a slow decay may resemble a shorter period
            apart = np.linalg.norm(np.array(states) - x, axis=1)
            shortest = next((d for d in range(1, len(states)) if apart[d] <= SAME * size), len(states))
            return np.array(states[:shortest]), np.max(amplitudes[:shortest], axis=0)
        states.append(after.x)
    return np.zeros((0, x.size)), np.zeros(0)


def _number(found: list[tuple[Array, Array]], states: Array, amplitude: Array) -> int:
    """Number of the motion in the list of found motions; a new one is added."""
    for number, (known, _) in enumerate(found):
        apart = np.linalg.norm(known - states[0], axis=1).min()
        if len(known) == len(states) and apart <= SAME * np.linalg.norm(states[0]):
            return number
    found.append((states, amplitude))
    return len(found) - 1
