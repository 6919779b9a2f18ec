"""Abradable coating: machined or worn in, the contact stays closed; a digging blade cuts itself free.

`python -m reports.studies.wear [--quick] [--out DIR]` runs the scenes of data/scenes/abradable on the frustum of
section_44: how long the contact is closed in the first and the last turn, how far the tip is past the first touch of
the remaining coating, the worn depth, and the energy dissipated by the coating's law against that of the worn profile.
In the last three scenes the gap closes slowly. Then worn volumes by step, bars and modes. Pictures go to DIR/abradable.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

import contact as ct
from casingfem.plot.contact import figure_wear
from casingfem.plot.style import png
from contact.io.outfiles import write_atomic
from contact.record.wear import Wear
from reports.studies.rim_levels import level_history
from reports.studies.section_44 import N_MAX, RECORD, N, make_blades
from reports.tables import DATA, Row, command_line, show, write
from reports.verification.rubs.bases import make_casing

SCENES = DATA / "scenes" / "abradable"
CASES = ("as_made", "machined", "worn", "digging_hard", "digging_soft")
CLOSING = ("wear_in", "pressed", "digging_in")  # the gap closes over 3 s: not cut short
TURN = 0.2  # s


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the tables, draw profiles and maps; returns the rows of the first table."""
    folder = out / "abradable"
    make_blades(folder)
    body = make_casing(folder, *((20, 1) if quick else (N_MAX, 2)))
    rows: list[Row] = []
    for name in CASES + CLOSING:
        write_atomic(folder / f"{name}.toml", (SCENES / f"{name}.toml").read_text(encoding="utf-8"))
        scene = ct.load_scene(folder / f"{name}.toml")
        result = ct.run(scene, t_end=1.0 if quick and name in CASES else None, record=RECORD)
        rows.append({"coating": name.replace("_", " "), **told(body, scene, result)})
        if result.wear is not None and result.wear.volume > 0.0:
            write_atomic(folder / f"{name}.png", png(figure_wear(result.wear)))
    show("Five turns a second, with the defect", rows)
    write(out / "wear.csv", rows)
    show("Worn volume [mm^3] by step, bars and modes", refined(folder, quick))
    return rows


def told(body: ct.ModalBody, scene: ct.Scene, result: ct.Result) -> Row:
    """Contact, motion and wear of a run."""
    wear = result.wear
    assert wear is not None  # every scene here is coated
    end = result.steps * result.dt
    levels = level_history(body, result, round(end / 0.05))[1]
    force = result.windowed_force()[result.time > end - TURN, 0]
    return {
        "closed, first turn [%]": closed(result, 0.0, TURN), "last turn [%]": closed(result, end - TURN, end),
        "past touch [um]": 1e6 * past_touch(scene, wear, end), "least force [N]": float(force.min()),
        "largest [N]": float(force.max()), "out of round [um]": 1e6 * float(np.ptp(wear.after)),
        f"n = {N}, highest [m]": float(levels[:, N].max()), "at the end [m]": float(levels[-1, N]),
        "worn [cm^3]": 1e6 * wear.volume, "deepest [um]": 1e6 * float(wear.worn.max()),
        "dissipated [J]": wear.dissipated, "against profile": wear.residual,
        "unaccounted": abs(result.energy.unaccounted) / result.energy.scale,
    }  # fmt: skip


def past_touch(scene: ct.Scene, wear: Wear, end: float) -> float:
    """Distance [m] of the tip at rest past the first touch of the remaining coating."""
    what = scene.what
    assert isinstance(what, ct.RotatingRim | ct.Rub)
    closing = what.closing.at(end) if isinstance(what, ct.Rub) else 0.0
    return closing - what.clearance - float(wear.after.min())


def closed(result: ct.Result, start: float, end: float) -> float:
    """Share of a time in which the contact is closed [%]."""
    held = sum(max(min(b, end) - max(a, start), 0.0) for a, b in result.intervals[0])
    return 100.0 * held / (end - start)


def refined(folder: Path, quick: bool) -> list[Row]:
    """Worn volumes of the soft coatings with half the step, twice the bars and twice the modes."""
    doubled = None if quick else make_casing(folder, N_MAX, 4, name="casing_doubled")
    rows: list[Row] = []
    for name in ("worn",) if quick else ("worn", "digging_soft", "wear_in"):
        scene = ct.load_scene(folder / f"{name}.toml")
        t_end, dt = 0.4 if quick else scene.t_end, scene.dt
        assert isinstance(scene.law, ct.Abradable)
        assert dt is not None
        fine = replace(scene.law, bars=2 * scene.law.bars)
        runs = {
            "as it is": ct.run(scene, t_end=t_end, record=RECORD),
            "dt/2": ct.run(scene, t_end=t_end, dt=0.5 * dt, record=RECORD),
            "bars x 2": ct.run(scene, t_end=t_end, law=fine, record=RECORD),
        }
        if doubled is not None:
            assert isinstance(scene.what, ct.RotatingRim | ct.Rub)
            what = replace(scene.what, casing=doubled)
            runs[f"{doubled.omega.size} modes"] = ct.run(replace(scene, what=what), record=RECORD)
        volumes = {key: 1e9 * run.wear.volume for key, run in runs.items() if run.wear is not None}
        rows.append({"coating": name.replace("_", " "), **volumes})
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
