"""Coverage of the interval of a run's growth, for pairs of a casing and a blade in closed contact with known poles.

`python -m reports.verification.rubs.growth_intervals [--count 260] [--first 0] [--quick] [--out DIR]` draws pairs of a
casing mode and a blade mode with a soft contact, at the speed of their fastest pole or 0.1 % beside it, and runs them
for 0.15 to 1.4 s. If the contact stays closed the motion is linear: it grows with the pole, and a forced motion does
not grow. The 95 % interval should contain the pole in 92 to 97 % of the runs: of all, of those shorter than half a
second, and of the longer ones. Its constants were chosen on seeds below 1500.
"""

from pathlib import Path

import numpy as np

import contact as ct
from contact.model.gaps.bladed_disk import pair_rim
from contact.stability.closed_contact import growth
from reports.tables import Row, command_line, show, write

STEP = 4e-5  # s
EVERY = 17  # steps between two states
LEAST, MOST = 0.3, 4.5  # e-folds by which a run grows
CLOSED = 0.99
SHARE = (92.0, 97.0)  # per cent
HALF = 0.5  # s: runs are short or long
QUICK = 24  # draws; about one in four gives a run that is compared


def drawn(seed: int) -> tuple[ct.Rub, float, float]:
    """A rub of one pair at a speed, its pole [1/s], and the length of its run [s]."""
    rng = np.random.default_rng(seed)
    n, casing_hz, blade_hz = int(rng.integers(2, 6)), float(rng.uniform(200.0, 400.0)), float(rng.uniform(80.0, 150.0))
    pair = ct.gaps.HandPair(
        casing=ct.gaps.ModalPair(n=n, freq_hz=casing_hz, modal_mass=1.5, zeta=float(10.0 ** rng.uniform(-4.0, -2.3))),
        blade=ct.gaps.ModalPair(freq_hz=blade_hz, modal_mass=0.2), compliance=float(10.0 ** rng.uniform(-5.0, -3.7)),
    )  # fmt: skip
    near = (casing_hz + blade_hz) / n
    peak = ct.stability.of_contact(pair.contact(), np.linspace(0.9 * near, 1.1 * near, 301)).peak_speed_hz
    hz = peak * float(rng.choice([1.0, 1.0, 1.001, 0.999]))
    blade = ct.ModalBody(
        omega=[2.0 * np.pi * blade_hz], zeta=[0.0], channels=("span", "flap"),
        rows=[[pair.blade.modal_mass**-0.5], [0.0]], S=pair.compliance * np.eye(2),
    )  # fmt: skip
    rub = ct.Rub(pair_rim(pair.casing, radius=0.5), (blade,), clearance=-1e-2, speed=ct.Speed.constant(hz))
    return rub, float(growth(pair.contact(), np.array([hz]))[0]), float(rng.uniform(0.15, 1.4))


def compared(seed: int) -> Row | None:
    """The growth of a run and its pole; None if it hardly grows, or if its contact opens."""
    rub, pole, end = drawn(seed)
    if not LEAST < pole * end < MOST:
        return None
    try:
        result = ct.run(rub, t_end=end, dt=STEP, record=ct.Record(every=EVERY, state_every=EVERY))
    except ct.NumericsError:
        return None
    found = result.growth
    if found is None or result.contact_steps[0] < CLOSED * result.steps or not np.isfinite(found.rate):
        return None
    return {
        "seed": seed, "seconds": end, "pole 1/s": pole, "growth 1/s": found.rate, "low": found.low, "high": found.high,
        "inside": found.low <= pole <= found.high,
    }  # fmt: skip


def _share(name: str, rows: list[Row], quick: bool) -> Row:
    """Share of runs whose interval contains the pole."""
    pole, growth, low, high = (
        np.array([float(str(row[key])) for row in rows]) for key in ("pole 1/s", "growth 1/s", "low", "high")
    )
    share = 100.0 * float(np.mean((low <= pole) & (pole <= high)))
    return {
        "length": name, "runs": len(rows), "interval has the pole %": share,
        "half interval over pole": float(np.median(0.5 * (high - low) / pole)),
        "off over pole": float(np.median(np.abs(growth / pole - 1.0))),
        "verdict": "pass" if quick or SHARE[0] <= share <= SHARE[1] else "FAIL",
    }  # fmt: skip


def main(out: Path, quick: bool = False, count: int = 260, first: int = 0) -> list[Row]:
    """Print the share of runs whose interval contains the pole; write a row for each."""
    found = [compared(seed) for seed in range(first, first + (min(count, QUICK) if quick else count))]
    rows = [row for row in found if row is not None]
    write(out / "growth_intervals.csv", rows)
    parts = {
        "all": rows, f"below {HALF:g} s": [row for row in rows if float(str(row["seconds"])) < HALF],
        f"from {HALF:g} s": [row for row in rows if float(str(row["seconds"])) >= HALF],
    }  # fmt: skip
    table = [_share(name, part, quick) for name, part in parts.items() if part]
    show("Growth of runs beside the pole of closed contact", table)
    return table


if __name__ == "__main__":
    command_line(__doc__, main, count=(260, "how many draws"), first=(0, "seed of the first"))
