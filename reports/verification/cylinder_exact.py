"""Cylinders between shear diaphragms, wave by wave: 3-D elasticity, and shear shells with the wall's metric or without.

`python -m reports.verification.cylinder_exact [--quick] [--out DIR]` computes the 650 values of 3-D elasticity in
data/reference/cyl_shear_diaphragm_exact.csv anew and prints the largest difference, then where the shell's gap to
them comes from; it writes cylinder_exact.csv.

With z from the mid-surface, r = R + z, k = m pi/L and displacements
U_x = a(z) cos(k x) cos(n t), U_t = b(z) sin(k x) sin(n t), U_r = c(z) sin(k x) cos(n t) the strains are

 e_xx = -k a, e_tt = (n b + c)/r, e_rr = c', g_xt = k b - n a/r, g_xr = a' + k c, g_tr = b' - (b + n c)/r.

3-D elasticity takes Legendre polynomials for a, b and c. A first-order shear shell takes a = u + z w_x,
b = v + z w_t, c = w, plane stress and 5/6 of the shear stiffness. "With metric" it keeps these strains and the volume
r dz; without, as `casingfem` has it, strains are linear in z and the volume is R dz.
"""

from pathlib import Path

import numpy as np
import pandas as pd
from numpy.polynomial import legendre
from scipy.linalg import eigh

from casingfem.io.arrays import FloatArray
from reports.tables import DATA, Row, command_line, show, write

NU = 0.3
DEGREE = 8
POINTS, WEIGHTS = legendre.leggauss(DEGREE + 6)  # through the wall
REFERENCE = DATA / "reference" / "cyl_shear_diaphragm_exact.csv"


def strains(moved: FloatArray, slopes: FloatArray, r: FloatArray, n: int, k: float) -> FloatArray:
    """The six strains (6, coefficients, points) of a, b, c and of their slopes, both (3, coefficients, points)."""
    (a, b, c), (da, db, dc) = moved, slopes
    return np.stack([-k * a, (n * b + c) / r, dc, k * b - n * a / r, da + k * c, db - (b + n * c) / r])


def lowest_factor(strain: FloatArray, moved: FloatArray, C: FloatArray, volume: FloatArray) -> float:
    """Omega = omega R sqrt(rho (1 - nu^2)/E) of the lowest wave, E = rho = R = 1."""
    K = np.einsum("aiq,ab,bjq,q->ij", strain, C, strain, volume)
    M = np.einsum("aiq,ajq,q->ij", moved, moved, volume)
    last = len(K) - 1  # of M against K the largest is asked for: that keeps the digits of the smallest of K against M
    return float(np.sqrt((1.0 - NU**2) / eigh(M, K, eigvals_only=True, subset_by_index=[last, last])[0]))


def elasticity(h: float, length: float, n: int, m: int, degree: int = DEGREE) -> float:
    """Lowest frequency factor by 3-D elasticity; wall h and length over the mean radius."""
    z, volume = 0.5 * h * POINTS, 0.5 * h * WEIGHTS * (1.0 + 0.5 * h * POINTS)
    unit = np.eye(degree + 1)
    P = legendre.legval(POINTS, unit)
    slope = np.array([legendre.legval(POINTS, legendre.legder(row)) for row in unit]) * 2.0 / h
    moved, slopes = (
        np.array([np.vstack([f if i == j else 0.0 * f for j in range(3)]) for i in range(3)]) for f in (P, slope)
    )
    C = np.zeros((6, 6))
    C[:3, :3] = NU / ((1.0 + NU) * (1.0 - 2.0 * NU))
    C += np.diag([2.0, 2.0, 2.0, 1.0, 1.0, 1.0]) / (2.0 * (1.0 + NU))
    return lowest_factor(strains(moved, slopes, 1.0 + z, n, m * np.pi / length), moved, C, volume)


def shear_shell(h: float, length: float, n: int, m: int, *, metric: bool) -> float:
    """Lowest frequency factor of the first-order shear shell, with the metric through the wall or without."""
    z = 0.5 * h * POINTS
    one, none = np.ones_like(z), np.zeros_like(z)
    moved = np.array([[one, none, none, z, none], [none, one, none, none, z], [none, none, one, none, none]])
    slopes = np.zeros_like(moved)
    slopes[0, 3] = slopes[1, 4] = 1.0
    strain = strains(moved, slopes, 1.0 + z, n, m * np.pi / length)
    if not metric:  # covariant strains, r^2 e_tt and r g_xt, to first order in z
        strain[1] = _linear(strain[1] * (1.0 + z) ** 2, z)
        strain[3] = _linear(strain[3] * (1.0 + z), z)
        strain[5] = _linear(strain[5] * (1.0 + z), z)
    volume = 0.5 * h * WEIGHTS * ((1.0 + z) if metric else one)
    shear = 1.0 / (2.0 * (1.0 + NU))
    C = np.zeros((6, 6))
    C[:2, :2] = np.array([[1.0, NU], [NU, 1.0]]) / (1.0 - NU**2)
    C[3, 3], C[4, 4], C[5, 5] = shear, 5.0 / 6.0 * shear, 5.0 / 6.0 * shear
    return lowest_factor(strain, moved, C, volume)


def _linear(values: FloatArray, z: FloatArray) -> FloatArray:
    """The part of functions of z that is of degree 1: their value and slope at the mid-surface."""
    table = np.polynomial.polynomial.polyfit(z, values.T, 3)
    return np.asarray(table[0][:, None] + np.outer(table[1], z))


def anew(table: pd.DataFrame) -> FloatArray:
    """3-D elasticity at the table's rows."""
    rows = table[["h_over_R", "L_over_R", "n", "m"]].itertuples(index=False)
    return np.array([elasticity(h, length, int(n), int(m)) for h, length, n, m in rows])


def gaps(h: float, length: float, n: int, m: int) -> tuple[float, float]:
    """Gap of the shear shell to 3-D elasticity in per cent: as it is, and with the metric through the wall."""
    exact = elasticity(h, length, n, m)
    one, other = (100.0 * (shear_shell(h, length, n, m, metric=kept) / exact - 1.0) for kept in (False, True))
    return one, other


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the difference and the table of gaps, and write the latter."""
    table = pd.read_csv(REFERENCE, comment="#")
    table = table[table.n % 4 == 0] if quick else table
    difference = float(np.abs(anew(table) / table.omega_3d.to_numpy() - 1.0).max())
    print(f"{len(table)} values of 3-D elasticity computed anew: largest relative difference {difference:.1e}")
    rows: list[Row] = []
    for length, n, m in ((20.0, 2, 1), (20.0, 2, 2), (0.5, 0, 2), (0.5, 12, 2)):
        for h in (0.005, 0.01, 0.02, 0.05, 0.1):
            bare, kept = gaps(h, length, n, m)
            rows.append({"h/R": h, "L/R": length, "n": n, "m": m, "without metric %": bare, "with metric %": kept})
    show("First-order shear shell against 3-D elasticity", rows)
    write(out / "cylinder_exact.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
