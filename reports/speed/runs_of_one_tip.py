"""Time runs of one tip on a rim as they are asked for on stdin; for `reports.speed.one_tip`, in any checkout.

It imports `contact` alone, from wherever PYTHONPATH says, and knows what former versions of it do not have.
"""

import json
import sys
import time
from pathlib import Path
from typing import Any

import contact as ct
from contact.run import completed, prepared

DT, SPEED, LEAN = 1e-5, 5.0, 10.0
ROUGH = ({"p": 2, "cos": 2e-4}, {"p": 3, "cos": 5e-5})


def scene(asked: dict[str, Any]) -> ct.Scene:
    """The rub that is asked for, as a rim or as a rub of one tip."""
    casing, blade = (ct.ModalBody.load(Path(asked["folder"]) / f"{name}.npz") for name in asked["bodies"])
    blade = blade.truncated(float(sorted(blade.omega)[1]) * 1.01)
    what: Any
    if asked["form"] == "RotatingRim":
        what = ct.RotatingRim(
            casing, blade, clearance=asked["clearance"], speed_hz=SPEED, lean_deg=LEAN, out_of_roundness=ROUGH
        )
    else:
        what = ct.Rub(
            casing, (blade,), [ct.ContactPoint(blade=0, lean_deg=LEAN)], clearance=asked["clearance"],
            speed=ct.Speed.constant(SPEED), profile=ct.RimProfile.fourier(list(ROUGH)),
        )  # fmt: skip
    law = ct.Coulomb(mu=asked["mu"]) if asked["mu"] else ct.Unilateral()
    # the rim may swing far: the time of a step is asked for, not what it says
    more = {"on_limit": "flag"} if hasattr(ct.Scene, "on_limit") else {}
    exact, record = ct.ExactModal(skip=False), ct.Record(every=10_007)
    return ct.Scene(what=what, law=law, t_end=asked["steps"] * DT, dt=DT, record=record, scheme=exact, **more)


def timed(asked: dict[str, Any]) -> dict[str, float]:
    """Microseconds of processor time a step, steps in contact over all, and the impulse."""
    ready = prepared(scene(asked))
    began = time.process_time()
    result = completed(ready)
    taken = time.process_time() - began
    closed, impulse = float(result.contact_steps[0]) / result.steps, float(result.impulse[0])
    return {"us/step": 1e6 * taken / result.steps, "closed": closed, "impulse": impulse}


if __name__ == "__main__":
    for line in sys.stdin:
        print(json.dumps(timed(json.loads(line))), flush=True)
