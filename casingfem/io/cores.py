"""How many cores this process may use: on shared machines fewer than there are."""

import os


def usable_cores() -> int:
    """Cores that the scheduler gives this process; where it does not say, those of the machine."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
