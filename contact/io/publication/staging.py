"""Temporary files: staging folders and parts with unguessable names, and remains of killed writers."""

from __future__ import annotations

import os
import re
import time
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from contact.io.publication.digests import digest_of_file
from contact.io.publication.manifest import (
    HERE,
    MANIFEST,
    PART,
    Entry,
    Publication,
    document_of,
    names_of,
    read_manifest,
    require_no_links,
)  # fmt: skip

PROCESSES = Path("/proc")  # of Linux
ABANDONED = 86_400.0  # s: no machine takes a day to write one file
HALF = ("manifest.part", "manifest.copy")  # of a manifest on its way
LONGEST = 100  # bytes of a name that the name of its part repeats


def part_name(name: str) -> str:
    """A hidden random name for a file or folder that is still being written."""
    label = name if len(os.fsencode(name)) <= LONGEST else "long"
    return f".{label}.{HERE}-{os.getpid()}-{start_of(os.getpid())}-{os.urandom(16).hex()}.part"


def start_of(process: int) -> int:
    """Start time of a process, in ticks since the system started.

    0 if the system does not state it, or the process ended.

    Process numbers are reused, often within minutes; number and start time together are unique.
    """
    try:
        fields = (PROCESSES / str(process) / "stat").read_text(encoding="latin-1").rpartition(")")[2].split()
        return 0 if fields[0] in "ZX" else int(fields[19])
    except (OSError, ValueError, IndexError):
        return 0


def has_ended(part: re.Match[str]) -> bool:
    """Whether the process that wrote a part ran on this machine and has ended."""
    if part["host"] != HERE or os.name != "posix":
        return False
    try:
        os.kill(int(part["process"]), 0)
    except (ProcessLookupError, OverflowError):
        return True
    except PermissionError:
        return False
    return PROCESSES.is_dir() and start_of(int(part["process"])) != int(part["start"])


def is_written(publication: Publication) -> bool:
    """Whether the process that writes a set runs on this machine."""
    part = PART.fullmatch(publication.staging)
    return part is not None and part["host"] == HERE and not has_ended(part)


def begun(folder: Path, names: Iterable[str], label: str = "set") -> Publication:
    """A set whose files are not written yet, with a new staging folder.

    Raises OSError, which names the folder, if the staging folder cannot be made.
    """
    entries = tuple(Entry(name=name, size=0, sha256="", replaces=None) for name in names)
    publication = Publication(folder=folder, staging=part_name(label), entries=entries)
    staging = folder / publication.staging
    try:
        staging.mkdir(mode=0o700)
        write_manifest(publication)
        for side in ("new", "old"):
            (staging / side).mkdir()
        for entry in entries:
            for path in (publication.new(entry), publication.old(entry)):
                path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        clear_staging(staging)
        raise OSError(error.errno, error.strerror, str(folder)) from error
    return publication


def write_manifest(publication: Publication) -> None:
    """Write the manifest into the staging folder, whole or not at all."""
    listed = publication.folder / publication.staging / "manifest.json"
    part = listed.with_name(HALF[0])
    part.write_text(publication.text(), encoding="ascii")
    os.replace(part, listed)


def complete(publication: Publication) -> Publication:
    """The same set, with the sizes and checksums of its files, which have been written."""
    entries = []
    for entry in publication.entries:
        path = publication.new(entry)
        entries.append(replace(entry, size=path.stat().st_size, sha256=digest_of_file(path)))
    return replace(publication, entries=tuple(entries))


def clear_staging(staging: Path) -> None:
    """Remove the files of a staging folder that its manifest names, and the folders that are then empty."""
    listed = staging / "manifest.json"
    for name in names_of(document_of(listed)):
        for side in ("new", "old"):
            with suppress(OSError):
                require_no_links(staging, f"{side}/{name}")
                (staging / side / name).unlink()
    for own in (listed, *(staging / name for name in HALF)):
        with suppress(OSError):
            own.unlink()
    for inside, _, names in os.walk(staging, topdown=False):  # which follows no links
        for name in filter(PART.fullmatch, names):  # of a file that was itself written whole or not at all
            with suppress(OSError):
                os.unlink(os.path.join(inside, name))
        with suppress(OSError):
            os.rmdir(inside)


def may_be_announced(folder: Path, staging: str) -> bool:
    """Whether the manifest in a folder names this staging folder, or cannot be read: then its files are needed."""
    if not os.path.lexists(folder / MANIFEST):
        return False
    publication = read_manifest(folder)
    return publication is None or publication.staging == staging


def parts_left(folder: Path, name: str = "") -> Iterator[Path]:
    """Files and folders of killed writers in a folder, for `name` alone if given; no links."""
    listed = list[os.DirEntry[str]]()
    with suppress(OSError):  # not there, or not to be listed
        listed = list(os.scandir(folder))
    for entry in listed:
        found = PART.fullmatch(entry.name)
        if found is None or name not in ("", found["name"]) or entry.is_symlink():
            continue
        if may_be_announced(folder, entry.name):
            continue
        with suppress(OSError):  # gone meanwhile
            if has_ended(found) or time.time() - entry.stat(follow_symlinks=False).st_mtime > ABANDONED:
                yield Path(entry.path)


def clear_parts(folder: Path, name: str = "") -> list[Path]:
    """Remove unfinished files of killed writers, for a file or folder `name` alone if given; returns their names."""
    found = list(parts_left(folder, name))
    for path in found:
        with suppress(OSError):  # another user's, or gone meanwhile
            clear_staging(path) if path.is_dir() else path.unlink()
    return [path for path in found if not os.path.lexists(path)]
