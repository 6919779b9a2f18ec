"""Processor time of an identification beyond start-up, by the size of the set, against what is allowed.

`python -m reports.benchmarks.identification_times [--quick] [--out DIR]` makes rims of
`reports.verification.updating.unkind` without troubles, with noise 40 dB below each channel's rms, identifies each
without help in one process, and prints a row after each set: channels, lines, modes, the modes found, seconds, the
limit, and the largest memory of the process so far. `--size K` times the Kth set alone. Every set is identified once,
after a small set that loads the libraries. It writes identification_times.csv. With `--beside FOLDER`, a checkout of
another commit, each set is identified there too, in a process of its own after a small one; `ratio` is the time there
over the time here.
"""

import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from casingfem.experiment.frf.frf_set import FrfSet
from casingfem.experiment.identify.identification import identify
from casingfem.experiment.rig.files import rig_angles
from casingfem.experiment.rig.rig import noisy
from reports.tables import Row, command_line, text, write
from reports.verification.updating.unkind import STEP_HZ, rim

SEED, SNR_DB = 12201, 40.0
SIZES = ((3, 1, 1_000, 0.5), (16, 1, 1_000, 1.0), (12, 1, 15_000, 4.0), (120, 1, 15_000, 20.0), (1_500, 2, 3_200, 60.0))
PEAK = 1024.0 * (1024.0 if sys.platform == "darwin" else 1.0)  # units of ru_maxrss in a MiB
SHORT = 1_000  # lines, from which on the band holds all modes


HERE = Path()
OTHER = """
import sys, time
import numpy as np
import casingfem as cf
data = np.load(sys.argv[1])
for last in (300, None):
    places = {name: data[name] for name in ("response_point", "reference_point")}
    frfs = cf.frf.FrfSet.from_arrays(
        kind="frf", x=data["x"][:last], responses=data["responses"][:, :last], unit=str(data["unit"]), **places
    )
    started = time.process_time()
    cf.identify(frfs, angles=dict(zip(data["points"].tolist(), data["angles"].tolist())))
    seconds = time.process_time() - started
print(seconds)
"""


def _beside(folder: Path, frfs: FrfSet, angles: dict[int, float]) -> float:
    """Processor seconds of the same identification by the packages of a folder."""
    with tempfile.TemporaryDirectory() as scratch:
        path = Path(scratch) / "set.npz"
        np.savez(
            path, x=frfs.x, responses=frfs.responses, unit=frfs.unit, response_point=frfs.response_point,
            reference_point=frfs.reference_point, points=list(angles), angles=list(angles.values()),
        )  # fmt: skip
        command = [sys.executable, "-c", OTHER, str(path)]
        environment = {**os.environ, "PYTHONPATH": str(folder.resolve())}
        ended = subprocess.run(command, cwd=folder, env=environment, stdout=subprocess.PIPE, text=True, check=True)
    return float(ended.stdout.split()[-1])


def timed(sensors: int, references: int, count: int, allowed: float, beside: Path = HERE) -> Row:
    """Make and identify one set of so many sensors, references and lines; `allowed` in processor seconds."""
    rig = rim(SEED, sensors)
    low, high = 0.97 * rig.freq[0], 1.03 * rig.freq[-1]
    lines = low + STEP_HZ * np.arange(count) if count <= SHORT else np.linspace(low, high, count)
    drives = [sensors, 0][:references]
    frfs = noisy(rig.frfs(lines, sensors=range(sensors), drives=drives), SNR_DB, seed=SEED)
    started = time.process_time()
    found = identify(frfs, angles=rig_angles(rig))
    seconds = time.process_time() - started
    other: Row = {}
    if beside != HERE:
        there = _beside(beside, frfs, rig_angles(rig))
        other = {"beside s": there, "ratio": there / seconds}
    return {
        "channels": len(frfs),
        "references": references,
        "lines": count,
        "modes": int(np.sum((rig.freq > lines[0]) & (rig.freq < lines[-1]))),
        "found": len(found),
        "sure": int(found.sure.sum()),
        "processor s": seconds,
        "allowed s": allowed,
        "peak MiB": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / PEAK,
        "verdict": "pass" if seconds <= allowed else "MISSED",
        **other,
    }


def main(out: Path, quick: bool = False, size: int = 0, beside: Path = HERE) -> list[Row]:
    """Time the sizes, print and write their rows."""
    timed(*SIZES[0])
    rows = list[Row]()
    print("Processor seconds of one identification, SYNTHETIC")
    for each in (size,) if size else range(1, 1 + (3 if quick else len(SIZES))):
        rows.append(timed(*SIZES[each - 1], beside))
        print(", ".join(f"{name} {text(value)}" for name, value in rows[-1].items()), flush=True)
    write(out / "identification_times.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(
        __doc__,
        main,
        size=(0, "the Kth set alone, from 1; 0 for all"),
        beside=(HERE, "checkout of another commit, or this one alone"),
    )
