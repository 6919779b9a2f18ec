"""Numbers of a run for tests of pages: those of a made-up rub, any of which a test may give itself."""

from types import SimpleNamespace
from typing import Any

import numpy as np

from casingfem.plot.pages.scene import Ran
from contact.record.growth import RunGrowth

CONTACT = {
    "contact": 1, "closings": 4, "closed_s": 0.08, "impulse_N_s": 2.4, "peak_force_N": 46.0, "windowed_force_N": 45.5,
    "max_penetration_m": 1e-21, "residual_m": 1e-21,
}  # fmt: skip


def growth_sample(state: str = "bounded", rate: float = 0.1) -> RunGrowth:
    """A growth in this state."""
    reached = 1.25 if state == "grows" else np.inf
    return RunGrowth(rate=rate, low=rate - 0.5, high=rate + 0.5, state=state, amplitude=4e-5, steady=0.1, since=0.2,
                     time_to_half_wall=reached, cause=None)  # fmt: skip


def rim_sample(largest: float = 4.5e-5, wall: float = 3e-3) -> Any:
    """A rim of 300 states that deflects by so much."""
    time = np.linspace(0.0, 0.4, 300)
    waves = np.zeros((300, 5), complex)
    waves[:, 3] = largest * np.exp(2j * np.pi * 50.0 * time)
    deflection = np.full(300, largest)
    return SimpleNamespace(time=time, waves=waves, deflection=deflection, wall=wall, allowed=0.5 * wall,
                           largest=largest, with_blades=-1)  # fmt: skip


def ran_sample(**given: Any) -> Ran:
    """A rub at 300 rpm that stays bounded, but for what is given."""
    numbers: dict[str, Any] = {
        "rubs": True, "steps": 20_000, "dt": 2e-5, "span": 0.4, "window": 8.9e-5, "contacts": [CONTACT],
        "force": 45.5, "impulse": 2.4, "closed": 0.08, "closings": 4, "least_gap": -1e-21, "residual": 1e-21,
        "unaccounted": 3e-13, "flags": (), "divergence": None, "growth": growth_sample(), "rim": rim_sample(),
        "speed_hz": 5.0, "tracks": (), "scheme": "exact modal", "seconds": 0.4,
    }  # fmt: skip
    return Ran(**numbers | given)
