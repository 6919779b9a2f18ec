"""Microseconds a step of a rub: tips around the rim, free, without and with friction; one tip both ways.

`python -m reports.speed.tips [--quick] [--out DIR]`. Processor time of one core, the least of several runs: on a
machine that others use, compare commits in turns. The casing of `reports.speed.sweeps` in 42 modes with its blade of
two, one blade a tip, at 5 Hz; out-of-roundness of two and three lobes.
"""

import time
from pathlib import Path

import contact as ct
from contact.run import completed, prepared
from reports.speed.sweeps import DT, ROUGH, bodies
from reports.tables import Row, command_line, show, write

TIPS = (1, 4, 16, 64, 256)
CASES = (("free", 1e-3, 0.0), ("frictionless", -1e-4, 0.0), ("friction", -1e-4, 0.3))  # clearance [m], mu
LEAN = 10.0


def rub(pair: tuple[ct.ModalBody, ct.ModalBody], tips: int, clearance: float) -> ct.Rub:
    """As many blades, one tip each, evenly around."""
    points = [ct.ContactPoint(blade=j, lean_deg=LEAN, angle_deg=360.0 * j / tips) for j in range(tips)]
    return ct.Rub(
        pair[0], (pair[1],) * tips, points, clearance=clearance, speed=ct.Speed.constant(5.0),
        profile=ct.RimProfile.fourier(list(ROUGH)),
    )  # fmt: skip


def least(what: ct.Rub | ct.RotatingRim, mu: float, steps: int, repeats: int) -> tuple[float, float, ct.Result]:
    """Least milliseconds to prepare and microseconds a step of so many runs, and the last result.

    A first one compiles and is not counted.
    """
    law = ct.Coulomb(mu=mu) if mu else ct.Unilateral()
    scene = ct.Scene(
        what=what, law=law, t_end=steps * DT, dt=DT, record=ct.Record(every=10_007), scheme=ct.ExactModal(skip=False),
        on_limit="flag",
    )  # fmt: skip
    before, times, result = [], [], completed(prepared(scene))
    for _ in range(repeats):
        began = time.process_time()
        ready = prepared(scene)
        before.append(time.process_time() - began)
        began = time.process_time()
        result = completed(ready)
        times.append(time.process_time() - began)
    return 1e3 * min(before), 1e6 * min(times) / result.steps, result


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print and write the table."""
    pair = bodies(out / "tips", 42)
    rows: list[Row] = []
    for tips in TIPS[:2] if quick else TIPS:
        for name, clearance, mu in CASES:
            if tips == 256 and mu:
                continue
            steps = (2_000 if tips < 16 else 500) if quick else (30_000 if tips < 16 else 2_000 if tips < 256 else 500)
            before, taken, result = least(rub(pair, tips, clearance), mu, steps, 2 if quick else 5)
            row: Row = {
                "tips": tips, "case": name, "closed": float(result.contact_steps.mean()) / result.steps,
                "prepared [ms]": before, "us/step": taken, "as RotatingRim us/step": None,
            }  # fmt: skip
            if tips == 1:
                rim = ct.RotatingRim(*pair, clearance=clearance, speed_hz=5.0, lean_deg=LEAN, out_of_roundness=ROUGH)
                _, row["as RotatingRim us/step"], _ = least(rim, mu, steps, 2 if quick else 5)
            rows.append(row)
    show("Rubs by their tips, 42 modes", rows)
    write(out / "speed_tips.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
