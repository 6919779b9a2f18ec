"""Periodic motions of driven bodies before stops, compared with published orbits and runs in time; and run times.

`python -m reports.verification.schemes.cycles [--quick] [--out DIR]` follows

- E1: a bar before an obstacle of r E A/L (Vadcard, Batailly, Thouverez, J. Sound Vib. 531, 2022, 116950, Table 1),
- E2: a mass before a stop of stiffness 100 and 1e5,
- E3: a bar before a rigid wall (Colaitis, Batailly, J. Sound Vib. 502, 2021, 116070), by all its modes,

compares amplitudes and folds, checks that runs leave the unstable orbits, and measures times.
"""

import math
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
from scipy.linalg import eigh

import contact as ct
from casingfem.io.arrays import FloatArray
from casingfem.plot.cycles import figure_cycles
from casingfem.plot.style import png
from contact.cycles import Branch, Cycles, DrivenBody, Orbit
from contact.cycles.driven import Family
from contact.cycles.shooting import map_of
from contact.io.outfiles import write_atomic
from reports.tables import Row, check, command_line, show, write

TURN = 2.0 * math.pi
BESIDE = 1e-10  # of the state: initial distance of runs beside an orbit
E1 = {
    0.4: ((60179.5, 1.0199e-4), (62708.1, 2.7032e-4), (63354.7, 3.3620e-4), (64594.8, 4.9436e-4)),
    4.0: ((61817.6, 2.0560e-4), (62718.4, 2.1736e-4), (63325.7, 2.2768e-4), (65774.4, 2.9874e-4), (68397.7, 3.8436e-4)),
}
BRANCHES = ((2, 500.0), (20, 2000.0))  # modes, ms allowed
E2_OMEGA = (1.07511, 1.19425, 1.31283, 1.42899, 1.50085)
E2 = {100.0: (0.11401, 0.13720, 0.17463, 0.23460, 0.29163), 1e5: (0.10577, 0.12159, 0.14646, 0.18296, 0.21462)}
THREE = 2200.0, 6.662e-5  # rad/s, m: a motion of three periods, the table's is the largest of one of them
E3 = ((2400.0, 7.207e-5), (2500.0, 7.654e-5), (2628.4, 8.730e-5), (3000.0, 1.639e-4), (3100.0, 2.039e-4))


def bar(
    obstacle: float, *, elements: int, length: float, area: float, modulus: float, rho: float, gap: float
) -> DrivenBody:  # fmt: skip
    """Clamped-free bar, two-node elements, consistent mass, damping 0.0075, 25 kN at its end; `obstacle` in E A/L."""
    h = length / elements
    K, M = np.zeros((elements + 1, elements + 1)), np.zeros((elements + 1, elements + 1))
    for e in range(elements):
        K[e : e + 2, e : e + 2] += modulus * area / h * np.array([[1.0, -1.0], [-1.0, 1.0]])
        M[e : e + 2, e : e + 2] += rho * area * h / 6.0 * np.array([[2.0, 1.0], [1.0, 2.0]])
    square, shapes = eigh(K[1:, 1:], M[1:, 1:])
    body = ct.ModalBody(
        omega=np.sqrt(square), zeta=np.full(elements, 0.0075), channels=("x", "stop"),
        rows=np.array([shapes[-1], -shapes[-1]]), S=np.zeros((2, 2)),
    )  # fmt: skip
    patch = ct.Patch(body=body, normal=("stop",), clearance=gap)
    stiffness = obstacle * modulus * area / length
    return DrivenBody(patch=patch, channel="x", amplitude=25e3, stiffness=stiffness, shown=("x",))


def rod(ratio: float, elements: int = 20) -> DrivenBody:
    """E1."""
    return bar(ratio, elements=elements, length=0.13, area=15.6e-4, modulus=210e9, rho=7800.0, gap=0.2e-3)


def rod_on_wall(elements: int = 100) -> DrivenBody:
    """E3: a rigid wall."""
    return bar(math.inf, elements=elements, length=1.0, area=0.05, modulus=21e9, rho=7500.0, gap=6e-5)


def mass_on_stop(stiffness: float = math.inf, amplitude: float = 0.02) -> DrivenBody:
    """E2: m = 1, c = 0.05, k = 1, gap 0.1."""
    body = ct.ModalBody(omega=[1.0], zeta=[0.025], channels=("x", "stop"), rows=[[1.0], [-1.0]], S=np.zeros((2, 2)))
    patch = ct.Patch(body=body, normal=("stop",), clearance=0.1)
    return DrivenBody(patch=patch, channel="x", amplitude=amplitude, stiffness=stiffness, shown=("x",))


def upper(found: Branch, value: float) -> Orbit:
    """Point of a branch where it first passes a value."""
    at = found.value
    return found.points[int(np.flatnonzero((at[:-1] - value) * (at[1:] - value) <= 0.0)[0])]


def at_omega(family: Family, found: Branch, omega: float) -> Orbit:
    """The orbit at omega [rad/s] where a branch first passes it."""
    near = upper(found, omega / TURN)
    return ct.cycles.orbit(family, omega / TURN, guess=np.array(near.x), start=near.start)


def published(out: Path, quick: bool) -> Iterator[Row]:
    """E1 and E2: amplitudes at published frequencies, folds."""
    for ratio, values in E1.items():
        family = rod(ratio).over("freq_hz", freq_hz=10e3)
        cycles = ct.cycles.follow(family, (9500.0, 10600.0 if ratio < 1.0 else 11300.0))
        found = cycles.branches[0]
        for omega, amplitude in values:
            here = at_omega(family, found, omega).amplitude["x"]
            yield check(f"E1 r = {ratio:g}, {omega:.1f} rad/s", "Vadcard 2022", amplitude, here, 0.2)
        if ratio < 1.0:
            fold = TURN * found.of("fold")[0].orbit.value
            yield check("E1 r = 0.4, fold [rad/s]", "Vadcard 2022", 64892.9, fold, 0.3)
        write_atomic(out / f"rod_{ratio:g}.png", png(figure_cycles(cycles.records(), cycles.marks())))
    for stiffness, amplitudes in E2.items():
        family = mass_on_stop(stiffness).over("freq_hz", freq_hz=0.2)
        found = ct.cycles.follow(family, (0.15, 0.25 if stiffness == 100.0 else 0.245)).branches[0]
        for omega, amplitude in zip(E2_OMEGA, amplitudes, strict=True):
            here = at_omega(family, found, omega).amplitude["x"]
            yield check(f"E2 k = {stiffness:g}, {omega:g} rad/s", "table", amplitude, here, 0.2)
        if stiffness == 100.0:
            yield check("E2 k = 100, fold [rad/s]", "table", 1.5579, TURN * found.of("fold")[0].orbit.value, 0.3)
    if not quick:
        yield from wall(out)


def wall(out: Path) -> Iterator[Row]:
    """E3: amplitudes on which runs from rest settle; then all branches from 1900 to 3400 rad/s, as text and picture."""
    family = rod_on_wall().over("freq_hz", freq_hz=400.0)
    for omega, amplitude in E3:
        here = ct.cycles.orbit(family, omega / TURN).amplitude["x"]
        yield check(f"E3, {omega:.1f} rad/s", "200 periods, Lagrange", amplitude, here, 0.02)
    omega, amplitude = THREE
    thrice = ct.cycles.orbit(family, omega / TURN, periods=3)
    period, x, sizes = map_of(family, thrice.value, thrice.start), np.array(thrice.x), list[float]()
    for _ in range(3):
        passed = period(x)
        x = passed.x
        sizes.append(float(passed.amplitude[0]))
    here = min(sizes, key=lambda size: abs(size - amplitude))
    yield check(f"E3, {omega:.1f} rad/s, one of 3 periods", "200 periods, Lagrange", amplitude, here, 0.02)
    for begin, end in ((2400.0, 1900.0), (2400.0, 3400.0)):
        found = ct.cycles.follow(family, (begin / TURN, end / TURN), longest=0.04)
        print(f"\nE3 from {begin:g} to {end:g} rad/s, in Hz\n{found!r}")
        write_atomic(out / f"rod_wall_{end:g}.png", png(figure_cycles(found.records(), found.marks())))


def left(family: Family, at: Orbit, periods: int, until: float = 1e-3) -> tuple[float, float]:
    """Largest distance of a run from an orbit over its initial distance, and its growth per period while it is small.

    The run begins along the eigenvector of the largest multiplier, and ends at the distance `until` of the state. It
    may settle on a neighbouring orbit before: orbits on both sides of a fold caused by contact are often 1e-5 apart.
    """
    period, size = map_of(family, at.value, at.start, at.periods), float(np.linalg.norm(at.x))
    values, vectors = np.linalg.eig(at.M)
    aside = vectors[:, int(np.abs(values).argmax())].real
    x = np.array(at.x) + BESIDE * size * aside / np.linalg.norm(aside)
    away = [BESIDE]
    while len(away) < periods and away[-1] < until:
        x = period(x, tangent=False).x
        away.append(float(np.linalg.norm(x - at.x)) / size)
    small = np.flatnonzero(np.array(away) < 1e-6)
    growth = math.exp(np.polyfit(small, np.log(np.array(away)[small]), 1)[0]) if small.size > 3 else math.nan
    return max(away) / BESIDE, growth


def unstable(quick: bool) -> list[Row]:
    """E1, r = 4: orbits of a published curve that are unstable."""
    family = rod(4.0).over("freq_hz", freq_hz=10e3)
    found = ct.cycles.follow(family, (10.0e3, 10.6e3)).branches[0]
    start, stop = (special.orbit.value for special in found.of("Neimark-Sacker"))
    inside = [point for point in found.points if start < point.value < stop]
    rows: list[Row] = []
    for point in inside[:: max(len(inside) // (2 if quick else 6), 1)]:
        far, growth = left(family, point, 2000)
        rows.append({
            "omega/omega_1": TURN * point.value / 62711.9764, "|multiplier|": point.multiplier, "of the run": growth,
            "error": growth - point.multiplier, "left by": far,
        })  # fmt: skip
    show(f"E1 r = 4: not kept from {TURN * start / 62711.9764:.5f} to {TURN * stop / 62711.9764:.5f} omega_1", rows)
    return rows


def best(work: Callable[[], object], times: int = 5) -> float:
    """Processor time, the least of several [ms]."""
    found = []
    for _ in range(times):
        begun = time.process_time()
        work()
        found.append(time.process_time() - begun)
    return 1e3 * min(found)


def many_contacts() -> DrivenBody:
    """60 modes before 16 springs."""
    rng, m, k = np.random.default_rng(3), 60, 16
    omega = np.sort(rng.uniform(1.0, 40.0, m))
    rows: FloatArray = 3.0 * rng.standard_normal((k + 1, m)) / math.sqrt(m)
    rows[0] = rng.standard_normal(m) * np.exp(-0.1 * omega)
    names = tuple(f"stop{i}" for i in range(k))
    S = np.zeros((k + 1, k + 1))
    body = ct.ModalBody(omega=omega, zeta=np.full(m, 0.02), channels=("d", *names), rows=rows, S=S)
    patch = ct.Patch(body=body, normal=names, clearance=rng.uniform(0.05, 0.1, k))
    return DrivenBody(patch=patch, channel="d", amplitude=1.0, stiffness=20.0, shown=("d",))


def of_branch(modes: int, rounds: int) -> Row:
    """Time of a branch of the bar E1, r = 4, by the number of modes."""
    family = rod(4.0, modes).over("freq_hz", freq_hz=1e4)
    found: list[Cycles] = []
    spent = best(lambda: found.append(ct.cycles.follow(family, (9500.0, 11300.0), longest=0.04)), rounds)
    points = found[0].branches[0].points
    newton, events = sum(point.iterations for point in points), 2 * sum(sum(point.closings) for point in points)
    return {"what": f"a branch: E1, r = 4, {modes} modes", "orbits": len(points), "Newton steps": newton,
            "events": events, "ms": spent, "ms an orbit": spent / len(points)}  # fmt: skip


def times(quick: bool) -> list[Row]:
    """Times of orbits of 2, 20 and 60 modes, from a neighbouring orbit, and of two branches."""
    rows: list[Row] = []
    for name, driven, value, allowed in (
        ("2 modes, 1 contact", rod(4.0, 2), 1e4, 2.0), ("20 modes, 1 contact", rod(4.0), 1e4, 8.0),
        ("60 modes, 1 contact", rod(4.0, 60), 1e4, 80.0), ("60 modes, 16 contacts", many_contacts(), 0.25, 300.0),
    ):  # fmt: skip
        family = driven.over("freq_hz", freq_hz=value)
        near = ct.cycles.orbit(family, value)
        guess, start = np.array(near.x), near.start
        orbit = ct.cycles.orbit(family, 1.001 * value, guess=guess, start=start)
        spent = best(lambda: ct.cycles.orbit(family, 1.001 * value, guess=guess, start=start))  # noqa: B023
        rows.append({"what": f"an orbit: {name}", "orbits": 1, "Newton steps": orbit.iterations,
                     "events": 2 * sum(orbit.closings), "ms": spent, "ms an orbit": spent,
                     "allowed ms": allowed})  # fmt: skip
    for modes, allowed in BRANCHES:
        rows.append(of_branch(modes, 1 if quick else 3) | {"allowed ms": allowed})
    show("Processor time", rows)
    return rows


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the tables, write CSV and pictures."""
    rows = list(published(out, quick))
    show("Periodic motions against published ones", rows)
    write(out / "cycles.csv", rows)
    write(out / "cycles_unstable.csv", unstable(quick))
    write(out / "cycles_times.csv", times(quick))
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
