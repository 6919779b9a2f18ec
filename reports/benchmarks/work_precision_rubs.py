"""The rub in `work_precision`: the blade of NASA rotor 37 before a steel cylinder, over steps and over contacts.

Two turns at 298 turns/s touch four times each. Errors are against the rigid contact at an eighth of the shortest step.
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable
from functools import partial

import contact as ct
from reports.tables import Row
from reports.verification.rubs import rotor37

SCENE = "rub of rotor 37"
TURNS = 2.0
STEPS = (1.2e-5, 6e-6, 3e-6, 1.5e-6)  # s
STIFFNESS = {"spring of 1e8 N/m": 1e8, "spring of 1e9 N/m": 1e9}


MOST, ENOUGH = 12, 0.1  # runs, s: a busy machine interrupts some of them


def loop_seconds(run: Callable[[], ct.Result]) -> float:
    """Run time of a step loop [s]: the least of two runs or more, at most the processor time of the whole run."""
    found: list[float] = []
    while len(found) < 2 or (len(found) < MOST and sum(found) < ENOUGH):
        begun = time.thread_time()
        seconds = run().seconds
        found.append(min(seconds, time.thread_time() - begun))
    return min(found)


def rows(quick: bool) -> list[Row]:
    """Impulse and energy of the rigid contact, with and without flight between stored steps, and of springs."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=".*mesh-(thin-curved|coarse|distorted-cell)")
        warnings.filterwarnings("ignore", message=".*reduce-steady")  # the blade is valid from 153 to 375 turns/s
        what = rotor37.scene(rotor37.COARSE).what
    assert isinstance(what, ct.RotatingRim)
    t_end = TURNS / float(what.speed_hz)
    steps = STEPS[:1] if quick else STEPS

    def ran(scheme: ct.ExactModal, law: ct.Unilateral | ct.Penalty, dt: float, every: int) -> ct.Result:
        return ct.run(what, law=law, scheme=scheme, t_end=t_end, dt=dt, record=ct.Record(every=every))

    exact = float(ran(ct.ExactModal(), ct.Unilateral(), steps[-1] / 8.0, 1).impulse[0])
    methods: dict[str, tuple[ct.ExactModal, ct.Unilateral | ct.Penalty]] = {
        "exact modal, rigid": (ct.ExactModal(), ct.Unilateral()),
        "exact modal, rigid, every step": (ct.ExactModal(skip=False), ct.Unilateral()),
        **{f"exact modal, {name}": (ct.ExactModal(), ct.Penalty(stiffness=k)) for name, k in STIFFNESS.items()},
    }
    result: list[Row] = []
    for name, (scheme, law) in methods.items():
        for dt in steps:
            found = ran(scheme, law, dt, 1)
            spent = loop_seconds(partial(ran, scheme, law, dt, 1000))
            result.append({
                "scene": SCENE, "method": name, "elements": 1, "courant": dt, "steps": found.steps, "seconds": spent,
                "impulse": float(found.impulse[0]) / exact - 1.0,
                "unaccounted": abs(found.energy.unaccounted) / found.energy.scale, "us/step": 1e6 * spent / found.steps,
            })  # fmt: skip
    return result
