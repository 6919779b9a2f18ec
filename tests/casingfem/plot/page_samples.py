"""Numbers of a run for tests of pages: those of a made-up rub, any of which a test may give itself."""

from types import SimpleNamespace
from typing import Any

import numpy as np

import contact as ct
from casingfem.plot.pages.scene import Ran
from contact.interacting import COLUMNS
from contact.io.columns import records_of
from contact.on_rotor import RotorHistory
from contact.record.growth import RunGrowth
from contact.result import CONTACTS
from contact.speed_verdict import SpeedRun

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


def rotor_sample(*, cased: bool = False) -> RotorHistory:
    """A rotor on a circle of 0.5 mm at 80 Hz, alone or in a casing."""
    time = np.linspace(0.0, 0.4, 300)
    circle = 5e-4 * np.stack([np.cos(500.0 * time), np.sin(500.0 * time)], axis=1)
    other = circle if cased else None
    return RotorHistory(time=time, speed_hz=np.full(300, 80.0), disk=circle, casing=other, bearings=other, mounts=other)


def ran_sample(**given: Any) -> Ran:
    """A rub at 300 rpm that stays bounded, but for what is given."""
    numbers: dict[str, Any] = {
        "rubs": True, "steps": 20_000, "dt": 2e-5, "span": 0.4, "window": 8.9e-5, "contacts": [CONTACT],
        "contact_columns": CONTACTS,
        "force": 45.5, "impulse": 2.4, "closed": 0.08, "closings": 4, "least_gap": -1e-21, "residual": 1e-21,
        "unaccounted": 3e-13, "flags": (), "divergence": None, "growth": growth_sample(), "rim": rim_sample(),
        "speed_hz": 5.0, "tracks": (), "scheme": "exact modal", "seconds": 0.4,
    }  # fmt: skip
    return Ran(**numbers | given)


def run_rows(status: str = "done", motion: str = "bounded", count: int = 4) -> list[dict[str, Any]]:
    """Rows of a sweep over the speed, the last of which has this status and motion; the second has a warning."""
    rows: list[dict[str, Any]] = [
        {"speed.hz": float(k), "status": "done", "amplitude_m": 1e-6 * k, "peak_force_N": 10.0 * k,
         "contact_fraction": 0.1, "motion": "bounded", "growth_1_s": 0.1 * k, "growth_low_1_s": 0.1 * k - 0.5,
         "growth_high_1_s": 0.1 * k + 0.5, "half_wall_at_s": None, "body": "casing", "n": 3, "source": "",
         "dominant_n": 3, "diverged_at_s": None, "unaccounted_rel": 1e-13, "flags": "", "why": ""}
        for k in range(1, count + 1)
    ]  # fmt: skip
    rows[1]["flags"] = "step-coarse"
    rows[-1] |= {"status": status, "motion": motion}
    if status == "diverged":
        rows[-1] |= {"diverged_at_s": 0.2}
    if status in ("refused", "failed"):
        measured = [name for name in rows[-1] if name not in ("speed.hz", "status")]
        rows[-1] |= dict.fromkeys(measured) | {"flags": "", "why": "speed.hz: found 4, expected less than 3"}
    return rows


def orbit_sample(value: float, multiplier: complex) -> ct.cycles.Orbit:
    """An orbit of one channel x whose amplitude grows with the value."""
    return ct.cycles.Orbit(
        name="freq_hz", value=value, period=1.0 / value, periods=1, start=0.0, x=np.zeros(2),
        multipliers=np.array([multiplier, np.conj(multiplier)]), amplitude={"x": 1e-5 * value}, gap=np.array([1e-6]),
        force=np.array([2.0 * value]), closings=(1,), rests=(0,), touching=(), M=np.eye(2), iterations=3,
    )  # fmt: skip


def cycles_sample() -> ct.cycles.Cycles:
    """A branch from 10 to 16 Hz that folds at 13 Hz, where it loses its stability."""
    points = [orbit_sample(10.0 + k, (0.4 + 0.2 * k) * np.exp(0.3j)) for k in range(7)]
    fold = ct.cycles.Special(kind="fold", orbit=points[3], before=points[2])
    graze = ct.cycles.Special(kind="grazing", orbit=points[1], before=points[0])
    return ct.cycles.Cycles(
        name="freq_hz", branches=(ct.cycles.Branch(points=tuple(points), specials=(graze, fold)),), seconds=1.0
    )


def trace_samples() -> list[ct.cycles.Trace]:
    """A stable and an unstable orbit over their period."""
    time = np.linspace(0.0, 1.0, 241)
    return [
        ct.cycles.Trace(orbit=orbit_sample(value, size), time=time / value,
              displacement={"x": 1e-5 * value * np.cos(2.0 * np.pi * time)})
        for value, size in ((12.0, 0.8), (14.0, 1.2))
    ]  # fmt: skip


def speeds_sample() -> Any:
    """A table of dangerous speeds from 1 to 10 Hz: unstable from 4 to 5 Hz, else safe."""

    def run(speed: float, verdict: str, growth: float) -> Any:
        return SpeedRun(
            speed_hz=speed, verdict=verdict, closed=12.0, growth=growth, low=growth - 0.1, high=growth + 0.1,
            amplitude_m=1e-5 * speed, half_wall_s=2.0 if growth > 0.0 else np.inf, n=3, wave="with", body="casing",
            seconds=0.4, contact=0.3, check="converged" if growth > 0.0 else "", force_n=40.0 * speed,
        )  # fmt: skip

    runs = (run(2.0, "safe", -0.5), run(4.5, "unstable", 3.0), run(9.0, "safe", -0.4))
    row = SimpleNamespace(
        from_hz=4.0, to_hz=5.0, at=runs[1], peak=None, n=3, wave="with", body="casing", mode=None, mover="casing"
    )
    peaks = SimpleNamespace(map=SimpleNamespace(speed_hz=np.linspace(1.0, 10.0, 10)), rotor=False)
    return SimpleNamespace(
        rows=(row,), runs=runs, peaks=peaks, COLUMNS=COLUMNS, words="3 runs of the scene: 1 unstable, 2 safe.",
        records=lambda: records_of(COLUMNS, SimpleNamespace(rows=(row,))),
    )  # fmt: skip
