"""Locking: thin shells, R/t from 100 to 10,000, three meshes against the converged solution; doublets of each.

`python -m reports.verification.modes.locking [--quick] [--out DIR]` takes the reference frustum's cone at five
thicknesses, its first 40 modes, by the two-dimensional shell and by harmonics: on the default mesh, and on two rows of
orders 8 and 3 with as many nodes around; order 3 locks. The reference is the same theory by harmonics, order 10 on
graded rows; the table's last column is what order 9 changes there. The doublet gap is the two-dimensional shell's,
whose members are computed apart; by harmonics they are equal. --quick takes two thicknesses, 12 modes and harmonics
alone. It writes locking.csv.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

from casingfem.io.arrays import FloatArray
from casingfem.modal.modes import modes
from casingfem.structure.edge.support import Clamped
from casingfem.structure.geometry.chart import Frustum
from casingfem.structure.material import Material
from casingfem.structure.mesh.shell_mesh import ShellMesh
from casingfem.structure.shell.shell import Shell
from reports.tables import Row, command_line, show, write

COUNT, RADIUS = 40, 0.5
SLENDERNESS = (100, 167, 1_000, 3_000, 10_000)


def casing(ratio: float) -> Shell:
    """The cone of the reference frustum, R/t = ratio, clamped at its base."""
    return Shell(
        chart=Frustum(r_base=RADIUS, r_top=0.45, height=0.25),
        thickness=RADIUS / ratio,
        material=Material(E=210e9, nu=0.3, rho=7800.0),
        supports={"base": Clamped()},
    )


def graded(ratio: float, order: int) -> ShellMesh:
    """Rows graded to both edges: the wall's thickness, the bending length sqrt(R t), the inside."""
    wall, bending = 4.0 / ratio, 4.0 * 2.0 / np.sqrt(ratio)
    low = [wall, min(bending, 0.25)]
    breaks = (0.0, *low, 0.5, *(1.0 - x for x in reversed(low)), 1.0)
    return ShellMesh(order=order, rows=tuple(float(x) for x in breaks), around=21)


def two_rows(shell: Shell, order: int) -> ShellMesh:
    """Two equal rows of an order, with the nodes around that the shell's own mesh has."""
    nodes = shell.mesh.order * shell.mesh.columns
    return ShellMesh(order=order, rows=2, around=2 * (nodes // (2 * order)) + 1)


def harmonic(shell: Shell, count: int) -> FloatArray:
    """First frequencies by harmonics [Hz]."""
    return modes(shell, count, method="fourier").freq


def worst(found: FloatArray, exact: FloatArray) -> float:
    """Largest relative error."""
    return float(np.abs(found / exact - 1.0).max())


def one_thickness(ratio: float, quick: bool) -> list[Row]:
    """The rows of one R/t."""
    shell, count = casing(ratio), 12 if quick else COUNT
    exact, below = (harmonic(replace(shell, mesh=graded(ratio, order)), count) for order in (10, 9))
    rows: list[Row] = []
    for name, mesh in {
        "default": shell.mesh,
        "two rows": two_rows(shell, 8),
        "two low rows": two_rows(shell, 3),
    }.items():
        on = replace(shell, mesh=mesh)
        found = None if quick else modes(on, count, method="shell")
        rows.append(
            {
                "R/t": ratio,
                "mesh": name,
                "order": mesh.order,
                "rows": len(mesh.breaks) - 1,
                "around": mesh.columns,
                "unknowns": found and found.dofs,
                "2-D shell": found and worst(found.freq, exact),
                "harmonics": worst(harmonic(on, count), exact),
                "doublet gap": found and float(found.splits.max()),
                "reference moves": worst(below, exact),
            }
        )
    return rows


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the table and write it."""
    rows = [row for ratio in (SLENDERNESS[::2][:2] if quick else SLENDERNESS) for row in one_thickness(ratio, quick)]
    show("Thin frusta, worst error of the first modes against the converged solution of the same theory", rows)
    write(out / "locking.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
