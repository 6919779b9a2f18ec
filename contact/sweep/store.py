"""Results of many runs on disk: one file a run, named by the hash of what defines it, with its own checksum.

A file is written under a temporary name and moved into place: whoever is killed leaves whole files only. Nothing is
flushed to the disk itself: after a power cut a file may be torn, which its checksum shows, and its run is computed
again. There is no index: to read and check a file takes 40 microseconds, a run milliseconds.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

from contact.io.checked_json import read_checked, write_checked

FORMAT = "contact-run-1"
Row = dict[str, Any]


def run_path(folder: Path, digest: str) -> Path:
    """File of a run, in one of 256 folders."""
    return folder / "runs" / digest[:2] / f"{digest}.json"


def write_run(folder: Path, digest: str, row: Row) -> None:
    """Write the row of a run, whole or not at all; any process may."""
    write_checked(run_path(folder, digest), "row", row, format=FORMAT, hash=digest)


def read_run(path: Path) -> Row | None:
    """Row of a run file; None where there is none, or none that is whole and what its name says."""
    return cast("Row | None", read_checked(path, "row", format=FORMAT, hash=path.stem))


@dataclass(frozen=True, slots=True, kw_only=True)
class Store:
    """A folder of runs, which any number of processes may write and read."""

    folder: Path

    @staticmethod
    def open(folder: Path) -> Store:
        """Open or make a store."""
        (folder / "runs").mkdir(parents=True, exist_ok=True)
        return Store(folder=folder)

    def rows(self, digests: Iterable[str]) -> dict[str, Row]:
        """Rows of those of the runs that are there, by hash."""
        found = {digest: read_run(run_path(self.folder, digest)) for digest in digests}
        return {digest: row for digest, row in found.items() if row is not None}

    def note(self, rows: Mapping[str, Row]) -> None:
        """Write what no worker has written, because it shares no disk."""
        for digest, row in rows.items():
            if read_run(run_path(self.folder, digest)) is None:
                write_run(self.folder, digest, row)

    def files(self) -> list[Path]:
        """All run files, by name."""
        return sorted((self.folder / "runs").glob("??/*.json"), key=lambda path: path.name)

    def unreadable(self) -> list[Path]:
        """Run files that are not whole: none, after any kill."""
        return [path for path in self.files() if read_run(path) is None]
