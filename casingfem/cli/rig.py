"""The command rig: the virtual test rig of a study, and what it measures."""

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from casingfem.cli.running import ProgressMessage, deliver, options
from casingfem.cli.study import STUDY, chart_study
from contact.io.outfiles import Content, json_text

if TYPE_CHECKING:
    from casingfem.study.rig import RigTest


@click.command()
@STUDY
@options
def rig(file: Path, as_json: bool, out: Path | None) -> None:
    """Test the structure of STUDY on the virtual rig that its [rig] describes.

    With --out DIR: frequency responses (frfs.uff with geometry, frfs.npz), their coherence, time records if the study
    keeps them, the circle scan (scan.npz), the truth behind them (truth.csv), pictures. Everything says SYNTHETIC.
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
    files = {} if out is None else result_files(test, document)
    deliver(document, words(test), as_json=as_json, out=out, files=files)


def waves_unit(test: "RigTest") -> str:
    """Unit of the waves' amplitudes: velocities, over the force where the scan has its record."""
    return "m/s" if test.scan is None or test.scan.record.force is None else "(m/s)/N"


def words(test: "RigTest") -> str:
    """What was made, in lines."""
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


def result_files(test: "RigTest", document: dict[str, Any]) -> dict[str, Content]:
    """Records, truth, document and pictures."""
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
