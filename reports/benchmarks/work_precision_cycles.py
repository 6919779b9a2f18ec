"""Error of an orbit's amplitude against processor time: shooting by Newton steps, harmonic balance by harmonics.

`python -m reports.benchmarks.work_precision_cycles [--quick] [--out DIR]` prints and writes work_precision_cycles.csv
and draws work_precision_cycles.png. The bar before an obstacle of 4 E A/L (Vadcard, Batailly, Thouverez 2022) has 2, 20
and 200 modes. Both methods start from their own solution at a frequency that is 0.1 % lower, as in a continuation. The
reference is shooting with eight times the samples, two Newton steps beyond convergence. SciPy's DOP853 integrates
one period from its state as a check: "returns" is the change of the state, "by integration" that of the amplitude.
Times are the least of several.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import matplotlib.pyplot as plt
import numpy as np
from scipy.integrate import solve_ivp

import contact as ct
from casingfem.io.arrays import FloatArray
from casingfem.plot.style import png
from contact.cycles.driven import ForcedFamily
from contact.cycles.shooting import map_of
from contact.io.outfiles import write_atomic
from reports.tables import Row, command_line, show, write
from reports.verification.schemes.cycles import best, rod

MODES = (2, 20, 200)
FREQ_HZ = 10.1e3
BELOW = 1e-3  # of the frequency: distance of the neighbour from which both methods start
STEPS = (1, 2, 3, 4, 5)  # Newton steps of shooting
HARMONICS = (3, 5, 10, 20, 30, 60, 120)
SHOOTING, BALANCE = "shooting", "harmonic balance"
LEAST = 1e-16


class Shot(NamedTuple):
    """A state, and the amplitude of the motion from it over one period [m]."""

    x: FloatArray
    amplitude: float


def shot(family: ForcedFamily, x: FloatArray, steps: int) -> Shot:
    """Newton steps on the map of one period from a state."""
    period, eye = map_of(family, FREQ_HZ), np.eye(x.size)
    for _ in range(steps):
        found = period(x)
        x = x + np.linalg.solve(found.M - eye, x - found.x)
    return Shot(x, float(period(x).amplitude[0]))


def reference(modes: int) -> tuple[Shot, Row]:
    """The converged orbit, and how far an integration over one period is from it."""
    looks = 8 * round(1.0 / (FREQ_HZ * rod(4.0, modes).over("freq_hz", freq_hz=FREQ_HZ).at(FREQ_HZ)[0].step))
    family = rod(4.0, modes).over("freq_hz", freq_hz=FREQ_HZ, looks=looks)
    orbit = ct.cycles.orbit(family, FREQ_HZ)
    found = shot(family, np.array(ct.cycles.orbit(family, FREQ_HZ, guess=np.array(orbit.x)).x), 2)
    motion, period = family.at(FREQ_HZ)
    plant, drive = motion.plant, motion.drive

    def rate(t: float, x: FloatArray) -> FloatArray:
        angle = motion.angle(t)
        gap = plant.C @ x + drive.c.at(angle)
        return plant.A @ x + drive.b.at(angle) + plant.B @ np.maximum(-gap / np.diag(plant.S), 0.0)

    times = np.linspace(0.0, period, 20_001)
    run = solve_ivp(rate, (0.0, period), found.x, method="DOP853", rtol=1e-12, atol=1e-17, t_eval=times)
    shown = plant.D @ run.y  # the obstacle gives way by itself, so that no force moves the channel directly
    peak = float(np.abs(shown[0]).max())
    row: Row = {
        "modes": modes, "amplitude [m]": found.amplitude, "touches": orbit.closings[0], "stable": str(orbit.stable),
        "returns": float(np.linalg.norm(run.y[:, -1] - found.x) / np.linalg.norm(found.x)),
        "by integration": peak / found.amplitude - 1.0,
    }  # fmt: skip
    return found, row


def measured(modes: int, quick: bool) -> tuple[list[Row], Row]:
    """Errors and times of both methods for a bar of so many modes, and the row of the reference."""
    exact, check = reference(modes)
    family = rod(4.0, modes).over("freq_hz", freq_hz=FREQ_HZ)
    near = np.array(ct.cycles.orbit(family, (1.0 - BELOW) * FREQ_HZ, guess=exact.x).x)
    rows: list[Row] = []

    def add(method: str, parameter: int, amplitude: float, work: Callable[[], object]) -> None:
        rows.append({
            "modes": modes, "method": method, "steps or harmonics": parameter,
            "error": amplitude / exact.amplitude - 1.0, "ms": best(work, 3 if quick else 15),
        })  # fmt: skip

    for steps in STEPS:
        amplitude = shot(family, near, steps).amplitude
        add(SHOOTING, steps, amplitude, lambda: shot(family, near, steps))  # noqa: B023
    for harmonics in HARMONICS[:4] if quick else HARMONICS:
        beside = ct.cycles.balance(family, (1.0 - BELOW) * FREQ_HZ, harmonics=harmonics)

        def solve(harmonics: int = harmonics, beside: ct.cycles.Balanced = beside) -> ct.cycles.Balanced:
            return ct.cycles.balance(family, FREQ_HZ, harmonics=harmonics, guess=beside)

        add(BALANCE, harmonics, solve().amplitude["x"], solve)
    return rows, check


def picture(rows: list[Row], path: Path) -> None:
    """Error against time: one panel for each number of modes."""
    sizes = sorted({int(str(row["modes"])) for row in rows})
    figure, axes = plt.subplots(
        1, len(sizes), figsize=(3.6 * len(sizes), 3.8), layout="constrained", sharex=True, sharey=True
    )
    for axis, modes in zip(axes, sizes, strict=True):
        for method, mark in ((SHOOTING, "o-"), (BALANCE, "s--")):
            mine = [row for row in rows if row["modes"] == modes and row["method"] == method]
            time_ms = [float(str(row["ms"])) for row in mine]
            error = [max(abs(float(str(row["error"]))), LEAST) for row in mine]
            axis.plot(time_ms, error, mark, label=method, ms=5, lw=1.0)
            for row, x, y in zip(mine, time_ms, error, strict=True):
                axis.annotate(str(row["steps or harmonics"]), (x, y), (4, 4), textcoords="offset points", fontsize=7)
        axis.set(xscale="log", yscale="log", title=f"{modes} modes", xlabel="processor time [ms]")
    axes[0].set(ylabel="relative error of the amplitude")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper center", ncols=2)
    write_atomic(path, png(figure))
    plt.close(figure)


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the references and the errors, write the table, draw the picture."""
    found = [measured(modes, quick) for modes in (MODES[:2] if quick else MODES)]
    rows = [row for part, _ in found for row in part]
    show("References, and one period of them by DOP853 with a tolerance of 1e-12", [check for _, check in found])
    show("Error of the amplitude and processor time of one orbit", rows)
    write(out / "work_precision_cycles.csv", rows)
    picture(rows, out / "work_precision_cycles.png")
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
