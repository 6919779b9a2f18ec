"""A sweep that is killed repeatedly: every run finishes after resuming, with the table of an undisturbed sweep.

`python -m reports.verification.robustness.sweep_kills [--quick] [--out DIR]`. A Dask scheduler and two workers on this
machine (extra `cluster`); 10,000 short runs, 20 times a worker and 5 times the driver get kill -9 at random moments and
are started again. --quick takes 200 runs, 2 workers' kills and 1 driver's.
"""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

import contact as ct
from contact.sweep.plan import SweepPlan, load_sweep
from contact.sweep.row import Store
from contact.sweep.sweep import SweepResult, run_sweep, table
from reports.tables import ROOT, Row, command_line, show, write

SEED = 20261
DEADLINE = 3600.0  # s, on a busy machine
DRIVER = """
import sys
from pathlib import Path
from contact.sweep.sweep import run_sweep
from contact.sweep.plan import load_sweep
run_sweep(load_sweep(sys.argv[1]), folder=Path(sys.argv[2]), scheduler=sys.argv[3] or None, jobs=2)
"""
SCENE = """[scene]
kind = "rim"
t_end = {t_end}
[casing]
basis = "casing.npz"
[blade]
basis = "blade.npz"
lean_deg = 10.0
[contact]
clearance = 1e-4
friction = 0.1
out_of_roundness = [{{p = 2, cos = 2e-4}}]
[speed]
hz = 20.0
turning = "blades"
[scheme]
kind = "exact-modal"
dt = 2e-5
[sweep]
kind = "random"
draws = {draws}
seed = 31
[[sweep.vary]]
key = "speed.hz"
from = 5.0
to = 40.0
[[sweep.vary]]
key = "contact.clearance"
from = 0.0
to = 2.5e-4
[[sweep.vary]]
key = "contact.friction"
from = 0.0
to = 0.3
[[sweep.vary]]
key = "casing.seed"
from = 0
to = 1000
[[sweep.vary]]
key = "casing.scatter"
values = [0.005]
"""


def write_scene(folder: Path, draws: int, t_end: float) -> Path:
    """A steel ring and a blade of two modes, and the sweep over them."""
    folder.mkdir(parents=True, exist_ok=True)
    ring = ct.bodies.ThinRing(radius=0.25, width=0.05, height=4e-3, E=210e9, rho=7800.0, k_r=2e7, k_t=2e6, zeta=0.005)
    ct.bodies.ring_modes(ring, 8).truncated(8e4).save(folder / "casing.npz")
    ct.ModalBody(
        omega=[2.0 * np.pi * 380.0, 2.0 * np.pi * 2400.0], zeta=[0.002, 0.002], channels=("span", "flap"),
        rows=[[0.1, 0.2], [2.0, 0.5]], S=[[2e-8, 0.0], [0.0, 6e-8]],
    ).save(folder / "blade.npz")  # fmt: skip
    file = folder / "sweep.toml"
    file.write_text(SCENE.format(draws=draws, t_end=t_end), encoding="utf-8")
    return file


def start(folder: Path, name: str, *arguments: str) -> subprocess.Popen[bytes]:
    """A process of this Python with the project on its path; its output goes to a file in the folder."""
    path = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    with (folder / f"{name}.log").open("ab") as log:
        return subprocess.Popen(
            [sys.executable, *arguments], env={**os.environ, "PYTHONPATH": path, "OPENBLAS_NUM_THREADS": "1"},
            stdout=log, stderr=log, cwd=folder,
        )  # fmt: skip


def driver(folder: Path, sweep: Path, store: Path, address: str = "") -> subprocess.Popen[bytes]:
    """A process that runs the sweep into the store: on the scheduler, or with two workers of its own."""
    return start(folder, "driver", "-c", DRIVER, str(sweep), str(store), address)


def finished(store: Path) -> int:
    """Number of runs with a file in the store."""
    return sum(1 for _ in (store / "runs").glob("??/*.json"))


@dataclass(slots=True, kw_only=True)
class Cluster:
    """Processes on this machine: a scheduler, workers, and the driver; only these are ever killed."""

    folder: Path
    sweep: Path
    store: Path
    address: str = ""
    scheduler: subprocess.Popen[bytes] | None = None
    workers: list[subprocess.Popen[bytes]] = field(default_factory=list)
    driver: subprocess.Popen[bytes] | None = None

    def open(self) -> None:
        """Start scheduler, two workers and driver."""
        card = self.folder / "scheduler.json"
        card.unlink(missing_ok=True)
        self.scheduler = start(
            self.folder, "scheduler", "-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0",
            "--no-dashboard", "--scheduler-file", str(card),
        )  # fmt: skip
        deadline = time.monotonic() + 120.0
        while not card.exists() and time.monotonic() < deadline:
            time.sleep(0.1)
        self.address = json.loads(card.read_text(encoding="utf-8"))["address"]
        self.workers = [self.worker() for _ in range(2)]
        self.drive()

    def worker(self) -> subprocess.Popen[bytes]:
        """Start a further worker."""
        return start(
            self.folder, "worker", "-m", "distributed.cli.dask_worker", self.address, "--nthreads", "1", "--no-nanny",
            "--no-dashboard", "--local-directory", str(self.folder / "scratch"),
        )  # fmt: skip

    def drive(self) -> None:
        """Start the driver, which continues from the store."""
        self.driver = driver(self.folder, self.sweep, self.store, self.address)

    def kill_worker(self, k: int) -> None:
        """Kill -9 worker k and start another."""
        kill(self.workers[k])
        self.workers[k] = self.worker()

    def kill_driver(self) -> None:
        """Kill -9 the driver and start it again."""
        kill(self.driver)
        self.drive()

    def close(self) -> None:
        """End all."""
        for process in (self.driver, *self.workers, self.scheduler):
            kill(process)


def kill(process: subprocess.Popen[bytes] | None) -> None:
    """Kill -9, and wait for the end."""
    if process is not None and process.poll() is None:
        process.send_signal(signal.SIGKILL)
    if process is not None:
        process.wait()


def disturb(cluster: Cluster, runs: int, workers: int, drivers: int) -> tuple[int, int, float]:
    """Let the driver finish, killing at random numbers of finished runs: kills of workers, of drivers, seconds."""
    rng = np.random.default_rng(SEED)
    kinds = rng.permutation(["worker"] * workers + ["driver"] * drivers)
    moments = np.sort(rng.uniform(0.02, 0.95, kinds.size)) * runs
    began, done, killed = time.monotonic(), 0, [0, 0]
    while cluster.driver is not None and cluster.driver.poll() is None:
        if time.monotonic() - began > DEADLINE:
            raise RuntimeError(f"not done after {DEADLINE:.0f} s: see the logs in {cluster.folder}")
        if done < kinds.size and finished(cluster.store) >= moments[done]:
            if kinds[done] == "worker":
                cluster.kill_worker(int(rng.integers(2)))
            else:
                cluster.kill_driver()
            killed[kinds[done] == "driver"] += 1
            done += 1
        time.sleep(0.1)
    if cluster.driver is None or cluster.driver.returncode != 0:
        raise RuntimeError(f"the driver failed: see the logs in {cluster.folder}")
    return killed[0], killed[1], time.monotonic() - began


def damaged(store: Path) -> Path:
    """The store with one bit flipped in every hundredth run file, one file cut and one emptied."""
    rng = np.random.default_rng(SEED)
    files = Store.open(store).files()
    for file in files[2::100]:
        data = bytearray(file.read_bytes())
        data[int(rng.integers(len(data)))] ^= 1 << int(rng.integers(8))
        file.write_bytes(data)
    files[0].write_bytes(files[0].read_bytes()[:-20])
    files[1].write_bytes(b"")
    return store


def compared(plan: SweepPlan, undisturbed: SweepResult, store: Path) -> Row:
    """Contents of the store after all kills, compared with the undisturbed table."""
    expected, there = table(undisturbed), run_sweep(plan, folder=store)
    return {
        "finished before the table was asked for": there.resumed,
        "unreadable files": len(Store.open(store).unreadable()),
        "table identical": table(there) == expected,
        "identical after damage": table(run_sweep(plan, folder=damaged(store))) == expected,
    }


def main(out: Path, quick: bool = False) -> Sequence[Row]:
    """Run, kill, compare, print."""
    draws, t_end, workers, drivers = (200, 0.4, 2, 1) if quick else (10_000, 0.05, 20, 5)
    folder = (out / "sweep_kills").resolve()
    shutil.rmtree(folder, ignore_errors=True)
    sweep = write_scene(folder, draws, t_end)
    plan = load_sweep(sweep)
    began = time.monotonic()
    undisturbed = run_sweep(plan, jobs=2)
    alone = time.monotonic() - began
    cluster = Cluster(folder=folder, sweep=sweep, store=folder / "store")
    try:
        cluster.open()
        worker_kills, driver_kills, seconds = disturb(cluster, draws, workers, drivers)
    finally:
        cluster.close()
    row: Row = {
        "runs": draws, "failed": undisturbed.failed, "workers killed": worker_kills, "drivers killed": driver_kills,
        "s undisturbed, 2 processes": alone, "s with kills, 2 Dask workers": seconds,
    }  # fmt: skip
    row |= compared(plan, undisturbed, cluster.store)
    whole = row["table identical"] and row["identical after damage"] and not row["unreadable files"]
    row["verdict"] = "pass" if whole else "FAIL"
    show("A sweep under kill -9", [{"what": name, "value": value} for name, value in row.items()])
    write(out / "sweep_kills.csv", [row])
    return [row]


if __name__ == "__main__":
    command_line(__doc__, main)
