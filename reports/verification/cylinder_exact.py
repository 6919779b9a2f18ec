"""Cylinders between shear diaphragms, wave by wave: 3-D elasticity, and shear shells with a curved or a linear wall.

`python -m reports.verification.cylinder_exact [--quick] [--out DIR]` computes the 650 values of 3-D elasticity in
data/reference/cyl_shear_diaphragm_exact.csv anew and prints the largest difference, then where the shell's gap to
them comes from; it writes cylinder_exact.csv.

With z from the mid-surface, r = R + z, k = m pi/L and displacements
U_x = a(z) cos(k x) cos(n t), U_t = b(z) sin(k x) sin(n t), U_r = c(z) sin(k x) cos(n t) the strains are

 e_xx = -k a, e_tt = (n b + c)/r, e_rr = c', g_xt = k b - n a/r, g_xr = a' + k c, g_tr = b' - (b + n c)/r.

3-D elasticity takes Legendre polynomials for a, b and c. A first-order shear shell takes a = u + z w_x and
b = v + z w_t. Its curved wall (`casingfem.structure.shell.wall`) takes c = w + z s1 + (z^2 - h^2/12) s2/2, these
strains without the slopes of s1 and s2, 5/(6 - nu) of the shear stiffness, the volume r dz; s1 and s2 have no inertia.
Its linear wall takes c = w, plane stress, 5/6 of the shear stiffness, strains linear in z, the volume R dz.
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


def lowest_factor(strain: FloatArray, M: FloatArray, C: FloatArray, volume: FloatArray) -> float:
    """Omega = omega R sqrt(rho (1 - nu^2)/E) of the lowest wave, E = rho = R = 1."""
    K = np.einsum("aiq,ab,bjq,q->ij", strain, C, strain, volume)
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
    M = np.einsum("aiq,ajq,q->ij", moved, moved, volume)
    return lowest_factor(strains(moved, slopes, 1.0 + z, n, m * np.pi / length), M, C, volume)


def shear_shell(h: float, length: float, n: int, m: int, wall: str) -> float:
    """Lowest frequency factor of the first-order shear shell, its wall "curved" or "linear" (`Shell.wall`)."""
    z, none, shear = 0.5 * h * POINTS, np.zeros_like(POINTS), 0.5 / (1.0 + NU)
    one, bow = none + 1.0, 0.5 * (z**2 - h**2 / 12.0)
    moved = np.array([[one, none, none, z, none, none, none], [none, one, none, none, z, none, none],
                      [none, none, one, none, none, z, bow]])  # fmt: skip
    slopes = np.zeros_like(moved)
    slopes[0, 3] = slopes[1, 4] = slopes[2, 5] = 1.0
    slopes[2, 6] = z
    strain = strains(moved, slopes, 1.0 + z, n, m * np.pi / length)
    C = np.zeros((6, 6))
    if wall == "curved":
        strain[4:, 5:] = 0.0  # the slopes of s1 and s2
        volume = 0.5 * h * WEIGHTS * (1.0 + z)
        C[:3, :3] = NU / ((1.0 + NU) * (1.0 - 2.0 * NU)) + 2.0 * shear * np.eye(3)
        C[3:, 3:] = shear * np.diag([1.0, *(2 * [5.0 / (6.0 - NU)])])
    else:  # covariant strains, r^2 e_tt, r g_xt and r g_tr, to first order in z
        strain, moved = strain[:, :5], moved[:, :5]
        for k, power in ((1, 2), (3, 1), (5, 1)):
            strain[k] = _linear(strain[k] * (1.0 + z) ** power, z)
        volume = 0.5 * h * WEIGHTS
        C[:2, :2] = np.array([[1.0, NU], [NU, 1.0]]) / (1.0 - NU**2)
        C[3:, 3:] = shear * np.diag([1.0, 5.0 / 6.0, 5.0 / 6.0])
    M = np.einsum("aiq,ajq,q->ij", moved, moved, volume)
    M[5:] = M[:, 5:] = 0.0
    return lowest_factor(strain, M, C, volume)


def _linear(values: FloatArray, z: FloatArray) -> FloatArray:
    """The part of functions of z that is of degree 1: their value and slope at the mid-surface."""
    table = np.polynomial.polynomial.polyfit(z, values.T, 3)
    return np.asarray(table[0][:, None] + np.outer(table[1], z))


def anew(table: pd.DataFrame) -> FloatArray:
    """3-D elasticity at the table's rows."""
    rows = table[["h_over_R", "L_over_R", "n", "m"]].itertuples(index=False)
    return np.array([elasticity(h, length, int(n), int(m)) for h, length, n, m in rows])


def gaps(h: float, length: float, n: int, m: int) -> tuple[float, float]:
    """Gap of the shear shell to 3-D elasticity in per cent: with a linear wall, and with a curved one."""
    exact = elasticity(h, length, n, m)
    one, other = (100.0 * (shear_shell(h, length, n, m, wall) / exact - 1.0) for wall in ("linear", "curved"))
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
            linear, curved = gaps(h, length, n, m)
            rows.append({"h/R": h, "L/R": length, "n": n, "m": m, "linear wall %": linear, "curved wall %": curved})
    show("First-order shear shell against 3-D elasticity", rows)
    write(out / "cylinder_exact.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
