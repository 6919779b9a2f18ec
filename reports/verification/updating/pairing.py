"""Pairing of rotated doublets at few sensors with noise: the success rate and its limits.

`python -m reports.verification.updating.pairing [--quick] [--out DIR]`. A frustum as the reference one, its wall 8 mm:
20 modes, doublets of n = 2 to 11. A test consists of their radial motion at 24 sensors on one circle near the rim. Each
doublet is rotated by a random angle in its plane. Noise is 5 % of each shape's rms, and frequencies have errors of 1 %
rms, like those of a model before its update. Rows are in order of frequency and without a label. Each draw is paired by
frequency and shape together. pairing.csv: by noise, sensors lost and frequency error; a draw is right if every row is
in its own doublet.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

from casingfem.experiment.correlation.correlate import seen_mac
from casingfem.experiment.correlation.mac import mac, subspace_mac
from casingfem.experiment.correlation.pairing import pair
from casingfem.experiment.correlation.sensors import sensors_of
from casingfem.experiment.frequency_table import FrequencyTable
from casingfem.io.arrays import FloatArray
from casingfem.modal.modes import Modes, modes
from casingfem.structure.mesh.shell_mesh import ShellMesh
from reports.tables import Row, command_line, show, write
from reports.verification.modes.frustum import reference_frustum

MODES, SENSORS, HEIGHT = 20, 24, 0.245
MESH = ShellMesh(order=7, rows=1, around=21)
SEED = 77
CASES = (  # noise, sensors lost, frequency error
    (0.05, 0, 0.01), (0.10, 0, 0.01), (0.20, 0, 0.01), (0.40, 0, 0.01), (0.80, 0, 0.01),
    (0.05, 4, 0.01), (0.05, 8, 0.01), (0.05, 12, 0.01), (0.05, 0, 0.03), (0.05, 0, 0.06), (0.20, 8, 0.03),
)  # fmt: skip


def model() -> Modes:
    """The modes of the casing that is tested."""
    return modes(replace(reference_frustum(), thickness=8e-3, mesh=MESH), MODES, method="shell")


def at_sensors(found: Modes, height: float = HEIGHT) -> FloatArray:
    """Radial motion of the modes at the sensors, (sensors, modes)."""
    theta = 2.0 * np.pi * np.arange(SENSORS) / SENSORS + 0.03
    out = np.column_stack([np.cos(theta), np.sin(theta), 0.0 * theta])
    points = np.real(found.shell.geometry(np.full(SENSORS, height), theta).surface.x).T
    return np.asarray(sensors_of(found, points, out).shapes(found.fields))


def tested(
    found: Modes, shapes: FloatArray, noise: float, off: float, rng: np.random.Generator
) -> tuple[FloatArray, FloatArray, list[int]]:
    """Frequencies and shapes of one test in order of frequency, and the true mode of each row."""
    measured = shapes.copy()
    freq = found.freq.copy()
    for pair_ in found.doublets:
        angle = rng.uniform(0.0, 2.0 * np.pi)
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        measured[:, list(pair_)] = shapes[:, list(pair_)] @ turn
        freq[list(pair_)] *= 1.0 + rng.normal(0.0, off)
    rms = np.sqrt(np.mean(measured**2, axis=0))
    measured += noise * rms * rng.standard_normal(measured.shape)
    order = np.argsort(freq, kind="stable")
    return freq[order], measured[:, order], order.tolist()


def one(found: Modes, shapes: FloatArray, case: tuple[float, int, float], rng: np.random.Generator) -> Row:
    """One draw: number of rows in their own doublet, and the MACs of the true pairs."""
    noise, lost, off = case
    kept = np.sort(rng.permutation(SENSORS)[: SENSORS - lost])
    computed = shapes[kept]
    freq, measured, true = tested(found, computed, noise, off, rng)
    table = FrequencyTable.from_arrays(freq_hz=freq, sigma_hz=1e-3 * freq)
    pairing = pair(found, table, reach=0.25, shape_mac=seen_mac(measured, computed))
    mode_of = {row: mode for match in pairing.matches for row, mode in zip(match.rows, match.modes, strict=True)}
    right = [
        found.doublet_of(mode_of[row]) == found.doublet_of(mode) for row, mode in enumerate(true) if row in mode_of
    ]
    planes = [[true.index(mode) for mode in pair_] for pair_ in found.doublets]
    both = [subspace_mac(measured[:, rows], computed[:, list(p)])
            for rows, p in zip(planes, found.doublets, strict=True)]  # fmt: skip
    plain = np.diag(mac(measured, computed)[:, true]) if len(true) == len(freq) else np.zeros(0)
    return {
        "right": sum(right),
        "unpaired": len(freq) - len(mode_of),
        "subspace": min(both),
        "plain": float(plain.min()),
    }


def case_row(found: Modes, shapes: FloatArray, case: tuple[float, int, float], draws: int) -> Row:
    """All draws of one case."""
    rng = np.random.default_rng(SEED)
    rows = [one(found, shapes, case, rng) for _ in range(draws)]
    right = np.array([float(str(row["right"])) for row in rows])
    return {
        "noise %": 100.0 * case[0],
        "sensors": SENSORS - case[1],
        "frequency error %": 100.0 * case[2],
        "draws": draws,
        "draws right %": 100.0 * float(np.mean(right == len(found))),
        "rows right %": 100.0 * float(right.mean() / len(found)),
        "worst subspace MAC": min(float(str(row["subspace"])) for row in rows),
        "median of worst": float(np.median([float(str(row["subspace"])) for row in rows])),
        "worst plain MAC": min(float(str(row["plain"])) for row in rows),
    }


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the rows and write them."""
    found = model()
    shapes = at_sensors(found)
    draws = 20 if quick else 200
    rows = [case_row(found, shapes, case, draws) for case in (CASES[:2] if quick else CASES)]
    labels = ", ".join(str(found.nodal_diameters[low]) for low, _ in found.doublets)
    show(f"{len(found)} modes in {len(found.doublets)} doublets, n = {labels}", rows)
    write(out / "pairing.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
