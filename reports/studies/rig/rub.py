"""The rub: a blade tuned to the casing, both reduced, run with the surveyed out-of-roundness and without."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

import casingfem as cf
import contact as ct
from casingfem.cli.scene_page import run_numbers
from casingfem.io.arrays import FloatArray
from casingfem.modal.interaction import wave_hz
from casingfem.modal.modes import Modes
from casingfem.plot.pages.scene import Ran
from casingfem.study import Study
from casingfem.study.tasks import run_reduce
from contact.interacting import Interactions
from contact.io.outfiles import write_atomic
from contact.recovery.around_rim import rim_motion
from contact.recovery.histories import RubFilm, rub_film
from contact.stability.split_casing import perfect_mean
from reports.studies.rig.tuning import RubPlan, Tuning, band_of_n, leading, tuned
from reports.studies.rim_levels import excess_db, rim_levels

LONGER_STEP = 3.0  # times the plan's step: of the runs over speed and of those with a cause taken away


@dataclass(frozen=True, slots=True, eq=False)
class Rub:
    """One run: the rim's radial motion by nodal diameters late in it, RMS [m], (n_max + 1,); the speeds around its own.

    `ran` has the numbers that a page on a scene says of its run, `speeds` the table of dangerous speeds.
    """

    name: str
    result: ct.Result
    levels: FloatArray
    ran: Ran
    speeds: Interactions
    film: RubFilm | None = None

    def excess_db(self, n: int) -> float:
        """Level of n over the highest other one [dB]."""
        return excess_db(self.levels, n)


def casing_target(casing: Modes, n: int) -> float:
    """Mean frequency [Hz] of the casing's lowest doublet of n nodal diameters."""
    pair = next(list(pair) for pair in casing.doublets if casing.nodal_diameters[pair[0]] == n)
    return float(casing.freq[pair].mean())


def deviation(terms: list[dict[str, float]], theta: FloatArray) -> FloatArray:
    """The deviation at angles [m]."""
    total = np.zeros_like(theta)
    for term in terms:
        total += term["cos"] * np.cos(term["p"] * theta) + term["sin"] * np.sin(term["p"] * theta)
    return total


def bodies(
    casing: Study, structure: cf.Shell, target: float, blade: Study, plan: RubPlan, out: Path
) -> tuple[tuple[Path, Path], Tuning]:
    """Reduce the casing, tune and reduce the blade, save both: only these files cross to contact.

    `target` is the casing's mode [Hz]. The blade is put at the free coincidence f_b = f_c - n f first, f_c that of the
    wave against the rotation in the frame of the casing. Poles of the closed contact give the band around it in which
    n leads what grows; the blade is then moved into that band.
    """
    files = out / "rig_casing.npz", out / "rig_blade.npz"
    rim = run_reduce(casing, structure)
    rim.save(files[0])
    against = float(wave_hz(plan.n, target, np.array([plan.speed_hz]), "casing", -1)[0])
    coincidence = against - plan.n * plan.speed_hz
    strip = tuned(blade.shell, coincidence)
    run_reduce(blade, strip).save(files[1])
    body = ct.ModalBody.load(files[0])
    low, high = band_of_n(body, ct.ModalBody.load(files[1]), plan, coincidence)
    wanted = low + plan.into_band * (high - low)
    strip = tuned(strip, wanted)
    tip = run_reduce(blade, strip)
    tip.save(files[1])
    print(rim, tip, sep="\n")
    grows = leading(perfect_mean(body), ct.ModalBody.load(files[1]), plan)
    tuning = Tuning(
        coincidence=coincidence, low=low, high=high, target=wanted, thickness=strip.thickness, grows=grows
    )  # fmt: skip
    return files, tuning


def scene_of(files: tuple[Path, Path], plan: RubPlan, terms: list[dict[str, float]]) -> ct.RotatingRim:
    """The rim and its blade, which is advanced past its first touch and starts opposite to it."""
    casing, blade = (ct.ModalBody.load(file) for file in files)
    theta = np.linspace(0.0, 2.0 * np.pi, 3601)
    d = deviation(terms, theta)
    return ct.RotatingRim(
        casing,
        blade,
        clearance=-float(d.min()) - plan.advance,
        speed_hz=plan.speed_hz,
        lean_deg=plan.lean_deg,
        out_of_roundness=terms,
        angle_deg=float(np.degrees(theta[d.argmax()])),
        turning="casing",
    )


def run(files: tuple[Path, Path], plan: RubPlan, terms: list[dict[str, float]]) -> tuple[ct.Result, Interactions]:
    """One rub, and the dangerous speeds around its own."""
    scene = planned(scene_of(files, plan, terms), plan)
    return ct.run(scene, record=ct.Record(every=5, state_every=20)), speeds_around(scene, plan)


def shown(name: str, files: tuple[Path, Path], plan: RubPlan, terms: list[dict[str, float]],
          ran: tuple[ct.Result, Interactions]) -> Rub:  # fmt: skip
    """What the page shows of a rub; its scene is written as a file for `casingfem rub`."""
    rim, (result, speeds) = scene_of(files, plan, terms), ran
    write_atomic(files[0].with_name(f"rub_{name.replace(' ', '_')}.toml"), scene_toml(rim, files, plan))
    print(f"\n{name}\n{result}\n{speeds}")
    return Rub(
        name=name, result=result, levels=rim_levels(rim.casing, result), film=rub_film(rim, result), speeds=speeds,
        ran=run_numbers(planned(rim, plan), result, rim_motion(rim, result)),
    )  # fmt: skip


def planned(rim: ct.RotatingRim, plan: RubPlan) -> ct.Scene:
    """A rub over the time of the plan; beyond the limits of linear theory it is flagged and goes on."""
    return ct.Scene(
        what=rim, law=ct.Coulomb(mu=plan.friction), scheme=ct.ExactModal(), t_end=plan.t_end, dt=plan.dt,
        on_limit="flag",  # its levels are wanted, also where the rim passes half its wall: the page states it
    )  # fmt: skip


def speeds_around(scene: ct.Scene, plan: RubPlan) -> Interactions:
    """The dangerous speeds up to twice the plan's, by runs at every tenth of that range and at peaks, LONGER_STEP.

    A run ends where the rim passes half of its wall.
    """
    scene, highest = replace(scene, dt=LONGER_STEP * plan.dt, on_limit="stop"), 2.0 * plan.speed_hz
    speeds = np.linspace(0.1 * highest, highest, 91)
    return ct.interactions(scene, speeds, runs=10)


def controls(files: tuple[Path, Path], plan: RubPlan) -> dict[str, float]:
    """Level of n over the next nodal diameter [dB] of the round rim with a cause taken away, all with LONGER_STEP."""
    plan = replace(plan, dt=LONGER_STEP * plan.dt)
    without = {
        f"digging blade, {LONGER_STEP:g} times the step": plan,
        "no friction": replace(plan, friction=0.0),
        "friction 0.15, below tan(lean)": replace(plan, friction=0.15),
        "trailing blade": replace(plan, lean_deg=-plan.lean_deg),
    }
    levels = {}
    for words, changed in without.items():
        scene = planned(scene_of(files, changed, []), changed)
        result = ct.run(scene, record=ct.Record(every=20, state_every=20))
        levels[words] = excess_db(rim_levels(scene.what.casing, result), plan.n)
    return levels


def scene_toml(scene: ct.RotatingRim, files: tuple[Path, Path], plan: RubPlan) -> str:
    """The run as a scene file beside the bases, for `casingfem rub`."""
    terms = ",\n    ".join(f"{{p = {t['p']}, cos = {t['cos']!r}, sin = {t['sin']!r}}}" for t in scene.out_of_roundness)
    return f"""[scene]
kind = "rim"
t_end = {plan.t_end!r}
on_limit = "flag"

[casing]
basis = "{files[0].name}"

[blade]
basis = "{files[1].name}"
lean_deg = {plan.lean_deg!r}

[contact]
clearance = {scene.clearance!r}
friction = {plan.friction!r}
angle_deg = {scene.angle_deg!r}
out_of_roundness = [
    {terms}
]

[speed]
hz = {plan.speed_hz!r}
turning = "{scene.turning}"

[scheme]
kind = "exact-modal"
dt = {plan.dt!r}
"""
