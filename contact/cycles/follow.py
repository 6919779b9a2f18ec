"""All branches over a range: the one on which runs settle, those beyond its ends and those of doubled period.

Kept on disk.
"""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable
from dataclasses import astuple, dataclass
from pathlib import Path

import numpy as np

from contact.base.arrays import require_count, require_finite, require_positive
from contact.base.checkpoint import Checkpoint
from contact.base.errors import InputError, NumericsError
from contact.cycles.balance import balance
from contact.cycles.branch import Course, Tangent, Way, begun, followed
from contact.cycles.driven import Family
from contact.cycles.result import Branch, Cycles, Special
from contact.cycles.shooting import Orbit, orbit, settled
from contact.io import notebook
from contact.io.threads import with_one_thread

TRIES = 100  # values in the range at which a run searches for orbits beyond the end of a branch
SETTLE = 200  # periods of such a run
Progress = Callable[[int, float, int], None]
Go = Callable[[Course, Orbit, Tangent], Branch]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Found:
    """State of a continuation: a digest of its input, finished branches, and the current branch."""

    asked: str
    done: tuple[Branch, ...] = ()
    way: Way | None = None

    def begins(self, number: int) -> Orbit | None:
        """First orbit of a branch, by its number from 0, if it was found."""
        if number < len(self.done):
            return self.done[number].points[0]
        return self.way.points[0] if self.way is not None and number == len(self.done) else None


def digest(family: Family, between: tuple[float, float], first: Orbit | None, *how: float) -> str:
    """Digest (64 letters) of the input: range, motions at both its ends, first orbit, settings of the continuation."""
    text = hashlib.sha256(repr((family.name, between, how)).encode())
    for value in between:
        motion, period = family.at(value)
        arrays = [*astuple(motion.plant), *motion.drive.b, *motion.drive.c, *motion.drive.d, period, motion.step]
        for part in arrays:
            text.update(np.ascontiguousarray(part).tobytes())
    text.update(b"" if first is None else np.ascontiguousarray(first.x).tobytes())
    return text.hexdigest()


@with_one_thread
def follow(
    family: Family, between: tuple[float, float], *, first: Orbit | None = None, longest: float = 0.02,
    most: int = 1000, doublings: int = 0, checkpoint: str | Path | None = None, progress: Progress | None = None,
) -> Cycles:  # fmt: skip
    """Follow the orbits of a family over a range of its parameter, past folds, until they leave the range.

    `first` is an orbit at the first value, by default the one on which a run settles, else the one that `balance` leads
    to. `longest` is the longest step; 1 is a change of the state by its own size, or of the parameter by the range.
    `most` is the largest number of orbits of a branch. If a branch ends inside the range (a rigid contact grazes), runs
    from its last stable orbit change the parameter by a hundredth of the range each, until one settles on an orbit,
    which starts another branch. Each flip starts a branch of doubled period, up to `doublings` doublings. `checkpoint`
    names a file that keeps the orbits found so far; if it exists, the search continues from it with bit-identical
    results. `progress` receives branch, value and number of orbits. Raises InputError, and NumericsError if no orbit is
    found.

    >>> import numpy as np
    >>> import contact as ct
    >>> mass = ct.ModalBody(omega=[1.0], zeta=[0.025], channels=("x", "stop"), rows=[[1.0], [-1.0]], S=np.zeros((2, 2)))
    >>> patch = ct.Patch(body=mass, normal=("stop",), clearance=0.1)
    >>> driven = ct.cycles.DrivenBody(patch=patch, channel="x", amplitude=0.02, stiffness=100.0, shown=("x",))
    >>> found = ct.cycles.follow(driven.over("freq_hz", freq_hz=0.1), (0.1, 0.14), longest=0.5)
    >>> (branch,) = found.branches
    >>> bool(branch.stable.all()), branch.amplitude("x")[[0, -1]].round(4).tolist()
    (True, [0.033, 0.0868])
    """
    require_finite(start=between[0], end=between[1])
    require_positive(longest=longest)
    progress = progress or notebook.notebook_progress("follow", "branch {} at {:.6g}, {} orbits".format)
    require_count(2, most=most)
    require_count(0, doublings=doublings)
    if between[0] == between[1]:
        raise InputError(f"{family.name}: found {between[0]:g} to {between[1]:g}, expected two different ends")
    started = time.perf_counter()
    asked = digest(family, between, first, longest, most, doublings) if checkpoint else ""
    kept = None if checkpoint is None else Checkpoint(checkpoint, asked, Found)
    before = (kept and kept.found) or Found(asked=asked)
    found: list[Branch] = []

    def keep(way: Way | None = None) -> None:
        if kept is not None:
            kept.keep(lambda: Found(asked=asked, done=tuple(found), way=way), now=way is None)

    def go(course: Course, begin: Orbit, ahead: Tangent) -> Branch:
        number = len(found)

        def told(way: Way) -> None:
            keep(way)
            if progress is not None:
                progress(number + 1, way.points[-1].value, len(way.points))

        if number < len(before.done):
            found.append(before.done[number])
            return found[-1]
        way = before.way if number == len(before.done) else None
        way = way or begun(course, begin, ahead, longest)
        found.append(followed(course, way, longest=longest, most=most, progress=told))
        keep()
        return found[-1]

    def looking(value: float) -> None:
        if progress is not None:
            progress(len(found) + 1, value, 0)

    _main(family, between, first, go, looking, lambda: before.begins(len(found)))
    for branch in list(found):
        _doubled(family, between, branch, doublings, longest, go)
    return Cycles(name=family.name, branches=tuple(found), seconds=time.perf_counter() - started)


def _main(
    family: Family, between: tuple[float, float], first: Orbit | None, go: Go, looking: Callable[[float], None],
    known: Callable[[], Orbit | None],
) -> None:  # fmt: skip
    """The main branch up to the other end, continued by runs where it ends inside the range; `known`.

    Starts already found.
    """
    begin, sense = first, float(np.sign(between[1] - between[0]))
    if begin is None:
        begin = known() or _first(family, between[0])
    while begin is not None:
        course = _course(family, between, begin)
        found = go(course, begin, Tangent(np.zeros_like(begin.x), sense))
        reached = max(found.points, key=lambda point: sense * point.value)
        kept = [point for point in found.points if point.stable]
        begin = None
        if found.end and kept and sense * (between[1] - reached.value) > 0.0:
            last = max(kept, key=lambda point: sense * point.value)
            begin = known()
            if begin is None or begin.periods > 1:  # of a branch of doubled period
                begin = _beyond(family, between, last, reached.value, looking)


def _first(family: Family, value: float) -> Orbit:
    """The orbit on which a run settles; the one near harmonic balance if Newton's method finds none there."""
    try:
        return orbit(family, value)
    except NumericsError as error:
        try:
            return orbit(family, value, guess=np.array(balance(family, value).x))
        except (NumericsError, InputError):
            raise error from None


def _beyond(
    family: Family, between: tuple[float, float], kept: Orbit, reached: float, looking: Callable[[float], None]
) -> Orbit | None:
    """The next orbit on which a run from a known one settles, beyond the range covered so far."""
    step = (between[1] - between[0]) / TRIES
    value, x, start = reached + 0.1 * step, np.array(kept.x), kept.start
    while abs(value - between[0]) < abs(between[1] - between[0]):
        looking(value)
        try:
            x, start = settled(family, value, SETTLE, x=x, at=start)
            return orbit(family, value, guess=x, start=start)
        except NumericsError:
            value += step
    return None


def _doubled(
    family: Family, between: tuple[float, float], branch: Branch, doublings: int, longest: float, go: Go
) -> None:
    """Branches of doubled period from the flips of a branch, and from the flips of those branches."""
    if doublings == 0:
        return
    for flip in branch.of("flip"):
        course = _course(family, between, flip.orbit)
        start = _beside(course, flip, longest)
        if start is not None:
            _doubled(family, between, go(course, *start), doublings - 1, longest, go)


def _beside(course: Course, flip: Special, longest: float) -> tuple[Orbit, Tangent] | None:
    """An orbit of doubled period beside a flip, and the direction away from the flip; None where none is found."""
    at = flip.orbit
    values, vectors = np.linalg.eig(at.M)
    across = vectors[:, int(np.argmin(np.abs(values + 1.0)))].real
    along = course.unit(Tangent(across, 0.0), at.x)
    double = at.twice()
    for part in (0.5, 0.25, 1.0, 0.1):
        try:
            begin = course.next(double, along, part * longest)
        except (NumericsError, np.linalg.LinAlgError):
            continue
        return begin, Tangent(begin.x - at.x, begin.value - at.value)
    return None


def _course(family: Family, between: tuple[float, float], begin: Orbit) -> Course:
    size = 1e-3 * float(np.linalg.norm(begin.x)) or 1.0
    return Course(family=family, low=min(between), high=max(between), size=size)
