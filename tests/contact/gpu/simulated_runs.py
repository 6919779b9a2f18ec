"""Runs of rims by the kernel on the simulator of a device, written to a file; started with NUMBA_ENABLE_CUDASIM=1."""

import sys
from dataclasses import replace

import numpy as np

from contact.gpu import device_runs
from tests.contact.test_run_many import different, scene

FEW = 8_000  # bytes that make two groups


def scenes():
    """Open, sliding, sticking and leaning contacts of different bases, speeds and steps."""
    given = [*different(), scene(speed_hz=20.0, mu=0.3, clearance=-4e-4, imperfect=0.1)]
    return [replace(one, t_end=steps * one.dt) for one, steps in zip(given, [60, 40] * 6, strict=True)]


def main(path):
    """Write the arrays of the runs."""
    found = device_runs(scenes(), most_bytes=FEW)
    names = ("q", "steps", "contact_steps", "impulse", "work", "rotation", "friction", "damping", "peak", "penetration")
    np.savez(path, stopped=np.array(found.stopped), **{name: getattr(found, name) for name in names})


if __name__ == "__main__":
    main(sys.argv[1])
