"""Cylinders between shear diaphragms: 650 frequencies against 3-D elasticity, on one fixed mesh.

`python -m reports.verification.cylinder [--quick] [--out DIR]` prints the summary and writes cylinder.csv (every row)
and cylinder_summary.csv. Reference: data/reference/cyl_shear_diaphragm_exact.csv; R = 1, E = 1, rho such that
omega is the table's frequency factor. Beside this project's shell stand its linear wall (`Shell.wall`) and the gaps of
Fluegge's and Donnell's thin-shell theories, from the same table. --quick takes every fourth n.
"""

from pathlib import Path

import numpy as np
import pandas as pd

from casingfem.modal.fourier import lowest
from casingfem.structure.edge.support import ShearDiaphragm
from casingfem.structure.geometry.chart import Cylinder
from casingfem.structure.material import Material
from casingfem.structure.mesh.shell_mesh import ShellMesh
from casingfem.structure.shell.axisymmetric import harmonic_matrices
from casingfem.structure.shell.shell import Shell
from reports.tables import DATA, Row, command_line, show, write
from reports.verification.cylinder_exact import shear_shell

REFERENCE = DATA / "reference" / "cyl_shear_diaphragm_exact.csv"
FIXED = ShellMesh(order=8, rows=3, around=1)
MATERIAL = Material(E=1.0, nu=0.3, rho=1.0 / (1.0 - 0.3**2))
WITHIN = 1e-3
CANDIDATES = 12  # lowest modes of one n among which the row's own is found: with short ends, torsion comes first


def cylinder(h_over_r: float, l_over_r: float, mesh: ShellMesh = FIXED, wall: str = "curved") -> Shell:
    """The table's cylinder, R = 1."""
    ends = {"base": ShearDiaphragm(), "top": ShearDiaphragm()}
    return Shell(
        chart=Cylinder(radius=1.0, height=l_over_r),
        thickness=h_over_r,
        material=MATERIAL,
        supports=ends,
        wall=wall,
        mesh=mesh,
    )


def errors(table: pd.DataFrame, mesh: ShellMesh = FIXED, wall: str = "curved") -> pd.DataFrame:
    """Rows of the table with the relative errors of this shell, Fluegge and Donnell against 3-D.

    The table has the lowest root of each (n, m). A row's own mode is the computed one nearest to the exact solution of
    the shell's own theory: nearest to 3-D it may be the mode of another m, where the theory is off by their distance.
    """
    parts = []
    for (h, length, n), rows in table.groupby(["h_over_R", "L_over_R", "n"]):
        values, _ = lowest(harmonic_matrices(cylinder(h, length, mesh, wall), n), CANDIDATES, 1e-6)
        found = np.sqrt(np.maximum(values, 0.0))
        exact = rows.omega_3d.to_numpy()
        theory = np.array([shear_shell(h, length, int(n), int(m), wall) for m in rows.m])
        nearest = found[np.abs(found[:, None] - theory).argmin(axis=0)]
        parts.append(
            rows[["h_over_R", "L_over_R", "n", "m", "omega_3d"]].assign(
                omega=nearest,
                error=nearest / exact - 1.0,
                fluegge=rows.omega_fluegge / exact - 1.0,
                donnell=rows.omega_donnell / exact - 1.0,
            )
        )
    return pd.concat(parts)


def summary(found: pd.DataFrame) -> list[Row]:
    """One row for each h/R: rows within 0.1 %, and the worst errors in per cent with their rows."""
    rows: list[Row] = []
    for h, part in found.groupby("h_over_R"):
        worst = part.loc[part.error.abs().idxmax()]
        rows.append(
            {
                "h/R": float(h),
                "rows": len(part),
                "within 0.1 %": int(np.count_nonzero(part.error.abs() < WITHIN)),
                "worst %": 100.0 * float(part.error.abs().max()),
                "at L/R": float(worst.L_over_R),
                "n": int(worst.n),
                "m": int(worst.m),
                "linear worst %": 100.0 * float(part.linear.abs().max()),
                "linear within": int(np.count_nonzero(part.linear.abs() < WITHIN)),
                "Fluegge worst %": 100.0 * float(part.fluegge.abs().max()),
                "Fluegge within": int(np.count_nonzero(part.fluegge.abs() < WITHIN)),
                "Donnell worst %": 100.0 * float(part.donnell.abs().max()),
            }
        )
    return rows


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the summary and write both tables."""
    table = pd.read_csv(REFERENCE, comment="#")
    if quick:
        table = table[table.n % 4 == 0]
    found = errors(table)
    found["linear"] = errors(table, wall="linear").error
    rows = summary(found)
    show(f"Cylinders between shear diaphragms against 3-D, order {FIXED.order}, {FIXED.rows} rows", rows)
    thin = found[found.h_over_R <= 0.02]
    good = np.count_nonzero(thin.error.abs() < WITHIN)
    print(f"h/R <= .02: {good} of {len(thin)} rows within 0.1 %, worst {100 * thin.error.abs().max():.3f} %")
    write(out / "cylinder_summary.csv", rows)
    found.to_csv(out / "cylinder.csv", index=False)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
