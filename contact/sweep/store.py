"""Results of many runs on disk: one file a run, named by the hash of what defines it, and an index beside them.

A file is written under a temporary name and moved into place: whoever is killed leaves whole files only. The files
are the truth; the index (SQLite, write-ahead log) saves reading them all, and is made again from them at any time.
Nothing is flushed to the disk itself: after a power cut a file may be torn, which its checksum shows, and its run is
computed again.
"""

from __future__ import annotations

import hashlib
import json
import sqlite3
from collections.abc import Iterable, Iterator, Mapping
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from contact.io.outfiles import write_atomic

FORMAT = "contact-run-1"
Row = dict[str, Any]


def digest_of(document: Mapping[str, Any]) -> str:
    """Hash of plain data, whatever the order of its keys.

    >>> digest_of({"a": 1.0, "b": [2]}) == digest_of({"b": [2], "a": 1.0})
    True
    """
    text = json.dumps(document, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode("utf-8")).hexdigest()


def run_path(folder: Path, digest: str) -> Path:
    """File of a run, in one of 256 folders."""
    return folder / "runs" / digest[:2] / f"{digest}.json"


def write_run(folder: Path, digest: str, row: Row) -> None:
    """Write the row of a run, whole or not at all; any process may."""
    path = run_path(folder, digest)
    content = {"format": FORMAT, "hash": digest, "row": row, "sha256": digest_of(row)}
    write_atomic(path, json.dumps(content, allow_nan=False) + "\n")


def read_run(path: Path) -> Row | None:
    """Row of a run file; None where there is none, or none that is whole and what its name says."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        row: Row = content["row"]
        whole = content["format"] == FORMAT and content["hash"] == path.stem and content["sha256"] == digest_of(row)
    except (OSError, ValueError, KeyError, TypeError):
        return None
    return row if whole else None


@dataclass(frozen=True, slots=True, kw_only=True)
class Store:
    """A folder of runs with its index; one process at a time keeps the index, any number write runs."""

    folder: Path

    @staticmethod
    def open(folder: Path) -> Store:
        """Open or make a store: the index is brought up to date with the files, or made again where it is broken."""
        (folder / "runs").mkdir(parents=True, exist_ok=True)
        store = Store(folder=folder)
        try:
            store._match()
        except sqlite3.DatabaseError:
            store.rebuild()
        return store

    @property
    def index(self) -> Path:
        """The SQLite file."""
        return self.folder / "index.sqlite"

    def rows(self, digests: Iterable[str]) -> dict[str, Row]:
        """Rows of those of the runs that are there, by hash."""
        wanted = set(digests)
        with self._opened() as index:
            return {d: json.loads(row) for d, row in index.execute("SELECT hash, row FROM runs") if d in wanted}

    def note(self, rows: Mapping[str, Row]) -> None:
        """Put runs into the index; what no worker has written, because it shares no disk, is written now."""
        for digest, row in rows.items():
            if not run_path(self.folder, digest).exists():
                write_run(self.folder, digest, row)
        with self._opened() as index:
            pairs = [(digest, json.dumps(row, allow_nan=False)) for digest, row in rows.items()]
            index.executemany("INSERT OR REPLACE INTO runs VALUES (?, ?)", pairs)

    def files(self) -> list[Path]:
        """All run files, by name."""
        return sorted((self.folder / "runs").glob("??/*.json"), key=lambda path: path.name)

    def unreadable(self) -> list[Path]:
        """Run files that are not whole: none, after any kill."""
        return [path for path in self.files() if read_run(path) is None]

    def rebuild(self) -> None:
        """Make the index again from the files."""
        for name in ("", "-wal", "-shm"):
            self.index.with_name(self.index.name + name).unlink(missing_ok=True)
        self._match()

    def _match(self) -> None:
        """Add the files that the index does not know, forget what has no file."""
        files = {path.stem: path for path in self.files()}
        with self._opened() as index:
            known = {digest for (digest,) in index.execute("SELECT hash FROM runs")}
            index.executemany("DELETE FROM runs WHERE hash = ?", [(gone,) for gone in known - files.keys()])
            for digest in sorted(files.keys() - known):
                row = read_run(files[digest])
                if row is not None:
                    index.execute("INSERT INTO runs VALUES (?, ?)", (digest, json.dumps(row, allow_nan=False)))

    @contextmanager
    def _opened(self) -> Iterator[sqlite3.Connection]:
        """The index, made where there is none: committed where all went well, closed also where it is broken."""
        with closing(sqlite3.connect(self.index, timeout=60.0)) as index, index:
            index.execute("PRAGMA journal_mode=WAL")
            index.execute("PRAGMA synchronous=NORMAL")
            index.execute("CREATE TABLE IF NOT EXISTS runs (hash TEXT PRIMARY KEY, row TEXT NOT NULL)")
            yield index
