"""Check of a reader: whether the set to which a file belongs is completely in place."""

from __future__ import annotations

import errno
import os
import shlex
import time
from contextlib import suppress
from pathlib import Path

from contact.io.publication.lock import PAUSE, WAIT, alone
from contact.io.publication.manifest import DEEPEST, MANIFEST, STOPPED, Publication, read_manifest
from contact.io.publication.staging import is_written


def require_whole(path: str) -> None:
    """Raise OSError for a file of an incomplete set, whose writer was stopped; else do nothing."""
    folder = os.path.dirname(os.path.abspath(path))
    for _ in range(1 + DEEPEST):
        if os.path.lexists(os.path.join(folder, MANIFEST)):
            _require_whole(Path(folder), path)
        above = os.path.dirname(folder)
        if above == folder:
            return
        folder = above


def _require_whole(folder: Path, path: str) -> None:
    name = Path(os.path.abspath(path)).relative_to(folder).as_posix()
    publication = _announced(folder, name)
    if publication is not None:
        _wait_for_writer(folder, publication)
        publication = _announced(folder, name)
    if publication is None:
        return
    there = sum(publication.state(entry) == "in place" for entry in publication.entries)
    if there < len(publication.entries):
        found = STOPPED.format(there, len(publication.entries))
        advice = f"run `casingfem recover {shlex.quote(str(folder))}`, or write all files again"
        raise OSError(errno.EBUSY, f"{found}; expected all or none: {advice}", path)


def _announced(folder: Path, name: str) -> Publication | None:
    """The unfinished set to which a file belongs."""
    publication = read_manifest(folder)
    return publication if publication and any(entry.name == name for entry in publication.entries) else None


def _wait_for_writer(folder: Path, publication: Publication) -> None:
    """Wait until no writer is at work, usually milliseconds. Raises OSError after `WAIT` seconds."""
    with suppress(PermissionError, FileNotFoundError), alone(folder, shared=True) as certain:
        if certain:
            return
    last = time.monotonic() + WAIT
    while is_written(publication) and publication.manifest.exists() and time.monotonic() < last:
        time.sleep(PAUSE)
