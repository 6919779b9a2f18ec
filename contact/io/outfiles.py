"""Result files: written under a temporary name and moved into place, all of a set or none.

A set for a folder that is not there yet is written into a folder beside it, which then takes its name. In a folder that
is there the set is made complete in a folder `.new`, and its files are moved from there: where a kill comes between,
what is in `.new` is moved by whoever reads or writes there next (`settle`).
"""

from __future__ import annotations

import errno
import hashlib
import json
import os
import platform
import re
import shutil
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from itertools import count
from math import isfinite
from pathlib import Path
from typing import Any

try:
    import fcntl
except ImportError:  # not on Windows
    fcntl = None  # type: ignore[assignment]

Content = str | bytes | Callable[[Path], object]  # what a file holds, or what writes it at a path
NEW = ".new"  # a complete set that is not all in its place
HERE = re.sub(r"\W", "_", platform.node())
PART = re.compile(r"\.(?P<name>.+)\.(?P<host>\w*)-(?P<process>\d+)-\d+\.part")
ABANDONED = 86_400.0  # s: whatever the machine, nobody writes one file for a day
_number = count()


def write_files(folder: str | os.PathLike[str], files: Mapping[str, Content]) -> list[Path]:
    r"""Write files into a folder (made if need be, like those in a file's name); none appears before all are complete.

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
    if not target.is_dir():
        target.parent.mkdir(parents=True, exist_ok=True)
        clear_parts(target.parent, target.name)
    with _part(target, target.is_dir()) as part:
        for name, content in files.items():
            (part / name).parent.mkdir(parents=True, exist_ok=True)
            _fill(part / name, content, target / name)
        _commit(part, target)
    settle(target)
    return [target / name for name in files]


def write_atomic(path: str | os.PathLike[str], content: Content) -> Path:
    """Write one file, whole or not at all. Raises OSError, which names it."""
    final = Path(path)
    return write_files(final.parent, {final.name: content})[0]


def _write_one(final: Path, content: Content) -> Path:
    final.parent.mkdir(parents=True, exist_ok=True)
    with _part(final) as part:
        _fill(part, content, final)
        os.replace(part, final)
    return final


def settle(folder: Path) -> None:
    """Move the rest of a set whose writer was killed: those it replaces go first, so that old and new never mix."""
    new = folder / NEW
    if not new.is_dir():
        return
    with _alone(folder):  # else one would remove what another has just moved
        inside = sorted(new.rglob("*"))
        names = [path.relative_to(new) for path in inside if not path.is_dir()]
        for name in names:
            (folder / name).unlink(missing_ok=True)
        for name in names:
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            with suppress(FileNotFoundError):  # moved meanwhile, where there is no lock
                os.replace(new / name, folder / name)
        for path in (*reversed(inside), new):
            with suppress(OSError):  # a file that was moved, or a folder with the next set in it already
                path.rmdir()


@contextmanager
def _alone(folder: Path) -> Iterator[None]:
    """One process at a time, where the system can; the lock goes with the process that holds it."""
    descriptor = os.open(folder, os.O_RDONLY) if fcntl is not None else -1
    try:
        if fcntl is not None:
            with suppress(OSError):  # some network drives have none
                fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        if descriptor >= 0:
            os.close(descriptor)


def clear_parts(folder: Path, name: str = "") -> None:
    """Remove what killed processes left unfinished in a folder; of the file or folder `name` alone if given."""
    for entry in os.scandir(folder) if folder.is_dir() else ():
        found = PART.fullmatch(entry.name)
        if found is None or name not in ("", found["name"]):
            continue
        with suppress(OSError):  # gone meanwhile, or another user's
            if _dead(found) or time.time() - entry.stat().st_mtime > ABANDONED:
                shutil.rmtree(entry) if entry.is_dir(follow_symlinks=False) else os.unlink(entry)


def _dead(part: re.Match[str]) -> bool:
    """Whether the process that wrote it ran on this machine and has ended."""
    if part["host"] != HERE or os.name != "posix":
        return False
    try:
        os.kill(int(part["process"]), 0)
    except (ProcessLookupError, OverflowError):
        return True
    except PermissionError:
        return False
    return False


def _check(target: Path, files: Mapping[str, Content]) -> None:
    """Refuse what could be seen only when half of the set is in its place."""
    if (way := in_the_way(target)) is not None:
        raise NotADirectoryError(errno.ENOTDIR, way, str(target))
    for name in files:
        if (target / name).is_dir():
            raise IsADirectoryError(errno.EISDIR, "found a folder, expected a file or none", str(target / name))


def in_the_way(folder: Path) -> str | None:
    """What stands where a folder is to be made, or where one of those that it lies in is; None where nothing does."""
    place = next((at for at in (folder, *folder.parents) if at.exists() or at.is_symlink()), None)
    if place is None or place.is_dir():
        return None
    found = "a file" if place.exists() else "a link to nothing"
    return f"found {found}{'' if place == folder else f', {place}'}, expected a folder or none"


@contextmanager
def _part(final: Path, inside: bool = False) -> Iterator[Path]:
    """Where something is written before it is complete: beside or inside what it becomes, hidden, gone in the end."""
    beside = final / "set" if inside else final
    part = beside.with_name(f".{beside.name}.{HERE}-{os.getpid()}-{next(_number)}.part")
    try:
        yield part
    except OSError as error:
        if error.filename is None or str(part) in str(error.filename):
            raise OSError(error.errno or errno.EIO, error.strerror or str(error), str(final)) from error
        raise
    finally:
        shutil.rmtree(part, ignore_errors=True) if part.is_dir() else part.unlink(missing_ok=True)


def _fill(part: Path, content: Content, final: Path) -> None:
    try:
        if callable(content):
            content(part)
        else:
            part.write_bytes(content.encode("utf-8") if isinstance(content, str) else content)
    except OSError as error:
        raise OSError(error.errno or errno.EIO, error.strerror or str(error), str(final)) from error


def _commit(part: Path, target: Path) -> None:
    """The set is complete: it becomes the folder, or what is to be moved into it."""
    for _ in range(10):
        try:
            os.rename(part, target / NEW if target.is_dir() else target)
        except OSError:
            if not target.is_dir():
                raise
            settle(target)  # another process writes there too
        else:
            return
    raise FileExistsError(errno.EEXIST, "found a folder that others write to all the time", str(target / NEW))


def json_text(document: Any, *, indent: int | None = None) -> str:
    r"""One JSON document, ending in a newline; numbers that JSON has no word for become null.

    >>> json_text({"freq_hz": 371.2, "zeta": float("nan")})
    '{"freq_hz": 371.2, "zeta": null}\n'
    """
    return json.dumps(finite(document), indent=indent, allow_nan=False, ensure_ascii=False) + "\n"


def finite(value: Any) -> Any:
    """The same plain data with nan and inf replaced by None."""
    if isinstance(value, float):  # nearly all entries are, and there may be millions
        return value if isfinite(value) else None
    if isinstance(value, list | tuple):
        return [finite(entry) for entry in value]
    if isinstance(value, Mapping):
        return {key: finite(entry) for key, entry in value.items()}
    return value


def digest_of(document: Any) -> str:
    """Hash of plain data, whatever the order of its keys.

    >>> digest_of({"a": 1.0, "b": [2]}) == digest_of({"b": [2], "a": 1.0})
    True
    """
    text = json.dumps(document, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode("utf-8")).hexdigest()


def write_checked(path: str | os.PathLike[str], name: str, value: Any, **head: Any) -> None:
    """Write `value` under its name, what says whose it is, and its checksum: whole or not at all."""
    content = {**head, name: value, "sha256": digest_of(value)}
    write_atomic(path, json.dumps(content, allow_nan=False) + "\n")


def read_checked(path: str | os.PathLike[str], name: str, **head: Any) -> Any:
    """What `write_checked` wrote with the same head; None where there is none, or none that is whole."""
    try:
        content = json.loads(Path(path).read_text(encoding="utf-8"))
        value = content[name]
        whole = content["sha256"] == digest_of(value) and all(content[key] == said for key, said in head.items())
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None
    return value if whole else None
