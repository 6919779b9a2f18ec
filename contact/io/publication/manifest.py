"""The manifest of a set of files that is being published: file names, contents, and the staging folder."""

from __future__ import annotations

import errno
import json
import os
import platform
import re
import stat
from dataclasses import asdict, dataclass
from pathlib import Path, PurePosixPath
from typing import Any, Literal

from contact.io.publication.digests import digest_of, digest_of_file

MANIFEST = ".casingfem-publication.json"
FORMAT = "casingfem-publication-1"
HERE = re.sub(r"\W", "_", platform.node())
WRITER = r"(?P<host>\w*)-(?P<process>\d+)-(?P<start>\d+)"
PART = re.compile(rf"\.(?P<name>.+)\.{WRITER}-(?P<key>[0-9a-f]{{32}})\.part", re.DOTALL)
DEEPEST = 3  # folders between that of a set and its files
MOST = 64e6  # bytes of a manifest
STOPPED = "found {0} of {1} new files, since the writing program was stopped"


@dataclass(frozen=True, slots=True, kw_only=True)
class Entry:
    """One file of a set: name below the folder, new content, size and time of the file that it replaces (or None)."""

    name: str
    size: int
    sha256: str
    replaces: tuple[int, int] | None


State = Literal["staged", "in place", "changed", "missing"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Publication:
    """A set that is being published into a folder from this staging folder inside it."""

    folder: Path
    staging: str
    entries: tuple[Entry, ...]

    @property
    def manifest(self) -> Path:
        """Path of the manifest."""
        return self.folder / MANIFEST

    def new(self, entry: Entry) -> Path:
        """Path of a new file before it is moved into place."""
        return self.folder / self.staging / "new" / entry.name

    def old(self, entry: Entry) -> Path:
        """Path of the replaced file until all files are in place."""
        return self.folder / self.staging / "old" / entry.name

    def place(self, entry: Entry) -> Path:
        """Final path of the file."""
        return self.folder / entry.name

    def text(self) -> str:
        """The manifest, with its own checksum."""
        document = {"format": FORMAT, "staging": self.staging, "files": [asdict(entry) for entry in self.entries]}
        return json.dumps({**document, "sha256": digest_of(document)}, indent=1) + "\n"

    def state(self, entry: Entry) -> State:
        """State of a file, by its checksum; "changed" if a file at this place is neither the old nor the new one."""
        place = self.place(entry)
        if is_as_stated(self.new(entry), entry):
            moved_away = os.path.lexists(self.old(entry))
            free = not os.path.lexists(place)
            return "staged" if free or (not moved_away and seen(place) == entry.replaces) else "changed"
        if is_as_stated(place, entry):
            return "in place"
        return "changed" if os.path.lexists(place) and seen(place) != entry.replaces else "missing"

    def can_go_back(self, entry: Entry) -> bool:
        """Whether the previous file still exists, here or in the staging folder, or there was none."""
        kept = seen(self.old(entry)) or (None if self.state(entry) == "in place" else seen(self.place(entry)))
        return kept == entry.replaces or entry.replaces is None


def seen(path: Path) -> tuple[int, int] | None:
    """Size and time of a file or link; None if there is none."""
    try:
        status = path.lstat()
    except OSError:
        return None
    return status.st_size, status.st_mtime_ns


def is_as_stated(path: Path, entry: Entry) -> bool:
    """Whether a path is a regular file, no link, with the content that the manifest states."""
    try:
        status = path.lstat()
        return stat.S_ISREG(status.st_mode) and status.st_size == entry.size and digest_of_file(path) == entry.sha256
    except OSError:
        return False


def names_of(document: Any) -> list[str]:
    """The file names of a manifest, without those that lead out of the folder."""
    files = document.get("files") if isinstance(document, dict) else None
    found = [file.get("name") if isinstance(file, dict) else None for file in files] if isinstance(files, list) else []
    return [name for name in found if isinstance(name, str) and stays_inside(name)]


def stays_inside(name: str) -> bool:
    """Whether a name means a file below a folder, not too deep.

    >>> stays_inside("vtu/mode_1.vtu"), stays_inside("../study.toml"), stays_inside("/etc/passwd")
    (True, False, False)
    """
    parts = PurePosixPath(name).parts
    plain = bool(parts) and "/".join(parts) == name and not {"..", "/", MANIFEST} & set(parts)
    return plain and "\0" not in name and len(parts) <= 1 + DEEPEST and (os.name == "posix" or "\\" not in name)


def require_no_links(folder: Path, name: str) -> None:
    """Raise OSError if a folder on the path of a file of the set is a link, which could lead anywhere."""
    inside = folder
    for part in PurePosixPath(name).parts[:-1]:
        inside = inside / part
        if inside.is_symlink():
            raise OSError(errno.ENOTDIR, "found a link, expected a folder or none", str(inside))


def document_of(path: Path) -> Any:
    """Contents of a manifest; None if it cannot be read. Links are not followed, and pipes are not read."""
    flags = os.O_RDONLY | sum(getattr(os, flag, 0) for flag in ("O_NOFOLLOW", "O_NONBLOCK", "O_CLOEXEC", "O_BINARY"))
    try:
        if path.is_symlink():
            return None
        descriptor = os.open(path, flags)
        with os.fdopen(descriptor, "rb") as stream:
            status = os.fstat(descriptor)
            if not stat.S_ISREG(status.st_mode) or status.st_size > MOST:
                return None
            return json.loads(stream.read())
    except (OSError, ValueError, RecursionError):
        return None


def read_manifest(folder: Path) -> Publication | None:
    """The set that is announced in a folder; None if there is none, or its manifest is incomplete."""
    if not os.path.lexists(folder / MANIFEST):
        return None
    document = document_of(folder / MANIFEST)
    try:
        own = {key: document[key] for key in ("format", "staging", "files")}
        if own["format"] != FORMAT or document["sha256"] != digest_of(own) or not PART.fullmatch(own["staging"]):
            return None
        if {"/", "\0"} & set(own["staging"]) or len(set(names_of(own))) != len(own["files"]):
            return None
        entries = [{**file, "replaces": tuple(file["replaces"] or ()) or None} for file in own["files"]]
        return Publication(folder=folder, staging=own["staging"], entries=tuple(Entry(**each) for each in entries))
    except (KeyError, TypeError, ValueError):
        return None
