"""Processor time of an identification beyond start-up, by the size of the set, against what is allowed.

`python -m reports.benchmarks.identification_times [--quick] [--out DIR]` makes rims of
`reports.verification.updating.unkind` without troubles, with noise 40 dB below each channel's rms, identifies each
without help in one process, and prints a row as soon as a set is done: channels, lines, modes, what was found, seconds,
the limit, and the largest memory of the process so far. `--size K` times the Kth set alone. Every set is identified
once; a small one before starts the libraries. It writes identification_times.csv.
"""

import resource
import sys
import time
from pathlib import Path

import numpy as np

from casingfem.experiment.identify.identification import identify
from casingfem.experiment.rig.files import rig_angles
from casingfem.experiment.rig.rig import noisy
from reports.tables import Row, command_line, text, write
from reports.verification.updating.unkind import STEP_HZ, rim

SEED, SNR_DB = 12201, 40.0
SIZES = ((3, 1, 1_000, 0.5), (16, 1, 1_000, 1.0), (12, 1, 15_000, 4.0), (120, 1, 15_000, 20.0), (1_500, 2, 3_200, 60.0))
PEAK = 1024.0 * (1024.0 if sys.platform == "darwin" else 1.0)  # units of ru_maxrss in a MiB
SHORT = 1_000  # lines, from which on the band holds all modes


def timed(sensors: int, references: int, count: int, allowed: float) -> Row:
    """Make and identify one set of so many sensors, references and lines; `allowed` in processor seconds."""
    rig = rim(SEED, sensors)
    low, high = 0.97 * rig.freq[0], 1.03 * rig.freq[-1]
    lines = low + STEP_HZ * np.arange(count) if count <= SHORT else np.linspace(low, high, count)
    drives = [sensors, 0][:references]
    frfs = noisy(rig.frfs(lines, sensors=range(sensors), drives=drives), SNR_DB, seed=SEED)
    started = time.process_time()
    found = identify(frfs, angles=rig_angles(rig))
    seconds = time.process_time() - started
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
    }


def main(out: Path, quick: bool = False, size: int = 0) -> list[Row]:
    """Time the sizes, print and write their rows."""
    timed(*SIZES[0])
    rows = list[Row]()
    print("Processor seconds of one identification, SYNTHETIC")
    for each in (size,) if size else range(1, 1 + (3 if quick else len(SIZES))):
        rows.append(timed(*SIZES[each - 1]))
        print(", ".join(f"{name} {text(value)}" for name, value in rows[-1].items()), flush=True)
    write(out / "identification_times.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main, size=(0, "the Kth set alone, from 1; 0 for all"))
