"""Runs a second of rubs on a CUDA device over the size of a batch, and on all cores of this machine.

`python -m reports.benchmarks.device [--quick] [--out DIR]`. Rims of ten modes and blades of two, 32 different bases
repeated, 2,000 steps with friction. For 1,000 to 1,000,000 runs together: seconds of the launches, runs and run-steps a
second, and the share of `LIMIT`, the double-precision operations a second of the device. The first row is
`ct.run_many` on one core, times the cores. The largest difference of the impulses of the first 32 runs to it must be
below 1e-12 of them. Takes below ten minutes; with NUMBA_ENABLE_CUDASIM=1 and --quick it runs on the simulator.
"""

import time
from pathlib import Path

import numpy as np

import contact as ct
from casingfem.io.side_by_side import usable_cores
from contact.gpu.device import simulated
from contact.gpu.rubs import advanced, run_of
from contact.prepared import prepared
from contact.scheme.modal.slot import slot_of
from reports.tables import Row, command_line, show, write

SIZES = (1_000, 10_000, 100_000, 1_000_000)
KINDS = 32
STEPS = 2_000
LIMIT = 34e12  # operations a second in double precision, of one H100 (SXM) without its tensor cores
TOP, SIZE = 6, 13


def casing(rng: np.random.Generator) -> ct.ModalBody:
    """A ring of the pairs n = 2 to 6 whose modes contain small parts of all waves."""
    rows, omega = [], []
    for n in range(2, TOP + 1):
        for first, second, sign in ((n, SIZE + TOP + n, -1.0), (TOP + n, SIZE + n, 1.0)):
            row = 0.05 * rng.standard_normal(2 * SIZE)
            row[first] += 1.0
            row[second] += sign / n
            rows.append(row)
            omega.append(2.0 * np.pi * 20.0 * (n * n - 1.0) * (1.0 + 0.01 * rng.standard_normal()))
    order = np.argsort(omega)
    return ct.ModalBody(
        omega=np.array(omega)[order], zeta=np.full(len(omega), 0.005), channels=ct.bodies.rim_channels(TOP),
        rows=np.array(rows)[order].T, S=4e-7 * np.eye(2 * SIZE), kind="rim", n_max=TOP, radius=0.45,
    )  # fmt: skip


def scenes(count: int, steps: int) -> list[ct.Scene]:
    """Different casings that rub."""
    rng = np.random.default_rng(5)
    blade = ct.ModalBody(
        omega=np.array([754.0, 5655.0]), zeta=np.array([0.01, 0.01]), channels=("span", "flap"),
        rows=np.array([[0.08, 0.16], [1.6, 0.4]]), S=np.array([[1e-6, 2.5e-7], [2.5e-7, 3e-6]]),
    )  # fmt: skip
    return [
        ct.Scene(
            what=ct.RotatingRim(
                casing(rng), blade, clearance=1e-4, speed_hz=20.0, out_of_roundness=[{"p": 2, "cos": 2.5e-4}],
                lean_deg=25.0,
            ),
            law=ct.Coulomb(mu=0.1), t_end=2e-5 * steps, dt=2e-5, scheme=ct.ExactModal(skip=False),
        )
        for _ in range(count)
    ]  # fmt: skip


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print and write the table."""
    kinds, steps, sizes = (3, 600, (3, 6)) if quick else (KINDS, STEPS, SIZES)
    given = scenes(kinds, steps)
    ct.run_many(given[:1])  # compiles
    began = time.perf_counter()
    alone = ct.run_many(given)
    rate = kinds * steps / (time.perf_counter() - began) * usable_cores()
    assert all(isinstance(one, ct.Result) for one in alone)
    ready = [prepared(scene) for scene in given]
    runs = [run_of(k, one) for k, one in enumerate(ready)]
    slots = [slot_of(run) for run in runs]
    operations = 2.0 * slots[0].normal.value.size + 6.0 * (TOP + 1) + 14.0 * runs[0].system.omega.size
    where = "simulator" if simulated() else "device"
    rows: list[Row] = [{"where": f"{usable_cores()} cores", "runs": kinds, "run-steps/s": rate}]
    advanced(ready, runs, slots, lambda _: None)  # compiles
    runs = [run_of(k, prepared(scene)) for k, scene in enumerate(given)]
    for size in sizes:
        which = [k % kinds for k in range(size)]
        found, seconds = advanced(
            [ready[k] for k in which], [runs[k] for k in which], [slots[k] for k in which], lambda _: None
        )
        impulse = np.array([one.impulse[0] for one in alone if isinstance(one, ct.Result)])
        taken = float(found["steps"].sum())
        rows.append({
            "where": where, "runs": size, "s": seconds, "runs/s": size / seconds, "run-steps/s": taken / seconds,
            "share of the limit %": 100.0 * taken / seconds * operations / LIMIT,
            "difference": float(np.abs(found["impulse"][:kinds] / impulse - 1.0).max()),
        })  # fmt: skip
    names = dict.fromkeys(name for row in rows for name in row)
    rows = [{name: row.get(name) for name in names} for row in rows]
    show("Rubs on a device", rows)
    write(out / "device.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
