"""Verification: every published, exact or independent reference of a structure in one table.

`python -m reports.verification [--quick] [--out DIR]` prints and writes verification.csv: case, source, reference,
computed, error and allowed error in per cent, and the verdict: pass, or the reason why not. A row over several
frequencies shows the worst of them. A reason holds up to a bound of its own; beyond it the verdict is FAIL. The
tables row by row: reports.verification.cylinder, reports.verification.cone, reports.verification.twisted_plate,
reports.verification.splitting. --quick takes a subset.
"""

from pathlib import Path

import numpy as np
import pandas as pd

from casingfem.modal.fourier import lowest
from casingfem.modal.modes import modes
from casingfem.structure.edge.support import Clamped, ShearDiaphragm
from casingfem.structure.geometry.chart import Cylinder, Panel, Plate
from casingfem.structure.material import Material
from casingfem.structure.mesh.shell_mesh import ShellMesh
from casingfem.structure.shell.axisymmetric import harmonic_matrices
from casingfem.structure.shell.shell import Shell
from reports.tables import DATA, Row, check, loose, show, write
from reports.verification import (
    blades,
    cone,
    contact,
    cylinder,
    cylinder_exact,
    fields,
    imported,
    interaction,
    locking,
    rig,
    rings,
    rotation,
    splitting,
    static,
    strips,
    twisted_plate,
)
from reports.verification.modes.frustum import reference_frustum

NAFEMS = Material(E=200e9, nu=0.3, rho=8000.0)
SQUARE = Plate(length=10.0, width=10.0)
ONE = ShellMesh(order=12, rows=1, around=1)
FINE = ShellMesh(order=10, rows=3, around=3)
LOVE = {
    15: {"C-C": 0.4, "C-F": 0.42, "F-C": 0.45, "F-F": 0.4, "S3-S3": 0.35},
    30: {"C-C": 0.86, "C-F": 0.66, "F-C": 0.74, "F-F": 0.75, "S3-S3": 0.46},
    45: {"C-C": 1.7, "C-F": 1.1, "F-C": 1.2, "F-F": 1.1, "S3-S3": 0.83},
    60: {"C-C": 2.6, "C-F": 1.5, "F-C": 1.7, "F-F": 1.3, "S3-S3": 1.2},
}  # per cent by half angle and ends: a fifth more than is seen of the gap between the shell and Love's theory
TWISTED = {
    (1, 5, 15): 0.93,
    (1, 5, 30): 1.95,
    (1, 5, 45): 3.2,
    (1, 5, 60): 4.4,
    (3, 5, 45): 0.74,
    (3, 5, 60): 0.9,
    (1, 20, 45): 0.76,
    (1, 20, 60): 0.98,
}  # per cent by a/b, b/h and twist: a fifth more than is seen


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
        reason = "a clamp in three dimensions holds the wall's thickness too (verification.wall)"
        case = f"A0 frustum, n = {n}, m = {m}"
        rows.append(check(case, "3-D elasticity", exact, float(found.freq[low]), 0.018, gap=0.026, reason=reason))
    return rows


def cylinders(quick: bool) -> list[Row]:
    """A1: the worst row of each h/R and L/R, and the long waves n = m = 2 of the longest cylinders."""
    table = reference("cyl_shear_diaphragm_exact.csv")
    found = cylinder.errors(table[table.n % 4 == 0] if quick else table)
    rows = []
    for (_, length), part in found.groupby(["h_over_R", "L_over_R"]):
        rows.append(beside_theory(worst(part), f"worst of {len(part)}"))
        if length == found.L_over_R.max():
            rows += [beside_theory(row, "long waves") for _, row in part[(part.n == 2) & (part.m == 2)].iterrows()]
    return rows


def beside_theory(row: pd.Series, words: str) -> Row:
    """A cylinder's row beside the gap of the shell's own theory, solved exactly: the mesh may add 0.002 %."""
    linear, theory = cylinder_exact.gaps(row.h_over_R, row.L_over_R, int(row.n), int(row.m))
    return check(
        f"A1 cylinder, h/R {row.h_over_R:g}, L/R {row.L_over_R:g}, {words}: n = {row.n:.0f}, m = {row.m:.0f}",
        "3-D elasticity",
        row.omega_3d,
        row.omega,
        0.045,
        gap=abs(theory) + 0.002,
        reason=f"first-order kinematics: the theory solved exactly {theory:.3f} %, with a linear wall {linear:.3f} %",
    )


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
                gap=LOVE[alpha][f"{small}-{large}"] if thin <= 0.1 else 0.0,
                reason=f"Love's gap: without shear and rotary inertia {thin:.2f} %",
            )
        )
    row = found.loc[found.thin.abs().idxmax()]
    computed = float(row["lambda"] * (1.0 + row.thin))
    case = f"A2 all {len(found)} rows without shear and rotary inertia, the worst"
    return [*rows, check(case, "Love, Ritz", row["lambda"], computed, 0.09)]


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
    reason = "thin-shell theory has no shear layer at free edges"
    rows = [
        check(f"A3 fan blade, mode {k + 1}", "Love, Ritz", exact[k], found[k], 0.3, gap=0.45, reason=reason)
        for k in range(7)
    ]
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
    return rows


def twisted(quick: bool) -> list[Row]:
    """A4: the worst mode of each pretwisted plate; solids computed here say what a gap is made of.

    The reference's sections are turned, their faces plane; a shell's faces follow its normal. A solid of the first
    kind is a control of the reference, one of the second of the shell.
    """
    table = reference("twisted_plate_3d.csv")
    if quick:
        table = table[(table.b_over_h == 20) & (table.a_over_b == 1)]
    rows = []
    for (a, h, twist), part in twisted_plate.errors(table).groupby(twisted_plate.CASE):
        row = worst(part)
        place = int(row["mode"]) - 1
        case = f"A4 twisted plate, a/b {a}, b/h {h}, {twist} deg, worst of {len(part)}: mode {place + 1}"
        gap, reason = TWISTED.get((a, h, twist), 0.0), "faces along the normal and first-order shear"
        if gap and not quick:
            orders = (13, 13, 3) if h == 20 else (10, 10, 4)
            turned, normal = (twisted_plate.solid(a, h, twist, section=s, orders=orders) for s in (True, False))
            exact = part["lambda"].to_numpy()
            k = int(np.abs(turned[part["mode"] - 1] / exact - 1.0).argmax())
            control = (
                f"A4 solid of one spectral brick, a/b {a}, b/h {h}, {twist} deg, worst of {len(part)}: mode {k + 1}"
            )
            rows.append(check(control, "3-D, spectral", exact[k], float(turned[part["mode"].iloc[k] - 1]), 0.25))
            faces, theory = normal[place] / turned[place] - 1.0, row.found / normal[place] - 1.0
            reason = f"faces along the normal {100 * faces:.2f} % (two solids), first-order shear {100 * theory:.2f} %"
        rows.append(check(case, "3-D elasticity", row["lambda"], row.found, 0.5, gap=gap, reason=reason))
    return rows


def mindlin(m: int, n: int, shell: Shell, side: float) -> float:
    """Frequency [Hz] of a simply supported square plate by Mindlin's theory, in closed form (Navier).

    With k^2 = (m^2 + n^2) pi^2/side^2: [[S k^2, S k], [S k, D k^2 + S]] against [rho h, rho h^3/12], S = kappa G h.
    """
    h, material = shell.thickness, shell.material
    k = np.pi * np.hypot(m, n) / side
    S = float(shell.shear_factor(np.asarray(material.nu))) * material.shear_modulus * h
    rigidity = material.E * h**3 / (12.0 * (1.0 - material.nu**2))
    mass = material.rho * np.array([h, h**3 / 12.0])
    A = np.array([[S * k**2, S * k], [S * k, rigidity * k**2 + S]]) / np.sqrt(np.outer(mass, mass))
    return float(np.sqrt(np.linalg.eigvalsh(A)[0]) / (2.0 * np.pi))


def nafems() -> list[Row]:
    """A5: flat plates FV12, FV16, FV52 (with Mindlin's shear factor, a linear wall's), the free thick cylinder FV41."""
    table = reference("nafems_free_vibration.csv").set_index("case")
    rows = []
    for case, supports in (("FV12", {}), ("FV16", {"root": Clamped()})):
        found = modes(Shell(chart=SQUARE, thickness=0.05, material=NAFEMS, supports=supports, mesh=ONE), 14)
        elastic = found.freq[found.rigid :]
        for label, exact in table.loc[case, ["mode", "check_hz"]].itertuples(index=False):
            place = int(str(label).partition("-")[0]) - (4 if case == "FV12" else 1)
            rows.append(check(f"A5 {case} plate, mode {label}", "Kirchhoff, Ritz", exact, elastic[place], 0.11))
    hard = {edge: ShearDiaphragm() for edge in SQUARE.edges}
    thick = Shell(chart=SQUARE, thickness=1.0, material=NAFEMS, supports=hard, wall="linear", mesh=ONE)
    found = modes(thick, 8)
    for m, n in ((1, 1), (1, 2), (2, 2)):
        exact = mindlin(m, n, thick, 10.0)
        near = found.freq[np.abs(found.freq - exact).argmin()]
        rows.append(check(f"A5 FV52 thick plate, hard support, ({m}, {n})", "Mindlin, Navier", exact, near, 1e-6))
    pipe = Shell(chart=Cylinder(radius=2.0, height=10.0), thickness=0.4, material=NAFEMS,
                 mesh=ShellMesh(order=10, rows=3, around=1))  # fmt: skip
    meridian = harmonic_matrices(pipe, 0)
    values, vectors = lowest(meridian, 12, 1e3)
    size = np.abs(meridian.expand(vectors)[:, :3]).max(axis=0)
    freq = np.sqrt(np.maximum(values, 0.0))[size[1] < np.maximum(size[0], size[2])] / (2.0 * np.pi)
    for label, exact in table.loc["FV41", ["mode", "check_hz"]].itertuples(index=False):
        case = f"A5 FV41 thick cylinder, mode {label}"
        rows.append(check(case, "3-D elasticity", exact, freq[int(label) - 1], 0.12))
    return rows


def summary(rows: list[Row]) -> Row:
    """Counts of verdicts; the largest split that symmetry forbids, the largest change by turning a field."""
    verdicts = [row["verdict"] for row in rows]

    def largest(words: str) -> float:
        return max((float(str(row["computed"])) for row in rows if words in str(row["case"])), default=0.0)

    counts = {"rows": len(rows), "pass": verdicts.count("pass"), "fail": verdicts.count("FAIL")}
    return {
        **counts, "reason": counts["rows"] - counts["pass"] - counts["fail"],
        "forbidden splits": largest("forbidden splits"), "turned": largest("turned by"),
    }  # fmt: skip


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the table and the count of verdicts, and write it."""
    rows = frustum() + cylinders(quick) + cones(quick) + blade(quick) + twisted(quick) + nafems()
    rows += splitting.checks(quick)
    rows += static.rows(quick) + rotation.rows(quick) + strips.rows(quick) + blades.rows(quick)
    rows += fields.rows(quick) + rig.rows(quick) + rings.rows(quick) + contact.rows(quick) + interaction.rows(quick)
    rows += imported.rows(quick) + locking.rows(quick)
    show("Verification", rows)
    passed, failed = (sum(row["verdict"] == word for row in rows) for word in ("pass", "FAIL"))
    print(f"{len(rows)} rows: {passed} pass, {len(rows) - passed - failed} have a reason, {failed} fail")
    if not quick:
        print("bounds wider than what is seen asks for:", "; ".join(loose(rows)) or "none")
    write(out / "verification.csv", rows)
    write(out / "verification_summary.csv", [summary(rows)])
    return rows
