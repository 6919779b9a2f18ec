"""Commands that compare a test with a study: correlate (mode shapes), locate (loose bolts or masses)."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from casingfem.cli.progress import ProgressMessage
from casingfem.cli.read_study import any_study, chart_study
from casingfem.cli.running import collected, deliver, options
from casingfem.cli.study import STUDY
from casingfem.cli.tables import csv_text
from contact.io.outfiles import Content, json_text

if TYPE_CHECKING:
    from casingfem.experiment.correlation.correlate import Correlation


@click.command()
@STUDY
@click.argument("shapes", metavar="SHAPES", type=click.Path(path_type=Path))
@click.option("--mass", type=click.Choice(("SEREP", "Guyan")), default="SEREP", show_default=True,
              help="How the mass is reduced to the sensors.")  # fmt: skip
@click.option("--reach", type=click.FloatRange(0.0, 1.0, min_open=True), default=0.2, show_default=True,
              help="Largest relative frequency error of a pair.")  # fmt: skip
@options
def correlate(file: Path, shapes: Path, mass: str, reach: float, as_json: bool, out: Path | None) -> None:
    """Correlate the mode shapes of SHAPES with the modes of STUDY.

    SHAPES is a universal file with data sets 55, or identified.npz of `casingfem identify --out`. Sensors are at the
    points of the file, which must lie on the wall; on an imported mesh at its nearest nodes.
    """
    from casingfem.experiment.correlation.correlate import correlate as compare
    from casingfem.experiment.correlation.measured_shapes import read_shapes
    from casingfem.modal.modes import modes
    from casingfem.structure.shell.assembly import assemble
    from casingfem.study import MeshStudy

    study = any_study(file)
    measured = read_shapes(shapes)
    with ProgressMessage(f"modes of {file.name}") as working:
        count = max(study.file.modes.wanted.get("count") or 40, len(measured) + 4)
        if isinstance(study, MeshStudy):
            part = study.structure.assembled()
            of_part = modes(study.structure, count, system=part)
            result = compare(of_part, measured, reach=reach, mass=mass, system=part)
        else:
            system = assemble(study.shell)
            found = modes(study.shell, count, method="shell", system=system)
            result = compare(found, measured, reach=reach, mass=mass, system=system)
    document = {**result.to_json(), "seconds": working.seconds, "warnings": collected(), "source": study.source}
    files: dict[str, Content] = {} if out is None else result_files(result, document)
    deliver(document, repr(result), as_json=as_json, out=out, files=files)


def result_files(result: "Correlation", document: dict[str, object]) -> dict[str, Content]:
    """The document and the pictures."""
    from casingfem.plot.correlation import figure_comac, figure_mac
    from casingfem.plot.style import png

    return {
        "correlation.json": json_text(document, indent=1),
        "correlation.csv": csv_text(result.records(), "measured shapes and the computed modes that pair with them"),
        "mac.png": png(figure_mac(result)),
        "comac.png": png(figure_comac(result)),
    }


@click.command()
@STUDY
@click.argument("table", metavar="TABLE", type=click.Path(path_type=Path))
@click.option("--baseline", type=click.Path(path_type=Path), metavar="CSV",
              help="Table of the same casing, measured before a bolt was loosened or a mass was added.")  # fmt: skip
@click.option("--among", type=click.Choice(("bolts", "mass")), default="bolts", show_default=True,
              help="What to search for.")  # fmt: skip
@click.option("--edge", default=None, help="Edge to search; the bolted edge, or the top for masses, if left out.")
@click.option("--most", type=click.IntRange(1, 12), default=4, show_default=True, help="Largest number of places.")
@click.option("--model-error", type=click.FloatRange(0.0, 0.5), default=0.0, show_default=True,
              help="Relative error of the model; without a baseline, that of its splits.")  # fmt: skip
@click.option("--shapes", type=click.Path(path_type=Path), metavar="FILE",
              help="Mode shapes measured with TABLE, as correlate takes them; distinguish opposite bolts.")  # fmt: skip
@options
def locate(
    file: Path,
    table: Path,
    baseline: Path | None,
    among: str,
    edge: str | None,
    most: int,
    model_error: float,
    shapes: Path | None,
    as_json: bool,
    out: Path | None,
) -> None:
    """Find loose bolts or added masses of STUDY from a frequency TABLE with nodal diameters and orientations."""
    from casingfem.experiment.correlation.measured_shapes import read_shapes
    from casingfem.experiment.frequency_table import FrequencyTable
    from casingfem.locate.localisation import locate as find
    from casingfem.locate.localisation import search_model
    from casingfem.locate.shape_check import checked_by_shapes
    from casingfem.plot.correlation import figure_located
    from casingfem.plot.style import png

    study = chart_study(file)
    now = FrequencyTable.from_csv(table)
    before = None if baseline is None else FrequencyTable.from_csv(baseline)
    seen = None if shapes is None else read_shapes(shapes)
    if seen is not None and among != "bolts":
        raise click.UsageError("--shapes found with a search for masses, expected it only with loose bolts")
    with ProgressMessage(f"search among {among} of {file.name}") as working:
        model = search_model(study.shell, now, among=among, edge=edge)
        found = find(
            study.shell, now, baseline=before, among=among, edge=edge, most=most, model_error=model_error, model=model
        )
        judged = [] if seen is None else checked_by_shapes(model[0], found, seen)
    order = [{"places": sorted(one.explanation.places), "unlike": one.unlike} for one in judged]
    document = {
        **found.to_json(), "by_shapes": order, "seconds": working.seconds, "warnings": collected(),
        "source": study.source,
    }  # fmt: skip
    lines = [f"bolts {one['places']}: the shapes differ by {one['unlike']:.2g}" for one in order]
    text = "\n".join(
        [repr(found), *(["places ranked by the measured shapes, the most likely first:"] if lines else []), *lines]
    )
    files: dict[str, Content] = {}
    if out is not None:
        files = {
            "located.json": json_text(document, indent=1),
            "located.csv": csv_text(found.records(), "COMPUTED: places that explain the table, the best one first"),
            "located.png": png(figure_located(found)),
        }
    deliver(document, text, as_json=as_json, out=out, files=files)
