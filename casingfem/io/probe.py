"""Is a file safe to read? A child process reads it first, with bounds on its time and memory.

For libraries that loop or fill the memory on a damaged file: no check of ours can tell from outside, and no error of
theirs comes back. What the child has read in time the parent reads again; that costs the start of a process, 0.5 s.
"""

import importlib
import os
import subprocess
import sys
from pathlib import Path

SECONDS, BYTES = 3.0, 1.5e9  # of processor time and memory for any file
PACE, ROOM = 20e6, 20.0  # bytes a second, and bytes of memory a byte, for large ones
CODE = "from casingfem.io.probe import read; import sys; read(*sys.argv[1:])"


def fault_of(path: Path, module: str, function: str) -> str:
    """What happens to a process that calls `module.function(path)`; "" where it ends within its bounds.

    An exception is no fault: the parent will meet it too.
    """
    size = path.stat().st_size
    seconds, memory = SECONDS + size / PACE, BYTES + ROOM * size
    line = [sys.executable, "-c", CODE, str(path), module, function, str(seconds), str(memory)]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path)), "OPENBLAS_NUM_THREADS": "1"}
    try:
        code = subprocess.run(line, env=environment, capture_output=True, timeout=4.0 * seconds, check=False).returncode
    except subprocess.TimeoutExpired:
        code = -1
    return f"its reader took more than {seconds:.3g} s or {memory / 1e9:.3g} GB, or crashed" if code else ""


def read(path: str, module: str, function: str, seconds: str, memory: str) -> None:
    """Call the reader within bounds (in the child)."""
    call = getattr(importlib.import_module(module), function)
    if os.name == "posix":
        import resource

        resource.setrlimit(resource.RLIMIT_CPU, (int(float(seconds)) + 1,) * 2)
        resource.setrlimit(resource.RLIMIT_AS, (int(float(memory)),) * 2)
    try:
        call(Path(path))
    except MemoryError:
        sys.exit(1)
    except Exception:  # the parent says what is wrong
        sys.exit(0)
