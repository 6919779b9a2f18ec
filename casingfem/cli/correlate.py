"""The command correlate: measured shapes against the modes of a study."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from casingfem.cli.model_warnings import collected
from casingfem.cli.running import ProgressMessage, deliver, options
from casingfem.cli.study import STUDY
from casingfem.cli.tables import csv_text
from contact.io.outfiles import Content, json_text

if TYPE_CHECKING:
    from casingfem.experiment.correlation.correlate import Correlation

SHAPES = click.argument("shapes", metavar="SHAPES", type=click.Path(path_type=Path))


@click.command()
@STUDY
@SHAPES
@click.option("--mass", type=click.Choice(("SEREP", "Guyan")), default="SEREP", show_default=True,
              help="How the mass is reduced to the sensors.")  # fmt: skip
@click.option("--reach", type=click.FloatRange(0.0, 1.0, min_open=True), default=0.2, show_default=True,
              help="Largest relative frequency error of a pair.")  # fmt: skip
@options
def correlate(file: Path, shapes: Path, mass: str, reach: float, as_json: bool, out: Path | None) -> None:
    """Correlate the mode shapes of SHAPES with the modes of STUDY.

    SHAPES is a universal file with sets 55, or identified.npz of `casingfem identify --out`. Sensors stand at the
    points of the file, which must lie on the wall; on an imported mesh at its nearest nodes.
    """
    from casingfem.experiment.correlation.correlate import correlate as compare
    from casingfem.experiment.correlation.measured_shapes import read_shapes
    from casingfem.modal.modes import modes
    from casingfem.structure.shell.assembly import assemble
    from casingfem.study import MeshStudy, load_any

    with ProgressMessage(f"reading {file.name}"):
        study = load_any(file)
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
        "correlation.csv": csv_text(result.records(), "measured shapes and the computed modes they pair with"),
        "mac.png": png(figure_mac(result)),
        "comac.png": png(figure_comac(result)),
    }
