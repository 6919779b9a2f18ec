"""The command locate: which bolts are loose, or where mass was added."""

from pathlib import Path

import click

from casingfem.cli.model_warnings import collected
from casingfem.cli.running import ProgressMessage, deliver, options
from casingfem.cli.study import STUDY
from casingfem.cli.tables import csv_text
from contact.io.outfiles import Content, json_text


@click.command()
@STUDY
@click.argument("table", metavar="TABLE", type=click.Path(path_type=Path))
@click.option("--baseline", type=click.Path(path_type=Path), metavar="CSV",
              help="The same casing measured before anything was loosened or added.")  # fmt: skip
@click.option("--among", type=click.Choice(("bolts", "mass")), default="bolts", show_default=True,
              help="What to look for.")  # fmt: skip
@click.option("--edge", default=None, help="Where; the bolted edge, or the top for masses.")
@click.option("--most", type=click.IntRange(1, 12), default=4, show_default=True, help="Largest number of places.")
@click.option("--model-error", type=click.FloatRange(0.0, 0.5), default=0.0, show_default=True,
              help="What the model may be off by, relative; without a baseline the size of its splits.")  # fmt: skip
@click.option("--shapes", type=click.Path(path_type=Path), metavar="FILE",
              help="Mode shapes measured with TABLE, as correlate takes them; tell opposite bolts apart.")  # fmt: skip
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
    from casingfem.plot.locate import figure_located
    from casingfem.plot.style import png
    from casingfem.study import load_study

    with ProgressMessage(f"reading {file.name}"):
        study = load_study(file)
    now = FrequencyTable.from_csv(table)
    before = None if baseline is None else FrequencyTable.from_csv(baseline)
    seen = None if shapes is None else read_shapes(shapes)
    if seen is not None and among != "bolts":
        raise click.UsageError("--shapes judges loose bolts, not masses")
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
    text = "\n".join([repr(found), *(["by the measured shapes, the likeliest first:"] if lines else []), *lines])
    files: dict[str, Content] = {}
    if out is not None:
        files = {
            "located.json": json_text(document, indent=1),
            "located.csv": csv_text(found.records(), "COMPUTED: places that explain the table, the best one first"),
            "located.png": png(figure_located(found)),
        }
    deliver(document, text, as_json=as_json, out=out, files=files)
