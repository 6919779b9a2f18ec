"""An interaction map: growth of a rub over speed and blade frequency, by poles and by runs.

`python -m reports.verification.rubs.interaction_map [--quick] [--out DIR]`. The scene is
data/scenes/interaction_map/map.toml: a blade pressed against the frustum's rim. The left picture has the growth of a
contact that stays closed, the right one the amplitude of runs, grey if the run ends because the rim deflects by half
its wall. Both show the lines f_b = f_c - n f. Bases, table and picture go to DIR/interaction_map.
"""

import os
import time
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.colors import LogNorm
from numpy.typing import NDArray

import contact as ct
from casingfem.plot.style import DIVERGING, PERFECT, new_figure, styled
from casingfem.study import load_shell_study
from casingfem.study.tasks import run_reduce
from contact.io.outfiles import write_atomic
from contact.model.gaps.permanent import rim_contact
from contact.scene.load import scene_of
from contact.stability.closed_contact import growth
from contact.sweep.plan import SweepPlan, load_sweep
from contact.sweep.sweep import run_sweep, table
from reports.tables import DATA, Row, command_line, show, write

SCENES = DATA / "scenes" / "interaction_map"
Map = NDArray[np.float64]


def prepare(folder: Path, quick: bool) -> SweepPlan:
    """Reduce both bodies, and put the scene beside them."""
    for name in ("casing", "blade"):
        run_reduce(load_shell_study(SCENES / f"{name}.toml")).save(folder / f"{name}.npz")
    text = (SCENES / "map.toml").read_text(encoding="utf-8")
    if quick:
        text = text.replace("steps = 61", "steps = 7").replace("steps = 41", "steps = 3")
    write_atomic(folder / "map.toml", text)
    return load_sweep(folder / "map.toml")


def by_poles(plan: SweepPlan, speed: Map, blade: Map) -> Map:
    """Growth [1/s] of a contact that stays closed, (blades, speeds)."""
    found = np.empty((blade.size, speed.size))
    for k in range(blade.size):
        scene = scene_of(plan.data(plan.runs[k]), plan.file)  # speeds vary slowest: the first runs have all blades
        assert isinstance(scene.what, ct.RotatingRim)
        assert isinstance(scene.law, ct.Coulomb)
        found[k] = growth(rim_contact(scene.what, mu=scene.law.mu), speed)
    return found


def compared(poles: Map, runs: Map, closed: Map, diverged: NDArray[np.bool_]) -> Row:
    """Number of equal signs, of all points and of those whose runs stay closed."""
    told = ~np.isnan(runs) & (np.abs(poles) > 0.5)  # a growth of .5 1/s shows in a run of a second
    stays = told & (closed > 0.95)
    same = (poles > 0.0) == (runs > 0.0)
    return {
        "points": poles.size, "grow by poles": int(np.count_nonzero(poles > 0.5)),
        "grow in runs": int(np.count_nonzero(runs > 0.5)), "diverge": int(np.count_nonzero(diverged)),
        "told": int(np.count_nonzero(told)),
        "signs agree %": 100.0 * float(np.mean(same[told])), "stay closed": int(np.count_nonzero(stays)),
        "of these agree %": 100.0 * float(np.mean(same[stays])),
    }  # fmt: skip


@styled
def figure_map(speed: Map, blade: Map, poles: Map, amplitude: Map, lines: list[tuple[int, Map]]) -> Any:
    """Growth and final amplitude over speed and blade frequency, with the coincidences f_b = f_c - n f."""
    figure = new_figure(9.6, 4.2)
    panels: Any = figure.subplots(1, 2, sharey=True)
    shown = {"shading": "nearest", "rasterized": True}
    most = float(np.percentile(np.abs(poles), 90.0))
    drawn = panels[0].pcolormesh(speed, blade, poles, cmap=DIVERGING, vmin=-most, vmax=most, **shown)
    figure.colorbar(drawn, ax=panels[0], label="growth [1/s], contact closed")
    panels[1].set_facecolor(PERFECT)
    drawn = panels[1].pcolormesh(speed, blade, 1e3 * amplitude, norm=LogNorm(), **shown)
    panels[1].set_title("grey: half the wall passed", fontsize=9)
    figure.colorbar(drawn, ax=panels[1], label="rim, last quarter of a run [mm rms]")
    for axes in panels:
        for n, line in lines:
            inside = np.flatnonzero((line >= blade[0]) & (line <= blade[-1]))
            if inside.size > 1:
                axes.plot(speed[inside], line[inside], color="black", linewidth=0.7, linestyle="--")
                at = inside[inside.size // 2]
                axes.annotate(f"{n}", (speed[at], line[at]), fontsize=8, ha="left", va="bottom")
        axes.set(xlabel="speed f [Hz]")
        axes.grid(visible=False)
    panels[0].set_ylabel("blade alone, f_b [Hz]")
    return figure


def coincidences(rim: ct.RotatingRim, speed: Map) -> list[tuple[int, Map]]:
    """Lines f_b = f_c - n f over speed: the backward waves of the casing's modes as the blade meets them."""
    lines: dict[int, Map] = {}
    N = rim.casing.n_max
    for omega, column in zip(rim.casing.omega, rim.casing.rows[: 2 * N + 1].T, strict=True):
        power = column[: N + 1] ** 2 + np.concatenate([[0.0], column[N + 1 :] ** 2])
        n = int(power.argmax())
        lines.setdefault(n, omega / (2.0 * np.pi) - n * speed)
    return sorted(lines.items())


def main(out: Path, quick: bool = False) -> list[Row]:
    """Map, compare, draw."""
    folder = out / "interaction_map"
    plan = prepare(folder, quick)
    speed, blade = (np.unique([float(run.values[k]) for run in plan.runs]) for k in range(2))
    began = time.perf_counter()
    poles = by_poles(plan, speed, blade)
    middle = time.perf_counter()
    found = run_sweep(plan, folder=None, jobs=os.cpu_count() or 1)
    seconds = {"poles": middle - began, "runs": time.perf_counter() - middle}
    read = [[np.nan if row[name] is None else float(row[name]) for row in found.rows] for name in
            ("growth_1_s", "contact_fraction", "amplitude_m")]  # fmt: skip
    runs, closed, amplitude = (np.reshape(values, (speed.size, blade.size)).T for values in read)
    status = np.reshape([str(row["status"]) for row in found.rows], (speed.size, blade.size)).T
    diverged = status == "diverged"
    runs = np.where(diverged & np.isnan(runs), np.inf, runs)  # grows too fast for its samples
    amplitude = np.where(diverged, np.nan, amplitude)
    steps = sum(int(row["steps"] or 0) for row in found.rows)
    rows: list[Row] = [
        {"map": "poles", "points": poles.size, "s": seconds["poles"], "ms a point": 1e3 * seconds["poles"] / poles.size,
         "us a step": None},
        {"map": "runs", "points": poles.size, "s": seconds["runs"], "ms a point": 1e3 * seconds["runs"] / poles.size,
         "us a step": 1e6 * seconds["runs"] / steps},
    ]  # fmt: skip
    show(f"Cost, {os.cpu_count()} cores for the runs, load before {os.getloadavg()[0]:.1f}", rows)
    verdict = compared(poles, runs, closed, diverged)
    show("Growth by poles of closed contact against growth in runs", [verdict])
    k, j = np.unravel_index(int(np.argmax(poles)), poles.shape)
    print(f"largest growth by poles {poles[k, j]:.3g} 1/s at {speed[j]:.4g} Hz, blade {blade[k]:.4g} Hz")
    print(f"largest rim amplitude in runs that do not diverge {np.nanmax(amplitude):.3g} m")
    scene = scene_of(plan.data(plan.runs[0]), plan.file)
    assert isinstance(scene.what, ct.RotatingRim)
    figure = figure_map(speed, blade, poles, amplitude, coincidences(scene.what, speed))
    figure.savefig(folder / "interaction_map.png", dpi=150, metadata={"Software": None})
    write_atomic(folder / "map.csv", table(found))
    write(out / "interaction_map.csv", rows)
    return [*rows, verdict]


if __name__ == "__main__":
    command_line(__doc__, main)
