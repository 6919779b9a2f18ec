"""What `--out` of a contact command shows: pictures, the forces as a table, the motion of --vtu, a scene's page."""

from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from casingfem.cli.tables import of_columns
from contact.io.infiles import read_bytes, text_of
from contact.io.outfiles import Content

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from contact.model.gaps.gap import RotatingRim
    from contact.model.gaps.rub import Rub
    from contact.record.wear import Wear
    from contact.result import Result
    from contact.run import Prepared, Scene

STATES = 4_000_000  # numbers that stored states may hold where the scene does not say what to record
TOP = 1.2  # times the highest mode: frequencies drawn


def with_states(ready: "Prepared") -> "Prepared":
    """A run that stores states for pictures too, as many as fit into STATES numbers."""
    from dataclasses import replace

    from contact.record.record import Record

    every = ready.record.every
    wanted = max(1, -(-ready.count * max(ready.stepper.size, 1) // STATES))
    return replace(ready, record=Record(every=every, state_every=every * -(-wanted // every)))


def figures(scene: "Scene", result: "Result") -> dict[str, "Figure"]:
    """All pictures that the run has the data for, by name."""
    from casingfem.plot.contact import figure_contact
    from casingfem.plot.motion import figure_energy, figure_orbit, figure_spectrum
    from contact.histories import strain_energy, tip_motion

    if not result.time.size or not result.force.shape[1]:
        return {}
    top = TOP / result.window
    found: dict[str, Figure] = {"run": figure_contact(result, int(result.impulse.argmax()))}
    if result.time.size > 1 and result.every:
        found["spectrum"] = figure_spectrum(
            result.time, result.windowed_force().sum(axis=1), label="force", unit="N", top_hz=top
        )
    moved = tip_motion(scene.what, result)
    if moved is not None:
        found["spectrum_tip"] = figure_spectrum(moved.time, moved.tip[:, 0], label="tip, normal", unit="m", top_hz=top)
        found["orbit"] = figure_orbit(moved)
    found["energy"] = figure_energy(ledger(result), result.state_time, strain_energy(scene.what, result))
    return found


def ledger(result: "Result") -> dict[str, float]:
    """Energy into the bodies by source [J], and what they gained."""
    e = result.energy
    return {
        "contact": -e.lost_in_contact, "turning rim": e.rotation, "friction": e.friction, "damping": e.damping,
        "loads": e.external, "gravity, whirl": e.body_force, "numerical": e.numerical,
        "stored at the end": e.end.total - e.start.total,
    }  # fmt: skip


def run_files(scene: "Scene", result: "Result", command: str) -> dict[str, Content]:
    """Pictures as png and the force history, under the names that --out gives them."""
    from casingfem.plot.style import png

    files: dict[str, Content] = {
        f"{command}.png" if name == "run" else f"{command}_{name}.png": png(figure)
        for name, figure in figures(scene, result).items()
    }
    if result.tracks and len(result.tracks[0].map_time) > 1:
        files |= coatings(result.tracks)
    return files | force_files(result, command)


def force_files(result: "Result", command: str) -> dict[str, Content]:
    """The force history: CSV, and parquet where pyarrow is installed."""
    from contact.histories import force_table

    table = force_table(result)

    def csv(path: Path) -> None:
        with path.open("w", encoding="utf-8", newline="\n") as file:
            file.write("# COMPUTED: contact forces; a row's mean is that of its impulse, peak and least gap are its ")
            file.write(f"samples'\n{','.join(table)}\n")
            np.savetxt(file, np.stack(list(table.values()), axis=1), fmt="%.9g", delimiter=",")

    files: dict[str, Content] = {f"{command}_forces.csv": csv}
    if find_spec("pyarrow") is not None:
        files[f"{command}_forces.parquet"] = of_columns(table)
    return files


def coatings(tracks: "tuple[Wear, ...]") -> dict[str, Content]:
    """Profile and wear map of each track of a coating."""
    from casingfem.plot.contact import figure_wear
    from casingfem.plot.style import png

    names = ["coating.png"] if len(tracks) == 1 else [f"coating_{k}.png" for k in range(1, len(tracks) + 1)]
    return {name: png(figure_wear(track)) for name, track in zip(names, tracks, strict=True)}


def series_files(what: "Rub | RotatingRim", result: "Result") -> dict[str, Content]:
    """The files of --vtu: casing.vtkhdf, blade.vtkhdf, ... of bodies in their own frames, tips.vtkhdf in the casing's.

    Raises InputError where no body's basis has a recovery, and where no states were stored.
    """
    from casingfem.export.meshes import frames, motion_files, point_files
    from contact.base.errors import InputError
    from contact.model.gaps.rub import rub_of
    from contact.recovery import at_points, rub_forces

    rub: Rub = rub_of(what)
    drawn = {name: body for name, body in zip(rub.names, rub.bodies, strict=True) if body.recovery_cells is not None}
    if not drawn:
        expected = "recovery = true in [reduce] of the study that makes it"
        raise InputError(f"basis: found none that recovers the motion of its nodes, expected {expected}")
    shown = frames(len(result.state_time))
    time = result.state_time[shown]
    files: dict[str, Content] = {}
    for name, body in drawn.items():
        forces = rub_forces(rub, result, name)[1][shown]
        moved = at_points(body, result.state_of(name)[shown], forces).reshape(len(shown), -1, 3)
        assert body.recovery_points is not None
        assert body.recovery_cells is not None
        files |= motion_files(name.replace(" ", "_"), body.recovery_points, body.recovery_cells, time, moved)
    turned = np.array([rub.speed.angle(float(t)) for t in time])
    angle = np.radians([tip.angle_deg for tip in rub.tips]) - turned[:, None]
    lines = [rub.casing.lines[t.line] if rub.casing.lines is not None else (0.0, rub.casing.radius) for t in rub.tips]
    axial, radius = np.array(lines).T
    places = np.stack([radius * np.cos(angle), radius * np.sin(angle), np.broadcast_to(axial, angle.shape)], axis=-1)
    force = result.tip_force[shown].reshape(len(shown), len(rub.tips), -1)[:, :, 0]
    files |= point_files("tips", time, places, {"normal_force_N": force})
    return {f"vtu/{name}": content for name, content in files.items()}


def page_numbers(result: "Result") -> dict[str, float]:
    """The figures at the head of a page, all contacts together."""
    energy = result.energy
    return {
        "steps": result.steps, "time step [s]": result.dt, "time simulated [s]": result.steps * result.dt,
        "contacts": int(result.impulse.size), "impulse [N s]": float(result.impulse.sum()),
        "largest windowed force [N]": float(result.windowed_force().max(initial=0.0)),
        "largest raw force [N]": float(result.peak_force.max(initial=0.0)),
        "time in contact [s]": float(result.contact_steps.max(initial=0)) * result.dt,
        "law violated by [m]": float(result.residual.max(initial=0.0)),
        "energy not accounted for": abs(energy.unaccounted) / energy.scale if energy.scale else 0.0,
    } | growth_numbers(result)  # fmt: skip


def growth_numbers(result: "Result") -> dict[str, float]:
    """Growth of the motion with its interval, the deflection, the time to half the wall; none of other problems."""
    grown = result.growth
    if grown is None:
        return {}
    found = {
        "growth [1/s]": grown.rate, "growth, low end [1/s]": grown.low, "growth, high end [1/s]": grown.high,
        "rim deflection, last stretch [m]": grown.amplitude, "half the wall reached at [s]": grown.time_to_half_wall,
    }  # fmt: skip
    return {name: value for name, value in found.items() if np.isfinite(value)}


def page(scene: "Scene", result: "Result", file: Path, say: Callable[[str], None]) -> str:
    """The HTML page on a scene that was run; of rims, rubs and disks with the table of dangerous speeds and a film."""
    from casingfem.plot.contact import rub_film as film_of
    from casingfem.plot.interaction import figure_interactions
    from casingfem.plot.page import Table
    from casingfem.plot.pages.contact import scene_page, scene_verdict
    from contact.base.errors import InputError
    from contact.histories import rub_film
    from contact.model.gaps.gap import RotatingRim
    from contact.model.gaps.rub import Rub
    from contact.scene.stability import load_interactions
    from contact.version import versions

    drawn, table, words = figures(scene, result), None, ""
    rubs = isinstance(scene.what, RotatingRim | Rub)
    if rubs:
        say("interactions")
        try:
            found = load_interactions(file).solve()
        except InputError as error:
            words = f"No table of dangerous speeds: {error}"
        else:
            drawn["interactions"], words = figure_interactions(found), found.words
            if found.rows:
                table = Table.of("Dangerous speeds, the worst first.", found.COLUMNS, found.records())
    say("drawing")
    film = rub_film(scene.what, result)
    numbers = page_numbers(result)
    verdict = scene_verdict(
        numbers, result.flags, diverged=result.divergence is not None, rubs=rubs,
        failed=any(flag.failed for flag in result.flags), motion="" if result.growth is None else result.growth.words,
    )  # fmt: skip
    text = text_of(read_bytes(file))
    return scene_page(
        file.stem, text, repr(result), result.flags, numbers, drawn, table, words, verdict=verdict,
        source={**scene.source, **versions()}, films=() if film is None else (film_of(film, result),),
    )  # fmt: skip
