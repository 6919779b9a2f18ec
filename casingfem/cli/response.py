"""`casingfem response STUDY`: response of a wheel, tuned and mistuned, to engine orders."""

from pathlib import Path

import click

from casingfem.cli.progress import ProgressMessage
from casingfem.cli.read_study import any_study
from casingfem.cli.running import collected, deliver, options
from casingfem.cli.study import STUDY
from casingfem.cli.tables import csv_text
from contact.io.outfiles import Content, json_text


@click.command()
@STUDY
@options
def response(file: Path, as_json: bool, out: Path | None) -> None:
    """Amplitudes of the wheel of STUDY under its engine orders over speed, and their amplification by mistuning.

    STUDY has [cyclic], [reduce] and tables [[response]]. --out DIR gets tables, curves and the SAFE diagram.
    """
    from casingfem.study.tasks import run_response

    study = any_study(file, wheel=True)
    with ProgressMessage(f"response of {file.name}") as working:
        wheel, found = run_response(study)
    document = {
        "modes": [
            {"nodal_diameters": n, "freq_hz": freq}
            for n, freq in zip(wheel.diameters.tolist(), wheel.freq.tolist(), strict=True)
        ],
        "responses": [
            {
                "order": one.order, "nodal_diameters": one.diameter, "peak_m": one.peak, "peak_hz": one.peak_hz,
                "tuned_peak_m": one.tuned_peak, "tuned_peak_hz": one.tuned_peak_hz,
                "amplification": one.amplification, "bound": one.bound, "rows": one.records(),
                "draws": None if drawn is None else {
                    "sigma": drawn.sigma, "seed": drawn.seed, "amplification": drawn.amplification.tolist(),
                    "worst": drawn.worst.tolist(),
                },
            }
            for one, drawn in found
        ],
        "seconds": working.seconds, "warnings": collected(), "source": study.source,
    }  # fmt: skip
    files: dict[str, Content] = {"response.json": json_text(document, indent=1)}
    if out is not None:
        from casingfem.plot.engine_orders import figure_response, figure_safe
        from casingfem.plot.style import png

        responses = [one for one, _ in found]
        files["safe.png"] = png(figure_safe(wheel, responses))
        for k, (one, drawn) in enumerate(found, 1):
            files[f"response_{k}.csv"] = csv_text(one.records())
            files[f"response_{k}.png"] = png(figure_response(one, drawn))
            if drawn is not None:
                files[f"amplification_{k}.csv"] = csv_text(drawn.records())
    lines = [words for one, drawn in found for words in (one.words, *(() if drawn is None else (drawn.words,)))]
    deliver(document, "\n".join(lines), as_json=as_json, out=out, files=files)
