"""Bladed disk in its casing: unstable speeds by f_c + f_b = n f, by poles and by time integration.

`python -m reports.verification.rubs.bladed_disk [--quick] [--out DIR]`. First the two-dimensional model of the
literature (P. Schmiechen, thesis, Imperial College, 1997; M. Legrand, C. Pierre, P. Cartraud, J.-P. Lombard, J. Sound
Vib. 319, 2009, 366), each body by its two modes of n diameters. Runs over many speeds find the unstable one, without
use of the condition. Then a lumped disk of 24 blades, tuned and mistuned, in the frustum of section_44. All tips stay
closed.
"""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import contact as ct
from casingfem.io.arrays import FloatArray, IntArray
from casingfem.plot.style import AFTER, BEFORE, PERFECT, new_figure, png, styled
from contact.io.outfiles import write_atomic
from contact.model.gaps.bladed_disk import two_dimensional
from contact.model.gaps.permanent import rub_contact
from contact.stability.closed_contact import growth
from reports.tables import Row, command_line, show, write
from reports.verification.rubs.bases import make_casing

CASING_HZ = {2: 280.0, 3: 290.0, 5: 300.0, 8: 340.0}  # by nodal diameters
DISK_HZ = {2: 110.0, 3: 115.0, 5: 120.0, 8: 130.0}
BLADES, STIFFNESS, PRESS = 22, 2e3, 1e-3
SPREAD = np.linspace(-0.005, 0.015, 17)  # speeds tried, relative to the free sum
KICK = 1e-6  # m/s of the casing: all else is symmetric
STRONG_KICK = 5e-3  # modal velocity, above what mistuned blades excite by turning


@styled
def figure_growth(
    speed_hz: FloatArray, poles: FloatArray, tried_hz: FloatArray, seen: FloatArray, free_hz: float
) -> Figure:
    """Growth rate [1/s] over speed: by poles as a line, by runs as dots, the free coincidence marked."""
    figure = new_figure(7.6, 3.6)
    axes: Any = figure.add_subplot()
    axes.plot(speed_hz, poles, color=BEFORE, label="poles")
    axes.plot(tried_hz, seen, "o", color=AFTER, markersize=5, label="time integration")
    axes.axvline(free_hz, color=PERFECT, linestyle=":", label="$f_c + f_b = n f$")
    axes.set_xlabel("speed [turns/s]")
    axes.set_ylabel("growth [1/s]")
    axes.legend(fontsize=8)
    return figure


def pairs(n: int) -> tuple[ct.gaps.ModalPair, ct.gaps.ModalPair]:
    """Casing and disk, undamped."""
    return (
        ct.gaps.ModalPair(n=n, freq_hz=CASING_HZ[n], modal_mass=2.0),
        ct.gaps.ModalPair(n=n, freq_hz=DISK_HZ[n], modal_mass=1.0),
    )


def rate(result: ct.Result, modes: IntArray | None = None) -> float:
    """Growth of the casing's modes over the second half of a run [1/s], or some of them; nan if a tip has opened."""
    if int(result.contact_steps.min()) < result.steps:
        return float("nan")
    q = result.state_of("casing")
    q = q if modes is None else q[:, modes]
    window = len(q) // 20
    starts = np.arange(len(q) // 2, len(q) - window, window // 4)
    level = [float(np.linalg.norm(q[i : i + window])) for i in starts]
    return float(np.polyfit(result.state_time[starts], np.log(level), 1)[0])


def seen(n: int, speed_hz: FloatArray) -> FloatArray:
    """Growth of runs of the two-dimensional model at these speeds [1/s]."""
    casing, disk = pairs(n)
    rates = []
    for speed in speed_hz:
        rub = two_dimensional(
            casing, disk, blades=BLADES, stiffness=STIFFNESS, press=PRESS, speed_hz=float(speed), velocity=KICK
        )
        rates.append(rate(ct.run(rub, t_end=1.2, dt=5e-5, record=ct.Record(every=4, state_every=4))))
    return np.array(rates)


def peak(speed_hz: FloatArray, rates: FloatArray) -> tuple[float, float]:
    """Speed [Hz] and value of the largest growth: growth^2 = s^2 - (pi n (f - f_0))^2 is a parabola in the band."""
    strong = rates > 0.3 * np.nanmax(rates)
    if np.count_nonzero(strong) < 3:
        raise ValueError(f"growth seen at {np.count_nonzero(strong)} of {len(rates)} speeds, expected three or more")
    a, b, c = np.polyfit(speed_hz[strong] - speed_hz[0], rates[strong] ** 2, 2)
    at = -b / (2.0 * a)
    return float(speed_hz[0] + at), float(np.sqrt(c + 0.5 * b * at))


def two_modes_each(n_values: tuple[int, ...], spread: FloatArray, out: Path) -> list[Row]:
    """Unstable speed of the two-dimensional model by n."""
    rows: list[Row] = []
    for n in n_values:
        free = (CASING_HZ[n] + DISK_HZ[n]) / n
        speed = free * (1.0 + spread)
        rates = seen(n, speed)
        contact = ct.gaps.disk_contact(*pairs(n), stiffness=STIFFNESS, blades=BLADES)
        found = ct.stability.of_contact(contact, np.linspace(speed[0], speed[-1], 401))
        at, most = peak(speed, rates)
        rows.append(
            {
                "n": n, "f_c [Hz]": CASING_HZ[n], "f_b [Hz]": DISK_HZ[n], "f_c + f_b = n f [Hz]": free,
                "run [Hz]": at, "off [%]": 100.0 * (at / free - 1.0),
                "poles [Hz]": found.peak_speed_hz, "off poles [%]": 100.0 * (at / found.peak_speed_hz - 1.0),
                "run [1/s]": most, "poles [1/s]": found.peak_growth,
            }
        )  # fmt: skip
        if n == n_values[-1]:
            figure = figure_growth(found.speed_hz, growth(contact, found.speed_hz), speed, rates, free)
            write_atomic(out / "bladed_disk.png", png(figure))
    return rows


def many_blades(folder: Path, quick: bool) -> list[Row]:
    """Unstable speeds of a lumped disk of 24 blades by n, friction and mistuning."""
    casing = make_casing(folder, 20, 1)
    pattern = np.random.default_rng(5).standard_normal(24)
    rows: list[Row] = []
    for mu, spread in ((0.0, 0.0),) if quick else ((0.0, 0.0), (0.0, 0.01), (0.3, 0.0), (0.3, 0.03)):
        disk = ct.gaps.BladedDisk(
            blades=24, freq_hz=200.0, modal_mass=0.1, coupling=0.02, mistuning=spread * pattern, lean_deg=30.0,
            compliance=1e-4,
        )  # fmt: skip
        for n in (8,) if quick else (7, 8, 9):
            waves = of_diameters(casing, n)
            free = (float(casing.omega[waves].min()) / (2.0 * np.pi) + float(disk.tuned_hz()[n])) / n
            rub = ct.Rub(casing, (disk.body(),), disk.tips(), clearance=-PRESS)
            speed = free * np.linspace(0.99, 1.01, 81)
            rates = growth(rub_contact(rub, mu=mu), speed)
            rows.append(
                {
                    "mu": mu, "mistuning, std [%]": 100.0 * spread, "n": n, "f_c + f_b = n f [Hz]": free,
                    "poles [Hz]": float(speed[rates.argmax()]),
                    "off [%]": 100.0 * float(speed[rates.argmax()] / free - 1.0), "poles [1/s]": float(rates.max()),
                    "run [1/s]": run_rate(rub, mu, waves, float(speed[rates.argmax()]), float(rates.max())),
                }
            )  # fmt: skip
    return rows


def run_rate(rub: ct.Rub, mu: float, waves: IntArray, speed_hz: float, pole: float) -> float:
    """Growth of these modes in a run at one speed [1/s], from rest under the press but for a kick to them."""
    closed, m = rub_contact(rub, mu=mu), rub.casing.omega.size
    force = np.linalg.solve(closed.compliance(1.0), np.full(len(rub.tips), PRESS))
    push = closed.pushes(1.0).T
    joined = push @ np.linalg.solve(closed.compliance(1.0), closed.Q)
    rest = np.linalg.solve(np.diag(closed.omega**2) + joined, push @ force)
    kick = np.zeros(m)
    kick[waves[0]] = STRONG_KICK
    started = replace(
        rub, speed=ct.Speed.constant(speed_hz), blade_starts=(ct.gaps.Start(displacement=rest[m:]),),
        casing_start=ct.gaps.Start(displacement=rest[:m], velocity=kick),
    )  # fmt: skip
    law = ct.Coulomb(mu=mu) if mu else ct.Unilateral()
    result = ct.run(started, law=law, t_end=3.0 / pole, dt=2.5e-5, record=ct.Record(every=20, state_every=20))
    return rate(result, waves)


def of_diameters(casing: ct.ModalBody, n: int) -> IntArray:
    """Numbers of the modes whose radial rows are largest at n."""
    N = casing.n_max
    radial = casing.rows[: N + 1] ** 2
    radial[1:] += casing.rows[N + 1 : 2 * N + 1] ** 2
    return np.flatnonzero(radial.argmax(axis=0) == n)


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print both tables and draw growth over speed; returns the rows of the first."""
    out.mkdir(parents=True, exist_ok=True)
    rows = two_modes_each((5,) if quick else (2, 3, 8, 5), SPREAD[::2] if quick else SPREAD, out)
    show(f"Two modes each, {BLADES} tips of {STIFFNESS:g} N/m", rows)
    write(out / "bladed_disk.csv", rows)
    names = ("off [%]", "off poles [%]")
    worst: Row = {name: max(abs(float(str(row[name]))) for row in rows) for name in names}
    write(out / "bladed_disk_summary.csv", [worst])
    blades = many_blades(out / "bladed_disk", quick)
    show("24 blades of 200 Hz, coupling .02, lean 30 deg, in the frustum of 42 modes", blades)
    write(out / "bladed_disk_24.csv", blades)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
