"""A stepper whose steps are written in Python: your own scheme defines one step, the base class does the rest."""

from __future__ import annotations

import math
from abc import abstractmethod
from typing import Any

import numpy as np

from contact.base.arrays import Array
from contact.base.errors import InputError
from contact.io.trust import Flag
from contact.record.record import Samples, Tally, tally
from contact.scheme.protocol import Block, Motion, PlainStepper


class PythonStepper(PlainStepper):
    """A run of your own scheme, for experiments: a step takes hundreds of times as long as a compiled one.

    A subclass calls `__init__`, keeps its coordinates in an array `u` (N,) that it writes in place, and defines `step`
    and `stored`. `memory` lists further arrays that a step changes, such as velocities, so that a stopped run can
    continue. Each step has the time of its start, n dt; its force acts over the step, and the gap is that at its end.

    Parameters
    ----------
    label
        Scheme in words.
    dt
        Time step [s].
    u
        Coordinates at t = 0, (N,); they are copied.
    gap
        Gaps at t = 0, (k,) [m].
    memory
        Further arrays that a step changes.
    window
        Period of the highest frequency [s], over which forces are averaged; the step if left out.

    Raises InputError for a step that is not positive and finite.

    Examples
    --------
    >>> import contact as ct
    >>> class Falling(ct.scheme.PythonStepper):
    ...     def step(self, n):
    ...         self.u -= self.dt
    ...         return np.zeros(1), self.u
    ...     def stored(self):
    ...         return ct.record.Stored(kinetic=0.5, strain=0.0, potential=0.0, residual=0.0, discrete=0.5)
    >>> from contact.record.record import Record, samples
    >>> run = Falling(label="falls", dt=0.5, u=[2.0], gap=[2.0])
    >>> out = samples(Record(), 3, 1, 1)
    >>> run.advance(out, 0, 3), out.gap[:3, 0].tolist()
    (-1, [1.5, 1.0, 0.5])
    """

    def __init__(
        self, *, label: str, dt: float, u: Any, gap: Any, memory: tuple[Array, ...] = (), window: float = 0.0
    ) -> None:
        if not (dt > 0.0 and math.isfinite(dt)):
            raise InputError(f"dt: found {dt!r}, expected a step above 0 in seconds")
        self.label, self.dt, self.window = label, float(dt), max(window, dt)
        self.u = np.array(u, dtype=float)
        self._gap = np.array(gap, dtype=float)
        self.sums: Tally = tally(self._gap.size)
        self._further = memory

    @abstractmethod
    def step(self, n: int) -> tuple[Array, Array]:
        """Take step n from n dt to (n + 1) dt: move `u`; return forces (k,) [N] >= 0 and gaps (k,) [m] at its end.

        A value that is not finite ends the run with the flag `motion-overflow`.
        """

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return int(self.u.size)

    @property
    def blocks(self) -> tuple[Block, ...]:
        """The single body."""
        return (("body 1", 0, self.size),)

    @property
    def memory(self) -> tuple[Any, ...]:
        """All arrays that a step changes."""
        return self.u, self._gap, self.sums, self._further

    def why(self) -> Flag:
        """Explain a failed step."""
        return Flag("the motion is not finite: reduce dt", "motion-overflow", failed=True)

    def motions(self) -> tuple[Motion, ...]:
        """Empty: no rigid motion is stated."""
        return (Motion(kind="body", number=0, mean_velocity=math.nan, momentum=math.nan),)

    def advance(self, out: Samples, first: int, steps: int) -> int:
        """Take steps, store due samples, and update the sums; returns -1, or the step that failed."""
        from contact.loop import tally as book

        due, store_state = uncompiled(book.state_due), uncompiled(book.store_state)
        note_step, store = uncompiled(book.note_step), uncompiled(book.store)
        for n in range(first, first + steps):
            if due(self.sums, out, n):
                store_state(self.sums, out, n, n * self.dt, self.u)
            before = self._gap.copy()
            force, gap = (np.array(values, dtype=float) for values in self.step(n))
            if not (np.isfinite(force).all() and np.isfinite(gap).all() and np.isfinite(self.u).all()):
                return n
            for k in range(force.size):
                slack = abs(min(float(force[k]), float(gap[k])))
                began = n * self.dt
                note_step(self.sums, out, k, self.dt, force[k], gap[k], slack, began, before[k], gap[k], began)
            self.sums.work[:] += force * (gap - before)
            self._gap[:] = gap
            store(self.sums, out, n, n * self.dt, force, gap)
        return -1


def uncompiled(function: Any) -> Any:
    """The Python function behind a compiled one; for one call per step it costs less than passing all its arrays."""
    return getattr(function, "py_func", function)
