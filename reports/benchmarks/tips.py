"""Microseconds a step of a rub: tips around the rim by modes, free, without and with friction.

`python -m reports.benchmarks.tips [--quick] [--out DIR]`. Processor time of one core, the least of several runs: on a
machine that others use, compare commits in turns. The casing of `reports.benchmarks.sweeps` with its blade of two modes
in as many modes together as the table says, one blade a tip, at 5 Hz; out-of-roundness of two and three lobes. 256 tips
with friction that all touch at once are left out: the search for their forces takes minutes. `--quick` takes 42 modes
and up to four tips.

Shares are of what `reports.benchmarks.core_limits` measures, for what a step must at least do: 14 flops a mode; for the
mean number c of closed tips, of size = d c unknowns, the terms of their rows, size m (2 size + 4) flops for their
Delassus matrix and 2 size^3/3 for its factors. Cached memory: 14 numbers a mode, and the coefficients of those rows.
"""

import time
from pathlib import Path

import contact as ct
from contact.prepared import prepared
from contact.run import completed
from contact.scheme.modal.rub_stepper import RubStepper
from reports.benchmarks.core_limits import limits
from reports.benchmarks.sweeps import DT, ROUGH, bodies
from reports.tables import Row, command_line, show, write

TIPS, MODES = (1, 4, 16, 64, 256), (42, 102, 328, 984)
CASES = (("free", 1e-3, 0.0), ("frictionless", -1e-4, 0.0), ("friction", -1e-4, 0.3))  # clearance [m], mu
LEAN = 10.0


def rub(pair: tuple[ct.ModalBody, ct.ModalBody], tips: int, clearance: float) -> ct.Rub:
    """As many blades, one tip each, evenly around."""
    points = [ct.ContactPoint(blade=j, lean_deg=LEAN, angle_deg=360.0 * j / tips) for j in range(tips)]
    return ct.Rub(
        pair[0], (pair[1],) * tips, points, clearance=clearance, speed=ct.Speed.constant(5.0),
        profile=ct.gaps.RimProfile.fourier(list(ROUGH)),
    )  # fmt: skip


def least(what: ct.Rub, mu: float, steps: int, repeats: int) -> tuple[float, float, ct.Result]:
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


def shares(what: ct.Rub, mu: float, closed: float, taken: float, peak: dict[str, float]) -> Row:
    """Shares of the core's flops and of its cached memory [%] that a step of `taken` us uses."""
    law = ct.Coulomb(mu=mu) if mu else ct.Unilateral()
    stepper = ct.ExactModal().prepare(what, law, dt=DT, courant=None)
    assert isinstance(stepper, RubStepper)
    m, d = stepper.system.omega.size, stepper.dimensions
    terms = stepper.arrays.rows.casing.value.size / stepper.system.directions
    size = closed * len(what.tips) * d
    flops = 14.0 * m + 2.0 * size * terms + size * stepper.arrays.rows.width * (2.0 * size + 4.0) + 2.0 * size**3 / 3.0
    return {
        "% of peak flops": 1e-1 * flops / taken / peak["GFlop/s"],
        "% of cache bandwidth": 1e-1 * 8.0 * (14.0 * m + size * terms) / taken / peak["GB/s, 12 kB"],
    }  # fmt: skip


def table(modes: int, pair: tuple[ct.ModalBody, ct.ModalBody], peak: dict[str, float], quick: bool) -> list[Row]:
    """Rows of all numbers of tips."""
    rows: list[Row] = []
    for tips in TIPS[:2] if quick else TIPS:
        for name, clearance, mu in CASES:
            if tips == TIPS[-1] and mu:
                rows.append({"modes": modes, "tips": tips, "case": f"{name}: left out"})
                continue
            steps = (2_000 if tips < 16 else 500) if quick else (30_000 if tips < 16 else 2_000 if tips < 256 else 500)
            steps = max(500, steps * MODES[0] // modes)
            what, repeats = rub(pair, tips, clearance), 2 if quick else 5
            before, taken, result = least(what, mu, steps, repeats)
            closed = float(result.contact_steps.mean()) / result.steps
            row: Row = {
                "modes": modes, "tips": tips, "case": name, "closed": closed, "prepared [ms]": before,
                "us/step": taken, **shares(what, mu, closed, taken, peak),
            }  # fmt: skip
            rows.append(row)
    return rows


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print and write the table."""
    peak, rows = limits(1 if quick else 3), []
    for modes in MODES[:1] if quick else MODES:
        rows += table(modes, bodies(out / "tips", modes), peak, quick)
    show("Rubs by their modes and tips", rows)
    write(out / "speed_tips.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
