"""Time runs of tips on a rim as requested on stdin; used by `reports.benchmarks.tips_beside`, in any checkout.

It imports `contact` only, from PYTHONPATH, and takes account of features that former versions do not have.
"""

import json
import sys
import time
from importlib import import_module
from pathlib import Path
from typing import Any

import contact as ct
from contact.record.record import samples
from contact.run import steps

prepared: Any = import_module("contact.run").prepared  # former versions define it there
DT, SPEED, LEAN = 1e-5, 5.0, 10.0
ROUGH = ({"p": 2, "cos": 2e-4}, {"p": 3, "cos": 5e-5})


def scene(asked: dict[str, Any]) -> ct.Scene:
    """The rub of a request: a rim with one tip, or as many blades as tips."""
    casing, blade = (ct.ModalBody.load(Path(asked["folder"]) / f"{name}.npz") for name in asked["bodies"])
    blade = blade.truncated(float(sorted(blade.omega)[1]) * 1.01)
    what: Any
    tips = asked["tips"]
    if tips == 1:
        what = ct.RotatingRim(
            casing, blade, clearance=asked["clearance"], speed_hz=SPEED, lean_deg=LEAN, out_of_roundness=ROUGH
        )
    else:
        points = [ct.ContactPoint(blade=j, lean_deg=LEAN, angle_deg=360.0 * j / tips) for j in range(tips)]
        what = ct.Rub(
            casing, (blade,) * tips, points, clearance=asked["clearance"],
            speed=ct.Speed.constant(SPEED), profile=ct.gaps.RimProfile.fourier(list(ROUGH)),
        )  # fmt: skip
    law = ct.Coulomb(mu=asked["mu"]) if asked["mu"] else ct.Unilateral()
    # the rim may swing far: the time of a step is asked for, not what it says
    more = {"on_limit": "flag"} if hasattr(ct.Scene, "on_limit") else {}
    exact, record = ct.ExactModal(skip=False), ct.Record(every=10_007)
    return ct.Scene(what=what, law=law, t_end=asked["steps"] * DT, dt=DT, record=record, scheme=exact, **more)


def timed(asked: dict[str, Any]) -> dict[str, float]:
    """Microseconds of processor time a step of the loop alone, steps in contact over all, and the impulse."""
    ready = prepared(scene(asked))
    stepper, record = ready.stepper, ready.record
    stepper.advance(samples(record, 0, stepper.sums.closed.size, stepper.size), 0, 0)  # compiles, takes no step
    began = time.process_time()
    taken = sum(chunk.steps for chunk in steps(stepper, ready.count, record=record))
    spent = time.process_time() - began
    closed = float(stepper.sums.contact_steps.mean()) / taken
    return {"us/step": 1e6 * spent / taken, "closed": closed, "impulse": float(stepper.sums.impulse.sum())}


if __name__ == "__main__":
    for line in sys.stdin:
        print(json.dumps(timed(json.loads(line))), flush=True)
