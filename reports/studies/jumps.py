"""Speeds at which a rub jumps up and down: a branch with its folds, compared with slow ramps up and down.

`python -m reports.studies.jumps [--quick] [--out DIR]`. The study's frustum (one order of n <= 20) turns before its
trailing blade, friction 0.15. A soft coating is worn in at 100 turns/s until nothing more is worn; then the gap closes
by 10 um. Three lobes pass at the blade's first frequency near 130 turns/s: the periodic motions are followed there on
the coating as it is left, and two runs, each from an orbit at one end of the range, go through it at a speed that rises
or falls by 0.1 turns/s in a second. They leave a motion where its branch ends in a fold.
"""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

import casingfem as cf
import contact as ct
from casingfem.io.arrays import FloatArray
from casingfem.plot.cycles import figure_cycles
from casingfem.plot.style import png
from contact.cycles import Cycles, Orbit, RimFamily, Special, as_worn
from contact.io.outfiles import write_atomic
from contact.model.gaps.rub import rub_of
from reports.studies.section_44 import first_touch
from reports.tables import Row, check, command_line, show, write
from reports.verification.rubs.bases import make_casing, steel_strip

DEFECT = ({"p": 2, "cos": 2e-4}, {"p": 3, "cos": 5e-5})
COATING = ct.Abradable(
    E=2e7, yield_stress=1e5, hardening=1e5, thickness=2e-3, width=0.04, tip=5e-3, bars=6, mu=0.15
)  # fmt: skip
THICKNESS = 5.4615e-3  # m: a blade whose first mode is at 384 Hz
ZETA, LEAN_DEG, ADVANCE, CLOSES = 0.005, -10.0, 1e-4, 1e-5
WORN_AT, BETWEEN = 100.0, (131.4, 133.6)  # turns/s
HARMONICS = (16, 80, 40)  # of the profile as worn; the last one goes on
WINDOW = 0.05  # s, of an amplitude: six turns
JUMPS = (  # in the order of their speeds: is the speed rising, is the motion after it larger
    ("falling: the large motion ends", False, False),
    ("rising: the small one jumps up", True, True),
    ("falling: the small one jumps up", False, True),
    ("rising: the large one ends", True, False),
)
NEAR = 0.1  # turns/s, before a fold
BEYOND = 2.0  # times the amplitude at the fold, more or less: it has jumped


@dataclass(frozen=True, slots=True, eq=False)
class Ramp:
    """Speed [turns/s] and amplitude of the blade's flap [m] in each window of a run."""

    speed_hz: FloatArray
    flap: FloatArray

    def leaves(self, fold: Special, *, up: bool) -> float:
        """Speed at which the amplitude is first far from the fold's, from near the fold on; nan if never."""
        past = np.sign(self.speed_hz[-1] - self.speed_hz[0]) * (self.speed_hz - fold.orbit.value) > -NEAR
        size = fold.orbit.amplitude["flap"]
        gone = self.flap > BEYOND * size if up else self.flap < size / BEYOND
        found = np.flatnonzero(past & gone)
        return float(self.speed_hz[found[0]]) if found.size else float("nan")


def pair(folder: Path) -> ct.Rub:
    """Casing and blade at rest before each other, the blade advanced past its first touch."""
    casing = make_casing(folder, 20, 1)
    strip = cf.reduce(steel_strip(THICKNESS), cf.Tip(), modes=4, zeta=ZETA)
    blade = ct.ModalBody.load(strip.save(folder / "blade_384.npz"))
    damped = [replace(body, zeta=np.full(body.omega.size, ZETA)) for body in (casing, blade)]
    rim = ct.RotatingRim(
        *damped, clearance=0.0, speed_hz=WORN_AT, lean_deg=LEAN_DEG, out_of_roundness=DEFECT
    )  # fmt: skip
    return rub_of(replace(rim, clearance=first_touch(rim) - ADVANCE))


def worn_in(rub: ct.Rub) -> tuple[ct.Result, Row]:
    """A run of one second at one speed; returns how much was worn, and when wear ended."""
    result = ct.run(rub, law=COATING, scheme=ct.ExactModal(), t_end=1.0, dt=2e-6, record=ct.Record(every=10))
    wear = result.wear
    assert wear is not None  # the law is a coating's
    depth = wear.map.sum(axis=1)
    return result, {
        "worn [mm^3]": 1e9 * wear.volume, "deepest [um]": 1e6 * float(wear.worn.max()),
        "nothing more after [s]": float(wear.map_time[int(np.argmax(depth >= (1.0 - 1e-12) * depth[-1]))]),
        "largest force at the end [N]": float(result.force[result.time > 0.9].max()),
        "yield force [N]": COATING.yield_stress * COATING.width * COATING.tip,
    }  # fmt: skip


def ramp(rub: ct.Rub, at: Orbit, to_hz: float, rate: float, dt: float) -> Ramp:
    """A run from an orbit to another speed on the worn coating, without further wear."""
    m, omega = rub.casing.omega.size, np.concatenate([body.omega for body in rub.bodies])
    q, v = np.split(np.asarray(at.x), 2)
    v = v * omega
    t_end = abs(to_hz - at.value) / rate
    blade = rub.blades[0]
    moving = replace(
        rub, speed=ct.Speed(time=[0.0, t_end], hz=[at.value, to_hz]),
        casing_start=ct.gaps.Start(displacement=q[:m], velocity=v[:m]),
        blade_starts=(ct.gaps.Start(displacement=q[m:], velocity=v[m:]),),
    )  # fmt: skip
    every = round(1e-4 / dt)
    result = ct.run(
        moving, law=replace(COATING, yield_stress=1e12), scheme=ct.ExactModal(law="averaged"), t_end=t_end, dt=dt,
        record=ct.Record(every=every, state_every=every),
    )  # fmt: skip
    count = round(WINDOW / 1e-4)
    flap = result.state_of("blade") @ blade.rows[blade.channel("flap")]
    whole = flap.size // count * count
    time = result.state_time[:whole].reshape(-1, count).mean(axis=1)
    size = np.abs(flap[:whole]).reshape(-1, count).max(axis=1)
    return Ramp(at.value + (to_hz - at.value) * time / t_end, size)


def jumps(found: Cycles, up: Ramp, down: Ramp, allowed: float) -> list[Row]:
    """The four folds, compared with the speeds at which runs leave them."""
    folds = sorted((fold for part in found.branches for fold in part.of("fold")), key=lambda fold: fold.orbit.value)
    if len(folds) != len(JUMPS):
        raise ct.NumericsError(f"found {len(folds)} folds, expected those of {len(JUMPS)} jumps")
    return [
        check(words, "fold", fold.orbit.value, (up if rising else down).leaves(fold, up=grows), allowed)
        for (words, rising, grows), fold in zip(JUMPS, folds, strict=True)
    ]


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the wear, the branches, the jumps; draw branches and ramps."""
    rub = pair(out / "jumps")
    result, told = worn_in(rub)
    assert result.wear is not None
    for count in HARMONICS:
        worn, stiffness = as_worn(rub, COATING, result.wear, count)
        family = RimFamily(rim=worn, mu=COATING.mu, stiffness=stiffness)
        told |= {f"orbit, {count} harmonics [N]": float(ct.cycles.orbit(family, WORN_AT).force[0])}
    show("Worn in at 100 turns/s", [told])
    closed = replace(worn, clearance=worn.clearance - CLOSES)
    family = replace(family, rim=closed)
    found = ct.cycles.follow(family, BETWEEN, longest=0.1 if quick else 0.05, most=300)
    force = max(float(point.force[0]) for part in found.branches for point in part.points)
    print(f"\n{found!r}\nlargest force {force:.0f} N: what is beyond the yield force would wear the coating on")
    rate, dt = (0.25, 4e-6) if quick else (0.1, 2e-6)
    first, last = found.branches[0].points[0], found.branches[-1].points[-1]
    up, down = ramp(closed, first, BETWEEN[1], rate, dt), ramp(closed, last, BETWEEN[0], rate, dt)
    rows = jumps(found, up, down, 0.2 if quick else 0.1)  # they are late by rate^(2/3)
    show("Speeds at which runs leave a motion [turns/s]", rows)
    write(out / "jumps.csv", rows)
    figure = figure_cycles(found.records(), found.marks())
    for one, words in ((up, "run, speed rising"), (down, "run, speed falling")):
        figure.axes[-1].plot(one.speed_hz, one.flap, lw=0.8, alpha=0.7, label=words)
    figure.axes[-1].legend(loc="upper left")
    write_atomic(out / "jumps.png", png(figure))
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
