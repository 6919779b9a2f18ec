"""Commands on scene.toml: contact, rub, stability, interactions and cycles."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import click

from casingfem.cli.progress import ProgressMessage
from casingfem.cli.running import NUMERICS_FAILED, STORES, deliver, fail, options, source_of
from casingfem.cli.tables import csv_text
from casingfem.io.side_by_side import usable_cores
from contact.io.outfiles import Content, json_text

if TYPE_CHECKING:
    from contact import NumericsError, Result, Scene
    from contact.cycles.balance_check import Agreement
    from contact.cycles.basins import Basins
    from contact.cycles.result import Cycles
    from contact.cycles.traced import Trace
    from contact.scene.cycles import CyclesScene

STABILITY = (
    "The contact is always closed here. `casingfem interactions SCENE` lists the dangerous speeds; those of a rim "
    "follow from runs of the scene."
)
ROTOR = "These are poles and steady motions. `casingfem interactions SCENE` runs the scene at each speed."
ORBITS = (
    "These are periodic motions. `casingfem interactions SCENE`, with a run in the scene, lists the dangerous speeds "
    "of all motions."
)
SCENE = click.argument("file", metavar="SCENE", type=click.Path(path_type=Path))
DRAWN = 4  # orbits of the page on periodic motions
NUMBERS = 20_000  # that the histories of a JSON document may have without --history
HISTORY = click.option(
    "--history", is_flag=True, help=f"Keep histories of more than {NUMBERS:,} numbers in --json and DIR's .json."
)
PICTURES = click.option(
    "--pictures", is_flag=True, help="With --out, also draw spectra, waves, orbit, section and energies."
)


@click.command()
@SCENE
@HISTORY
@PICTURES
@options
def contact(file: Path, as_json: bool, out: Path | None, history: bool, pictures: bool) -> None:
    """Run SCENE: rods, masses and walls, a rim against a blade, or a beam in a circle.

    --out DIR gets the result, one picture of force, gap and motion over time, and the forces as a table. `casingfem
    report` shows all pictures on one page. After a stop the same command continues the run.
    """
    run_scene(file, "contact", as_json, out, history=history, pictures=pictures)


@click.command()
@SCENE
@click.option("--vtu", is_flag=True, help="Also write the motion of all nodes for ParaView to DIR/vtu.")
@HISTORY
@PICTURES
@options
def rub(file: Path, as_json: bool, out: Path | None, vtu: bool, history: bool, pictures: bool) -> None:
    """Run SCENE: a rotating casing against one blade tip (rim), or many tips of many blades (rub); or a rotor.

    --out DIR gets the result, one picture of force, gap and motion over time, and the forces as a table. `casingfem
    report` shows all pictures on one page. A diverging run stops, keeps its results, and ends with exit code 3, or 0
    with on_limit = "flag". After a stop the same command continues the run. --vtu writes one VTKHDF file for each body
    and needs a basis that recovers its nodes: recovery = true in [reduce] of its study.
    """
    if vtu and out is None:
        raise click.UsageError("found --vtu without --out DIR, expected both")
    if vtu:
        from casingfem.export.series import require_series

        require_series()
    run_scene(file, "rub", as_json, out, vtu=vtu, history=history, pictures=pictures)


@click.command()
@SCENE
@options
def stability(file: Path, as_json: bool, out: Path | None) -> None:
    """Growth over speed of a contact that stays closed, or of a rotor: SCENE is a pair, a rim with speed.scan, a rotor.

    For a rotor: growth without contact; with a casing also synchronous rub with its growth, and dry backward whirl.
    """
    from contact.scene.stability import load_stability
    from contact.stability.growth_map import StabilityMap

    scene = load_stability(file)
    with ProgressMessage(f"stability {file.name}"):
        found = scene.solve()
    closed = isinstance(found, StabilityMap)
    document = found.to_dict()
    files: dict[str, Content] = {"stability.json": json_text(document)}
    if out is not None:
        from casingfem.plot.interaction import figure_stability
        from casingfem.plot.rotor import figure_rotor_stability
        from casingfem.plot.style import png

        card = f"COMPUTED: growth of {'closed contact' if closed else 'a rotor'}, by poles"
        files["stability.csv"] = csv_text(found.records(), card)
        files["stability.png"] = png(figure_stability(found) if closed else figure_rotor_stability(found))
    deliver(document, f"{found!r}\n{STABILITY if closed else ROTOR}", as_json=as_json, out=out, files=files)


@click.command()
@SCENE
@click.option(
    "--runs",
    type=click.IntRange(2, 100_000),
    help="Number of runs evenly over the range, by default 60; more are added where they disagree.",
)
@options
def interactions(file: Path, runs: int | None, as_json: bool, out: Path | None) -> None:
    """Which speeds of SCENE are dangerous? SCENE is a pair, a rim, a rub, a disk or a rotor.

    Poles of closed contact propose speeds and the growing motion. The scene is run at each of these speeds, at its own
    speed, at --runs speeds evenly over the range, and midway between runs that disagree; the runs decide. The range is
    speed.scan, by default up to twice
    the scene's speed. --out DIR gets the table, its picture and the page interactions.html.
    """
    from contact.interacting import RUNS
    from contact.scene.stability import load_interactions

    scene = load_interactions(file)
    with ProgressMessage(f"interactions {file.name}"):
        found = scene.solve(runs or RUNS, usable_cores())
    document = found.to_dict()
    files: dict[str, Content] = {"interactions.json": json_text(document)}
    if out is not None:
        from casingfem.cli.pictures import speed_figures
        from casingfem.plot.pages.interactions import interactions_page
        from casingfem.plot.style import Drawn

        figures = speed_figures(scene.scene, found)
        table = Drawn(figures["interactions"])
        card = ["COMPUTED: dangerous speeds, by runs at speeds that poles of closed contact propose"]
        card += [f"{column.name}: {column.text}" for column in found.COLUMNS]
        names = [column.name for column in found.COLUMNS]
        files["interactions.csv"] = csv_text(found.records(), "\n".join(card), names)
        files["interactions.png"] = table.png
        page = interactions_page(file.stem, found, figures | {"interactions": table}, source_of(file))
        files["interactions.html"] = page
    deliver(document, repr(found), as_json=as_json, out=out, files=files)


@click.command()
@SCENE
@click.option(
    "--check",
    type=click.IntRange(1, 1000),
    metavar="N",
    help="Compare every orbit with harmonic balance of N harmonics, such as 30; for contacts that give way.",
)
@options
def cycles(file: Path, check: int | None, as_json: bool, out: Path | None) -> None:
    """Periodic motions of SCENE over frequency, force or speed: amplitude, stability, and where they jump.

    SCENE is a patch with [drive] instead of [scheme], or a rim, a rub or a disk with a range of speed, clearance or
    friction instead of a run. [basins] finds which of these motions random starts reach.

    With --out DIR: cycles.csv, .npz, .json, .png and the page cycles.html; the same command continues after a stop.
    """
    from contact.scene.cycles import load_cycles

    scene = load_cycles(file)
    if check is not None:
        scene.require_check(check)
    part = None if out is None else out / STORES["cycles"]
    with ProgressMessage(f"cycles {file.name}") as working:

        def progress(branch: int, at: float, points: int) -> None:
            first, last = scene.between
            share = min(max((at - first) / (last - first), 0.0), 1.0)
            working.tell(f"branch {branch}, {points} orbits, at {at:.6g} of {first:g} to {last:g}", share)

        found = scene.solve(progress, part)
        starts = 0 if scene.ask is None else scene.ask.starts
        reached = scene.reached(
            found, lambda k: working.say(f"cycles {file.name}: {k} of {starts} random starts", k / starts)
        )
        agreement = None if check is None else scene.checked(found, check)
    document, words = found.to_dict(), repr(found)
    if found.name == "speed_hz":
        words += f"\n{ORBITS}"
    if reached is not None:
        document["basins"] = {"at": reached.value, "starts": len(reached.reached), "motions": reached.records()}
        words += f"\n{reached!r}"
    if agreement is not None:
        document["harmonic_balance"] = agreement.to_dict()
        words += f"\n{agreement.words}"
    files = {} if out is None else cycles_files(scene, found, reached, agreement, document, file)
    deliver(document, words, as_json=as_json, out=out, files=files)
    if part is not None:
        part.unlink(missing_ok=True)


def cycles_files(
    scene: "CyclesScene", found: "Cycles", reached: "Basins | None", agreement: "Agreement | None",
    document: dict[str, object], file: Path,
) -> dict[str, Content]:  # fmt: skip
    """The table, the states, the document, the picture and the page."""
    from casingfem.plot.cycles import figure_cycles
    from casingfem.plot.pages.cycles import cycles_page
    from casingfem.plot.style import png

    rows, marks = found.records(), found.marks()
    motions = [] if reached is None else [{found.name: reached.value, **one} for one in reached.records()]
    checked = "" if agreement is None else agreement.words
    return {
        "cycles.html": cycles_page(file.stem, found, source_of(file), traces_of(scene, found), motions, checked),
        "cycles.csv": csv_text(rows), "cycles.npz": found.save, "cycles.json": json_text(document, indent=1),
        "cycles.png": png(figure_cycles(rows, marks, motions)),
    }  # fmt: skip


def traces_of(scene: "CyclesScene", found: "Cycles") -> "list[Trace]":
    """For the first DRAWN intervals of equal stability: the largest orbit over its period.

    An orbit that cannot be followed in parts, such as one with chatter, is left out.
    """
    from itertools import groupby

    from contact import NumericsError
    from contact.cycles import traced

    channel = next(iter(found.branches[0].points[0].amplitude))
    parts = [list(part) for branch in found.branches for _, part in groupby(branch.points, key=lambda one: one.stable)]
    traces = []
    for part in parts[:DRAWN]:
        try:
            traces.append(traced(scene.family, max(part, key=lambda one: one.amplitude[channel])))
        except NumericsError:
            continue
    return traces


def run_scene(
    file: Path, command: str, as_json: bool, out: Path | None, *, vtu: bool = False, history: bool,
    pictures: bool,
) -> None:  # fmt: skip
    """Load and run a scene and write its results; for a failed or diverged run, those up to that step."""
    if pictures and out is None:
        raise click.UsageError("found --pictures without --out DIR, expected both")
    from contact import RotatingRim, Rub, load_scene
    from contact.model.rotor import Rotor
    from contact.scene.load import read_scene
    from contact.scene.problems import SceneError

    scene = load_scene(file)
    if command == "rub" and not isinstance(scene.what, RotatingRim | Rub | Rotor):
        kind = read_scene(file)[0].scene.kind
        expected = "'rim', 'rub', 'disk' or 'rotor' (casingfem contact runs them all)"
        problem = f"scene.kind: found {kind!r}, expected {expected}"
        raise SceneError([f"{file}: {problem}"])
    part = None if out is None else out / STORES[command]
    with ProgressMessage(f"{command} {file.name}: starting; a first run compiles its loop") as working:
        result, broken = ran(scene, lambda done: working.say(f"{command} {file.name}", done), part)
    document = result.to_dict(most=None if history else NUMBERS)
    files: dict[str, Content] = {}
    if out is not None:
        from casingfem.cli.pictures import run_files

        files = {f"{command}.npz": result.save, f"{command}.json": json_text(document)}
        files |= run_files(scene, result, command, every=pictures)
    if vtu and isinstance(scene.what, RotatingRim | Rub):
        from casingfem.cli.pictures import series_files

        files |= series_files(scene.what, result)
    deliver(document, repr(result), as_json=as_json, out=out, files=files)
    say_left_out(document["left_out"], command, as_json, out)
    if part is not None:
        part.unlink(missing_ok=True)
    require_solved(f"{command} {file}", result, broken)


def say_left_out(names: object, command: str, as_json: bool, out: Path | None) -> None:
    """Name on stderr the histories that are left out of the JSON document, and where they are."""
    if isinstance(names, dict) and names and (as_json or out is not None):
        counted = ", ".join(f"{name} ({count:,} numbers)" for name, count in names.items())
        there = "" if out is None else f"; {out / command}.npz contains them"
        click.echo(f"{command}: the JSON document omits {counted}; --history adds them{there}", err=True)


def require_solved(command: str, result: "Result", broken: "NumericsError | None") -> None:
    """End with exit code 3 if a run failed, or has a flag of failure."""
    failures = [str(flag) for flag in result.flags if flag.failed]
    if broken is not None or failures:
        fail(f"{command}: the computation failed: {broken or failures[0]}", NUMERICS_FAILED)


def ran(scene: "Scene", progress: Callable[[float], None], part: Path | None) -> "tuple[Result, NumericsError | None]":
    """Run a scene; for a failed or diverged run, its result so far and the reason.

    `part` is the file of an unfinished run, from which it continues; with it, states are stored for pictures.
    """
    from contact import NumericsError
    from contact.prepared import prepared
    from contact.run import completed

    ready = prepared(scene)
    if part is not None and scene.record is None:
        from casingfem.cli.pictures import with_states

        ready = with_states(ready)
    try:
        return completed(ready, progress, part), None
    except NumericsError as error:
        if error.result is None:
            raise
        return error.result, error


def is_scene(file: Path) -> bool:
    """Whether a file is a contact scene, that is TOML with [scene].

    The reader of studies reports files of neither kind.
    """
    from contact.io.toml import read_toml

    try:
        return "scene" in read_toml(file)[1]
    except (OSError, ValueError):
        return False
