"""Pretwisted cantilever plates: 160 frequencies against 3-D elasticity, on one fixed mesh.

`python -m reports.verification.twisted_plate [--quick] [--out DIR]` prints one row for each plate and writes
twisted_plate.csv. Reference: data/reference/twisted_plate_3d.csv, chord 1, E = 1, rho = 1. A second table says what the
shell's gap is made of: solids (one spectral hexahedron, computed here) whose sections are turned, as the reference's
are, and whose thickness is laid along the normal, as a shell's is. --quick takes the thin plates and no solids.
"""

from pathlib import Path

import numpy as np
import pandas as pd

from casingfem.io.arrays import FloatArray
from casingfem.modal.modes import modes
from casingfem.structure.edge.support import Clamped
from casingfem.structure.geometry.blade import TwistedPlate
from casingfem.structure.material import Material
from casingfem.structure.mesh.shell_mesh import ShellMesh
from casingfem.structure.shell.shell import Shell
from reports.tables import DATA, Row, command_line, show, write
from reports.verification.spectral_solid import solid_modes, unit_cube

REFERENCE = DATA / "reference" / "twisted_plate_3d.csv"
FIXED = ShellMesh(order=12, rows=1, around=1)
MATERIAL = Material(E=1.0, nu=0.3, rho=1.0)
MODES = 8
WITHIN = 5e-3
CASE = ["a_over_b", "b_over_h", "twist_deg"]


def blade(a_over_b: float, b_over_h: float, twist_deg: float, *, section: bool = True, **changes: object) -> Shell:
    """The table's plate, chord 1; its thickness measured in the section, or else along the normal."""
    chart = TwistedPlate(length=float(a_over_b), width=1.0, twist=float(np.radians(twist_deg)))
    parts: dict[str, object] = {"mesh": FIXED, "thickness_defect": chart.section_thickness if section else None}
    return Shell(
        chart=chart, thickness=1.0 / b_over_h, material=MATERIAL, supports={"root": Clamped()}, **(parts | changes)
    )


def factors(omega: FloatArray, a_over_b: float, b_over_h: float) -> FloatArray:
    """Frequency factors omega a^2 sqrt(rho h/D)."""
    rigidity = b_over_h**-3.0 / (12.0 * (1.0 - MATERIAL.nu**2))
    return np.asarray(omega * a_over_b**2 * np.sqrt(1.0 / b_over_h / rigidity))


def errors(table: pd.DataFrame, **changes: object) -> pd.DataFrame:
    """Rows of the table with the relative errors of the shell."""
    parts = []
    for (a, h, twist), rows in table.groupby(CASE):
        found = factors(modes(blade(a, h, twist, **changes), MODES).omega, a, h)[rows["mode"].to_numpy() - 1]
        parts.append(rows.assign(found=found, error=found / rows["lambda"] - 1.0))
    return pd.concat(parts)


def solid(
    a_over_b: float, b_over_h: float, twist_deg: float, *, section: bool, orders: tuple[int, int, int] = (13, 13, 3)
) -> FloatArray:
    """Frequency factors of the solid plate: one spectral hexahedron, its rule's points the nodes.

    X = (x, y c - z s, y s + z c) with turned sections, X = (x, y c, y s) + z n along the normal, where z spans the
    section's thickness times (1 + (rate y)^2)^(-1/2), as the shell has it.
    """
    x, y, z = unit_cube(orders) - np.array([[0.0], [0.5], [0.5]])
    x, z = a_over_b * x, z / b_over_h
    rate = np.radians(twist_deg) / a_over_b
    c, s, lean = np.cos(rate * x), np.sin(rate * x), 1.0 / np.sqrt(1.0 + (rate * y) ** 2)
    through = np.array([0.0 * x, -s, c]) if section else lean**2 * np.array([-rate * y, -s, c])
    omega = solid_modes(np.array([x, y * c, y * s]) + z * through, x == 0.0, orders, MATERIAL, MODES)
    return factors(omega, a_over_b, b_over_h)


def summary(found: pd.DataFrame) -> list[Row]:
    """One row for each plate: worst error, where it is, modes within 0.5 %."""
    rows: list[Row] = []
    for (a, h, twist), part in found.groupby(CASE):
        worst = part.loc[part.error.abs().idxmax()]
        within = int(np.count_nonzero(part.error.abs() < WITHIN))
        rows.append(
            {"a/b": float(a), "b/h": float(h), "twist deg": float(twist), "modes": len(part), "within 0.5 %": within,
             "worst %": 100.0 * float(worst.error), "mode": int(worst["mode"])}
        )  # fmt: skip
    return rows


def anatomy(table: pd.DataFrame, a_over_b: float, b_over_h: float, twist_deg: float) -> list[Row]:
    """Mode by mode, in per cent: what the shell's gap to the reference is made of."""
    case = (a_over_b, b_over_h, twist_deg)
    rows = table[(table[CASE].to_numpy() == np.array(case)).all(axis=1)]
    exact = rows["lambda"].to_numpy()
    turned, normal = solid(*case, section=True), solid(*case, section=False)
    shell, full = (factors(modes(blade(*case, section=s), MODES).omega, *case[:2]) for s in (True, False))
    columns = {
        "shell / table": shell / exact,
        "solid, turned sections / table": turned / exact,
        "solid along the normal / turned": normal / turned,
        "shell / solid along the normal": shell / normal,
        "h along the normal instead": full / shell,
    }
    return [
        {"mode": k + 1} | {name: 100.0 * float(ratio[k] - 1.0) for name, ratio in columns.items()} for k in range(MODES)
    ]


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print both tables and write them."""
    table = pd.read_csv(REFERENCE, comment="#")
    found = errors(table[table.b_over_h == 20] if quick else table)
    rows = summary(found)
    show(f"Pretwisted plates against 3-D elasticity, order {FIXED.order}, one element", rows)
    thin = found[found.b_over_h == 20]
    good = int(np.count_nonzero(thin.error.abs() < WITHIN))
    print(f"b/h = 20: {good} of {len(thin)} rows within 0.5 %, worst {100 * thin.error.abs().max():.2f} %")
    if not quick:
        parts = anatomy(table, 1, 20, 60)
        show("a/b = 1, b/h = 20, twist 60 degrees: what the gap is made of, per cent", parts)
        write(out / "twisted_plate_gap.csv", parts)
    write(out / "twisted_plate.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
