"""Agreement of the table of dangerous speeds with separate runs, for three machines.

`python -m reports.verification.rubs.beside [--quick] [--out DIR]` prints the table of `ct.interactions` of the
tutorial's casing and blade, of NASA rotor 37 before a cylinder of 4 mm (`reports.verification.rubs.rotor37`), and of a
titanium casing of three pieces with a stiffener whose track lies inside. For each of the worst rows, and for some safe
speeds, it prints a separate run at that speed, at the step of the scene and at half of it: its growth, its motion, and
whether it confirms the verdict. DIR gets the page of each table, as NAME.html.
"""

import runpy
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

import casingfem as cf
import contact as ct
from casingfem.cli.pictures import speed_figures
from casingfem.plot.pages.interactions import interactions_page
from casingfem.study.load import load_shell_study
from casingfem.study.tasks import run_reduce
from contact.interacting import Interactions
from contact.io.outfiles import write_atomic
from contact.speed_runs import at_speed
from contact.speed_verdict import SpeedRun
from contact.version import versions
from reports.tables import ROOT, Row, command_line, show, write
from reports.verification.rubs import rotor37

WORST, SAFE = 6, 3  # compared rows of each table, and safe speeds
TITANIUM = cf.Material(E=114e9, nu=0.34, rho=4430.0)
WALL = """
[material]
E = 114e9
nu = 0.34
rho = 4430.0
[chart]
kind = "meridian"
start = [0.60, 0.0]
fillet = 4e-3
[[chart.piece]]
to = [0.60, 0.80]
[[chart.piece]]
to = [0.52, 1.05]
thickness = 4e-3
[[chart.piece]]
to = [0.545, 1.05]
thickness = 5e-3
[shell]
thickness = 3.5e-3
[[stiffener]]
at = 0.40
width = 20e-3
depth = 6e-3
offset = [11.75e-3, 0.0]
"""  # titanium: cylinder, cone and flange, one stiffener
CASING = (
    WALL
    + """[support.base]
kind = "clamped"
[modes]
count = 16
[reduce]
interface = "top"
lines = [0.70]
n_max = 20
modes = 60
zeta = 0.002
"""
)


def tutorial() -> tuple[ct.Scene, Interactions]:
    """The scene of the tutorial and its table."""
    import matplotlib as mpl

    mpl.use("Agg")
    found = runpy.run_path(str(ROOT / "docs" / "tutorial" / "casing_and_blade.py"))
    return found["scene"], found["interactions"]


def track_inside() -> ct.Scene:
    """A strip of titanium on a line 0.35 m below the upper edge, pressed in by 50 um."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "casing.toml")
        file.write_text(CASING, encoding="utf-8")
        casing = ct.ModalBody.of(run_reduce(load_shell_study(file)))
    strip = cf.Shell(
        chart=cf.Plate(length=0.15, width=0.06), thickness=4e-3, material=TITANIUM, supports={"root": cf.Clamped()}
    )
    tip = ct.ModalBody.of(cf.reduce(strip, cf.Tip(), modes=3, zeta=0.002))
    rub = ct.RotatingRim(casing, tip, clearance=-5e-5, speed_hz=130.0, lean_deg=15.0)
    return ct.Scene(what=rub, law=ct.Coulomb(mu=0.15), t_end=0.1, dt=1e-5)


def machines(quick: bool) -> Iterator[tuple[str, ct.Scene, Interactions]]:
    """Name, scene and table of each machine."""
    yield ("tutorial", *tutorial())
    rotor = rotor37.scene(rotor37.COARSE if quick else rotor37.CELLS)
    yield "rotor 37", rotor, ct.interactions(rotor, np.linspace(290.0, 330.0, 41), runs=4 if quick else 12)
    if not quick:
        inside = track_inside()
        yield "track inside", inside, ct.interactions(inside, np.linspace(20.0, 170.0, 300), runs=30)


def ran(scene: ct.Scene, run: SpeedRun, parts: int) -> tuple[bool, float, int | None]:
    """Whether a run at the speed of a row grows, its growth [1/s] and nodal diameters; with divided steps.

    A run that passed a limit has twice the time, since it may pass it somewhat later with other steps.
    """
    one, seconds = at_speed(scene, run.speed_hz), run.seconds * (2.0 if run.stopped else 1.0)
    assert one.dt is not None
    try:
        result = ct.run(one, t_end=max(seconds, scene.t_end or 0.0), dt=one.dt / parts)
    except ct.NumericsError as error:
        result = error.result
    grown = result.growth
    passed = result.divergence is not None and result.divergence.limit in ("wall", "radius")
    grows = passed or (grown is not None and grown.outcome == "grows")
    return grows, np.nan if grown is None else grown.rate, None if grown is None else grown.nodal_diameters


def compared(name: str, scene: ct.Scene, found: Interactions) -> list[Row]:
    """The worst rows of a table and safe speeds, each compared with separate runs."""
    safe = [run for run in found.runs if run.verdict == "safe"]
    chosen = [row.at for row in found.rows[:WORST]]
    chosen += [run for run in safe[:: max(1, len(safe) // SAFE)] if run not in chosen][:SAFE]
    rows: list[Row] = []
    for run in chosen:
        (alone, rate, n), (fine, half, _) = ran(scene, run, 1), ran(scene, run, 2)
        unstable = run.verdict == "unstable"
        decided = run.verdict != "not decided"
        rows.append({
            "machine": name, "rpm": 60.0 * run.speed_hz, "verdict": run.verdict, "pole 1/s": run.closed,
            "table 1/s": run.growth, "low": run.low, "high": run.high, "check": run.check, "n": run.n, "run 1/s": rate,
            "n of run": n, "half step 1/s": half,
            "agree": "-" if not decided else "yes" if alone == fine == unstable else "NOT",
        })  # fmt: skip
    return rows


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print each table and the separate runs; write beside.csv and a page of each table."""
    rows: list[Row] = []
    for name, scene, found in machines(quick):
        print(f"\n{name}\n{found}")
        page = interactions_page(name, found, speed_figures(scene, found), versions())
        write_atomic(out / f"{name.replace(' ', '_')}.html", page)
        mine = compared(name, scene, found)
        show(f"{name}: runs beside the table", mine)
        rows += mine
    write(out / "beside.csv", rows)
    return [replace_none(row) for row in rows]


def replace_none(row: Row) -> Row:
    """The row with its verdict under the name that decides how the command ends."""
    return row | {"verdict": "NOT" if row["agree"] == "NOT" else "pass"}


if __name__ == "__main__":
    command_line(__doc__, main)
