"""Files that `--out` of a contact command writes: pictures, a table of forces, and the motion for --vtu."""

from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from casingfem.cli.tables import of_columns
from contact.io.outfiles import Content

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from casingfem.io.arrays import Array
    from casingfem.plot.waves import Mark
    from contact.interacting import Interactions
    from contact.model.gaps.gap import RotatingRim
    from contact.model.gaps.rub import Rub
    from contact.prepared import Prepared, Scene
    from contact.record.wear import Wear
    from contact.recovery.around_rim import RimMotion
    from contact.result import Result

STATES = 4_000_000  # numbers that stored states may contain where the scene does not state what to record
PAIR = 0.03  # of a frequency: modes of one n that lie closer are a pair
TOP = 1.2  # times the highest mode: frequencies drawn


def with_states(ready: "Prepared") -> "Prepared":
    """The scene with stored states for pictures, as many as fit into STATES numbers."""
    from dataclasses import replace

    from contact.record.record import Record

    every = ready.record.every
    wanted = max(1, -(-ready.count * max(ready.stepper.size, 1) // STATES))
    return replace(ready, record=Record(every=every, state_every=every * -(-wanted // every)))


def figures(
    scene: "Scene", result: "Result", rim: "RimMotion | None" = None, casing: "Array | None" = None
) -> dict[str, "Figure"]:
    """All pictures that the run's data allow; `rim` and `casing` are its motions if they are known already."""
    from casingfem.plot.motion import figure_energy, figure_orbit, figure_spectrum
    from casingfem.plot.rotor import figure_rotor_run
    from casingfem.plot.waves import figure_force_map, figure_section, figure_waves
    from contact.model.gaps.rub import Rub
    from contact.on_rotor import rotor_history
    from contact.recovery.around_rim import force_over_angle, once_a_turn, rim_motion
    from contact.recovery.displacements import casing_motion
    from contact.recovery.histories import strain_energy, tip_motion

    if not result.time.size:
        return {}
    rotor = rotor_history(scene.what, result)
    found = {}
    if rotor is not None:
        clearance = scene.what.clearance if isinstance(scene.what, Rub) else 0.0
        found["rotor"] = figure_rotor_run(rotor, max(0.0, clearance))
    if not result.force.shape[1]:
        return found
    casing = casing_motion(scene.what, result) if casing is None else casing
    rim = rim_motion(scene.what, result) if rim is None else rim
    top = TOP / result.window
    found |= over_time(scene, result, rim)
    marks, turn_hz = marks_of(scene.what), turn_of(scene.what)
    moved = tip_motion(scene.what, result, casing)
    if result.time.size > 1 and result.every:
        total = result.windowed_force().sum(axis=1)
        found["spectrum"] = figure_spectrum(
            result.time, total, label="force", unit="N", top_hz=top, marks=marks, turn_hz=turn_hz,
            waterfall=moved is None,
        )  # fmt: skip
    if moved is not None:
        found["spectrum_tip"] = figure_spectrum(
            moved.time, moved.tip[:, 0], label="tip, normal", unit="m", top_hz=top, marks=marks, turn_hz=turn_hz
        )
        found["orbit"] = figure_orbit(moved)
    if rim is not None:
        found["waves"] = figure_waves(rim, pairs_of(scene.what), top_hz=top)
    over_angle = force_over_angle(scene.what, result)
    if over_angle is not None:
        found["angle"] = figure_force_map(over_angle)
    section = None if moved is None else once_a_turn(scene.what, result, moved)
    if section is not None:
        found["section"] = figure_section(section)
    found["energy"] = figure_energy(ledger(result), result.state_time, strain_energy(scene.what, result))
    return found


def over_time(scene: "Scene", result: "Result", rim: "RimMotion | None" = None) -> dict[str, "Figure"]:
    """Force, gap and motion over time, as "run"; empty if nothing was stored."""
    from casingfem.plot.contact import figure_contact
    from contact.recovery.around_rim import rim_motion

    if not result.time.size or not result.force.shape[1]:
        return {}
    rim = rim_motion(scene.what, result) if rim is None else rim
    return {"run": figure_contact(result, int(result.impulse.argmax()), rim=rim)}


def speed_figures(scene: object, found: "Interactions", speed_hz: float = 0.0) -> dict[str, "Figure"]:
    """Pictures of a table of dangerous speeds: over speed, and the map at one speed, by default the worst one."""
    from casingfem.plot.interaction import figure_interactions, figure_map

    drawn = {"interactions": figure_interactions(found)}
    pairs = pairs_of(getattr(scene, "what", None))
    if pairs and not found.peaks.rotor:
        worst = found.rows[0].at.speed_hz if found.rows else float(found.peaks.map.peak_speed_hz)
        drawn["map"] = figure_map(pairs, found.peaks.blade_hz, speed_hz or worst)
    return drawn


def pairs_of(what: object) -> list[tuple[int, float]]:
    """Nodal diameters and frequency [Hz] of the casing's modes, one for each pair; empty without a rim."""
    from contact.model.gaps.rub import rub_of
    from contact.stability.mode_groups import casing_diameters

    rub: Rub | None = rub_of(what)
    if rub is None:
        return []
    n, freq = casing_diameters(rub.casing).tolist(), (rub.casing.omega / (2.0 * np.pi)).tolist()
    kept: list[tuple[int, float]] = []
    for order, hz in zip(n, freq, strict=True):
        if not any(order == other and abs(hz - f) < PAIR * hz for other, f in kept):
            kept.append((order, hz))
    return kept


def marks_of(what: object) -> "list[Mark]":
    """Frequencies of blade and casing without contact, for marks in spectra."""
    from casingfem.plot.waves import Mark
    from contact.model.gaps.rub import rub_of

    rub: Rub | None = rub_of(what)
    if rub is None:
        return []
    blade = rub.blades[rub.tips[0].blade].omega / (2.0 * np.pi)
    marks = [Mark(float(hz), "f_b" if k == 0 else f"f_b{k + 1}", "f_b") for k, hz in enumerate(blade)]
    return marks + [Mark(hz, str(n), "f_c") for n, hz in pairs_of(what)]


def turn_of(what: object) -> float:
    """Speed [turns/s] of a steady rotation, else 0."""
    from contact.model.gaps.rub import rub_of
    from contact.model.rotor import Rotor

    turning = what if isinstance(what, Rotor) else rub_of(what)
    return 0.0 if turning is None or np.ptp(turning.speed.hz) else abs(float(turning.speed.hz[0]))


def ledger(result: "Result") -> dict[str, float]:
    """Energy supplied to the bodies by source [J], and energy gained by them."""
    e = result.energy
    return {
        "contact": -e.lost_in_contact, "turning rim": e.rotation, "friction": e.friction, "damping": e.damping,
        "loads": e.external, "gravity, whirl": e.body_force, "numerical": e.numerical,
        "stored at the end": e.end.total - e.start.total,
    }  # fmt: skip


def run_files(scene: "Scene", result: "Result", command: str, *, every: bool) -> dict[str, Content]:
    """Pictures as png and the force history, under their names for --out.

    By default only the picture of the run over time; with `every` all pictures that the data allow.
    """
    from casingfem.plot.style import png

    drawn = figures(scene, result) if every else over_time(scene, result)
    files: dict[str, Content] = {
        f"{command}.png" if name == "run" else f"{command}_{name}.png": png(figure) for name, figure in drawn.items()
    }
    if result.tracks and len(result.tracks[0].map_time) > 1:
        files |= coatings(result.tracks)
    return files | force_files(result, command)


def force_files(result: "Result", command: str) -> dict[str, Content]:
    """The force history: CSV, and parquet if pyarrow is installed."""
    from contact.recovery.histories import force_table

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
    """Files of --vtu: casing.vtkhdf, blade.vtkhdf, ...

    of bodies in their own frames, tips.vtkhdf in the casing's frame.

    Raises InputError if no body's basis has a recovery, or no states were stored.
    """
    from casingfem.export.meshes import frames, motion_files, point_files
    from contact.base.errors import InputError
    from contact.model.gaps.rub import rub_of
    from contact.recovery.displacements import at_points, rub_forces

    rub: Rub = rub_of(what)
    drawn = {name: body for name, body in zip(rub.names, rub.bodies, strict=True) if body.recovery_cells is not None}
    if not drawn:
        expected = "a basis from a study with reduce.recovery = true"
        raise InputError(f"basis: found no data for the motion of its nodes, expected {expected}")
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
