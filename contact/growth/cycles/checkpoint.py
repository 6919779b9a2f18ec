"""A search for branches on disk: what is done, how far the branch under way is; it goes on as if nothing had been."""

from __future__ import annotations

import hashlib
import time
from dataclasses import astuple, dataclass
from pathlib import Path

import numpy as np

from contact.base.errors import InputError
from contact.growth.cycles.branch import Way
from contact.growth.cycles.driven import Family
from contact.growth.cycles.result import Branch
from contact.growth.cycles.shooting import Orbit
from contact.io.stored import StoredError, load_value, save_value

EVERY = 2.0  # s between two writings, at least
SHARE = 20.0  # times what a writing takes, likewise


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Found:
    """What was asked for, as a digest, the branches that are done, and the one under way."""

    asked: str
    done: tuple[Branch, ...] = ()
    way: Way | None = None

    def begins(self, number: int) -> Orbit | None:
        """First orbit of a branch, counted from 0, if it was found."""
        if number < len(self.done):
            return self.done[number].points[0]
        return self.way.points[0] if self.way is not None and number == len(self.done) else None


class Checkpoint:
    """The file of a search, or none: what it held at the start, and when it is written again."""

    def __init__(self, path: str | Path | None, asked: str) -> None:
        self.path = None if path is None else Path(path)
        self.found = Found(asked=asked)
        self._due = time.monotonic() + EVERY
        if self.path is None or not self.path.exists():
            return
        try:
            self.found = load_value(self.path, Found)
        except StoredError as error:
            raise InputError(f"checkpoint: {error}; remove it to begin anew") from error
        if self.found.asked != asked:
            raise InputError(
                f"checkpoint: {self.path}: found that of another body, range or way to continue, expected this one's; "
                "name another file, or remove it"
            )

    def keep(self, done: list[Branch], way: Way | None = None) -> None:
        """Write what there is: at the end of a branch, within one when it is time."""
        if self.path is None or (way is not None and time.monotonic() < self._due):
            return
        begun = time.monotonic()
        save_value(self.path, Found(asked=self.found.asked, done=tuple(done), way=way))
        self._due = time.monotonic() + max(EVERY, SHARE * (time.monotonic() - begun))


def digest(family: Family, between: tuple[float, float], first: Orbit | None, *how: float) -> str:
    """What is asked for, in 64 letters: the range, its motion at both ends, the first orbit and how to continue."""
    text = hashlib.sha256(repr((family.name, between, how)).encode())
    for value in between:
        motion, period = family.at(value)
        arrays = [*astuple(motion.plant), *motion.drive.b, *motion.drive.c, *motion.drive.d, period, motion.step]
        for part in arrays:
            text.update(np.ascontiguousarray(part).tobytes())
    text.update(b"" if first is None else np.ascontiguousarray(first.x).tobytes())
    return text.hexdigest()
