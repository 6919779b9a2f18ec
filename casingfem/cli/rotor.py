"""`casingfem campbell` for a scene of a rotor: whirl frequencies over speed, critical speeds, unbalance response."""

from pathlib import Path

import click

from casingfem.cli.progress import ProgressMessage
from casingfem.cli.running import deliver
from casingfem.cli.tables import csv_text
from contact.io.outfiles import Content, json_text

FINE = 401  # speeds of the unbalance response


def rotor_campbell(file: Path, as_json: bool, out: Path | None, to_hz: float | None, steps: int) -> None:
    """Print the Campbell data of a rotor over speed, and write them with --out."""
    import numpy as np

    from contact import InputError, load_scene
    from contact.model.gaps.gap import RotatingRim
    from contact.model.gaps.rub import Rub
    from contact.model.rotor import Rotor, campbell, critical_speeds, unbalance_response

    scene = load_scene(file)
    rotor = scene.what.rotor if isinstance(scene.what, Rub) else scene.what
    if not isinstance(rotor, Rotor):
        turns = isinstance(scene.what, RotatingRim | Rub)
        more = ": casingfem interactions finds the dangerous speeds of a rub" if turns else ""
        raise InputError(f"{file}: scene.kind: found another kind, expected a study or a scene of kind 'rotor'{more}")
    top = to_hz if to_hz is not None else 1.5 * rotor.speed.fastest / (2.0 * np.pi)
    if not top > 0.0:
        raise click.UsageError("--to-hz: missing, and the speed of the rotor is 0: give the highest speed")
    with ProgressMessage(f"campbell of {file.name}"):
        found = campbell(rotor, np.linspace(0.0, top, steps))
        critical = [one for one in critical_speeds(rotor) if one["speed_hz"] <= top]
        response = unbalance_response(rotor, np.linspace(top / FINE, top, FINE))
    document = {
        "whirl": found.records(), "critical_speeds": critical, "response": response.records(), "source": scene.source,
    }  # fmt: skip
    files: dict[str, Content] = {"campbell.json": json_text(document, indent=1)}
    if out is not None:
        from casingfem.plot.rotor import figure_whirl
        from casingfem.plot.style import png

        files |= {
            "campbell.csv": csv_text(found.records()), "response.csv": csv_text(response.records()),
            "campbell.png": png(figure_whirl(found, response, [one["speed_hz"] for one in critical])),
        }  # fmt: skip
    speeds = ", ".join(
        f"{one['speed_hz']:.4g} Hz ({60.0 * one['speed_hz']:.5g} rpm, {one['sense']})" for one in critical
    )
    words = f"Critical speeds up to {top:.4g} Hz: {speeds or 'none'}."
    deliver(document, f"{found!r}\n{words}", as_json=as_json, out=out, files=files)
