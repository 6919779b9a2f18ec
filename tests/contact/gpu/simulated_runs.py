"""Runs of rims by the kernel on the simulator of a device, written to a file; started with NUMBA_ENABLE_CUDASIM=1."""

import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

import contact as ct
from contact.gpu import device_runs
from tests.contact.synthetic_rim import blade
from tests.contact.test_run_many import different, scene

NAMES = ("q", "steps", "contact_steps", "impulse", "work", "rotation", "friction", "damping", "peak", "penetration")
GROUP = 128  # runs that are on the device together if there is little memory


def scenes():
    """Open, sliding, sticking and leaning contacts of different bases, speeds and steps."""
    given = [*different(), scene(speed_hz=20.0, mu=0.3, clearance=-4e-4, imperfect=0.1)]
    return [replace(one, t_end=steps * one.dt) for one, steps in zip(given, [60, 40] * 6, strict=True)]


def stopping():
    """Two tips that fly off, one sooner; a rim that deflects by millimetres, with walls of five sizes [m]."""
    hit = scene(t_end=1.4e-3, mu=0.2, clearance=-1e-4, blade_velocity=[10.0, 0.0])
    flying = [replace(hit, what=replace(hit.what, blade_velocity=[v, 0.0])) for v in (100.0, 300.0)]
    walls = (1e-4, 1e-3, 1e-2, 3e-2, 1e-1)
    return flying + [
        replace(hit, what=replace(hit.what, casing=replace(hit.what.casing, thickness=one))) for one in walls
    ]


def refusals():
    """Scenes that the kernel does not take."""
    fewer = replace(scene(), what=replace(scene().what, blade=blade().truncated(2000.0)))
    rod = ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, elements=20, x=1.0, velocity=-1.0)
    return [[], [scene(), fewer], [scene(), ct.Scene(what=[rod, ct.Wall()], t_end=1.0, courant=0.9)]]


def refused(scenes):
    """What is said of them."""
    try:
        device_runs(scenes)
    except ct.InputError as error:
        return str(error)
    return ""


def many():
    """More runs than a group, each of two steps and of its own speed."""
    return [scene(t_end=4e-5, mu=0.2, clearance=-1e-4, speed_hz=one) for one in np.linspace(1.0, 40.0, GROUP + 2)]


def main(path):
    """Write the arrays of the runs, and in text how runs stop, the shares of the work, and refusals."""
    shares = []
    ends = device_runs(stopping(), progress=shares.append)
    parts, few = device_runs(many(), most_bytes=1, progress=shares.append), [0, GROUP - 1, GROUP, GROUP + 1]
    alone = device_runs([many()[k] for k in few])
    text = {
        "stopped": ends.stopped, "steps": ends.steps.tolist(), "shares": shares,
        "same": all(np.array_equal(getattr(alone, name), getattr(parts, name)[few]) for name in NAMES),
        "refused": [refused(scenes) for scenes in refusals()],
    }  # fmt: skip
    Path(path).with_suffix(".json").write_text(json.dumps(text), encoding="utf-8")
    found = device_runs(scenes())
    np.savez(path, stopped=np.array(found.stopped), **{name: getattr(found, name) for name in NAMES})


if __name__ == "__main__":
    main(sys.argv[1])
