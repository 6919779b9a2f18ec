"""Conical frusta with five pairs of ends: 880 frequencies against Love's thin-shell theory, on one fixed mesh.

`python -m reports.verification.cone [--quick] [--out DIR]` prints one row for each half angle and pair of ends, and
writes cone_summary.csv and cone.csv (every row). Reference: data/reference/cone_love_ritz_irie_set.csv; R2 = 1, E = 1,
rho such that omega is the table's frequency factor. Beside this project's shell stands its limit of thin shells, whose
wall is linear, in which transverse shear is stiff and the rotations have no inertia: what it meets and the shell does
not is Love's own gap. --quick takes every fifth n.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd

from casingfem.io.arrays import FloatArray
from casingfem.modal.fourier import lowest
from casingfem.structure.edge.support import Clamped, ShearDiaphragm, Support
from casingfem.structure.geometry.chart import Frustum
from casingfem.structure.material import Material
from casingfem.structure.mesh.kinematics import DOFS
from casingfem.structure.mesh.shell_mesh import ShellMesh
from casingfem.structure.shell.axisymmetric import Meridian, harmonic_matrices
from casingfem.structure.shell.shell import Shell
from reports.tables import DATA, Row, command_line, show, write

REFERENCE = DATA / "reference" / "cone_love_ritz_irie_set.csv"
FIXED = ShellMesh(
    order=8, rows=(0.0, 0.04, 0.5, 0.96, 1.0), around=1
)  # free edges' shear layers have rows of their own
MATERIAL = Material(E=1.0, nu=0.3, rho=1.0 / (1.0 - 0.3**2))
THICKNESS = 0.01
WITHIN = 3e-3
RIGID = 1e-4  # the lowest elastic factor is 60 times as high
STIFF = 1e3  # shear correction of the thin limit
LIGHT = 1e-3  # what is left of the rotary inertia there
ENDS: dict[str, Support] = {"C": Clamped(), "S3": ShearDiaphragm()}
CASE = ["alpha_deg", "Lsina_over_R2", "bc_small", "bc_large"]


def cone(alpha_deg: float, l_sin_alpha: float, small: str, large: str, mesh: ShellMesh = FIXED) -> Shell:
    """The table's frustum, R2 = 1: small end below, large end on top."""
    pairs = (("base", small), ("top", large))
    height = l_sin_alpha / float(np.tan(np.radians(alpha_deg)))
    return Shell(
        chart=Frustum(r_base=1.0 - l_sin_alpha, r_top=1.0, height=height),
        thickness=THICKNESS,
        material=MATERIAL,
        supports={edge: ENDS[name] for edge, name in pairs if name != "F"},
        mesh=mesh,
    )


def thin_limit(shell: Shell, n: int) -> Meridian:
    """Matrices of one harmonic, linear wall without transverse shear and rotary inertia: Love's theory."""
    meridian = harmonic_matrices(replace(shell, shear_correction=STIFF, wall="linear"), n)
    rotations = meridian.free % DOFS > 2
    return replace(meridian, mass=np.where(rotations, LIGHT, 1.0) * meridian.mass)


def elastic_factors(meridian: Meridian, count: int = 2) -> FloatArray:
    """Lowest elastic frequency factors of one harmonic; n = 0 without the torsional modes, which uncouple."""
    values, vectors = lowest(meridian, count + 6, 1e-6)
    found = np.sqrt(np.maximum(values, 0.0))
    keep = found > RIGID
    if meridian.n == 0:
        size = np.abs(meridian.expand(vectors)[:, :3]).max(axis=0)
        keep &= size[1] < np.maximum(size[0], size[2])
    return np.asarray(found[keep][:count])


def errors(table: pd.DataFrame, mesh: ShellMesh = FIXED) -> pd.DataFrame:
    """Rows of the table with the relative errors of the shell and of its thin limit."""
    parts = []
    for (alpha, length, small, large, n), rows in table.groupby([*CASE, "n"]):
        shell, rank = cone(alpha, length, small, large, mesh), rows.m.to_numpy() - 1
        found, thin = elastic_factors(harmonic_matrices(shell, n)), elastic_factors(thin_limit(shell, n))
        parts.append(
            rows.assign(
                found=found[rank],
                error=found[rank] / rows["lambda"] - 1.0,
                thin=thin[rank] / rows["lambda"] - 1.0,
            )
        )
    return pd.concat(parts)


def summary(found: pd.DataFrame) -> list[Row]:
    """One row for each half angle and pair of ends: worst errors in per cent, and where."""
    rows: list[Row] = []
    for (alpha, small, large), part in found.groupby(["alpha_deg", "bc_small", "bc_large"]):
        worst = part.loc[part.error.abs().idxmax()]
        rows.append(
            {
                "alpha": float(alpha),
                "ends": f"{small}-{large}",
                "rows": len(part),
                "within 0.3 %": int(np.count_nonzero(part.error.abs() < WITHIN)),
                "worst %": 100.0 * float(worst.error),
                "n": int(worst.n),
                "m": int(worst.m),
                "thin limit within": int(np.count_nonzero(part.thin.abs() < WITHIN)),
                "thin limit worst %": 100.0 * float(part.thin.abs().max()),
            }
        )
    return rows


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the summary and write both tables."""
    table = pd.read_csv(REFERENCE, comment="#")
    if quick:
        table = table[table.n % 5 == 0]
    found = errors(table)
    rows = summary(found)
    show(f"Conical frusta against Love's theory, order {FIXED.order}, {len(FIXED.breaks) - 1} rows", rows)
    good, thin = (int(np.count_nonzero(error.abs() < WITHIN)) for error in (found.error, found.thin))
    print(f"within 0.3 %: {good} of {len(found)}; without shear and rotary inertia {thin}, worst "
          f"{100 * found.thin.abs().max():.3f} %")  # fmt: skip
    write(out / "cone_summary.csv", rows)
    found.to_csv(out / "cone.csv", index=False)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
