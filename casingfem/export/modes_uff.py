"""Mode shapes as a universal file, for test software: units, nodes, lines between them, a set 55 for each mode."""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import numpy as np

from casingfem.experiment.uff.nodes import Nodes, TraceLine, Units
from casingfem.experiment.uff.set_55 import NORMAL_MODE, Shape
from casingfem.experiment.uff.write import write_uff
from casingfem.export.meshes import Drawn, chosen_modes, drawn
from casingfem.modal.mesh_modes import MeshModes
from casingfem.modal.mode_set import Modes

STRUCTURAL, TRANSLATIONS, DISPLACEMENT = 1, 2, 8  # set 55: model, data characteristic, quantity
LINE_COLOR = 8


def write_modes_uff(
    modes: Modes | MeshModes,
    path: str | os.PathLike[str],
    which: Sequence[int] | None = None,
    *,
    nodes_set: Literal["15", "2411"] = "15",
) -> Path:
    """Write the modes of a structure so that test software shows them: sets 151, 164 (SI), 15 or 2411, 82, 55.

    Shapes are mass-normalised translations in global directions, modal mass 1; set 55 stores six digits.

    Parameters
    ----------
    which
        Indices into the modes, by default all.
    nodes_set
        "15", which all test software reads, has six digits; "2411" has all.

    Raises
    ------
    ValueError
        A mode does not exist.
    """
    chosen, surface = chosen_modes(modes, which), drawn(modes)
    none = np.zeros(len(surface.points), np.int64)
    return write_uff(
        path,
        header=("casingfem", "modes of a shell" if isinstance(modes, Modes) else "modes of an imported part"),
        units=Units(),
        nodes=Nodes(labels=surface.labels, points=surface.points, systems=none, motions=none),
        nodes_set=nodes_set,
        lines=[drawn_lines(surface)],
        shapes=[one_shape(modes, mode, surface) for mode in chosen],
    )


def drawn_lines(surface: Drawn) -> TraceLine:
    """The edges of all cells, each once, as one polyline with breaks."""
    once = surface.labels[np.unique(np.sort(surface.sides, axis=1), axis=0)]
    pen = np.column_stack([once, np.zeros(len(once), np.int64)]).ravel()[:-1]
    return TraceLine(number=1, name="mid-surface", color=LINE_COLOR, nodes=pen)


def one_shape(modes: Modes | MeshModes, mode: int, surface: Drawn) -> Shape:
    """One mode as set 55: frequency [Hz], modal mass 1, no damping."""
    n = int(modes.nodal_diameters[mode])
    label = f"n = {n}, m = {int(modes.meridional[mode])}" if n >= 0 else "NONE"
    return Shape(
        text=(f"mode {mode + 1}", label, "NONE", "NONE", "NONE"),
        model=STRUCTURAL,
        analysis=NORMAL_MODE,
        characteristic=TRANSLATIONS,
        quantity=DISPLACEMENT,
        integers=(1, mode + 1),
        reals=(float(modes.freq[mode]), 1.0, 0.0, 0.0),
        nodes=surface.labels,
        values=modes.fields[surface.rows, :3, mode],
    )
