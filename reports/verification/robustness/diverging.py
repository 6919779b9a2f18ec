"""Diverging or mistyped scenes: each is refused, or stops, keeps all results and names the cause.

`python -m reports.verification.robustness.diverging [--quick] [--out DIR]` runs them by the command line, as a user
would. One row a scene: exit code, the limit that was passed and its time, growth of the run and by theory of a contact
that stays closed, the largest stored force, the message. "NOT ..." is a scene that ended without a message, lost its
record, or named another cause.
"""

import json
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from click.testing import CliRunner

import contact as ct
from casingfem.cli import main as casingfem
from contact.io.outfiles import write_atomic
from reports.tables import Row, command_line, show, write

RADIUS, WALL = 0.25, 4e-3
RIM = """[scene]
kind = "rim"
t_end = 2.0
[casing]
basis = "casing.npz"
[blade]
basis = "blade.npz"
lean_deg = 10.0
[contact]
clearance = -1e-5
friction = 0.3
[speed]
hz = 60.0
[scheme]
kind = "exact-modal"
dt = 2e-5
"""
RUB = """[scene]
kind = "rub"
t_end = 2.0
[casing]
basis = "casing.npz"
[[blade]]
basis = "blade.npz"
lean_deg = 10.0
count = 2
[contact]
clearance = -1e-5
friction = 0.3
[speed]
hz = 60.0
[scheme]
kind = "exact-modal"
dt = 2e-5
"""
DISK = """[scene]
kind = "disk"
t_end = 4.0
[casing.pair]
n = 3
freq_hz = 290.0
modal_mass = 2.0
radius = 0.5
kick = 1e-2
[disk]
blades = 22
freq_hz = 115.0
modal_mass = 0.1
compliance = 5e-5
lean_deg = 45.0
[contact]
clearance = -1e-3
[speed]
hz = 136.0
[scheme]
kind = "exact-modal"
dt = 5e-5
"""
PATCH = """[scene]
kind = "patch"
t_end = 1.0
[body]
omega = [40.0, 60.0]
channels = ["x", "y"]
rows = [[1.0, 0.2], [0.9, 1.0]]
S = [[0.0, 0.0], [0.0, 0.0]]
load = {y = -1.0}
[[contact]]
normal = "y"
tangent = ["x"]
slide = [1.0]
[ground]
friction = 0.3
[scheme]
kind = "exact-modal"
dt = 1e-3
"""
SMOOTH, FLAG = ("friction = 0.3", "friction = 0.0"), ("t_end = 2.0", 't_end = 2.0\non_limit = "flag"')
OF_WALL, OF_RADIUS = "at most 0.002 m, 0.5 of its wall", "a tenth of the radius"
THEORY = "always closed, the motion grows"
COATING = """[coating]
E = 2e11
yield_stress = 1e12
hardening = 1e12
thickness = 2e-3
width = 0.04
tip = 5e-3
"""


@dataclass(frozen=True, slots=True)
class Case:
    """A scene and its expected outcome: "refused", "stopped" or "flagged"; `says` is in the message."""

    name: str
    end: str
    says: str
    scene: str
    command: str = "rub"


def changed(scene: str, *pairs: tuple[str, str]) -> str:
    """The scene with some of its lines replaced."""
    for old, new in pairs:
        if old not in scene:
            raise ValueError(f"no {old!r} in the scene")
        scene = scene.replace(old, new, 1)
    return scene


def bodies(folder: Path) -> None:
    """A steel ring on springs as casing, with and without its thickness and damping, and a blade of two modes."""
    folder.mkdir(parents=True, exist_ok=True)
    ring = ct.bodies.ThinRing(radius=RADIUS, width=0.05, height=WALL, E=210e9, rho=7800.0, k_r=2e7, k_t=2e6, zeta=1e-3)
    casing = replace(ct.bodies.ring_modes(ring, 8).truncated(8e4), thickness=WALL)
    blade = ct.ModalBody(
        omega=[2.0 * np.pi * 380.0, 2.0 * np.pi * 2400.0], zeta=[1e-3, 1e-3], channels=("span", "flap"),
        rows=[[0.1, 0.2], [2.0, 0.5]], S=[[2e-8, 0.0], [0.0, 6e-8]],
    )  # fmt: skip
    casing.save(folder / "casing.npz")
    replace(casing, thickness=0.0).save(folder / "old.npz")
    replace(casing, zeta=np.zeros(casing.omega.size)).save(folder / "undamped.npz")
    casing.detuned(1e-3, seed=7).save(folder / "split.npz")
    blade.save(folder / "blade.npz")
    write_atomic(folder / "round_mm.csv", "theta_deg,depth_m\n0,0\n90,150\n180,0\n270,100\n")


def cases() -> list[Case]:
    """Forty scenes: first those that diverge, by cause, then those that are mistyped."""
    return [*rims(), *rubs(), *disks_sweeps_patches(), *mistyped()]


def at(hz: float, *more: tuple[str, str], scene: str = RIM) -> str:
    """A scene at another speed, with other lines."""
    return changed(scene, ("hz = 60.0", f"hz = {hz}"), *more)


def rims() -> list[Case]:
    """One blade tip."""
    undamped, old, split = (("casing.npz", f"{name}.npz") for name in ("undamped", "old", "split"))
    pulses = ("-1e-5", "9e-5\nout_of_roundness = [{p = 2, cos = 1e-4}]")
    retuned = ('basis = "blade.npz"', 'basis = "blade.npz"\nfreq_hz = 300.0')
    forward, rough = ('"exact-modal"', '"exact-modal"\nlaw = "forward"'), ("= 0.3", "= 1.0")
    return [
        Case("digging blade, 100 Hz", "stopped", THEORY, at(100.0)),
        Case("digging blade, 150 Hz", "stopped", OF_WALL, at(150.0)),
        Case("backwards, 150 Hz", "stopped", OF_WALL, at(-150.0)),
        Case("no friction, f_c + f_b = n f, 135 Hz", "stopped", THEORY, at(135.0, SMOOTH)),
        Case("no friction, 150 Hz", "stopped", THEORY, at(150.0, SMOOTH)),
        Case("no friction, 200 Hz", "stopped", THEORY, at(200.0, SMOOTH)),
        Case("no damping, 5 Hz", "stopped", "grows by", at(5.0, undamped)),
        Case("no damping, 20 Hz", "stopped", "friction (", at(20.0, undamped)),
        Case("split pairs, 150 Hz", "stopped", "mean of each mode pair", at(150.0, split)),
        Case("a basis of before, no thickness", "stopped", OF_RADIUS, at(150.0, old)),
        Case("no thickness, friction 1", "stopped", OF_RADIUS, at(150.0, old, rough)),
        Case("flagged", "flagged", OF_RADIUS, at(150.0, FLAG)),
        Case("flagged, no friction", "flagged", "rim deflected by", at(200.0, FLAG, SMOOTH)),
        Case("out of round, pulses, 150 Hz", "stopped", OF_WALL, at(150.0, pulses)),
        Case("blade retuned to 300 Hz, 140 Hz", "stopped", OF_WALL, at(140.0, retuned)),
        Case("forward law, 150 Hz", "stopped", OF_WALL, at(150.0, forward)),
        Case("hard coating, 150 Hz", "stopped", OF_WALL, at(150.0) + COATING),
    ]


def rubs() -> list[Case]:
    """Several tips, and quantities that change during a run."""
    many, sticks, away = ("count = 2", "count = 5"), ("= 0.3", "= 0.9"), ("clearance = -1e-5", "clearance = 1e-4")
    ramp = ("hz = 60.0", "time = [0.0, 1.0]\nhz = [20.0, 160.0]")
    closes, whirls = "[closing]\nby = 2e-4\ntime_constant = 0.1\n", "[[whirl]]\namplitude = 2e-4\nper_rev = -1.0\n"
    return [
        Case("two blades, 150 Hz", "stopped", OF_WALL, at(150.0, scene=RUB)),
        Case("two blades, no friction", "stopped", THEORY, at(150.0, SMOOTH, scene=RUB)),
        Case("five blades, sticking", "stopped", OF_WALL, at(150.0, many, sticks, scene=RUB)),
        Case("run up into it", "stopped", OF_WALL, changed(RUB, ramp)),
        Case("gap closes into it", "stopped", OF_WALL, at(150.0, away, scene=RUB) + closes),
        Case("whirl into it", "stopped", OF_WALL, at(150.0, away, scene=RUB) + whirls),
        Case("blades flagged", "flagged", OF_RADIUS, at(150.0, FLAG, scene=RUB)),
    ]


def disks_sweeps_patches() -> list[Case]:
    """The other kinds of scenes and the other commands."""
    mistuned = ("[contact]", f"mistuning = {[0.002 * (-1) ** k for k in range(22)]}\n[contact]")
    some, all_of = at(60.0, ("t_end = 2.0", "t_end = 0.2")) + SPEEDS, at(60.0) + SPEEDS.replace("20.0, ", "")
    sunk = changed(PATCH, ("load =", "displacement = [0.0, -1.0]\nload ="))
    return [
        Case("bladed disk, f_c + f_b = n f", "stopped", THEORY, DISK),
        Case("bladed disk, mistuned", "stopped", OF_RADIUS, changed(DISK, mistuned)),
        Case("sweep over speeds", "swept", '"status": "diverged"', some, "sweep"),
        Case("sweep, all diverge", "swept-out", "all 2 runs failed, diverged", all_of, "sweep"),
        Case("patch below its ground", "refused", "contact 1 penetrates by 1 m", sunk, "contact"),
    ]


def mistyped() -> list[Case]:
    """Scenes with obvious typing errors."""
    oval = ("friction", "out_of_roundness = [{p = 2, cos = 0.3333}]\nfriction")
    profile = ("friction", 'profile = "round_mm.csv"\nfriction')
    closes, whirls = "[closing]\nby = 0.1\ntime_constant = 0.1\n", "[[whirl]]\namplitude = 0.05\n"
    refused = (
        ("friction 10", "friction: found 10", changed(RIM, ("= 0.3", "= 10"))),
        (
            "friction in per cent",
            "expected 0 to 2 (steel on steel 0.1 to 0.8, rubber 1); in percent?",
            changed(RUB, ("= 0.3", "= 30")),
        ),
        (
            "out of round by a third of a metre",
            "out_of_roundness[1].cos: found 0.3333 m, expected -0.01 to 0.01 m",
            changed(RIM, oval),
        ),
        ("profile in millimetres", "out_of_roundness: found 150 m", changed(RUB, profile)),
        ("closing by 100 mm", "closing: found 0.0999", RUB + closes),
        ("clearance of 30 mm", "clearance: found 0.03 m", changed(RIM, ("-1e-5", "0.03"))),
        ("whirl of 50 mm", "whirl: found 0.05 m", RUB + whirls),
        ("thickness in millimetres", "thickness: found 4 m", changed(RUB, ("[[blade]]", "thickness = 4.0\n[[blade]]"))),
        ("step of a millisecond", "dt: found omega_max dt", changed(RIM, ("2e-5", "1e-3"))),
        (
            "speed in turns a minute",
            "found 3600 Hz = 216,000 rpm, a surface speed of 5,655 m/s",
            changed(RIM, ("60.0", "3600.0")),
        ),
        ("an end in a thousand years", "t_end: found 3e+10 s", changed(RIM, ("2.0", "3e10"))),
    )
    return [Case(name, "refused", says, scene) for name, says, scene in refused]


SPEEDS = """[sweep]
kind = "list"
[[sweep.vary]]
key = "speed.hz"
values = [20.0, 150.0, 200.0]
"""
CODES = {"refused": 2, "stopped": 3, "failed": 3, "flagged": 0, "swept": 0, "swept-out": 3}


def judged(case: Case, folder: Path) -> Row:
    """Run one scene by the command line; returns its outcome."""
    out = folder / "out"
    file = folder / "scene.toml"
    write_atomic(file, case.scene)
    found = CliRunner().invoke(casingfem, [case.command, str(file), "--out", str(out), "--json"])
    said = found.stderr + found.stdout
    row: Row = {"scene": case.name, "exit": found.exit_code, "limit": None, "after s": None, "growth 1/s": None,
                "theory 1/s": None, "kept steps": None, "largest N": None}  # fmt: skip
    wrong = [] if found.exit_code == CODES[case.end] else [f"exit code {found.exit_code}, expected {CODES[case.end]}"]
    if case.says not in said:
        wrong.append(f"does not contain {case.says!r}")
    if case.end in ("stopped", "flagged", "failed") and not wrong:
        kept = ct.Result.load(out / f"{case.command}.npz")
        ended = kept.divergence
        row |= {"kept steps": kept.steps, "largest N": float(kept.peak_force.max())}
        if ended is not None:
            numbers = (ended.growth, ended.theory)
            row |= {"limit": ended.limit, "after s": ended.time}
            row |= {name: number if math.isfinite(number) else None for name, number in zip(
                ("growth 1/s", "theory 1/s"), numbers, strict=True)}  # fmt: skip
        elif case.end == "stopped":
            wrong.append("no divergence")
        if not (np.isfinite(kept.force).all() and np.isfinite(kept.gap).all() and kept.time.size):
            wrong.append("a record that is empty, or not finite")
        if abs(kept.time[-1] - (kept.steps - 1) * kept.dt) > kept.every * kept.dt:
            wrong.append("a record that ends early")
    if case.end.startswith("swept") and not wrong:
        runs = json.loads((out / "sweep.json").read_text(encoding="utf-8"))["runs"]
        ended_at = [run["diverged_at_s"] for run in runs if run["status"] == "diverged"]
        row |= {"limit": f"{len(ended_at)} of {len(runs)}", "after s": float(max(ended_at))}
        if max(run["amplitude_m"] or 0.0 for run in runs) > RADIUS:
            wrong.append("an amplitude beyond the radius")
    first = said.strip().splitlines()[-1] if case.end in ("refused", "failed") else ""
    return row | {"verdict": "NOT as expected: " + "; ".join(wrong) if wrong else case.end.partition("-")[0],
                  "said": first.partition("scene.toml: ")[2][:90]}  # fmt: skip


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print and write the table."""
    folder = out / "diverging"
    chosen: Callable[[list[Case]], list[Case]] = (lambda all_: all_[1::8]) if quick else (lambda all_: all_)
    rows: list[Row] = []
    for number, case in enumerate(chosen(cases()), 1):
        bodies(folder / f"{number:02d}")
        rows.append(judged(case, folder / f"{number:02d}"))
    show("Scenes made to diverge, or mistyped", rows)
    good = sum(not str(row["verdict"]).startswith("NOT") for row in rows)
    print(f"\n{good} of {len(rows)} refused, or stopped with everything kept and the cause named")
    write(out / "diverging.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
