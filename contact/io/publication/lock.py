"""A lock that lets one writer at a time move files in a folder; it ends with its process and leaves no file."""

from __future__ import annotations

import errno
import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

try:
    import fcntl
except ImportError:  # not on Windows
    fcntl = None  # type: ignore[assignment]

WAIT, PAUSE = 10.0, 0.02  # s for another writer to move its files, and between evaluations


@contextmanager
def alone(folder: Path, *, shared: bool = False) -> Iterator[bool]:
    """Let one writer at a time move files in a folder, or several readers read.

    Yields whether the system supports locks.

    The lock ends with its process. Nothing is written. Raises OSError after `WAIT` seconds.
    """
    try:
        descriptor = os.open(folder, os.O_RDONLY)
    except PermissionError:  # Windows opens no folders
        yield False
        return
    try:
        yield _locked(descriptor, folder, fcntl.LOCK_SH if shared else fcntl.LOCK_EX)
    finally:
        os.close(descriptor)


def _locked(descriptor: int, folder: Path, kind: int) -> bool:
    last = time.monotonic() + WAIT
    while True:
        try:
            fcntl.flock(descriptor, kind | fcntl.LOCK_NB)
        except BlockingIOError:
            if time.monotonic() > last:
                found = f"found another program that still writes files after {WAIT:g} s, expected its end: try again"
                raise OSError(errno.EBUSY, found, str(folder)) from None
            time.sleep(PAUSE)
        except OSError:  # some network drives have no locks
            return False
        else:
            return True
