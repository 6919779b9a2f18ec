"""Read study.toml for a command, with a message while it is read."""

from pathlib import Path
from typing import TYPE_CHECKING

from casingfem.cli.progress import ProgressMessage

if TYPE_CHECKING:
    from casingfem.study import MeshStudy, Study


def any_study(file: Path, *, wheel: bool = False) -> "Study | MeshStudy":
    """Read a study, of a shell on a chart or of an imported mesh."""
    from casingfem.study import load_study

    with ProgressMessage(f"reading {file.name}"):
        return load_study(file, wheel=wheel)


def chart_study(file: Path) -> "Study":
    """Read the study of a shell on a chart."""
    from casingfem.study import load_shell_study

    with ProgressMessage(f"reading {file.name}"):
        return load_shell_study(file)
