"""Elements around a frustum with waves in its radius: error, splits that symmetry forbids, effect of a rotation, time.

`python -m reports.verification.modes.around [--quick] [--out DIR]` takes the frustum of data/studies/frustum.toml. Its
radius has 8, 20 and 4 waves, whose common period is 4: a pair of n nodal diameters with odd n must stay double. The
table has meshes of several orders and numbers of elements around. "error" is the largest relative one of 40 frequencies
against order 9 with 61 elements around and four times the rows. "forbidden" is the largest relative split of odd pairs.
"turned" is the largest change of a frequency when the waves are turned by 0.4567 and 2 rad. "time" is processor time
over that of the default mesh, in turns. Writes around.csv.
"""

import time
from collections.abc import Iterable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from casingfem.io.arrays import FloatArray
from casingfem.modal.modes import Modes, modes
from casingfem.structure.field.fourier import FourierField
from casingfem.structure.mesh.shell_mesh import ShellMesh
from casingfem.structure.shell.shell import Shell
from reports.tables import Row, command_line, show, write
from reports.verification.modes.frustum import COUNT, reference_frustum

WAVES = FourierField.of({8: 0.004, 20: 0.003, 4: (0.0019, 0.0006)})
PERIOD = 4
ANGLES = (0.4567, 2.0)  # rad
MESHES = ((7, 41), (7, 25), (7, 28), (7, 33), (7, 36), (7, 44), (8, 25), (8, 28), (8, 29), (9, 24))  # order, around
QUICK = ((7, 33), (7, 28))


def wavy(order: int, around: int, rows: Iterable[float], field: FourierField = WAVES) -> Shell:
    """The frustum with waves in its radius on a mesh."""
    mesh = ShellMesh(order=order, rows=tuple(rows), around=around)
    return replace(reference_frustum(), radius_defect=field, mesh=mesh)


def solved(shell: Shell) -> tuple[Modes, float]:
    """Modes, and the processor time they take [s]."""
    begun = time.process_time()
    found = modes(shell, COUNT, method="shell")
    return found, time.process_time() - begun


def finest(rows: FloatArray) -> FloatArray:
    """Frequencies of the finest mesh [Hz]."""
    inner = np.concatenate([np.linspace(low, high, 5)[:-1] for low, high in pairwise(rows.tolist())])
    return modes(wavy(9, 61, [*inner.tolist(), 1.0]), COUNT, method="shell").freq


def row_of(order: int, around: int, rows: FloatArray, default: ShellMesh, exact: FloatArray | None) -> Row:
    """A row of the table."""
    spent: list[tuple[float, float]] = []
    for _ in range(2):
        found, mine = solved(wavy(order, around, rows))
        spent.append((mine, solved(wavy(default.order, default.around, rows))[1]))
    turned = [modes(wavy(order, around, rows, WAVES.rotated(angle)), COUNT, method="shell").freq for angle in ANGLES]
    odd = np.array([2 * found.nodal_diameters[low] % PERIOD != 0 for low, _ in found.doublets])
    return {
        "order": order, "around": around, "unknowns": found.dofs,
        "error": None if exact is None else float(np.abs(found.freq / exact - 1.0).max()),
        "forbidden": float(found.splits[odd].max()), "allowed": float(found.splits[~odd].max()),
        "turned": max(float(np.abs(freq / found.freq - 1.0).max()) for freq in turned),
        "time": min(mine for mine, _ in spent) / min(theirs for _, theirs in spent),
    }  # fmt: skip


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the table and write it; the quick one has no errors."""
    plain = reference_frustum()
    default = Shell(chart=plain.chart, thickness=plain.thickness, material=plain.material, supports=plain.supports,
                    radius_defect=WAVES).mesh  # fmt: skip
    exact = None if quick else finest(default.breaks)
    rows = [row_of(order, around, default.breaks, default, exact) for order, around in (QUICK if quick else MESHES)]
    show(f"Frustum with 8, 20 and 4 waves; default: order {default.order}, {default.around} around", rows)
    write(out / "around.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
