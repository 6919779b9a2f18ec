"""Reference frustum: error against 3-D elasticity and time, over orders and meshes; the default mesh is marked.

`python -m reports.verification.modes.frustum [--quick] [--out DIR]` prints the table, best first, and writes
frustum_convergence.csv. 40 modes; the error is the largest relative one against the 3-D column of
data/reference/reference_frustum.csv. "graded" gives the free edge's shear layer a row of its own. Seconds are
of one run each, BLAS as the machine has it: read them as ratios. --quick takes three meshes.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pandas as pd

from casingfem.io.arrays import FloatArray
from casingfem.modal.modes import Modes, modes
from casingfem.structure.edge.support import Clamped
from casingfem.structure.geometry.chart import Frustum
from casingfem.structure.material import Material
from casingfem.structure.mesh.shell_mesh import ShellMesh
from casingfem.structure.shell.shell import Shell
from reports.tables import DATA, Row, command_line, show, write

REFERENCE = DATA / "reference" / "reference_frustum.csv"
COUNT = 40
BOTH = (0.0, 0.03, 0.97, 1.0)


def reference_frustum(mesh: ShellMesh | None = None) -> Shell:
    """The frustum of the reference table."""
    return Shell(
        chart=Frustum(r_base=0.50, r_top=0.45, height=0.25),
        thickness=3e-3,
        material=Material(E=210e9, nu=0.3, rho=7800.0),
        supports={"base": Clamped()},
        **({} if mesh is None else {"mesh": mesh}),
    )


GRADED = reference_frustum().mesh.rows
ROWS: dict[str, int | tuple[float, ...]] = {"1": 1, "2": 2, "4": 4, "graded": GRADED, "graded both": BOTH}


def exact_frequencies() -> FloatArray:
    """The first 40 frequencies of the table's 3-D column [Hz], doublets twice."""
    table = pd.read_csv(REFERENCE, comment="#")
    branches = table[["f1_3d", "f2_3d", "f3_3d"]].to_numpy()
    return np.sort(np.repeat(branches, np.where(table.n == 0, 1, 2), axis=0).ravel())[:COUNT]


def meshes(quick: bool) -> Iterator[tuple[str, ShellMesh]]:
    """Row scheme and mesh, each with about 8 to 10 nodes a wave at n = 16; the default comes first."""
    default = reference_frustum().mesh
    yield next(name for name, rows in ROWS.items() if rows == default.rows), default
    if quick:
        choices = [(6, "1", 21), (8, "1", 17)]
    else:
        choices = [(order, name, 2 * (74 // order) + 1) for order in range(4, 11) for name in ("1", "graded")]
        choices += [(4, "4", 37), (6, "2", 25), (8, "2", 19), (7, "graded", 25), (8, "graded both", 19)]
        choices += [(order, name, 2 * (56 // order) + 1) for order in (6, 8, 10) for name in ("1", "graded")]
    for order, name, around in choices:
        mesh = ShellMesh(order=order, rows=ROWS[name], around=around)
        if mesh != default:
            yield name, mesh


def measured(method: str, rows: str, found: Modes, exact: FloatArray, default: bool) -> Row:
    """One row of the table."""
    mesh, seconds = found.shell.mesh, found.seconds
    return {
        "method": method,
        "order": mesh.order,
        "rows": rows,
        "around": mesh.around if method == "shell" else None,
        "dofs": found.dofs,
        "worst error": float(np.abs(found.freq / exact - 1.0).max()),
        "rms error": float(np.sqrt(np.mean((found.freq / exact - 1.0) ** 2))),
        "doublet gap": float(found.splits.max()),
        "sturm": found.sturm_count,
        "assemble s": seconds.get("assemble", 0.0),
        "solve s": seconds["solve"],
        "label s": seconds["label"],
        "total s": sum(seconds.values()),
        "": "<- default" if default else "",
    }


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the table, best first, and write it."""
    exact = exact_frequencies()
    modes(reference_frustum(ShellMesh(order=4, rows=1, around=5)), 4, method="shell")  # imports and caches
    rows = []
    default = reference_frustum().mesh
    for name, mesh in meshes(quick):
        shell = reference_frustum(mesh)
        rows.append(measured("shell", name, modes(shell, COUNT, method="shell"), exact, mesh == default))
        if mesh == default or mesh.order % 2 == 0:
            rows.append(measured("fourier", name, modes(shell, COUNT, method="fourier"), exact, mesh == default))
    unique = {(row["method"], row["order"], row["rows"], row["around"]): row for row in reversed(rows)}
    rows = sorted(unique.values(), key=lambda row: (str(row["method"]), float(str(row["worst error"]))))
    show(f"Reference frustum, {COUNT} modes against 3-D elasticity", rows)
    write(out / "frustum_convergence.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
