"""Commands of a test: rig simulates one on the virtual rig of a study, identify finds modes in frequency responses."""

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from casingfem.cli.progress import ProgressMessage
from casingfem.cli.read_study import chart_study
from casingfem.cli.running import deliver, options, source_of
from casingfem.cli.study import STUDY
from contact.io.outfiles import Content, json_text

if TYPE_CHECKING:
    from casingfem.experiment.frf.frf_set import FrfSet
    from casingfem.experiment.identify.identified import Identified
    from casingfem.study.rig import RigTest


NO_ANGLES = (
    "n and angle are not given: the file has no places of the sensors. State them with --angles sensors.csv"
    " (point,angle_deg), or use --open for a blade or a plate"
)


@click.command()
@click.argument("file", metavar="FRFS", type=click.Path(path_type=Path))
@click.option("--band", type=(float, float), metavar="FROM TO", default=None, help="Frequencies [Hz]; all if left out.")
@click.option(
    "--angles", "angles_file", type=click.Path(path_type=Path), metavar="CSV",
    help="Angles of the points on the sensors' circle: point,angle_deg; with radius_m,z_m their places too. From the"
    " geometry of a universal file if left out.",
)  # fmt: skip
@click.option(
    "--form", type=click.Choice(("receptance", "mobility", "accelerance")), default=None,
    help="Kind of responses; decided by their unit if left out.",
)  # fmt: skip
@click.option(
    "--array", "named_arrays", multiple=True, metavar="MEANING=NAME",
    help="Name of an array of a .mat or .npz file, such as frf=Hf_chan_2; once for each of freq_hz, frf, coherence ...",
)  # fmt: skip
@click.option("--order", type=click.IntRange(2, 200), default=None, help="Largest model order.")
@click.option("--open", "open_part", is_flag=True, help="A blade or plate: no n; directions 1, 2, 3 are x, y, z.")
@click.option(
    "--n-max",
    type=click.IntRange(0, 200),
    default=None,
    help="Largest nodal diameter of a label; 64, or as far as the sensors resolve, if left out.",
)
@click.option(
    "--pick",
    "pick_file",
    type=click.Path(path_type=Path),
    metavar="CSV",
    default=None,
    help="Poles picked by hand from the stabilisation diagram: a table with a column freq_hz. None is added to them.",
)
@click.option(
    "--exponential", type=float, metavar="TAU", default=None,
    help="Time constant [s] of an exponential window exp(-t/TAU), whose damping is subtracted; from the card's"
    " exponential_window_s if left out.",
)  # fmt: skip
@click.option(
    "--coherence", "coherence_file", type=click.Path(path_type=Path), metavar="FILE", default=None,
    help="Coherence of the responses, .uff or as `casingfem rig` writes it (.npz). Lines with low coherence weigh less."
    " From the universal file itself if left out.",
)  # fmt: skip
@click.option(
    "--output-only", "output_only", is_flag=True,
    help="FRFS is one long record of responses to random loads (.uff, .wav, .mat, .npz, .csv), without their forces.",
)  # fmt: skip
@click.option(
    "--channels", "channels_file", type=click.Path(path_type=Path), metavar="CSV", default=None,
    help="With --output-only: table of the channels, channel,kind,point,direction,unit,factor.",
)  # fmt: skip
@click.option(
    "--seconds", type=float, default=None, help="With --output-only: the longest lag of the correlations [s]."
)
@options
def identify(
    file: Path,
    band: tuple[float, float] | None,
    angles_file: Path | None,
    form: str | None,
    named_arrays: tuple[str, ...],
    order: int | None,
    n_max: int | None,
    open_part: bool,
    pick_file: Path | None,
    exponential: float | None,
    coherence_file: Path | None,
    output_only: bool,
    channels_file: Path | None,
    seconds: float | None,
    as_json: bool,
    out: Path | None,
) -> None:
    """Modes of the responses FRFS (.uff, .mat, .npz, .h5, .csv, .xlsx): frequency, damping, nodal diameters, angle.

    The program chooses the poles; with --pick you choose them. Each mode is sure or doubtful. A pair that the data
    cannot resolve is one mode, and a note names it. DIR gets the frequency table and the shapes (identified.csv,
    identified.npz) for `casingfem update`, `correlate` and `locate`. It also gets the stabilisation diagram, the fitted
    responses, and fit.png: mode indicator, fit, residual and coherence over all lines. The page identified.html shows
    all of them. With --output-only FRFS is a record of responses to random loads, and the pictures show half spectra of
    their correlations.
    """
    from casingfem.experiment.frf import files as given
    from casingfem.experiment.frf.sensor_grid import angles_of

    if open_part and angles_file is not None:
        raise click.UsageError(
            "--open found with --angles, expected one of them: --open is for parts without a circle of sensors"
        )
    unnamed = [word for word in named_arrays if not all(word.partition("="))]
    if unnamed:
        raise click.UsageError(f"--array {unnamed[0]}: expected MEANING=NAME, such as frf=Hf_chan_2")
    arrays = {meaning: name for meaning, _, name in (word.partition("=") for word in named_arrays)} or None
    not_measured = {
        "--form": form, "--array": arrays, "--pick": pick_file, "--exponential": exponential,
        "--coherence": coherence_file,
    }  # fmt: skip
    _check_options(output_only, not_measured, {"--channels": channels_file, "--seconds": seconds})
    if angles_file is None:
        places = given.file_places(file)
        angles = None if places is None or open_part else angles_of(places)
    else:
        angles, places = given.read_places(angles_file)
    shared: dict[str, Any] = {"angles": angles, "places": places, "band": band, "order": order, "n_max": n_max}
    coherence = None
    with ProgressMessage(f"modes in {file.name}") as working:
        if output_only:
            from casingfem.experiment.frf.records.read import read_responses
            from casingfem.experiment.identify.output_only.output_only import identify_output_only

            frfs = read_responses(file, channels=channels_file)
            found = identify_output_only(frfs, seconds=seconds, **shared)
        else:
            from casingfem.experiment.identify.identification import identify as find

            frfs = given.read_frfs(file, arrays=arrays)
            pick = None if pick_file is None else given.read_picks(pick_file)
            if coherence_file is None:
                coherence = given.file_coherence(file, arrays=arrays)
            else:
                coherence = given.read_coherence(coherence_file)
            found = find(frfs, form=form, pick=pick, exponential=exponential, coherence=coherence, **shared)
    if angles is None and not open_part:
        found = replace(found, notes=(*found.notes, NO_ANGLES))
    document = {
        "modes": found.records(),
        "sure": int(found.sure.sum()),
        "notes": list(found.notes),
        "channels": len(frfs),
        "sensors": len(found.sensors),
        "references": len(found.sensors.references),
        "lines": len(found.lines),
        "deviation_rel": found.deviation,
        "seconds": working.seconds,
        "source": str(file),
    }
    files: dict[str, Content] = {} if out is None else result_files(found, document, coherence, not output_only)
    deliver(document, repr(found), as_json=as_json, out=out, files=files)


def _check_options(output_only: bool, not_measured: dict[str, Any], only: dict[str, Any]) -> None:
    """Refuse options that belong to the other kind of input."""
    wrong = [name for name, value in (not_measured if output_only else only).items() if value is not None]
    if wrong:
        where = "are of frequency responses: leave them" if output_only else "belong to --output-only: leave them"
        raise click.UsageError(f"{', '.join(wrong)} {where} out")


def result_files(
    found: "Identified", document: dict[str, Any], coherence: "FrfSet | None" = None, pick: bool = True
) -> dict[str, Content]:
    """The table, the pictures and the document."""
    from casingfem.plot.identify import figure_fit, figure_responses, figure_stabilisation
    from casingfem.plot.pages.identification import identification_page
    from casingfem.plot.style import Drawn

    files: dict[str, Content] = {"identified.json": json_text(document, indent=1)}
    source = source_of(Path(document["source"]))
    drawn = {
        "stabilisation": Drawn(figure_stabilisation(found)),
        "responses": Drawn(figure_responses(found)),
        "fit": Drawn(figure_fit(found, coherence)),
    }
    files["identified.html"] = identification_page(source["file"], found, source, drawn, coherence is not None, pick)
    if len(found):
        table = found.table([f"source: {source['file']}, sha256 {source['sha256']}"])
        files["identified.csv"] = table.to_csv
        files["identified.npz"] = lambda path: found.save(path, responses=False)
    return files | {f"{name}.png": picture.png for name, picture in drawn.items()}


@click.command()
@STUDY
@options
def rig(file: Path, as_json: bool, out: Path | None) -> None:
    """Test the structure of STUDY on the virtual rig that its [rig] describes.

    With --out DIR: frequency responses (frfs.uff with geometry, frfs.npz), their coherence, time records if the study
    keeps them, the circle scan (scan.npz), the exact modes (truth.csv), pictures. Everything is marked SYNTHETIC.
    """
    from casingfem.study.rig import run_rig

    study = chart_study(file)
    with ProgressMessage(f"rig of {file.name}") as working:
        test = run_rig(study)
    document = {
        "synthetic": True,
        "modes": [
            {"mode": k + 1, "freq_hz": f, "n": n if n >= 0 else None, "angle_deg": a, "zeta": z}
            for k, (f, n, a, z) in enumerate(
                zip(*(c.tolist() for c in (test.truth.freq_hz, test.truth.n, test.truth.angle_deg, test.truth.zeta)),
                    strict=True)
            )
        ],
        "frfs": None if test.frfs is None else {
            "channels": len(test.frfs), "lines": len(test.frfs.x), "unit": test.frfs.unit
        },
        "troubles": None if test.troubles is None else test.troubles.records(),
        "waves": None if test.waves is None else [w._asdict() for w in test.waves.waves() if w.seen],
        "waves_unit": waves_unit(test),
        "seconds": working.seconds,
        "source": study.source,
    }  # fmt: skip
    files = {} if out is None else files_of_test(test, document)
    deliver(document, words_of_test(test), as_json=as_json, out=out, files=files)


def waves_unit(test: "RigTest") -> str:
    """Unit of the waves' amplitudes: velocities, divided by force if the scan contains its record."""
    return "m/s" if test.scan is None or test.scan.record.force is None else "(m/s)/N"


def words_of_test(test: "RigTest") -> str:
    """Lines that summarise the simulated test."""
    import numpy as np

    parts = ["SYNTHETIC: nobody measured this", repr(test.rig), repr(test.truth)]
    parts += [] if test.frfs is None else [repr(test.frfs)]
    if test.coherence is not None:
        parts.append(f"coherence {np.median(test.coherence.responses.real):.4f} (median)")
    if test.scan is not None:
        parts += [
            repr(test.scan.record),
            f"waves: amplitude [{waves_unit(test)}], phase and angle [deg]",
            repr(test.waves),
        ]
    return "\n".join(parts)


def files_of_test(test: "RigTest", document: dict[str, Any]) -> dict[str, Content]:
    """Records, exact modes, document and pictures."""
    from casingfem.experiment.rig.files import write_rig_uff
    from casingfem.plot.experiment import figure_deflections, figure_responses, figure_scan
    from casingfem.plot.style import png

    files: dict[str, Content] = {"rig.json": json_text(document, indent=1), "truth.csv": test.truth.to_csv}
    pictures = {}
    if test.frfs is not None:
        frfs = test.frfs
        files["frfs.uff"] = partial(write_rig_uff, rig=test.rig, sets=[frfs])
        files["frfs.npz"] = frfs.save
        pictures["frfs.png"] = figure_responses(frfs, marks=test.truth.freq_hz, coherence=test.coherence)
    for name, kept in zip(("responses", "forces"), test.records, strict=False):
        files[f"{name}.uff"] = partial(write_rig_uff, rig=test.rig, sets=[kept])
    if test.coherence is not None:
        files["coherence.npz"] = test.coherence.save
    if test.scan is not None and test.waves is not None:
        files["scan.npz"] = test.scan.record.save
        pictures["scan.png"] = figure_scan(test.scan.record, test.waves)
        largest = [max(range(len(test.waves.n)), key=lambda k: abs(V[k])) for V in test.waves.V]
        shown = [(tone, abs(int(test.waves.n[k]))) for tone, k in enumerate(largest)][:8]
        pictures["deflections.png"] = figure_deflections(test.waves, shown)
    return files | {name: png(figure) for name, figure in pictures.items()}
