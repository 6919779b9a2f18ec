"""Speed of many rubs: one run, eight in slots, contact-free time skipped, and the limits of the core.

`python -m reports.benchmarks.sweeps [--quick] [--out DIR]`. Times are processor seconds, the best of several, all of
one process on one core unless the row says two; on a busy machine they are upper bounds, and ratios within the report
are more reliable. The casing is the rig's: a frustum R .50 -> .45 m, 3 mm, the blade's first mode near 380 Hz.
"""

import os
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

import casingfem as cf
import contact as ct
from contact.model.gaps.modal_system import rim_system
from contact.prepared import prepared
from contact.run import completed
from contact.run_many import together
from contact.sweep.plan import load_sweep
from contact.sweep.sweep import run_sweep
from reports.benchmarks.core_limits import best, best_of, limits
from reports.tables import Row, command_line, show, write
from reports.verification.modes.frustum import reference_frustum
from reports.verification.rubs.bases import blade
from reports.verification.rubs.checks import COARSE, MU, SPEED, body, strip
from reports.verification.rubs.checks import casing as seen_along_the_axis
from reports.verification.rubs.checks import rub as tips_on

DT = 1e-5
RUNS = 64  # at once
ROUNDS = 3  # of the first table: what others do on the machine comes and goes
ROUGH = ({"p": 2, "cos": 2e-4}, {"p": 3, "cos": 5e-5})
SPARSE = ct.Record(every=10_007)


ONE = {16: 1e-4}  # radius defect [m] by harmonic: a mode sees few others
SEVERAL = {2: 2e-4, 3: 2e-4, 5: 1e-4, 7: 5e-5, 11: 5e-5, 16: 1e-4}  # as a survey finds: every mode sees every harmonic


def bodies(folder: Path, modes: int, defect: Mapping[int, complex] = ONE) -> tuple[ct.ModalBody, ct.ModalBody]:
    """A reduced casing with a radius defect, and a blade of two modes: `modes` together."""
    folder.mkdir(parents=True, exist_ok=True)
    shell = replace(reference_frustum(), radius_defect=cf.FourierField.of(defect))
    shell = replace(shell, mesh=replace(shell.mesh, around=29))  # fewer elements add terms of their own to the rows
    casing = cf.reduce(shell, cf.Rim("top", n_max=20), modes=modes - 2, zeta=0.002)
    strip = blade()
    files = casing.save(folder / f"casing_{modes}.npz"), strip.save(folder / "blade.npz")
    rim, tip = (ct.ModalBody.load(file) for file in files)
    return rim, tip.truncated(float(np.sort(tip.omega)[1]) * 1.01)


def rub(pair: tuple[ct.ModalBody, ct.ModalBody], *, clearance: float = 0.0, speed_hz: float = 5.0, mu: float = 0.3,
        rough: bool = True, t_end: float = 1.0, skip: bool = False) -> ct.Scene:  # fmt: skip
    """The rub of the rig; the clearance counts from the first touch."""
    terms = ROUGH if rough else ()
    theta = np.linspace(0.0, 2.0 * np.pi, 3601)
    low = float(np.min(sum((t["cos"] * np.cos(t["p"] * theta) for t in terms), np.zeros(theta.size))))
    rim = ct.RotatingRim(*pair, clearance=clearance - low, speed_hz=speed_hz, lean_deg=10.0, out_of_roundness=terms)
    law = ct.Coulomb(mu=mu) if mu else ct.Unilateral()
    exact = ct.ExactModal(skip=skip)
    # without S or damping the rim swings by more than half its wall: the time of a step is asked for, not what it says
    return ct.Scene(what=rim, law=law, t_end=t_end, dt=DT, record=SPARSE, scheme=exact, on_limit="flag")


def physics(pair: tuple[ct.ModalBody, ct.ModalBody], steps: int, repeats: int, peak: dict[str, float]) -> list[Row]:
    """Microseconds per step, alone and in slots, with each part of the physics added."""
    undamped = tuple(replace(body, zeta=np.zeros(body.omega.size)) for body in pair)
    bare = tuple(replace(body, S=np.zeros(body.S.shape)) for body in undamped)
    end = steps * DT
    cases = [
        ("no contact, no damping, S = 0", rub(bare, clearance=1e-3, mu=0.0, rough=False, t_end=end)),
        ("contact all the time, S = 0", rub(bare, clearance=-1e-4, mu=0.0, rough=False, t_end=end)),
        ("and S", rub(undamped, clearance=-1e-4, mu=0.0, rough=False, t_end=end)),
        ("and damping", rub(pair, clearance=-1e-4, mu=0.0, rough=False, t_end=end)),
        ("and out-of-roundness", rub(pair, clearance=-4e-4, mu=0.0, t_end=end)),
        ("and friction", rub(pair, clearance=-4e-4, t_end=end)),
    ]
    return [_speeds(name, scene, repeats, peak) for name, scene in cases]


def faster(one: Row, other: Row) -> Row:
    """The smaller times and the larger rates of two rounds."""
    return {key: min(one[key], other[key]) if key.startswith("us/") else max(one[key], other[key]) for key in one}


def _speeds(name: str, scene: ct.Scene, repeats: int, peak: dict[str, float]) -> Row:
    """One run, and 64 at neighbouring speeds in slots; preparing the runs is not counted."""
    assert isinstance(scene.what, ct.RotatingRim)  # as `rub` makes them
    rims = [replace(scene.what, speed_hz=scene.what.speed_hz * (1.0 + 1e-3 * k)) for k in range(RUNS)]
    scenes = [replace(scene, what=rim) for rim in rims]
    result = ct.run(scene)
    ct.run_many(scenes[:1])
    one = best_of(lambda: prepared(scene), completed, repeats)
    many = best_of(
        lambda: [(k, prepared(one)) for k, one in enumerate(scenes)], lambda ready: list(together(ready)), repeats
    )
    m, terms, along = _size(scene)
    touching = float(result.contact_steps[0]) / result.steps
    rate = 1e-9 * RUNS * result.steps / many  # billions of steps a second
    flops = 14.0 * m + 2.0 * terms + touching * 9.0 * m
    if isinstance(scene.law, ct.Coulomb):
        flops += touching * (11.0 * m + 2.0 * along)
    return {
        "case": name, "modes": m, "terms of the rows": terms, "contact fraction": touching,
        "us/step alone": 1e6 * one / result.steps,
        "us/run-step in slots": 1e6 * many / (RUNS * result.steps),
        "million steps/s in slots": 1e3 * rate,
        "% of peak flops": 100.0 * rate * flops / peak["GFlop/s"],
        "% of cache bandwidth": 100.0 * rate * 8.0 * 14.0 * m / peak["GB/s, 12 kB"],
    }  # fmt: skip


def _size(scene: ct.Scene) -> tuple[int, int, int]:
    """Modes, and terms (cosines and sines) of their normal and their tangential rows."""
    assert isinstance(scene.what, ct.RotatingRim)
    system = rim_system(scene.what)
    assert system.table is not None
    normal, tangent = system.table.terms()
    return system.omega.size, normal.value.size, tangent.value.size


def contacts(steps: int, repeats: int, peak: dict[str, float]) -> list[Row]:
    """Microseconds per step of 1, 5 and 16 tips on one blade, each part of the physics added.

    Flops count the modes' motion, the rows of all tips, and where tips touch their Delassus matrix and one
    factorisation: 14 m + 6 K m, and d K (2 m K d + 4 m) + 2 (d K)^3/3 while some tip touches.
    """
    rim, dt, rows = body(cf.reduce(seen_along_the_axis(), COARSE, modes=48, zeta=0.002)), 1.0 / SPEED / 1000, []
    friction = ct.Coulomb(mu=MU)
    for tips in (1, 5, 16):
        blade = strip(tips)
        blade = blade.truncated(min(2.5 / dt, float(blade.omega[1]) * 1.01))
        cases = (("no contact", -1e-3, ct.Unilateral()), ("contact", 1e-4, ct.Unilateral()),
                 ("friction in two directions", 1e-4, friction))  # fmt: skip
        for name, advance, law in cases:
            what = tips_on(rim, blade, tips, advance=advance)
            record = ct.Record(every=10_007)
            scene = ct.Scene(what=what, law=law, t_end=steps * dt, dt=dt, record=record, on_limit="flag")
            result, seconds = ct.run(scene), best_of(lambda scene=scene: prepared(scene), completed, repeats)
            m, d = rim.omega.size + blade.omega.size, 3 if law is friction else 1
            touching, size = float(result.contact_steps.max()) / result.steps, d * tips
            flops = 14.0 * m + 6.0 * tips * m + touching * (size * m * (2.0 * size + 4.0) + 2.0 * size**3 / 3.0)
            rows.append({
                "case": name, "modes": m, "tips": tips, "contact fraction": touching,
                "us/step": 1e6 * seconds / result.steps,
                "% of peak flops": 100e-9 * flops * result.steps / seconds / peak["GFlop/s"],
            })  # fmt: skip
    return rows


CLEARANCES = (-3e-4, -1e-4, -5e-5, -2e-5, -5e-6, -5e-7)  # [m], past the first touch


def skips(
    pair: tuple[ct.ModalBody, ct.ModalBody], turns: int, repeats: int, clearances: Sequence[float] = CLEARANCES
) -> list[Row]:
    """Speed-up by skipping over the contact fraction, and the largest difference of the end state."""
    rows: list[Row] = []
    for clearance in clearances:
        plain, skipping = (
            rub(pair, clearance=clearance, mu=0.1, t_end=turns / 5.0, skip=skip) for skip in (False, True)
        )
        a, b = (ct.run(replace(scene, record=ct.Record(every=9973, state_every=9973))) for scene in (plain, skipping))
        difference = float(np.abs(a.state - b.state).max() / np.abs(a.state).max())
        slow, fast = (best(lambda scene=scene: ct.run(scene), repeats) for scene in (plain, skipping))
        slots = [best(lambda s=scene: ct.run_many([s] * 8), repeats) for scene in (plain, skipping)]
        rows.append({
            "clearance past touch [m]": clearance, "contact fraction": float(a.contact_steps[0]) / a.steps,
            "steps": a.steps, "state differs by": difference,
            "impulse differs by": float(abs(b.impulse[0] / a.impulse[0] - 1.0)),
            "speed-up alone": slow / fast, "speed-up in slots": slots[0] / slots[1],
        })  # fmt: skip
    return rows


SWEEP = """[scene]
kind = "rim"
t_end = {t_end}
[casing]
basis = "casing_42.npz"
[blade]
basis = "blade.npz"
lean_deg = 10.0
[contact]
clearance = 1.8e-4
friction = 0.1
out_of_roundness = [{{p = 2, cos = 2e-4}}, {{p = 3, cos = 5e-5}}]
[speed]
turning = "blades"
hz = 5.0
[scheme]
kind = "exact-modal"
dt = {dt}
[sweep]
[[sweep.vary]]
key = "speed.hz"
from = 4.5
to = 5.5
steps = {speeds}
"""


def rig_sweep(folder: Path, speeds: int, turns: int) -> list[Row]:
    """Speeds of the rig, `turns` turns at 5 Hz each, from the command's own code: wall seconds on one core and two.

    Processor time is that of all processes; starting them and what they compile or load is part of both.
    """
    file = folder / "sweep_speed.toml"
    file.write_text(SWEEP.format(t_end=turns / 5.0, dt=DT, speeds=speeds), encoding="utf-8")
    plan, rows = load_sweep(file), []
    for jobs in (1, 2):
        began, spent, load = time.perf_counter(), sum(os.times()[:4]), os.getloadavg()[0]
        found = run_sweep(plan, jobs=jobs)
        steps = sum(row["steps"] for row in found.rows)
        seconds = time.perf_counter() - began
        rows.append({
            "cores": jobs, "speeds": speeds, "turns": turns, "steps": steps, "s": seconds,
            "ms/run": 1e3 * seconds / speeds, "processor ms/run": 1e3 * (sum(os.times()[:4]) - spent) / speeds,
            "us/run-step": 1e6 * seconds / steps,
            "failed": found.failed, "load of the machine before": load,
        })  # fmt: skip
    return rows


def main(out: Path, quick: bool = False) -> Sequence[Row]:
    """Measure and print."""
    folder = out / "sweep_speed"
    steps, repeats = (10_000, 1) if quick else (100_000, 3)
    print(f"load of the machine: {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors")
    peak = limits(repeats)
    show("Limits of the core, measured here", [{"what": name, "value": value} for name, value in peak.items()])
    rows: list[Row] = []
    pairs = [bodies(folder, modes) for modes in ((42,) if quick else (12, 42, 82))]
    dense = rub(bodies(folder / "several", 42, SEVERAL), clearance=-4e-4, t_end=steps * DT)
    for _ in range(1 if quick else ROUNDS):
        found = [row for pair in pairs for row in physics(pair, steps, repeats, peak)]
        found.append(_speeds("all that, a casing of several harmonics", dense, repeats, peak))
        rows = [faster(*both) for both in zip(rows or found, found, strict=True)]
    show("Microseconds per step, processor time", rows)
    several = contacts(1_000 if quick else 20_000, repeats, peak)
    show("Microseconds per step of several contacts, processor time", several)
    write(out / "sweep_tips.csv", several)
    write(out / "sweep_speed.csv", rows)
    few = CLEARANCES[::5] if quick else CLEARANCES
    skipped = skips(bodies(folder, 42), 2 if quick else 4, 1 if quick else 3, few)
    show("Skips over contact-free time", skipped)
    write(out / "sweep_leaps.csv", skipped)
    swept = rig_sweep(folder, 8, 1) if quick else [*rig_sweep(folder, 100, 100), *rig_sweep(folder, 10_000, 1)]
    show("A sweep of the rig over its speed", swept)
    write(out / "sweep_rig.csv", swept)
    return [*rows, *several, *skipped, *swept]


if __name__ == "__main__":
    command_line(__doc__, main)
