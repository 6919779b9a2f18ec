"""Verification: every published, exact or independent reference of a structure in one table.

`python -m reports.verification [--quick] [--out DIR]` prints and writes verification.csv: case, source, reference,
computed, error and allowed error in per cent, and the verdict: pass, or the reason why not. A row over several
frequencies shows the worst of them. A reason holds up to a bound of its own; beyond it the verdict is FAIL. The
tables row by row: reports.cylinder, reports.cone, reports.twisted_plate, reports.splitting. --quick takes a subset.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd

from casingfem.modal.fourier import lowest
from casingfem.modal.modes import modes
from casingfem.structure.axisymmetric import harmonic_matrices
from casingfem.structure.chart import Cylinder, Panel, Plate
from casingfem.structure.material import Material
from casingfem.structure.mesh import ShellMesh
from casingfem.structure.shell import Shell
from casingfem.structure.support import Clamped, ShearDiaphragm
from reports import (
    cone,
    cylinder,
    splitting,
    twisted_plate,
    verify_blades,
    verify_contact,
    verify_fields,
    verify_imported,
    verify_interaction,
    verify_locking,
    verify_rig,
    verify_rings,
    verify_rotation,
    verify_static,
    verify_strips,
)
from reports.frustum_convergence import reference_frustum
from reports.tables import DATA, Row, check, command_line, show, write

NAFEMS = Material(E=200e9, nu=0.3, rho=8000.0)
SQUARE = Plate(length=10.0, width=10.0)
ONE = ShellMesh(order=12, rows=1, around=1)
FINE = ShellMesh(order=10, rows=3, around=3)
EDGES = ShellMesh(order=12, rows=(0.0, 0.02, 0.5, 0.98, 1.0), around=4)


def reference(name: str) -> pd.DataFrame:
    """A table of data/reference."""
    return pd.read_csv(DATA / "reference" / name, comment="#")


def worst(part: pd.DataFrame) -> pd.Series:
    """The row with the largest error."""
    return part.loc[part.error.abs().idxmax()]


def frustum() -> list[Row]:
    """A0: the 20 doublets of the reference frustum against 3-D elasticity."""
    table = reference("reference_frustum.csv").set_index("n")
    found = modes(reference_frustum(), 40)
    rows = []
    for low, _ in found.doublets:
        n, m = int(found.nodal_diameters[low]), int(found.meridional[low])
        exact = float(table.loc[n, f"f{m}_3d"])
        rows.append(check(f"A0 frustum, n = {n}, m = {m}", "3-D elasticity", exact, float(found.freq[low]), 0.1))
    return rows


def cylinders(quick: bool) -> list[Row]:
    """A1: the worst row of each h/R and L/R; beyond h/R = .02 shell theory itself ends."""
    table = reference("cyl_shear_diaphragm_exact.csv")
    found = cylinder.errors(table[table.n % 4 == 0] if quick else table)
    gaps = {0.02: 0.19, 0.05: 1.2, 0.1: 4.5}
    rows = []
    for (h, length), part in found.groupby(["h_over_R", "L_over_R"]):
        row = worst(part)
        rows.append(
            check(
                f"A1 cylinder, h/R {h:g}, L/R {length:g}, worst of {len(part)}: n = {row.n:.0f}, m = {row.m:.0f}",
                "3-D elasticity",
                row.omega_3d,
                row.omega,
                0.1,
                gap=gaps.get(h, 0.0),
                reason=f"first-order shear theory, short waves in a thick wall; Fluegge {100 * row.fluegge:.2g} %",
            )
        )
    return rows


def cones(quick: bool) -> list[Row]:
    """A2: the worst row of each half angle and pair of ends, and of the thin limit over all."""
    table = reference("cone_love_ritz_irie_set.csv")
    found = cone.errors(table[table.n % 5 == 0] if quick else table)
    rows = []
    for (alpha, small, large), part in found.groupby(["alpha_deg", "bc_small", "bc_large"]):
        row, thin = worst(part), 100.0 * float(part.thin.abs().max())
        rows.append(
            check(
                f"A2 cone {alpha} deg, {small}-{large}, worst of {len(part)}: n = {row.n}, m = {row.m}",
                "Love, Ritz",
                row["lambda"],
                row.found,
                0.3,
                gap=2.2 if thin <= 0.1 else 0.0,
                reason=f"Love's gap: without shear and rotary inertia {thin:.2f} %",
            )
        )
    row = found.loc[found.thin.abs().idxmax()]
    computed = float(row["lambda"] * (1.0 + row.thin))
    case = f"A2 all {len(found)} rows without shear and rotary inertia, the worst"
    return [*rows, check(case, "Love, Ritz", row["lambda"], computed, 0.3)]


def blade(quick: bool) -> list[Row]:
    """A3: the fan blade as it comes against the seven converged values, and in the limit of thin shells."""
    exact = reference("olson_lindberg_fan_blade.csv").computed_love_ritz_hz.to_numpy()
    material = Material(E=206.85e9, nu=0.3, rho=7857.2)
    shell = Shell(
        chart=Panel(radius=0.6096, length=0.3048, angle=0.5),
        thickness=3.048e-3,
        material=material,
        supports={"root": Clamped()},
    )
    found = modes(shell, 7).freq
    rows = [check(f"A3 fan blade, mode {k + 1}", "Love, Ritz", exact[k], found[k], 0.3) for k in range(7)]
    if not quick:
        thin = Shell(
            chart=shell.chart, thickness=shell.thickness, material=material, supports=shell.supports,
            shear_correction=100.0, mesh=FINE,
        )  # fmt: skip
        found = modes(thin, 12).freq
        rows += [
            check(f"A3 fan blade, shear made stiff, mode {k + 1}", "Love, Ritz", exact[k], found[k], 0.1)
            for k in range(12)
        ]
        found = modes(replace(shell, mesh=EDGES), 7).freq
        k = int(np.abs(found / exact[:7] - 1.0).argmax())
        case = f"A3 fan blade, free-edge layers resolved, worst of 7: mode {k + 1}"
        reason = "thin-shell theory has no shear layer at free edges"
        rows.append(check(case, "Love, Ritz", exact[k], found[k], 0.3, gap=0.45, reason=reason))
    return rows


def twisted(quick: bool) -> list[Row]:
    """A4: the worst mode of each pretwisted plate."""
    table = reference("twisted_plate_3d.csv")
    if quick:
        table = table[(table.b_over_h == 20) & (table.a_over_b == 1)]
    reasons = {
        20: "the solid's faces are plane, the shell's follow its normal: about half of it (reports.twisted_plate)",
        5: "thick: the gap of a first-order shear shell, that of faces along its normal included",
    }
    rows = []
    for (a, h, twist), part in twisted_plate.errors(table).groupby(twisted_plate.CASE):
        row = worst(part)
        case = f"A4 twisted plate, a/b {a}, b/h {h}, {twist} deg, worst of {len(part)}: mode {row['mode']:.0f}"
        gap = 1.15 if h == 20 else 6.5
        rows.append(check(case, "3-D elasticity", row["lambda"], row.found, 0.5, gap=gap, reason=reasons[h]))
    return rows


def mindlin(m: int, n: int, shell: Shell, side: float) -> float:
    """Frequency [Hz] of a simply supported square plate by Mindlin's theory, in closed form (Navier).

    With k^2 = (m^2 + n^2) pi^2/side^2: [[S k^2, S k], [S k, D k^2 + S]] against [rho h, rho h^3/12], S = kappa G h.
    """
    h, material = shell.thickness, shell.material
    k = np.pi * np.hypot(m, n) / side
    S = shell.shear_correction * material.shear_modulus * h
    rigidity = material.E * h**3 / (12.0 * (1.0 - material.nu**2))
    mass = material.rho * np.array([h, h**3 / 12.0])
    A = np.array([[S * k**2, S * k], [S * k, rigidity * k**2 + S]]) / np.sqrt(np.outer(mass, mass))
    return float(np.sqrt(np.linalg.eigvalsh(A)[0]) / (2.0 * np.pi))


def nafems() -> list[Row]:
    """A5: flat plates FV12, FV16, FV52 and the free thick cylinder FV41."""
    table = reference("nafems_free_vibration.csv").set_index("case")
    rows = []
    for case, supports in (("FV12", {}), ("FV16", {"root": Clamped()})):
        found = modes(Shell(chart=SQUARE, thickness=0.05, material=NAFEMS, supports=supports, mesh=ONE), 14)
        elastic = found.freq[found.rigid :]
        for label, exact in table.loc[case, ["mode", "check_hz"]].itertuples(index=False):
            place = int(str(label).partition("-")[0]) - (4 if case == "FV12" else 1)
            rows.append(check(f"A5 {case} plate, mode {label}", "Kirchhoff, Ritz", exact, elastic[place], 0.2))
    hard = {edge: ShearDiaphragm() for edge in SQUARE.edges}
    thick = Shell(chart=SQUARE, thickness=1.0, material=NAFEMS, supports=hard, mesh=ONE)
    found = modes(thick, 8)
    for m, n in ((1, 1), (1, 2), (2, 2)):
        exact = mindlin(m, n, thick, 10.0)
        near = found.freq[np.abs(found.freq - exact).argmin()]
        rows.append(check(f"A5 FV52 thick plate, hard support, ({m}, {n})", "Mindlin, Navier", exact, near, 0.2))
    pipe = Shell(chart=Cylinder(radius=2.0, height=10.0), thickness=0.4, material=NAFEMS,
                 mesh=ShellMesh(order=10, rows=3, around=1))  # fmt: skip
    meridian = harmonic_matrices(pipe, 0)
    values, vectors = lowest(meridian, 12, 1e3)
    size = np.abs(meridian.expand(vectors)[:, :3]).max(axis=0)
    freq = np.sqrt(np.maximum(values, 0.0))[size[1] < np.maximum(size[0], size[2])] / (2.0 * np.pi)
    for label, exact in table.loc["FV41", ["mode", "check_hz"]].itertuples(index=False):
        reason = "R/t = 5: the gap of first-order shell theory"
        case = f"A5 FV41 thick cylinder, mode {label}"
        rows.append(check(case, "3-D elasticity", exact, freq[int(label) - 1], 0.2, gap=0.6, reason=reason))
    return rows


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the table and the count of verdicts, and write it."""
    rows = frustum() + cylinders(quick) + cones(quick) + blade(quick) + twisted(quick) + nafems()
    rows += splitting.checks(quick)
    rows += (
        verify_static.rows(quick) + verify_rotation.rows(quick) + verify_strips.rows(quick) + verify_blades.rows(quick)
    )
    rows += (
        verify_fields.rows(quick)
        + verify_rig.rows(quick)
        + verify_rings.rows(quick)
        + verify_contact.rows(quick)
        + verify_interaction.rows(quick)
    )
    rows += verify_imported.rows(quick) + verify_locking.rows(quick)
    show("Verification", rows)
    passed, failed = (sum(row["verdict"] == word for row in rows) for word in ("pass", "FAIL"))
    print(f"{len(rows)} rows: {passed} pass, {len(rows) - passed - failed} have a reason, {failed} fail")
    write(out / "verification.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
