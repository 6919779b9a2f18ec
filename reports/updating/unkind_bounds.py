"""How well the modes of the tests of `reports.updating.unkind` can be known at all: Cramer-Rao bounds.

`python -m reports.updating.unkind_bounds [--quick] [--out DIR]`. For one who knows the noise of each channel but what
the others tell of it, which channels are spoilt, how many modes there are and of which n, and that shapes are waves
round the circle within 4.5 % and 5 deg: the least standard deviation of each mode's mean frequency over the set-ups, by
the equations of `casingfem.experiment.identify.setups.wave_fit` at the true poles. It prints how many of the modes
above the noise no method can know to 0.02 % in 95 of 100 tests, and the largest bounds, and writes unkind_bounds.csv.
"""

from pathlib import Path

import numpy as np

from casingfem.experiment.identify.poles.bands import line_noise
from casingfem.experiment.identify.poles.pole_window import Window
from casingfem.experiment.identify.setups.around import Places
from casingfem.experiment.identify.setups.clusters import AROUND, REACH, Cluster
from casingfem.experiment.identify.setups.inner_products import Problem
from casingfem.experiment.identify.setups.own_shifts import Modes
from casingfem.experiment.identify.setups.wave_fit import wave_fit
from casingfem.experiment.identify.setups.wave_model import WIDE, Shapes, WaveProblem, Waves
from casingfem.experiment.rig.files import rig_angles
from casingfem.experiment.rig.rig import Rig
from casingfem.experiment.rig.troubles import TroubledTest, troubled_frfs
from casingfem.io.arrays import FloatArray, IntArray
from reports.tables import Row, command_line, show, write
from reports.updating.unkind import ABOVE, NORMAL, SEEDS, SENSORS, STEP_HZ, TROUBLES, rim

ASKED = 2e-4  # of a frequency
OFF, LAG = 0.045, 0.0873  # what shapes are off a wave, real and imaginary parts over a mode's size
ORDERS = tuple(range(2, 10))


def bounds(rig: Rig, test: TroubledTest) -> FloatArray:
    """Least standard deviation of each mode's mean ln f, (modes,)."""
    truth, count = test.truth, len(test.truth.setup)
    freq, zeta = truth.freq.T, truth.zeta.mean(axis=0)
    theta = np.radians(np.array(list(rig_angles(rig).values())))[:count]
    setups = [np.flatnonzero(truth.setup == s) for s in range(len(truth.freq))]
    places = Places(theta, np.ones(count), np.zeros(count, int), ORDERS)
    columns, spoilt = (
        np.array([places.waves(n) for n in ORDERS]),
        [*truth.dead, *truth.flipped, *sum(truth.swapped, ())],
    )
    off, lag = (np.full((len(ORDERS), count), size) for size in (OFF, LAG))
    off[:, spoilt] = lag[:, spoilt] = WIDE
    rows = rig.rows[:count].T * rig.rows[SENSORS][:, None] / rig.omega[:, None] ** 2
    rest = [rows - (rows @ Q) @ Q.T for Q in (np.linalg.qr(each)[0] for each in columns)]
    kind = np.sum(np.square(rest), axis=2).argmin(axis=0)
    noise, lines = line_noise(test.frfs.responses) * np.sqrt(untold(count)), test.frfs.x
    found = np.zeros(len(zeta))
    reach = (REACH[0] + REACH[1] * zeta) * freq.min(axis=1)
    apart = np.flatnonzero(freq.min(axis=1)[1:] - freq.max(axis=1)[:-1] > reach[1:] + reach[:-1]) + 1
    for members in np.split(np.arange(len(zeta)), apart):
        found[members] = _of_cluster(members, Modes(freq, zeta, rows.astype(complex)), lines, noise, setups,
                                     Waves(columns, off, lag), kind)  # fmt: skip
    return found


def untold(channels: int) -> float:
    """Share of a channel's noise that others do not tell: 1/(R^-1)_cc of R = (1 - s) 1 + s t t^H, s in common."""
    ratio = TROUBLES.coherent / (1.0 - TROUBLES.coherent)
    return (1.0 - TROUBLES.coherent) * (1.0 + channels * ratio) / (1.0 + (channels - 1) * ratio)


def _of_cluster(
    members: IntArray, modes: Modes, lines: FloatArray, noise: FloatArray, setups: list[IntArray], waves: Waves,
    kind: IntArray,
) -> FloatArray:  # fmt: skip
    """Bounds of modes near each other."""
    mine = modes.some(members)
    wide = 1.0 + AROUND * mine.zeta.max()
    here = lines[(lines > mine.freq.min() / wide) & (lines < mine.freq.max() * wide)]
    scale = (2.0 * np.pi) ** 2 / noise  # responses are accelerances, of residues in (j f)^2
    empty = np.zeros((2 * len(here), len(noise)))
    window = Window(freq=here, Y=empty, power=2, residues="complex", weight=scale, floor=0.0, along=np.ones(len(here)),
                    leak=STEP_HZ)  # fmt: skip
    clean = mine.response(window, setups)
    window = Window(freq=here, Y=np.concatenate([clean.real, clean.imag]), power=2, residues="complex", weight=scale,
                    floor=0.0, along=window.along, leak=STEP_HZ)  # fmt: skip
    c = Cluster(mine, window, (float(here[0]), float(here[-1])), 1.0)
    problem = WaveProblem(c, Problem.of(window, setups), scale * window.scale**2, waves, TROUBLES.shift / np.sqrt(3.0))
    shapes = Shapes(kind[members], np.sqrt(np.mean(np.abs(mine.residues) ** 2, axis=1)))
    m, count = mine.freq.shape
    covariance = wave_fit(problem, shapes, np.log(mine.freq), np.log(mine.zeta)).covariance(1.0)
    own = covariance[: m * count, : m * count].reshape(m, count, m, count)
    return np.asarray(np.sqrt(np.maximum([own[k, :, k, :].sum() for k in range(m)], 0.0)) / count)


def main(out: Path, quick: bool = False) -> list[Row]:
    """Bounds of all tests; prints what they come to, returns the rows of the modes."""
    rows: list[Row] = []
    for seed in SEEDS[:2] if quick else SEEDS:
        rig = rim(seed)
        lines = np.arange(0.97 * rig.freq[0], 1.03 * rig.freq[-1], STEP_HZ)
        test = troubled_frfs(rig, lines, TROUBLES, sensors=range(SENSORS), drives=[SENSORS], seed=seed)
        freq, peaks, least = test.truth.freq.mean(axis=0), test.truth.peak, bounds(rig, test)
        above = np.flatnonzero(peaks > ABOVE)
        each = np.stack([freq, peaks, least], axis=1)[above].tolist()
        rows += [{"seed": seed, "freq Hz": f, "peak over noise": peak, "bound": known} for f, peak, known in each]
    every = np.array([float(str(row["bound"])) for row in rows])
    beyond = int(np.sum(NORMAL * every > ASKED))
    show("Largest bounds", sorted(rows, key=lambda row: -float(str(row["bound"])))[:12])
    print(
        f"\n{beyond} of {len(rows)} modes cannot be known to {100.0 * ASKED:.2g} % in 95 of 100 tests; median of the"
        f" bounds {100.0 * np.median(every):.2g} %, largest {100.0 * every.max():.2g} %"
    )
    write(out / "unkind_bounds.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
