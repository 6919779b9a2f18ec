"""Cache of machine code on disk.

One file for each loop and signature, in a directory named after all sources of the loop.

Numba's own cache compares the file of a function and not the files of what the function calls. Its index of several
files may also name another signature's code after two processes wrote at once. Here a file is complete in itself: it
contains its key (digest of its sources, versions of numba and llvmlite, processor, signature) and a checksum, and it is
written under a temporary name and renamed. A file that does not fit its key is compiled again.

Directories are read in this order, up to the first one that can be written: `NUMBA_CACHE_DIR`, the `__pycache__` of
this package, `~/.cache/contact`. New code goes into the last of them. A directory that an administrator filled and made
read-only is therefore used, and each user stores the code that it lacks.
"""

from __future__ import annotations

import hashlib
import os
import pickle
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

import llvmlite
import numba
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps

config: Any = numba.config
result: Any = CompileResult
packed_by_numba: Any = dumps
ROOT = Path(__file__).parents[1]
JIT = sorted((ROOT / "jit").glob("*.py"))
SOURCES = (
    *JIT,
    ROOT / "io/trust.py",
    ROOT / "record/record.py",
    ROOT / "record/spin.py",
    ROOT / "model/bodies/band.py",
    ROOT / "model/gaps/limits.py",
    *sorted((ROOT / "loop").rglob("*.py")),
    *sorted((ROOT / "solver").rglob("*.py")),
)
IMPORT = "from contact."
ENDING = ".code"


@cache
def sources_of(file: Path) -> frozenset[Path]:
    """Compiled sources that a module takes names from, itself and those of `contact.jit` included.

    Modules are found by their lines `from contact.x import ...`. A test checks that compiled code uses no other
    modules.
    """
    found, waiting = set(SOURCES[: len(JIT)]), [file]
    while waiting:
        source = waiting.pop()
        if source in found and source != file:
            continue
        found.add(source)
        names = [line.split()[1] for line in source.read_text("utf-8").splitlines() if line.startswith(IMPORT)]
        files = [(ROOT.parent / name.replace(".", "/")).with_suffix(".py") for name in names]
        waiting += [each for each in files if each in SOURCES and each not in found]
    return frozenset(found)


@cache
def digest(file: Path) -> str:
    """Hash of the contents and names of a module's compiled sources and of the versions of Python and compiler."""
    made_by = sys.implementation.cache_tag, getattr(sys, "abiflags", ""), numba.__version__, llvmlite.__version__
    read = hashlib.sha256(str(made_by).encode())
    for source in sorted(sources_of(file)):
        read.update(f"\0{source.relative_to(ROOT).as_posix()}\0".encode())
        read.update(source.read_bytes())
    return read.hexdigest()


def user_directory() -> Path | None:
    """Directory for caches of this user, where there is one."""
    with suppress(RuntimeError):  # no home directory
        return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "contact"
    return None


def can_write(directory: Path) -> bool:
    """Whether files can be made in a directory; of a missing directory, whether it can be made."""
    there = next((each for each in (directory, *directory.parents) if each.exists()), None)
    return there is not None and there.is_dir() and os.access(there, os.W_OK | os.X_OK)


def directories() -> Iterator[Path]:
    """Directories of machine code, up to the first that can be written."""
    for base in (config.CACHE_DIR, ROOT / "__pycache__", user_directory()):
        if base:
            yield Path(base)
            if can_write(Path(base)):
                return


def writable() -> Path | None:
    """Directory where new machine code goes; None where no directory can be written."""
    return next((each for each in directories() if can_write(each)), None)


def kept_in(directory: Path) -> int:
    """Number of files of machine code in a directory, also of older sources."""
    return len(list(directory.glob(f"contact-*/*{ENDING}")))


class MachineCode:
    """Numba's cache interface for one function.

    Only functions of `SOURCES` are cached, since the digest covers only them.
    """

    def __init__(self, function: Callable[..., object]) -> None:
        file = Path(function.__code__.co_filename)
        self.kept = file in SOURCES
        self.digest = digest(file) if self.kept else ""
        self.folder = f"contact-{self.digest[:16]}"
        self.name = f"{file.stem}.{function.__qualname__}".replace("<", "").replace(">", "")
        self.code = hashlib.sha256(function.__code__.co_code).hexdigest()

    @property
    def cache_path(self) -> str | None:
        """Directory where new code goes; None where none can be written, or for a function that is not cached."""
        directory = writable() if self.kept else None
        return None if directory is None else str(directory / self.folder)

    def _key(self, signature: Any, codegen: Any) -> tuple[Any, ...]:
        return self.digest, self.name, self.code, codegen.magic_tuple(), signature

    def _file(self, key: tuple[Any, ...]) -> str:
        return f"{self.name}-{hashlib.sha256(str(key).encode()).hexdigest()[:16]}{ENDING}"

    def load_overload(self, signature: Any, context: Any) -> Any:
        """Return the code for a signature, None if no directory has an intact file."""
        if not self.kept:
            return None
        context.refresh()
        key = self._key(signature, context.codegen())
        for directory in directories():
            found = whole(directory / self.folder / self._file(key), key)
            if found is not None:
                return result._rebuild(context, *found)
        return None

    def save_overload(self, signature: Any, compiled: Any) -> None:
        """Save the code for a signature; if no directory is writable, the next process compiles again."""
        directory = self.cache_path
        if directory is None or any(not each.can_cache for each in compiled.lifted):
            return
        if compiled.library.has_dynamic_globals:  # addresses of this process
            return
        key = self._key(signature, compiled.codegen)
        packed = packed_by_numba((key, compiled._reduce()))
        with suppress(OSError):
            publish(Path(directory) / self._file(key), hashlib.sha256(packed).digest() + packed)


def whole(file: Path, key: tuple[Any, ...]) -> Any:
    """Contents of a file for this key; None if the file is missing, is damaged, or has another key."""
    try:
        read = file.read_bytes()
    except OSError:
        return None
    checksum, packed = read[:32], read[32:]
    if hashlib.sha256(packed).digest() != checksum:
        return None
    made_for, found = pickle.loads(packed)
    return found if made_for == key else None


def publish(file: Path, content: bytes) -> None:
    """Write a temporary file and rename it, so that a reader sees the whole file or none."""
    file.parent.mkdir(parents=True, exist_ok=True)
    handle, staged = tempfile.mkstemp(dir=file.parent)
    try:
        with os.fdopen(handle, "wb") as opened:
            opened.write(content)
        Path(staged).chmod(0o666 & ~umask())  # mkstemp lets only its owner read, other users read this cache
        os.replace(staged, file)
    except OSError:
        Path(staged).unlink(missing_ok=True)
        raise


@cache
def umask() -> int:
    """File permissions that this process withholds from new files (umask)."""
    found = os.umask(0o022)
    os.umask(found)
    return found
