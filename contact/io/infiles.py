"""Open the files that a user names: an unreadable file gets a clear error, and nothing hangs.

A regular file is read up to a bound on its size. A pipe (`<(command)`, /dev/stdin, a FIFO) is read until its writer
closes it, up to the same bound and to bounds on time. Folders, devices, sockets and links to nothing are refused.
A file of an incomplete set is refused too (`contact.io.publication`). Reading changes nothing on the disk.
"""

from __future__ import annotations

import errno
import os
import select
import stat
import time
from codecs import BOM_UTF8, BOM_UTF16_BE, BOM_UTF16_LE
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from io import BytesIO
from pathlib import Path
from typing import IO

from contact.io.names import hint
from contact.io.publication.reading import require_whole

MOST = 4e9  # bytes of any file
MOST_TEXT = 256e6  # bytes of a table or another text that is read line by line
SILENCE = 20.0  # s that a pipe may give nothing
LONGEST = 600.0  # s until a pipe is at its end
CHUNK = 1 << 20
NAMED = 1000  # files of a folder among which a mistyped name is searched for
OPENING = os.O_RDONLY | sum(getattr(os, flag, 0) for flag in ("O_NONBLOCK", "O_CLOEXEC", "O_NOCTTY", "O_BINARY"))
KINDS = (
    (stat.S_ISDIR, errno.EISDIR, "a folder"),
    (stat.S_ISCHR, errno.EINVAL, "a device"),
    (stat.S_ISBLK, errno.EINVAL, "a device"),
)
_read_pipes: ContextVar[dict[tuple[int, int], bytes] | None] = ContextVar("_read_pipes", default=None)


class TextError(ValueError):
    """A file that is not the expected text; `line`, `found` and `expected` describe the fault."""

    def __init__(self, line: int, found: str, expected: str) -> None:
        self.line, self.found, self.expected = line, found, expected
        super().__init__(f"line {line}: found {found}, expected {expected}")


def open_file(path: str | os.PathLike[str], *, most: float = MOST) -> IO[bytes]:
    """Open a file for reading, seekable; for a pipe, its whole content.

    Raises
    ------
    OSError
        The file is unreadable or larger than `most` bytes, or a pipe is empty or endless. The error has the number of
        the system, and in `strerror` a sentence: what was found and what is expected.
    """
    name = os.fspath(path)
    require_whole(name)
    descriptor = _opened(name)
    try:
        status = os.fstat(descriptor)
        _check(status, name, most)
        if stat.S_ISREG(status.st_mode) and status.st_size:
            return os.fdopen(descriptor, "rb")
        content = _content(descriptor, status, name, most)
    except BaseException:
        os.close(descriptor)
        raise
    os.close(descriptor)
    return BytesIO(content)


def read_bytes(path: str | os.PathLike[str], *, most: float = MOST) -> bytes:
    """The bytes of a file. Raises OSError as `open_file` does."""
    with open_file(path, most=most) as stream:
        return stream.read()


def read_text(path: str | os.PathLike[str], *, most: float = MOST_TEXT) -> str:
    """The text of a file in UTF-8. Raises OSError as `open_file` does, and TextError for another encoding."""
    return text_of(read_bytes(path, most=most))


def read_loose_text(path: str | os.PathLike[str], *, most: float = MOST) -> str:
    """The text of a file of another program, whose comments may be in any encoding. Raises OSError as `open_file`."""
    data = read_bytes(path, most=most)
    marked = data[:2] in (BOM_UTF16_LE, BOM_UTF16_BE)
    return data.decode("utf-16" if marked else "utf-8-sig", errors="replace")


def regular_file(path: str | os.PathLike[str], *, most: float = MOST) -> Path:
    """The path of a regular file, for a library that opens files by their names. Raises OSError as `open_file` does.

    A pipe is refused, since a library reads a file in several places.
    """
    name = os.fspath(path)
    require_whole(name)
    descriptor = _opened(name)
    try:
        status = os.fstat(descriptor)
        _check(status, name, most)
        if not stat.S_ISREG(status.st_mode):
            raise OSError(errno.EINVAL, "found a pipe, expected a file on a disk: this format cannot be piped", name)
    finally:
        os.close(descriptor)
    return Path(path)


@contextmanager
def pipes_read_once() -> Iterator[None]:
    """Within this context a second read of a pipe returns the same bytes, for the parser and then for the hash."""
    if _read_pipes.get() is not None:
        yield
        return
    token = _read_pipes.set({})
    try:
        yield
    finally:
        _read_pipes.reset(token)


def text_of(data: bytes, *, utf16: bool = False) -> str:
    r"""The text of bytes in UTF-8, without its byte order mark; with `utf16` also UTF-16 that begins with the mark.

    Raises TextError with the line, for another encoding and for binary data.

    >>> text_of(b"\xef\xbb\xbfhz = 5"), text_of("a,b".encode("utf-16"), utf16=True)
    ('hz = 5', 'a,b')
    """
    marked = data[:2] in (BOM_UTF16_LE, BOM_UTF16_BE)
    if marked and not utf16:
        raise TextError(1, "the mark of UTF-16", "UTF-8 text: save the file as UTF-8")
    if not marked and (zero := data.find(b"\0")) >= 0:
        found = "a zero byte, as in UTF-16 without a mark or in a binary file"
        raise TextError(data.count(b"\n", 0, zero) + 1, found, "UTF-8 text: save the file as UTF-8")
    try:
        return data.decode("utf-16") if marked else data.removeprefix(BOM_UTF8).decode("utf-8")
    except UnicodeDecodeError as error:
        if marked:
            line = data[: error.start].decode("utf-16", errors="ignore").count("\n") + 1
            raise TextError(line, "bytes that are not UTF-16 after a mark of UTF-16", "a complete text file") from None
        data = data.removeprefix(BOM_UTF8)
        byte = data[error.start]
        latin = f" ({chr(byte)!r} in Latin-1)" if byte >= 0xA0 else ""
        found = f"byte 0x{byte:02x}, which is not UTF-8{latin}"
        line = data.count(b"\n", 0, error.start) + 1
        raise TextError(line, found, "UTF-8 text: save the file as UTF-8") from None


def _opened(name: str) -> int:
    """A file descriptor, opened without waiting."""
    try:
        return os.open(name, OPENING)
    except ValueError:
        raise OSError(errno.EINVAL, "found a name with a zero byte, expected the name of a file", repr(name)) from None
    except FileNotFoundError as error:
        raise OSError(error.errno, _missing(name), name) from None
    except OSError as error:
        found = {
            errno.EACCES: "found no permission to read it, expected a file that you may read",
            errno.ELOOP: "found a link that leads back to itself, expected a file",
            errno.ENOTDIR: "found a file where its folder should be, expected a file in a folder",
            errno.ENXIO: "found a device or a socket that cannot be opened, expected a file or a pipe",
        }.get(error.errno or 0, error.strerror)
        raise OSError(error.errno, found, name) from None


def _missing(name: str) -> str:
    """Description of a path where no file exists."""
    if os.path.islink(name):
        return f"found a link to {os.readlink(name)!r}, which does not exist, expected a file"
    folder = os.path.dirname(name) or "."
    if not os.path.isdir(folder):
        return f"found no folder {folder!r}, expected a file in it"
    try:
        with os.scandir(folder) as entries:
            beside = [entry.name for _, entry in zip(range(NAMED), entries, strict=False)]
    except OSError:
        beside = []
    return f"found no such file, expected one{hint(os.path.basename(name), beside)}"


def _check(status: os.stat_result, name: str, most: float) -> None:
    for is_kind, number, kind in KINDS:
        if is_kind(status.st_mode):
            raise OSError(number, f"found {kind}, expected a file or a pipe", name)
    if status.st_size > most:
        raise _too_large(f"{status.st_size / 1e6:.6g} MB", name, most)


def _too_large(found: str, name: str, most: float) -> OSError:
    return OSError(errno.EFBIG, f"found {found}, expected a file of at most {most / 1e6:g} MB", name)


def _content(descriptor: int, status: os.stat_result, name: str, most: float) -> bytes:
    """Contents of a pipe, or of a file that states no size, such as those of /proc."""
    read, which = _read_pipes.get(), (status.st_dev, status.st_ino)
    if read is None or not stat.S_ISFIFO(status.st_mode):
        return _to_the_end(descriptor, stat.S_ISFIFO(status.st_mode), name, most)
    if which not in read:
        read[which] = _to_the_end(descriptor, True, name, most)
    return read[which]


def _to_the_end(descriptor: int, pipe: bool, name: str, most: float) -> bytes:
    """All pieces until the last writer has closed the pipe.

    Before the first piece the writer may not have opened it yet.
    """
    pieces, size, last, writer = list[bytes](), 0, time.monotonic() + LONGEST, not pipe
    while True:
        try:
            piece = os.read(descriptor, CHUNK)
        except BlockingIOError:
            writer = True
        else:
            if not piece and writer:
                return b"".join(pieces)
            if piece:
                pieces.append(piece)
                size, writer = size + len(piece), True
                if size > most:
                    raise _too_large(f"a pipe with more than {most / 1e6:g} MB", name, most)
                if time.monotonic() < last:
                    continue
        if time.monotonic() >= last:
            found = f"found a pipe that is still open after {LONGEST:g} s, expected its end: write a file instead"
            raise OSError(errno.ETIMEDOUT, found, name)
        writer |= _waited(descriptor, name)


def _waited(descriptor: int, name: str) -> bool:
    """Wait until the pipe has data or its writer has closed it; returns whether it was closed."""
    if not hasattr(select, "poll"):  # on Windows a read waits itself
        return True
    poll = select.poll()
    poll.register(descriptor, select.POLLIN)
    if not (events := poll.poll(1e3 * SILENCE)):
        found = f"found a pipe without data for {SILENCE:g} s, expected its content: start the writing program first"
        raise OSError(errno.ETIMEDOUT, found, name)
    return bool(events[0][1] & select.POLLHUP)
