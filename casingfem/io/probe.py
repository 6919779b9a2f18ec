"""Read files in a child process with limits on time and memory.

Some libraries loop, exhaust memory or crash on a damaged file without raising an error. After a successful read in the
child, the parent reads files that may loop or exhaust memory again (`fault_of`). Files that may crash the reader are
never read in the parent, since a crash can depend on memory addresses; the child returns its arrays (`arrays_of`).
Either costs the start of a process, 0.5 s.
"""

import importlib
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import IO, Any

import numpy as np

from casingfem.io.arrays import Array

SECONDS, BYTES = 3.0, 1.5e9  # of processor time and memory for any file
PATIENCE = 20.0  # seconds by the clock for one of processor time: on a busy machine a child gets a small share
PACE, ROOM = 20e6, 20.0  # bytes a second, and bytes of memory a byte, for large ones
CODE = "from casingfem.io.probe import {0}; import sys; {0}(*sys.argv[1:])"
REFUSED = 3  # exit code: the reader raised, and what it stated was handed over


class UnreadableError(Exception):
    """A file could not be read: the reader reported a fault, or its process ended."""


def fault_of(path: Path, module: str, function: str) -> str:
    """Fault of a child process that calls `module.function(path)`; "" if it ends within its limits.

    An exception is not a fault, since the parent will get it too.
    """
    code, fault = in_child("read", path, module, function, subprocess.DEVNULL)
    return fault if code else ""


def arrays_of(path: Path, module: str, function: str) -> dict[str, Array]:
    """The named arrays that `module.function(path)` returns in a child process; arrays of objects are refused.

    Raises
    ------
    UnreadableError
        The reader raised an error, which is quoted, or crashed, or exceeded its limits.
    """
    with tempfile.TemporaryFile() as stream:
        code, fault = in_child("hand_over", path, module, function, stream)
        if code not in (0, REFUSED):
            raise UnreadableError(fault)
        stream.seek(0)
        return taken(stream)


def in_child(task: str, path: Path, module: str, function: str, stdout: IO[bytes] | int) -> tuple[int, str]:
    """Exit code of a child process that does one of the two tasks below, and the name of a crash or a timeout."""
    size = path.stat().st_size
    seconds, memory = SECONDS + size / PACE, BYTES + ROOM * size
    line = [sys.executable, "-c", CODE.format(task), str(path), module, function, str(seconds), str(memory)]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path)), "OPENBLAS_NUM_THREADS": "1"}
    try:
        code = subprocess.run(
            line, env=environment, stdout=stdout, stderr=subprocess.DEVNULL, timeout=PATIENCE * seconds, check=False
        ).returncode
    except subprocess.TimeoutExpired:
        code = -1
    return code, f"its reader took more than {seconds:.3g} s or {memory / 1e9:.3g} GB, or crashed"


def read(path: str, module: str, function: str, seconds: str, memory: str) -> None:
    """Call the reader within limits (in the child)."""
    call = bounded(module, function, seconds, memory)
    try:
        call(Path(path))
    except MemoryError:
        sys.exit(1)
    except Exception:  # the parent states what is wrong
        sys.exit(0)


def hand_over(path: str, module: str, function: str, seconds: str, memory: str) -> None:
    """Call the reader within limits and write its result to standard output (in the child)."""
    stream = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # a library may print: its text goes to standard error
    call = bounded(module, function, seconds, memory)
    code = give(stream, call, Path(path))
    stream.close()
    sys.exit(code)


def bounded(module: str, function: str, seconds: str, memory: str) -> Callable[[Path], Any]:
    """Set the limits of this process, and return the reader."""
    call: Callable[[Path], Any] = getattr(importlib.import_module(module), function)
    if os.name == "posix":
        import resource

        resource.setrlimit(resource.RLIMIT_CPU, (int(float(seconds)) + 1,) * 2)
        resource.setrlimit(resource.RLIMIT_AS, (int(float(memory)),) * 2)
    return call


def give(stream: IO[bytes], call: Callable[[Path], Mapping[str, Any]], path: Path) -> int:
    """Write the names and arrays that a reader returned, or its error; returns the exit code."""
    try:
        arrays = {name: np.asarray(array) for name, array in call(path).items()}
        if odd := [name for name, array in arrays.items() if array.dtype.hasobject]:
            raise TypeError(f"{odd[0]} is no array of numbers")
    except MemoryError:
        return 1
    except Exception as error:  # any error of the reader means a malformed file
        np.save(stream, np.array([str(error) or type(error).__name__, "raised"]))
        return REFUSED
    np.save(stream, np.array([*arrays, "read"]))
    for array in arrays.values():
        np.save(stream, array)
    return 0


def taken(stream: IO[bytes]) -> dict[str, Array]:
    """Read the file that `give` wrote."""
    *names, end = np.load(stream, allow_pickle=False).tolist()
    if end == "raised":
        raise UnreadableError(names[0])
    return {name: np.load(stream, allow_pickle=False) for name in names}
