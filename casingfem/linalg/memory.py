"""Limits of memory and time: the memory of a factorisation is known from its plan; hours are announced first."""

import mmap
from pathlib import Path

import numpy as np

from casingfem.errors import ModelError, NumericsError, sentence

SPARED = 0.9  # of what is free may be taken
INFO = Path("/proc/meminfo")
STATUS = Path("/proc/self/statm")
GROUP = Path("/sys/fs/cgroup")
MOST = 2e8  # modes times unknowns: an hour or so, 1.6 GB of shapes
MODES = 1000.0  # modes that may be requested at once for any number of unknowns


class MemoryNeedError(NumericsError, MemoryError):
    """A computation needs more memory than is free."""


def free_memory() -> float:
    """Bytes that this process may still use: free on the machine, in its control group, and within its own limit.

    Infinite if the system does not report it.
    """
    return min(free_on_machine(), left_in_group(), left_by_limit())


def free_on_machine() -> float:
    """Memory that programs may take without swapping."""
    lines = INFO.read_text(encoding="ascii").splitlines() if INFO.exists() else []
    return next((1024.0 * float(line.split()[1]) for line in lines if line.startswith("MemAvailable")), np.inf)


def left_in_group() -> float:
    """Memory left within the limit of the control group, as in a container."""
    try:
        most, used = ((GROUP / name).read_text(encoding="ascii").strip() for name in ("memory.max", "memory.current"))
        return np.inf if most == "max" else float(most) - float(used)
    except OSError:
        return np.inf


def left_by_limit() -> float:
    """Memory left within the process's limit on its address space (ulimit -v)."""
    try:
        import resource
    except ImportError:
        return np.inf
    most, _ = resource.getrlimit(resource.RLIMIT_AS)
    if most == resource.RLIM_INFINITY or not STATUS.exists():
        return np.inf
    return float(most) - mmap.PAGESIZE * float(STATUS.read_text(encoding="ascii").split()[0])


def require_memory(needed: float, unknowns: int, free: float) -> None:
    """Refuse a factorisation that needs more bytes than are free.

    Raises
    ------
    MemoryNeedError
        `modes-memory`, with the needed and the free memory.

    >>> require_memory(7e10, 10**6, free=8e9)
    Traceback (most recent call last):
        ...
    casingfem.linalg.memory.MemoryNeedError: the factor of 1000000 unknowns takes 70 GB, 8 GB are free; use fewer \
elements or a computer with more memory; thick solids need no factorisation with \
`cf.modal.mesh_modes(solid, count, multigrid=True)` [modes-memory]
    """
    if needed > SPARED * free:
        takes, left = f"{1e-9 * needed:.2g} GB", f"{1e-9 * max(free, 0.0):.2g} GB"
        found = f"the factor of {unknowns} unknowns takes {takes}, {left} are free"
        raise MemoryNeedError(sentence("modes-memory", found))


def require_affordable(modes: float, unknowns: int) -> None:
    """Refuse a number of modes that would take more than an hour.

    Raises
    ------
    ModelError
        `modes-count`, with the number of modes, of unknowns, and the expected time.

    >>> require_affordable(1e5, 16_000)
    Traceback (most recent call last):
        ...
    casingfem.errors.ModelError: modes: some 1e+05 of 16000 unknowns, hours of work and 13 GB of shapes, expected at \
most 12500 at once, or band after band; ask for at least 1 mode, and for far fewer than the mesh has unknowns \
[modes-count]
    """
    most = max(MOST / unknowns, MODES)
    if not modes <= most:
        cost = f"hours of work and {8e-9 * modes * unknowns:.2g} GB of shapes"
        found = f"modes: some {modes:.3g} of {unknowns} unknowns, {cost}"
        raise ModelError("modes-count", f"{found}, expected at most {most:.0f} at once, or band after band")
