"""A file with the results so far of a long computation, which continues from it after a stop."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Generic, Protocol, TypeVar

from contact.base.errors import InputError
from contact.io.stored import StoredError, load_value, save_value

EVERY = 2.0  # s between two writings, at least
SHARE = 20.0  # times the duration of a writing, at least: writing takes at most a twentieth of the time


class Asked(Protocol):
    """Input of the computation to which a file belongs, as arrays."""

    @property
    def asked(self) -> str:
        """Digest of all input that decides the result."""


Kept = TypeVar("Kept", bound=Asked)


class Checkpoint(Generic[Kept]):
    """The file of a computation; `found` is its content at the start, None if it did not exist.

    Raises InputError for a file that cannot be read, and for one of another computation.
    """

    def __init__(self, path: str | Path, asked: str, kind: type[Kept]) -> None:
        self.path = Path(path)
        self.found: Kept | None = None
        self._due = time.monotonic() + EVERY
        if not self.path.exists():
            return
        try:
            self.found = load_value(self.path, kind)
        except StoredError as error:
            raise InputError(f"checkpoint: {error}; delete the file to start the computation again") from error
        if self.found is not None and self.found.asked != asked:
            found = "a checkpoint of another computation or version"
            expected = "one of this computation: give another file or folder, or delete this file to start again"
            raise InputError(f"checkpoint: {self.path}: found {found}, expected {expected}")

    def keep(self, value: Callable[[], Kept], *, now: bool = False) -> None:
        """Save a value to the file if enough time has passed, or at once if `now`."""
        if not now and time.monotonic() < self._due:
            return
        begun = time.monotonic()
        self.path.parent.mkdir(parents=True, exist_ok=True)
        save_value(self.path, value())
        self._due = time.monotonic() + max(EVERY, SHARE * (time.monotonic() - begun))
