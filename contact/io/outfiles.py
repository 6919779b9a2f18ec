"""Result files: written under a temporary name and moved into place, all files of a set or none.

For a new folder, the set is written into a temporary folder, which is then renamed. In an existing folder
`contact.io.publication` replaces one set by another. A writer first completes the set of a killed one.
"""

from __future__ import annotations

import errno
import json
import os
import shutil
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from math import isfinite
from pathlib import Path
from typing import Any

from contact.io.infiles import read_bytes
from contact.io.interrupts import interrupts_held
from contact.io.publication.digests import digest_of
from contact.io.publication.lock import alone
from contact.io.publication.manifest import MANIFEST, Publication, require_no_links, stays_inside
from contact.io.publication.moves import commit
from contact.io.publication.recovery import settled
from contact.io.publication.staging import begun, clear_parts, complete, may_be_announced, part_name

Content = str | bytes | Callable[[Path], object]  # what a file contains, or what writes it at a path


def write_files(folder: str | os.PathLike[str], files: Mapping[str, Content]) -> list[Path]:
    r"""Write files into a folder (made if missing, like the folders in file names).

     None appears before all are complete.

    Raises OSError, which names the file that could not be written.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     [path.name for path in write_files(folder, {"modes.csv": "mode,freq_hz\n"})]
    ['modes.csv']
    """
    target = Path(folder)
    _check(target, files)
    settle(target)
    clear_parts(target)
    if len(files) == 1:
        return [_write_one(target / name, content) for name, content in files.items()]
    clear_parts(target.parent, target.name)
    if target.is_dir():
        with _staged(target, target, files) as publication:
            whole = complete(publication)
            with alone(target) as certain, interrupts_held():
                settled(target, certain)
                commit(whole)
    elif not _written_as_new(target, files):
        return write_files(folder, files)
    return [target / name for name in files]


def _written_as_new(target: Path, files: Mapping[str, Content]) -> bool:
    """Whether the files are now in a folder that did not exist; false if another process has made it meanwhile."""
    target.parent.mkdir(parents=True, exist_ok=True)
    with _staged(target.parent, target, files) as publication:
        try:
            os.rename(target.parent / publication.staging / "new", target)
        except OSError:
            if not target.is_dir():
                raise
            return False
    return True


def write_atomic(path: str | os.PathLike[str], content: Content) -> Path:
    """Write one file, whole or not at all. Raises OSError, which names it."""
    final = Path(path)
    return write_files(final.parent, {final.name: content})[0]


def _write_one(final: Path, content: Content) -> Path:
    final.parent.mkdir(parents=True, exist_ok=True)
    part = final.with_name(part_name(final.name))
    try:
        with _named(part, final):
            _fill(part, content, final)
            os.replace(part, final)
    finally:
        part.unlink(missing_ok=True)
    return final


@contextmanager
def _staged(beside: Path, target: Path, files: Mapping[str, Content]) -> Iterator[Publication]:
    """The complete files of a set in a staging folder inside `beside`, which is removed at the end."""
    publication = begun(beside, files, "set" if beside == target else target.name)
    staging = beside / publication.staging
    try:
        with _named(staging, target):
            for name, content in files.items():
                _fill(staging / "new" / name, content, target / name)
        yield publication
    finally:
        if not may_be_announced(beside, publication.staging):
            shutil.rmtree(staging, ignore_errors=True)


def settle(folder: Path) -> None:
    """Finish the set that a killed writer left in a folder. Raises OSError where it cannot be recognised."""
    if os.path.lexists(folder / MANIFEST):
        with alone(folder) as certain, interrupts_held():
            settled(folder, certain)


def _check(target: Path, files: Mapping[str, Content]) -> None:
    """Refuse faults that would otherwise appear when half of the files are in place."""
    if (way := in_the_way(target)) is not None:
        raise NotADirectoryError(errno.ENOTDIR, way, str(target))
    for name in files:
        if (target / name).is_dir():
            raise IsADirectoryError(
                errno.EISDIR, "found a folder, expected a file or an unused name", str(target / name)
            )
        if len(files) > 1:
            if not stays_inside(name):
                raise OSError(
                    errno.EINVAL, "found a name outside the folder, expected one inside it", str(target / name)
                )
            require_no_links(target, name)


def in_the_way(folder: Path) -> str | None:
    """The path that prevents making a folder or one of its parents; None if there is none."""
    place = next((at for at in (folder, *folder.parents) if at.exists() or at.is_symlink()), None)
    if place is None or place.is_dir():
        return None
    found = "a file" if place.exists() else "a broken link"
    return f"found {found}{'' if place == folder else f', {place}'}, expected a folder or an unused name"


@contextmanager
def _named(part: Path, final: Path) -> Iterator[None]:
    """Report an error of a temporary file under its final name."""
    try:
        yield
    except OSError as error:
        if error.filename is None or str(part) in str(error.filename):
            raise OSError(error.errno or errno.EIO, error.strerror or str(error), str(final)) from error
        raise


def _fill(part: Path, content: Content, final: Path) -> None:
    try:
        if callable(content):
            content(part)
        else:
            part.write_bytes(content.encode("utf-8") if isinstance(content, str) else content)
    except OSError as error:
        raise OSError(error.errno or errno.EIO, error.strerror or str(error), str(final)) from error


def json_text(document: Any, *, indent: int | None = None) -> str:
    r"""One JSON document, ending in a newline; NaN and infinite numbers become null.

    >>> json_text({"freq_hz": 371.2, "zeta": float("nan")})
    '{"freq_hz": 371.2, "zeta": null}\n'
    """
    return json.dumps(finite(document), indent=indent, allow_nan=False, ensure_ascii=False) + "\n"


def finite(value: Any) -> Any:
    """The same plain data, with None for nan and inf."""
    if isinstance(value, float):  # nearly all entries are, and there may be millions
        return value if isfinite(value) else None
    if isinstance(value, list | tuple):
        return [finite(entry) for entry in value]
    if isinstance(value, Mapping):
        return {key: finite(entry) for key, entry in value.items()}
    return value


def write_checked(path: str | os.PathLike[str], name: str, value: Any, **head: Any) -> None:
    """Write `value` under its name, with its owner and its checksum: whole or not at all."""
    content = {**head, name: value, "sha256": digest_of(value)}
    write_atomic(path, json.dumps(content, allow_nan=False) + "\n")


def read_checked(path: str | os.PathLike[str], name: str, **head: Any) -> Any:
    """Data that `write_checked` wrote with the same head; None if the file is missing or damaged."""
    if not os.path.exists(path):  # an error message would compare the name with all others of the folder
        return None
    try:
        content = json.loads(read_bytes(path))
        value = content[name]
        whole = content["sha256"] == digest_of(value) and all(content[key] == said for key, said in head.items())
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None
    return value if whole else None
