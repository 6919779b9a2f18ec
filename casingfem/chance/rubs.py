"""Time simulations of drawn casings, each with its own basis, at the speed of the largest growth of closed contact.

One compiled loop advances a group of runs together. Memory contains only the bases of one group. Each group is stored
in a file. A run does not depend on the others of its group, so a resumed table is bit-identical.
"""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from casingfem.chance.estimates import Estimate, clopper_pearson
from casingfem.chance.evaluate import Drawing, severity
from casingfem.chance.result import Chance
from casingfem.chance.run import drawing_of
from casingfem.io.arrays import FloatArray
from casingfem.io.side_by_side import one_thread_for_children, usable_cores
from contact.io.outfiles import finite, json_text, read_checked, write_checked
from contact.model.bodies.modal_body import ModalBody
from contact.model.gaps.gap import RotatingRim
from contact.model.gaps.rub import Rub
from contact.model.gaps.rub_laws import Closing, RimProfile
from contact.model.law import Coulomb, Law, Unilateral
from contact.prepared import Scene
from contact.speed_runs import runs_at_speeds
from contact.sweep.spread import on_workers

GROUP = 32  # runs of a file
KEPT = (
    "speed_hz", "verdict", "closed", "growth", "low", "high", "amplitude_m", "n", "wave", "body", "seconds", "contact",
)  # fmt: skip
Row = dict[str, Any]


class Group(NamedTuple):
    """A task of a worker: scene file, what it has to contain, the draws, growth (draws, speeds) of closed contact."""

    path: str
    source: str
    draws: list[int]
    growth: FloatArray


def run_rubs(
    found: Chance, folder: Path | None, progress: Callable[[int, int], None], *, processes: int | None = None,
    scheduler: str | None = None,
) -> list[Row]:  # fmt: skip
    """One row for each of the first casings that are dangerous at some speed: its draw, and the result of its run.

    The draws are in random order, so that the first ones are a fair sample of all. `processes` and `scheduler` are
    those of `run_draws`.
    """
    given, lot = found.drawn.given, found.drawn.lot
    chosen = np.flatnonzero(severity(lot) > found.drawn.floor)[: given.table.runs].tolist()
    groups = [chosen[first : first + GROUP] for first in range(0, len(chosen), GROUP)]
    kept = {draws[0]: rows for draws in groups if (rows := read_group(found, folder, draws)) is not None}
    path, source = str(given.path), json_text(given.source)
    missing = [Group(path, source, draws, lot["growth"][draws]) for draws in groups if draws[0] not in kept]
    progress(sum(map(len, kept.values())), max(len(chosen), 1))
    if missing and scheduler is None:
        _ = drawing_of(path, source).casings.wide  # once, for all workers that are copies of this process
    with one_thread_for_children():
        for draws, rows in on_workers(missing, run_group, processes or usable_cores(), scheduler):
            if folder is not None:
                write_checked(group_file(folder, draws), "runs", rows, **head_of(found, draws))
            kept[draws[0]] = rows
            progress(sum(map(len, kept.values())), len(chosen))
    return [row for draws in groups for row in kept[draws[0]]]


def run_group(group: Group) -> tuple[list[int], list[Row]]:
    """The draws of a group and their rows."""
    return group.draws, group_of(drawing_of(group.path, group.source), group.draws, group.growth)


def read_group(found: Chance, folder: Path | None, draws: list[int]) -> list[Row] | None:
    """The stored rows of a group; None if they are missing or damaged."""
    if folder is None:
        return None
    rows: list[Row] | None = read_checked(group_file(folder, draws), "runs", **head_of(found, draws))
    return rows


def group_file(folder: Path, draws: list[int]) -> Path:
    """The file of a group."""
    return folder / f"runs_{draws[0]:07d}_{draws[-1]:07d}.json"


def head_of(found: Chance, draws: list[int]) -> dict[str, Any]:
    """Head of the file of a stored group: its draws and the turns of a run."""
    return {"draws": draws, "turns": found.drawn.given.table.turns}


def group_of(own: Drawing, draws: list[int], growth: FloatArray) -> list[Row]:
    """Rows of some draws; `growth` (draws, speeds) is that of their closed contact."""
    speeds = np.asarray(own.given.speed_hz)[growth.argmax(axis=1)]
    runs = runs_at_speeds(drawn_scenes(own, draws, speeds), speeds, growth.max(axis=1))
    rows = [{"draw": draw} | {name: getattr(run, name) for name in KEPT} for draw, run in zip(draws, runs, strict=True)]
    return [dict(finite(row)) for row in rows]


def drawn_scenes(own: Drawing, draws: list[int], speeds: FloatArray) -> list[Scene]:
    """The scene with the casing, the blade, the gap and the friction of each draw, at the draw's speed [Hz]."""
    u = np.concatenate([own.point(draw) for draw in draws])
    series, inputs, turns, scene = own.series(u), own.inputs(u), own.given.table.turns, own.given.scene
    bodies, deviations = own.casings.bodies(series), own.casings.deviation(series).tolist()
    numbers = [dict(zip(inputs, values, strict=True)) for values in np.stack(list(inputs.values()), axis=1).tolist()]
    return [
        replace(
            scene,
            what=drawn_bodies(own, body, deviation, number),
            law=with_friction(scene.law or Unilateral(), number["friction"]),
            t_end=scene.t_end if turns is None else turns / speed,
        )
        for body, deviation, number, speed in zip(bodies, deviations, numbers, speeds.tolist(), strict=True)
    ]


def drawn_bodies(
    own: Drawing, body: ModalBody, deviation: list[complex], number: dict[str, float]
) -> RotatingRim | Rub:
    """The rim or rub with a drawn casing, its deviation of the radius (`Casings.deviation`), and the drawn numbers."""
    what, terms = own.perfect, [(p, value.real, -value.imag) for p, value in enumerate(deviation) if value]
    if isinstance(what, RotatingRim):
        more = tuple({"p": p, "cos": cos, "sin": sin} for p, cos, sin in terms)
        shape = (*what.out_of_roundness, *more)
        blade = retuned(what.blade, number["blade"])
        return replace(what, casing=body, blade=blade, clearance=number["clearance"], out_of_roundness=shape)
    profile = RimProfile((*what.profile.terms, *terms), theta=what.profile.theta, depth=what.profile.depth)
    closing = what.closing
    if "closing" in own.given.laws:
        closing = Closing(closing.time, closing.by * (number["closing"] / own.given.means["closing"]))
    blades = tuple(retuned(blade, number["blade"]) for blade in what.blades)
    return replace(
        what, casing=body, blades=blades, clearance=number["clearance"], profile=profile, closing=closing
    )  # fmt: skip


def retuned(blade: Any, ratio: float) -> Any:
    """A blade with its frequencies multiplied by a ratio."""
    return blade.retuned(ratio * float(blade.omega[blade.omega > 0.0].min()) / (2.0 * np.pi))


def with_friction(law: Law, mu: float) -> Any:
    """The law with another coefficient of friction."""
    if type(law) in (Unilateral, Coulomb):
        return Coulomb(mu=mu) if mu > 0.0 else Unilateral()
    return replace(law, mu=mu)  # type: ignore[type-var]


def unstable(rows: list[Row]) -> Estimate:
    """Share of growing runs among those with a verdict, with its interval."""
    decided = [row for row in rows if row["verdict"] != "not decided"]
    return clopper_pearson(sum(row["verdict"] == "unstable" for row in decided), max(len(decided), 1))


def words_of_runs(rows: list[Row]) -> str:
    """Number of runs that grow, in a sentence; empty without runs."""
    if not rows:
        return ""
    names = ("unstable", "resonance", "safe", "not decided")
    count = {name: sum(row["verdict"] == name for row in rows) for name in names}
    ended = ", ".join(f"{number} {name}" for name, number in count.items() if number)
    one = unstable(rows)
    share = f"{100 * one.value:.3g} % (95 %: {100 * one.low:.3g} to {100 * one.high:.3g} %)"
    return f"{len(rows)} runs of dangerous casings at their worst speed: {ended}. The motion grows in {share}."
