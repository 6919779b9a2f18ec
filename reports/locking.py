"""Locking: thin shells, R/t from 100 to 10,000, order and mesh against the converged solution; doublets of each.

`python -m reports.locking [--quick] [--out DIR]` takes the reference frustum's cone at four thicknesses, its first 40
modes. The reference is the same theory by harmonics, order 14 on eight graded rows: refining it to order 16 moves
nothing by more than the table's last column. Rows: the default mesh by the two-dimensional shell, and orders 3 to 9 by
harmonics, two rows each. The doublet gap is that of the two-dimensional shell; by harmonics doublets are exact.
--quick leaves out R/t above 1,000, most orders and the two-dimensional shell. It writes locking.csv.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

from casingfem.arrays import FloatArray
from casingfem.modal.modes import modes
from casingfem.structure.chart import Frustum
from casingfem.structure.material import Material
from casingfem.structure.mesh import ShellMesh
from casingfem.structure.shell import Shell
from casingfem.structure.support import Clamped
from reports.tables import Row, command_line, show, write

COUNT, RADIUS = 40, 0.5
SLENDERNESS = (100, 1_000, 3_000, 10_000)
ORDERS = (3, 4, 5, 6, 7, 9)


def casing(ratio: float, mesh: ShellMesh | None = None) -> Shell:
    """The cone of the reference frustum, R/t = ratio, clamped at its base."""
    shell = Shell(
        chart=Frustum(r_base=RADIUS, r_top=0.45, height=0.25),
        thickness=RADIUS / ratio,
        material=Material(E=210e9, nu=0.3, rho=7800.0),
        supports={"base": Clamped()},
    )
    return shell if mesh is None else replace(shell, mesh=mesh)


def graded(ratio: float, order: int) -> ShellMesh:
    """Rows graded to both edges: the wall's thickness, the bending length sqrt(R t), the inside."""
    wall, bending = 4.0 / ratio, 4.0 * 2.0 / np.sqrt(ratio)
    low = [wall, min(bending, 0.25)]
    breaks = (0.0, *low, 0.5, *(1.0 - x for x in reversed(low)), 1.0)
    return ShellMesh(order=order, rows=tuple(float(x) for x in breaks), around=21)


def harmonic(ratio: float, mesh: ShellMesh) -> FloatArray:
    """First frequencies by harmonics."""
    return modes(casing(ratio, mesh), COUNT, method="fourier").freq


def worst(found: FloatArray, exact: FloatArray) -> float:
    """Largest relative error."""
    return float(np.abs(found / exact - 1.0).max())


def one_thickness(ratio: float, quick: bool) -> list[Row]:
    """The rows of one R/t."""
    exact = harmonic(ratio, graded(ratio, 14))
    sure = worst(harmonic(ratio, graded(ratio, 16)), exact)
    common: Row = {"R/t": ratio}
    rows: list[Row] = []
    default = casing(ratio).mesh
    found = modes(casing(ratio), COUNT, method="fourier" if quick else "shell")
    gap = None if quick else float(found.splits.max())
    rows.append(common | {"mesh": "default", "order": default.order, "rows": len(default.breaks) - 1,
                          "around": default.around, "worst error": worst(found.freq, exact),
                          "doublet gap": gap, "reference moves": sure})  # fmt: skip
    for order in ORDERS[::4] if quick else ORDERS:
        error = worst(harmonic(ratio, ShellMesh(order=order, rows=2, around=21)), exact)
        rows.append(common | {"mesh": "two rows", "order": order, "rows": 2, "around": None, "worst error": error,
                              "doublet gap": 0.0, "reference moves": sure})  # fmt: skip
    return rows


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the table and write it."""
    rows = [row for ratio in (SLENDERNESS[:2] if quick else SLENDERNESS) for row in one_thickness(ratio, quick)]
    show(f"Thin frusta, {COUNT} modes against the converged solution of the same theory", rows)
    write(out / "locking.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
