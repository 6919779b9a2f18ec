"""Section 4.4 of the source study: when n = 10 dominates a rub, and the effect of removing each cause.

`python -m reports.studies.section_44 [--quick] [--out DIR]` runs the scenes of data/scenes/section_44: four rubs, each
with three controls; the casing turns before a fixed blade. Level of n = 10 over the next nodal diameter, with half the
step and with twice the modes; then the same by how far the blade is advanced, which the study does not state. Bases,
scenes and pictures go to DIR/section_44.
"""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import casingfem as cf
import contact as ct
from casingfem.io.arrays import Array
from casingfem.plot.style import AFTER, PERFECT, new_figure, png, styled
from contact.io.outfiles import write_atomic
from contact.stability.closed_contact import growth
from reports.studies.rim_levels import excess_db, level_history, rim_levels
from reports.tables import DATA, Row, command_line, show, write
from reports.verification.rubs.bases import ZETA, make_casing, steel_strip

SCENES = DATA / "scenes" / "section_44"
RUBS = {
    "half_hz": ".5 Hz, with the defect",
    "one_hz": "1 Hz, with the defect",
    "five_hz": "5 Hz, with the defect",
    "five_hz_machined": "5 Hz, defect machined away",
}
CONTROLS = {
    "": "digging blade",
    "_no_friction": "no friction",
    "_low_friction": "mu .15 < tan(lean)",
    "_trailing": "trailing blade",
}
THICKNESS = {"blade_423": 6.021e-3, "blade_418": 5.948e-3, "blade_388": 5.52e-3}  # m: first mode near the Hz named
N, N_MAX = 10, 40
ADVANCES = (5e-6, 1e-5, 2e-5, 5e-5, 1e-4)
RECORD = ct.Record(every=20, state_every=20)
ASSUMED = """Assumed, because the study does not state it:
- friction of .3 above tan(lean) = .176, the blade leaning into the motion;
- the blade is tuned anew for each speed, by its thickness, near where n = 10 grows fastest in a contact that stays
  closed, with the Coriolis forces and the centrifugal stress of the casing, which turns (column "pole"; "pole at rest"
  leaves them out: at 5 Hz a blade of 378 Hz, which it lets grow by 38 1/s, grows by 7);
- one contact point, no wear: amplitudes of a millimetre are the model's; the fourth rub swings by half of
  its wall after 0.28 s, where linear theory ends: its scene says on_limit = "flag", which runs on;
- the blade is advanced 50 um past its first touch at .5 and 1 Hz, 10 um at 5 Hz. With the defect it is shut for part
  of a turn only; n = 10 grows if it gains more there than it loses to damping while the contact is open;
- no single advance gives all four rows: how much of a turn the blade is shut depends on the advance and hardly on the
  speed, and n = 10 needs a larger share of it at .5 Hz than at 5 Hz (column "even"), so that what makes the first rub
  grow makes the third grow too;
- the defect is a clearance (2 lobes of .2 mm, 3 of .05 mm): the casing's modes are those of a perfect frustum."""


@styled
def figure_levels(histories: Mapping[str, tuple[Array, Array]], n: int, n_max: int = 20) -> Figure:
    """RMS motion by nodal diameters over time, one panel a run: `n` and its neighbours named, the rest grey.

    A history is the times (windows,) [s] and the levels (windows, nodal diameters) [m].
    """
    figure = new_figure(8.0, 2.0 * len(histories))
    panels: Any = figure.subplots(len(histories), 1, sharex=True, squeeze=False)[:, 0]
    for axes, (title, (time, levels)) in zip(panels, histories.items(), strict=True):
        floor = 1e-3 * float(levels.max(initial=0.0)) or 1e-12
        for k in range(2, min(n_max + 1, levels.shape[1])):
            own = k == n
            axes.semilogy(
                time,
                np.maximum(levels[:, k], floor),
                color=AFTER if own else PERFECT,
                linewidth=2.0 if own else 0.7,
                zorder=3 if own else 2,
                label=f"n = {n}" if own else f"n = 2 .. {n_max}" if k == 2 else None,
            )
        axes.set_title(title)
        axes.set_ylabel("rms [m]")
    panels[0].legend(ncols=2, fontsize=8)
    panels[-1].set_xlabel("time [s]")
    return figure


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the tables and draw the levels over time; returns the rows of the first table."""
    folder = out / "section_44"
    make_blades(folder)
    base = make_casing(folder, *((20, 1) if quick else (N_MAX, 2)))
    doubled = None if quick else make_casing(folder, N_MAX, 4, name="casing_doubled")
    for file in sorted(SCENES.glob("*.toml")):
        write_atomic(folder / file.name, file.read_text(encoding="utf-8"))
    rows, histories = [], {}
    for name, words in RUBS.items():
        for tail, control in CONTROLS.items():
            scene = ct.load_scene(folder / f"{name}{tail}.toml")
            result = ct.run(scene, record=RECORD)
            rows.append({"rub": words, "blade": control, **measured(base, scene, result)})
            if doubled is not None:
                rows[-1] |= refined(scene, base, doubled)
            if not tail:
                histories[words] = level_history(base, result, 80)
    show(f"Level of n = {N} over the next nodal diameter, last quarter of the run", rows)
    write(out / "section_44.csv", rows)
    if not quick:
        show(f"The same [dB] by the advance of the blade; {len(base.omega)} modes", by_advance(folder))
    print(f"\n{ASSUMED}")
    write_atomic(folder / "levels.png", png(figure_levels(histories, N)))
    return rows


def measured(body: ct.ModalBody, scene: ct.Scene, result: ct.Result) -> Row:
    """Pole of the closed contact beside what the run shows, and the share of time at which growth and damping even out.

    A contact closed for the share s of a turn gains s pole and loses (1 - s) zeta omega of the open blade.
    """
    levels = rim_levels(body, result)
    rim, mu = rim_of(scene), scene.law.mu if isinstance(scene.law, ct.Coulomb) else 0.0
    pole = float(growth(ct.gaps.rim_contact(rim, mu=mu), np.array([rim.speed_hz]))[0])
    still = replace(rim, casing=rim.casing.without_rotation())
    at_rest = float(growth(ct.gaps.rim_contact(still, mu=mu), np.array([rim.speed_hz]))[0])
    loss = float(rim.blade.zeta[0] * rim.blade.omega[0])
    return {
        "blade [Hz]": float(rim.blade.omega[0] / (2.0 * np.pi)), "pole [1/s]": pole, "pole at rest [1/s]": at_rest,
        "even [%]": 100.0 * loss / (loss + pole) if pole > 0.0 else None,
        "closed [%]": 100.0 * float(result.contact_steps[0]) / result.steps,
        "n = 10 [m]": float(levels[N]), "over next [dB]": excess_db(levels, N),
    }  # fmt: skip


def refined(scene: ct.Scene, body: ct.ModalBody, doubled: ct.ModalBody) -> Row:
    """Levels [dB] with half the step, and with twice the modes."""
    assert scene.dt is not None  # a rim's file has one
    halved = ct.run(scene, dt=0.5 * scene.dt, record=ct.Record(every=40, state_every=40))
    richer = ct.run(replace(scene, what=replace(rim_of(scene), casing=doubled)), record=RECORD)
    return {
        "dt/2 [dB]": excess_db(rim_levels(body, halved), N),
        f"{len(doubled.omega)} modes [dB]": excess_db(rim_levels(doubled, richer), N),
    }


def by_advance(folder: Path) -> list[Row]:
    """Levels [dB] of the four rubs over how far the blade is advanced past its first touch [m]."""
    rows: list[Row] = []
    for name, words in RUBS.items():
        scene = ct.load_scene(folder / f"{name}.toml")
        rim = rim_of(scene)
        touch = first_touch(rim)
        row: Row = {"rub": words}
        past: list[str] = []
        for advance in ADVANCES:
            moved = replace(scene, what=replace(rim, clearance=touch - advance), on_limit="flag")
            result = ct.run(moved, record=RECORD)
            row[f"{1e6 * advance:g} um"] = excess_db(rim_levels(rim.casing, result), N)
            past += [f"{1e6 * advance:g} um"] if result.flags else []
        row["beyond half the wall at"] = ", ".join(past) or "-"
        rows.append(row)
    return rows


def rim_of(scene: ct.Scene) -> ct.RotatingRim:
    """The rim of a scene of that kind."""
    assert isinstance(scene.what, ct.RotatingRim)
    return scene.what


def first_touch(rim: ct.RotatingRim) -> float:
    """Clearance [m] at which the rim at rest just touches."""
    theta = np.linspace(0.0, 2.0 * np.pi, 36001)
    d = sum((a * np.cos(p * theta) + b * np.sin(p * theta) for p, a, b in rim.terms), np.zeros_like(theta))
    return -float(np.min(d))


def make_blades(folder: Path) -> None:
    """The strips of reports.verification.rubs.bases, each with its thickness."""
    for name, thickness in THICKNESS.items():
        cf.reduce(steel_strip(thickness), cf.Tip(), modes=4, zeta=ZETA).save(folder / f"{name}.npz")


if __name__ == "__main__":
    command_line(__doc__, main)
