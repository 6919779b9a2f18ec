"""Commands on study.toml: modes, campbell, update, reduce, report."""

from itertools import zip_longest
from pathlib import Path

import click

from casingfem.cli.mode_files import mode_pictures, modes_tables, print_wheel, shape_files
from casingfem.cli.progress import ProgressMessage
from casingfem.cli.read_study import any_study
from casingfem.cli.rotor import rotor_campbell
from casingfem.cli.running import collected, deliver, options
from casingfem.cli.tables import csv_text
from contact.io.outfiles import Content, json_text

CROSSINGS = (
    "A crossing is a possible resonance. `casingfem interactions SCENE` runs the contact with the casing and lists the "
    "dangerous speeds."
)
STUDY = click.argument("file", metavar="STUDY", type=click.Path(path_type=Path))


def numbers(context: click.Context, option: click.Parameter, value: str | None) -> tuple[int, ...] | None:
    """List of mode numbers, such as 1,2,5: from 1, each once, in the given order."""
    if value is None:
        return None
    parts = [part.strip() for part in value.split(",")]
    if not all(part.isdecimal() and int(part) > 0 for part in parts):
        raise click.BadParameter(f"found {value!r}, expected mode numbers such as 1,2,5", context, option)
    return tuple(dict.fromkeys(map(int, parts)))


@click.command()
@STUDY
@click.option("--vtu", is_flag=True, help="Also write the shapes for ParaView to DIR/vtu.")
@click.option("--uff", is_flag=True, help="Also write the shapes for test software to DIR/modes.uff.")
@click.option(
    "--modes",
    "shown",
    callback=numbers,
    metavar="1,2,5",
    help="Numbers of the modes that --vtu and --uff write; all if left out.",
)
@click.option("--sigma", type=click.FloatRange(0.0, 0.1, min_open=True), default=1e-4, show_default=True,
              help="Relative uncertainty of the frequencies in modes.csv.")  # fmt: skip
@options
def modes(
    file: Path, as_json: bool, out: Path | None, vtu: bool, uff: bool, shown: tuple[int, ...] | None, sigma: float
) -> None:
    """Modes of the structure of STUDY, with their labels and counts.

    --out DIR gets pictures of the frequencies and of the rim of a casing, and modes.csv. This is a frequency table for
    `casingfem locate` and `update`, marked COMPUTED.
    """
    from casingfem.modal.modes import modes as compute
    from casingfem.study import MeshStudy

    if shown is not None and not (vtu or uff):
        raise click.UsageError("--modes found without --vtu or --uff, expected one of them")
    if (vtu or uff) and out is None:
        raise click.UsageError("--vtu or --uff found without --out DIR, expected both")
    study = any_study(file, wheel=True)
    if isinstance(study, MeshStudy) and study.wheel is not None:
        print_wheel(study, study.wheel, as_json=as_json, out=out, sigma=sigma, shown=shown, vtu=vtu, uff=uff)
        return
    with ProgressMessage(f"modes of {file.name}"):
        found = compute(study.structure, **study.file.modes.wanted)
    if found.rigid and study.file.modes.elastic_only:
        what = f"true, and {found.rigid} rigid modes"
        raise study.error("modes.elastic_only", what, "a structure that its supports fix")
    document = {
        "modes": found.records(),
        "dofs": found.dofs,
        "seconds": found.seconds,
        "sturm_count": found.sturm_count,
        "rigid": found.rigid,
        "warnings": collected(),
        "source": study.source,
    }
    files = modes_tables(document, found, study, sigma)
    if out is not None:
        files |= mode_pictures(found)
    if vtu or uff:
        files |= shape_files(found, shown, vtu=vtu, uff=uff)
    deliver(document, repr(found), as_json=as_json, out=out, files=files)


@click.command()
@STUDY
@click.option("--to-hz", type=click.FloatRange(0.0, min_open=True), default=None,
              help="Highest speed [Hz] (1 Hz = 60 rpm); 1.5 times the speed of STUDY if left out.")  # fmt: skip
@click.option("--steps", type=click.IntRange(2, 500), default=16, show_default=True, help="Number of speeds from 0.")
@click.option(
    "--count", type=click.IntRange(1, 100), default=6, show_default=True, help="Number of modes, the lowest at rest."
)
@click.option("--orders", type=click.IntRange(1, 100), default=8, show_default=True, help="Engine orders.")
@options
def campbell(
    file: Path, as_json: bool, out: Path | None, to_hz: float | None, steps: int, count: int, orders: int
) -> None:
    """Frequencies of the rotating structure of STUDY over speed, and their crossings with engine orders.

    The structure is a shell on a chart or an imported part; both need a [rotation]. For a scene of kind rotor: whirl
    frequencies, critical speeds and the orbit due to its unbalance.
    """
    import numpy as np

    from casingfem.cli.contact import is_scene
    from casingfem.modal.campbell import campbell as compute

    if is_scene(file):
        rotor_campbell(file, as_json, out, to_hz, steps)
        return
    study = any_study(file)
    rotation = study.structure.rotation
    if rotation is None:
        raise study.error("rotation", "none", "a [rotation], which a Campbell diagram needs")
    top = to_hz if to_hz is not None else 1.5 * abs(rotation.omega) / (2.0 * np.pi)
    if top == 0.0:
        raise click.UsageError("--to-hz: missing, and the speed of STUDY is 0: give the highest speed")
    with ProgressMessage(f"campbell of {file.name}"):
        found = compute(study.structure, 2.0 * np.pi * np.linspace(0.0, top, steps), count)
    document = {**found.to_json(orders), "source": study.source}
    files: dict[str, Content] = {"campbell.json": json_text(document, indent=1)}
    if out is not None:
        from casingfem.plot.style import png

        files |= {"campbell.csv": found.to_csv(), "campbell.png": png(found.plot(orders=orders))}
    deliver(document, f"{found.table(orders)}\n{CROSSINGS}", as_json=as_json, out=out, files=files)


@click.command()
@STUDY
@click.option("--leave-one-out", "left_out", is_flag=True, help="Predict each row by an update without this row.")
@click.option(
    "--posterior",
    type=click.Choice(["laplace", "emcee"]),
    help="Method for the uncertainty in addition to J^T J; emcee needs the extra sampling.",
)
@options
def update(file: Path, as_json: bool, out: Path | None, left_out: bool, posterior: str | None) -> None:
    """Fit the parameters of STUDY to its measured frequency table, and to mode shapes if it names them.

    --out DIR gets the document, the updated study, and the page update.html.
    """
    from casingfem.study import updated_toml
    from casingfem.study.tasks import judge_update, run_update
    from casingfem.updating.shape_fit import shape_fit

    study = any_study(file)
    with ProgressMessage(f"update of {file.name}") as working:
        fit = run_update(study)
        fit_seconds = working.seconds
        further = judge_update(study, fit, left_out=left_out, posterior=posterior, say=working.say)
    compared = shape_fit(fit)
    document = {
        **fit.to_json(),
        "shapes": None if compared is None else compared.to_json(),
        **{name: part.to_json() for name, part in further.items()},
        "seconds": fit_seconds,
        "warnings": collected(),
        "source": study.source,
    }
    files: dict[str, Content] = {"update.json": json_text(document, indent=1)}
    if out is not None:
        from casingfem.plot.pages.study import update_page

        files["update.csv"] = csv_text(fit.records(), f"COMPUTED: parameters fitted to {fit.table.path}")
        files["update_pairs.csv"] = csv_text(fit.pairs(), f"rows of {fit.table.path} and the modes that pair with them")
        values = {p.name: value for p, value in zip(fit.parameters, fit.value, strict=True)}
        files[f"{file.stem}_updated.toml"] = updated_toml(study, values, out)
        files["update.html"] = update_page(study, fit, getattr(further.get("posterior"), "samples", None))
    parts = [fit, *([] if compared is None else [compared]), *further.values()]
    deliver(document, "\n".join(map(repr, parts)), as_json=as_json, out=out, files=files)


@click.command()
@STUDY
@options
def reduce(file: Path, as_json: bool, out: Path | None) -> None:
    """Reduce the structure of STUDY to a modal basis at its interface.

    The basis is written to --out DIR, by default next to STUDY if its key reduce.out names the file.
    """
    from casingfem.study.tasks import run_reduce

    study = any_study(file, wheel=True)
    with ProgressMessage(f"reduction of {file.name}") as working:
        basis = run_reduce(study)
    wanted = study.file.reduce.out if study.file.reduce is not None else None
    folder = out if out is not None else file.parent if wanted is not None else None
    name = wanted or f"{file.stem}.npz"
    document = {
        "file": None if folder is None else str(folder / name),
        "kind": basis.kind,
        "freq_hz": basis.freq.tolist(),
        "zeta": basis.zeta.tolist(),
        "channels": list(basis.channels),
        "n_max": basis.n_max,
        "radius": basis.radius,
        "lines": [
            {"axial_m": axial, "radius_m": radius, "thickness_m": wall}
            for (axial, radius), wall in zip_longest(basis.lines.tolist(), basis.line_thickness.tolist())
        ],
        "seconds": working.seconds,
        "provenance": basis.provenance,
        "source": study.source,
    }
    text = repr(basis) + ("" if folder is not None else "\nnot written: give --out DIR")
    deliver(document, text, as_json=as_json, out=folder, files={name: basis.save})


@click.command()
@click.argument("files", metavar="FILE...", nargs=-1, required=True, type=click.Path(path_type=Path))
@options
def report(files: tuple[Path, ...], as_json: bool, out: Path | None) -> None:
    """Write report.html about FILE, a study or a contact scene, to --out DIR (by default here).

    A scene is run. With several files the page has a part for each: a blade, its casing, the scenes of both.
    """
    from casingfem.cli.report import write_report

    write_report(files, as_json, out if out is not None else Path())
