"""The files of `casingfem modes`: the table, shapes for ParaView, a universal file."""

from typing import TYPE_CHECKING

import click

from contact.io.outfiles import Content

if TYPE_CHECKING:
    from casingfem.modal.cyclic.modes import CyclicModes
    from casingfem.modal.mesh_modes import MeshModes
    from casingfem.modal.mode_set import Modes, ModeSet
    from casingfem.study.imported import MeshStudy
    from casingfem.study.load import Study


def shapes(found: "Modes | MeshModes", shown: tuple[int, ...] | None) -> dict[str, bytes]:
    """The files of --vtu by name."""
    from casingfem.export.meshes import mode_files

    which = indices(found, shown)
    return {f"vtu/{name}": content for name, content in mode_files(found, which).items()}


def universal(found: "Modes | MeshModes", shown: tuple[int, ...] | None) -> dict[str, Content]:
    """The file of --uff."""
    from casingfem.export.modes_uff import write_modes_uff

    which = indices(found, shown)
    return {"modes.uff": lambda path: write_modes_uff(found, path, which)}


def indices(found: "ModeSet", shown: tuple[int, ...] | None) -> list[int] | None:
    """The modes chosen, from 0, which must be among those computed."""
    if shown is not None and max(shown) > len(found):
        raise click.UsageError(f"--modes: found {max(shown)}, expected numbers up to the {len(found)} modes computed")
    return None if shown is None else [number - 1 for number in shown]


def modes_csv(found: "ModeSet | CyclicModes", study: "Study | MeshStudy", sigma: float) -> str:
    """The modes as a frequency table with its card, and beyond it what only a model knows."""
    from casingfem.experiment.frequency_table import COLUMNS, COMPUTED

    source = study.source
    versions = ", ".join(f"{name} {number}" for name, number in source["versions"].items())
    lines = [
        f"# COMPUTED, SYNTHETIC where a test is expected: modes of {source['study']} (sha256 {source['sha256']})",
        f"# by {versions}",
        f"# sigma_hz: {sigma:g} of the frequency, as stated by --sigma",
        ",".join(COLUMNS + COMPUTED),
    ]
    for row in found.records():
        cells = {**row, "sigma_hz": sigma * float(str(row["freq_hz"])), "zeta": None}
        lines.append(",".join("" if cells[name] is None else str(cells[name]) for name in COLUMNS + COMPUTED))
    return "\n".join(lines) + "\n"
