"""Frequency responses from time records: `casingfem frf`."""

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import click

from casingfem.cli.progress import ProgressMessage
from casingfem.cli.running import deliver, options, source_of
from contact.io.outfiles import Content, json_text

if TYPE_CHECKING:
    from casingfem.experiment.frf.records.estimated import Estimate
    from casingfem.experiment.frf.records.read import RecordFile


@click.command()
@click.argument("files", metavar="RECORDS...", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option(
    "--channels", "channels_file", type=click.Path(path_type=Path), metavar="CSV", default=None,
    help="Table of the channels: channel,kind,point,direction,unit,factor. Sound files need it.",
)  # fmt: skip
@click.option(
    "--test", "test", type=click.Choice(("hammer", "shaker")), default=None,
    help="Kind of test; decided by the peak of the force over its rms if left out.",
)  # fmt: skip
@click.option(
    "--estimator", type=click.Choice(("H1", "H2", "Hv")), default="H1", show_default=True,
    help="H1: noise on the responses; H2: on the force; Hv: on both.",
)  # fmt: skip
@click.option(
    "--exponential", type=float, metavar="TAU", default=None,
    help="Time constant [s] of an exponential window. `identify` subtracts its damping.",
)  # fmt: skip
@click.option("--seconds", type=float, default=None, help="Length of a block [s]; chosen from the records if left out.")
@click.option("--before", type=float, default=None, help="Pre-trigger [s] of hits in a long record.")
@click.option(
    "--window", type=click.Choice(("hann", "rectangular")), default="hann", show_default=True,
    help="Window of the blocks of a shaker test; rectangular for bursts that decay within the block.",
)  # fmt: skip
@click.option("--overlap", type=float, default=0.5, show_default=True, help="Overlap of the blocks of a shaker test.")
@click.option("--band", type=(float, float), metavar="FROM TO", default=None, help="Lines kept [Hz]; to fs/2.56.")
@options
def frf(
    files: tuple[Path, ...],
    channels_file: Path | None,
    test: Literal["hammer", "shaker"] | None,
    estimator: Literal["H1", "H2", "Hv"],
    exponential: float | None,
    seconds: float | None,
    before: float | None,
    window: Literal["hann", "rectangular"],
    overlap: float,
    band: tuple[float, float] | None,
    as_json: bool,
    out: Path | None,
) -> None:
    """Frequency responses of the time records RECORDS (.uff, .wav, .mat, .npz, .csv) of a hammer or shaker test.

    Each hit is found by its pulse. Double, truncated and clipped hits are left out and listed. DIR gets the responses
    and their coherence with the geometry of the records (frfs.uff) for `casingfem identify`, and the page frfs.html:
    hits, windows, responses, coherence.
    """
    from casingfem.experiment.frf.records.channels import read_channels
    from casingfem.experiment.frf.records.estimate import estimate
    from casingfem.experiment.frf.records.read import read_record_file

    table = None if channels_file is None else read_channels(channels_file)
    name = files[0].name if len(files) == 1 else f"{files[0].name} and {len(files) - 1} more"
    with ProgressMessage(f"responses of {name}") as working:
        read = [read_record_file(file, table) for file in files]
        found = estimate(
            [take for each in read for take in each.takes], test=test, estimator=estimator, exponential=exponential,
            seconds=seconds, before=before, window=window, overlap=overlap, band=band,
        )  # fmt: skip
    document = {
        "channels": len(found.frfs),
        "lines": len(found.frfs.x),
        "from_hz": float(found.frfs.x[0]),
        "to_hz": float(found.frfs.x[-1]),
        "unit": found.frfs.unit,
        "averages": found.averages,
        "test": "hammer" if found.hits else "shaker",
        "hits": found.records() if found.hits else [],
        "ringing_left": found.left,
        "exponential_window_s": exponential,
        "median_coherence": [found.median_coherence(k) for k in range(len(found.frfs))],
        "notes": list(found.notes),
        "seconds": working.seconds,
        "source": [str(file) for file in files],
    }
    written: dict[str, Content] = {} if out is None else result_files(name, found, read[0], files[0], document)
    deliver(document, repr(found), as_json=as_json, out=out, files=written)


def result_files(
    name: str, found: "Estimate", first: "RecordFile", file: Path, document: dict[str, Any]
) -> dict[str, Content]:
    """The universal file, the page, the pictures and the document."""
    from casingfem.experiment.frf.records.write import write_estimate
    from casingfem.plot.pages.records import records_page
    from casingfem.plot.records import figure_estimate, figure_hit, figure_peaks
    from casingfem.plot.style import Drawn

    drawn = {"frfs": Drawn(figure_estimate(found))}
    if found.hits:
        drawn = {"hit": Drawn(figure_hit(found)), **drawn, "hits": Drawn(figure_peaks(found))}
    return {
        "frf.json": json_text(document, indent=1),
        "frfs.uff": partial(write_estimate, found=found, nodes=first.nodes, lines=first.lines),
        "frfs.html": records_page(name, found, source_of(file), drawn),
        **{f"{key}.png": picture.png for key, picture in drawn.items()},
    }
