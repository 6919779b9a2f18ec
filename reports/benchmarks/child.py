"""Work in a child process with limits on its memory and time.

The cost of the work, or what was reached before the stop.
"""

import resource
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path

from casingfem.linalg.memory import MemoryNeedError

Numbers = dict[str, object]
GIGABYTE = 2**30


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits of a child process: seconds of wall time, bytes of address space."""

    seconds: float = 540.0
    memory: int = 14 * GIGABYTE


@dataclass(frozen=True, slots=True)
class Outcome:
    """What the child sent, its largest memory [MB], and how it ended: "done", or the limit that stopped it."""

    numbers: Numbers = field(default_factory=dict)
    peak: float | None = None
    ended: str = "done"


def peak_memory() -> float:
    """Largest resident memory of this process so far [MB]."""
    unit = 1e-6 if sys.platform == "darwin" else 1e-6 * 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit


def peak_of(child: int | None) -> float | None:
    """Largest resident memory [MB] of a child that still runs; None if the system does not give it."""
    status = Path(f"/proc/{child}/status")
    lines = status.read_text(encoding="ascii").splitlines() if status.exists() else []
    return next((1e-6 * 1024 * float(line.split()[1]) for line in lines if line.startswith("VmHWM")), None)


def tell(pipe: Connection, work: Callable[[], Iterator[Numbers]], limits: Limits) -> None:
    """In the child: send each part of the work as it is computed, and how the work ended."""
    resource.setrlimit(resource.RLIMIT_AS, (limits.memory, limits.memory))
    ended = "done"
    try:
        for numbers in work():
            pipe.send((numbers, peak_memory(), "stopped"))
    except MemoryNeedError as error:  # the package's own words
        ended = str(error)
    except MemoryError:
        ended = f"more than {limits.memory / GIGABYTE:.3g} GB"
    except Exception as error:  # a failure is a row of the table
        ended = str(error)
    pipe.send(({}, peak_memory(), ended))


def in_child(work: Callable[[], Iterator[Numbers]], limits: Limits) -> Outcome:
    """Run work, a generator of numbers, in a fork of this process.

    >>> def work():
    ...     yield {"half": 1}
    ...     bytearray(2**40)
    >>> outcome = in_child(work, Limits(seconds=60.0))
    >>> outcome.numbers, outcome.ended
    ({'half': 1}, 'more than 14 GB')
    """
    context = get_context("fork")
    here, there = context.Pipe(duplex=False)
    child = context.Process(target=tell, args=(there, work, limits))
    child.start()
    there.close()
    numbers: Numbers = {}
    peak, ended = None, "stopped"
    deadline = time.monotonic() + limits.seconds
    while ended == "stopped":
        if not here.poll(max(0.0, deadline - time.monotonic())):
            ended, peak = f"not done after {limits.seconds:.0f} s", peak_of(child.pid)
            break
        try:
            part, peak, ended = here.recv()
        except EOFError:
            ended = "killed by the system"
            break
        numbers |= part
    child.kill()
    child.join()
    return Outcome(numbers, peak, ended)
