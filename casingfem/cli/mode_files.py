"""Files of `casingfem modes`: the table, shapes for ParaView, a universal file; and modes of a whole wheel."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from casingfem.cli.progress import ProgressMessage
from casingfem.cli.running import collected, deliver
from casingfem.cli.tables import csv_text
from contact.io.outfiles import Content, json_text

if TYPE_CHECKING:
    from casingfem.modal.cyclic.modes import CyclicModes
    from casingfem.modal.mesh_modes import MeshModes
    from casingfem.modal.mode_set import Modes, ModeSet
    from casingfem.study.cyclic import Wheel
    from casingfem.study.imported import MeshStudy
    from casingfem.study.load import Study


RIMS = 8  # doublets and single modes whose rim is drawn


def shape_files(
    found: "Modes | MeshModes", shown: tuple[int, ...] | None, *, vtu: bool, uff: bool
) -> dict[str, Content]:
    """The files of --vtu and --uff by name."""
    from casingfem.export.meshes import mode_files
    from casingfem.export.modes_uff import write_modes_uff

    which = indices(found, shown)
    shapes = mode_files(found, which) if vtu else {}
    files: dict[str, Content] = {f"vtu/{name}": content for name, content in shapes.items()}
    return files | ({"modes.uff": lambda path: write_modes_uff(found, path, which)} if uff else {})


def indices(found: "ModeSet", shown: tuple[int, ...] | None) -> list[int] | None:
    """Indices of the chosen modes, from 0, which must be among the computed ones."""
    if shown is not None and max(shown) > len(found):
        raise click.UsageError(f"--modes: found {max(shown)}, expected numbers from 1 to {len(found)}")
    return None if shown is None else [number - 1 for number in shown]


def modes_csv(found: "ModeSet | CyclicModes", study: "Study | MeshStudy", sigma: float) -> str:
    """The modes as a frequency table with its comment lines, and further columns that only a model has."""
    from casingfem.experiment.frequency_table import COLUMNS, COMPUTED

    source = study.source
    versions = ", ".join(f"{name} {number}" for name, number in source["versions"].items())
    card = [
        f"COMPUTED, SYNTHETIC in place of a test: modes of {source['study']} (sha256 {source['sha256']})",
        f"by {versions}",
        f"sigma_hz: {sigma:g} of the frequency, as stated by --sigma",
    ]
    rows = [{**row, "sigma_hz": sigma * float(str(row["freq_hz"])), "zeta": None} for row in found.records()]
    return csv_text(rows, "\n".join(card), COLUMNS + COMPUTED)


def modes_tables(
    document: dict[str, Any], found: "ModeSet | CyclicModes", study: "Study | MeshStudy", sigma: float
) -> dict[str, Content]:
    """Tables that --out writes for modes."""
    return {"modes.json": json_text(document, indent=1), "modes.csv": modes_csv(found, study, sigma)}


def mode_pictures(found: "ModeSet") -> dict[str, Content]:
    """Pictures that --out writes for modes: frequencies by nodal diameter, and shapes of the rim of a casing."""
    from casingfem.modal.mode_set import Modes
    from casingfem.plot.modes import figure_frequencies, figure_rim, groups
    from casingfem.plot.style import png

    files: dict[str, Content] = {"modes.png": png(figure_frequencies(found))}
    shown = groups(found, RIMS)
    if isinstance(found, Modes) and found.rings is not None and shown:
        files["modes_rim.png"] = png(figure_rim(found, shown))
    return files


def print_wheel(
    study: "MeshStudy",
    wheel: "Wheel",
    *,
    as_json: bool,
    out: Path | None,
    sigma: float,
    shown: tuple[int, ...] | None,
    vtu: bool,
    uff: bool,
) -> None:
    """Compute the tasks of a wheel's study, print the results, and write the files."""
    from casingfem.modal.cyclic.mistuned import mistuned_modes
    from casingfem.modal.cyclic.modes import cyclic_modes, wheel_modes
    from casingfem.modal.cyclic.reduction import OF_A_DIAMETER
    from casingfem.modal.cyclic.whirl import cyclic_whirl

    asked = study.file.modes
    count = asked.count if "count" in asked.model_fields_set else OF_A_DIAMETER
    if asked.band_hz is not None and (wheel.coriolis or wheel.deviations is not None):
        raise study.error("modes.band_hz", "a band of a mistuned or whirling wheel", "count, of each nodal diameter")
    if asked.method != "auto":
        raise study.error("modes.method", repr(asked.method), '"auto" for a wheel')
    with ProgressMessage(f"modes of {study.path.name}") as working:
        wanted = asked.wanted.get("band", count)
        found = cyclic_modes(wheel.sector, wanted, diameters=wheel.diameters)
        working.say(f"modes of {study.path.name}: waves, mistuning")
        whirl = cyclic_whirl(wheel.sector, count, diameters=wheel.diameters) if wheel.coriolis else None
        mistuned = None
        if wheel.deviations is not None:
            mistuned = mistuned_modes(wheel.sector, wheel.deviations, count, blade=wheel.blade)
    if found.rigid.any() and asked.elastic_only:
        what = f"true, and {int(found.rigid.sum())} rigid modes"
        raise study.error("modes.elastic_only", what, "a structure that its supports fix")
    parts = [part for part in (found, whirl, mistuned) if part is not None]
    document = {
        "modes": found.records(),
        "whirl": None if whirl is None else whirl.records(),
        "mistuned": None if mistuned is None else mistuned.records(),
        "sectors": wheel.sector.sectors,
        "dofs": found.unknowns,
        "seconds": found.seconds,
        "sturm_counts": {str(n): counted for n, counted in found.sturm_counts.items()},
        "warnings": collected(),
        "source": study.source,
    }
    files = modes_tables(document, found, study, sigma)
    if vtu or uff:
        files |= shape_files(wheel_modes(found), shown, vtu=vtu, uff=uff)
    deliver(document, "\n".join(map(repr, parts)), as_json=as_json, out=out, files=files)
