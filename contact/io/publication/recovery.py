"""A set whose writer was killed: complete it, or restore the previous files, or leave it and state the reason."""

from __future__ import annotations

import errno
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from contact.io.publication.lock import alone
from contact.io.publication.manifest import MANIFEST, STOPPED, State, read_manifest, require_no_links
from contact.io.publication.moves import finish, move_back, withdraw
from contact.io.publication.staging import clear_parts, is_written


@dataclass(frozen=True, slots=True, kw_only=True)
class Recovery:
    """Outcome for an unfinished set: "finished", "put back" or "nothing", and its files."""

    action: Literal["finished", "put back", "nothing"]
    files: tuple[str, ...] = ()
    removed: tuple[str, ...] = ()
    damaged: tuple[str, ...] = ()


def recover(folder: Path) -> Recovery:
    """Complete the set of a killed writer in a folder; if it is damaged, restore the previous files.

    Raises
    ------
    OSError
        If the folder is missing, the set cannot be recognised, or files were changed since. Then nothing is changed.
    """
    if not folder.is_dir():
        raise NotADirectoryError(errno.ENOTDIR, "found no such folder, expected a folder with results", str(folder))
    with alone(folder) as certain:
        found = settled(folder, certain)
        removed = tuple(path.name for path in clear_parts(folder))
    return Recovery(action=found.action, files=found.files, damaged=found.damaged, removed=removed)


def settled(folder: Path, certain: bool) -> Recovery:
    """Recover the announced set in a locked folder; `certain`: the lock shows that no writer is alive."""
    if not os.path.lexists(folder / MANIFEST):
        return Recovery(action="nothing")
    publication = read_manifest(folder)
    if publication is None:
        found = f"found {MANIFEST} of another program, expected none: move it to another folder"
        raise OSError(errno.EEXIST, found, str(folder))
    if not certain and is_written(publication):
        found = "found files that another program is writing, expected its end: try again"
        raise OSError(errno.EBUSY, found, str(folder))
    for entry in publication.entries:
        for name in (entry.name, f"{publication.staging}/new/{entry.name}", f"{publication.staging}/old/{entry.name}"):
            require_no_links(folder, name)
    states: Mapping[str, State] = {entry.name: publication.state(entry) for entry in publication.entries}
    names = tuple(states)
    if changed := [name for name, state in states.items() if state == "changed"]:
        found = f"found files changed after the writing program was stopped: {', '.join(changed)}"
        raise OSError(
            errno.EEXIST, f"{found}; expected none: move them to another folder, then recover again", str(folder)
        )
    missing = tuple(name for name, state in states.items() if state == "missing")
    if not missing:
        finish(publication)
        return Recovery(action="finished", files=names)
    if not all(publication.can_go_back(entry) for entry in publication.entries):
        whole = len(names) - len(missing)
        found = (
            f"{STOPPED.format(whole, len(names))}; neither the new nor the old version of {', '.join(missing)} exists"
        )
        advice = f"move {MANIFEST} to another folder to use the files that exist"
        raise OSError(errno.EIO, f"{found}; expected all new or all old files: {advice}", str(folder))
    move_back(publication)
    withdraw(publication)
    return Recovery(action="put back", files=names, damaged=missing)
