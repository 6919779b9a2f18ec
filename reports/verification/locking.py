"""Thin cylinders between shear diaphragms, h/R = 1e-3 and 1e-4, against Fluegge's closed form, on one fixed mesh.

`python -m reports.verification.locking [--quick] [--out DIR]` prints and writes verify_locking.csv;
reports.verification has the same rows. Locking is visible here, because the lowest modes of such a thin wall are almost
inextensional.

With u = U cos(a x) cos(n theta), v = V sin(a x) sin(n theta), w = W sin(a x) cos(n theta), a = m pi R/L, x = z/R and
k = h^2/(12 R^2), Fluegge's equations are a symmetric 3 x 3 eigenvalue problem for
Omega^2 = omega^2 R^2 rho (1 - nu^2)/E (Leissa, Vibration of Shells, NASA SP-288, 1973, sections 2.1 and 2.3). Its
values of data/reference/cyl_shear_diaphragm_exact.csv come out the same.

A mode is found by its shape, sin(a x), not by its place. Membranes have infinitely many modes just below Omega = sqrt(1
- nu^2) = 0.95. At h/R = 1e-4 bending does not raise the shortest waves of a mesh above them. The diagonal mass is too
large for these waves, so some have values down to 0.75, between correct modes.
"""

from pathlib import Path

import numpy as np

from casingfem.io.arrays import FloatArray
from casingfem.modal.fourier import lowest
from casingfem.modal.modes import modes
from casingfem.structure.mesh.shell_mesh import ShellMesh
from casingfem.structure.shell.axisymmetric import harmonic_matrices
from reports.tables import Row, check, command_line, show, write
from reports.verification.cylinder import FIXED, MATERIAL, cylinder

NU = MATERIAL.nu
WAVES = 3  # axial half waves compared
CANDIDATES = 40  # lowest modes of one n among which they are found
DIAMETERS = (2, 4, 8, 12)  # and those of the lowest mode
LENGTHS = (0.5, 1.0, 2.0, 5.0, 20.0)
AROUND = ShellMesh(order=FIXED.order, rows=FIXED.rows, around=41)


def fluegge(h_over_r: float, l_over_r: float, n: int, m: int) -> FloatArray:
    """The three frequency factors Omega of n nodal diameters and m axial half waves, ascending.

    >>> fluegge(0.005, 0.5, 2, 1).round(9).tolist()[0]  # the reference table's
    0.863580391
    """
    k, a = h_over_r**2 / 12.0, m * np.pi / l_over_r
    A = np.zeros((3, 3))
    A[0, 0] = a**2 + 0.5 * (1.0 - NU) * (1.0 + k) * n**2
    A[1, 1] = 0.5 * (1.0 - NU) * (1.0 + 3.0 * k) * a**2 + n**2
    A[2, 2] = 1.0 + k * ((a**2 + n**2) ** 2 - 2.0 * n**2 + 1.0)
    A[0, 1] = A[1, 0] = -0.5 * (1.0 + NU) * a * n
    A[0, 2] = A[2, 0] = -NU * a - k * (a**3 - 0.5 * (1.0 - NU) * a * n**2)
    A[1, 2] = A[2, 1] = n + 0.5 * k * (3.0 - NU) * a**2 * n
    return np.sqrt(np.linalg.eigvalsh(A))


def found_by_shape(h_over_r: float, l_over_r: float, n: int) -> FloatArray:
    """Frequency factors of the modes whose radial motion is sin(m pi x/L), m = 1 .. `WAVES`, on the fixed mesh."""
    meridian = harmonic_matrices(cylinder(h_over_r, l_over_r), n)
    values, vectors = lowest(meridian, CANDIDATES, 1e-6)
    shapes = np.sin(np.pi / l_over_r * np.outer(np.arange(1, WAVES + 1), meridian.z)) * np.gradient(meridian.z)
    return np.sqrt(values[np.abs(shapes @ meridian.expand(vectors)[:, 0]).argmax(axis=1)])


def lowest_of(h_over_r: float, l_over_r: float, n: int) -> FloatArray:
    """The lowest frequency factor of n >= 2 nodal diameters for each of 1 .. `WAVES` half waves: radial motion."""
    return np.array([fluegge(h_over_r, l_over_r, n, m)[0] for m in range(1, WAVES + 1)])


def valley(h_over_r: float, l_over_r: float) -> int:
    """Nodal diameters of the lowest mode."""
    n = 2
    while fluegge(h_over_r, l_over_r, n + 1, 1)[0] < fluegge(h_over_r, l_over_r, n, 1)[0]:
        n += 1
    return n


def by_harmonics(h_over_r: float, l_over_r: float, quick: bool) -> Row:
    """The worst of the first half waves of every n, one meridian problem each."""
    diameters = sorted({*DIAMETERS[:: 2 if quick else 1], valley(h_over_r, l_over_r)})
    exact = np.array([lowest_of(h_over_r, l_over_r, n) for n in diameters])
    found = np.array([found_by_shape(h_over_r, l_over_r, n) for n in diameters])
    i, j = np.unravel_index(np.abs(found / exact - 1.0).argmax(), exact.shape)
    case = f"A1 thin cylinder, h/R {h_over_r:g}, L/R {l_over_r:g}, worst of {exact.size}"
    return check(f"{case}: n = {diameters[i]}, m = {j + 1}", "Fluegge, exact", exact[i, j], found[i, j], 0.012)


def by_shell(h_over_r: float, l_over_r: float, count: int) -> Row:
    """The worst of the lowest modes of all n, by the two-dimensional shell on the same rows."""
    exact = np.sort(np.repeat([lowest_of(h_over_r, l_over_r, n) for n in range(2, 120)], 2))[:count]
    shell = cylinder(h_over_r, l_over_r, AROUND)
    found = 2.0 * np.pi * modes(shell, count + 1, method="shell").freq[1:]  # it slides along its axis
    worst = int(np.abs(found / exact - 1.0).argmax())
    case = f"A1 thin cylinder, h/R {h_over_r:g}, L/R {l_over_r:g}, 2-D shell, worst of {count}: mode {worst + 1}"
    return check(case, "Fluegge, exact", exact[worst], found[worst], 0.012)


def rows(quick: bool) -> list[Row]:
    """Both walls, every length; the two-dimensional shell at one length."""
    lengths = LENGTHS[1:3] if quick else LENGTHS
    table = [by_harmonics(h, length, quick) for h in (1e-3, 1e-4) for length in lengths]
    return table if quick else [*table, *(by_shell(h, 2.0, 12) for h in (1e-3, 1e-4))]


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print and write them."""
    found = rows(quick)
    show("Thin cylinders", found)
    write(out / "verify_locking.csv", found)
    return found


if __name__ == "__main__":
    command_line(__doc__, main)
