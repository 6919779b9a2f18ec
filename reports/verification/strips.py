"""Strips against exact solutions: a stepped cylinder of two materials, wave by wave, and a stepped tube in torsion.

`python -m reports.verification.strips [--quick] [--out DIR]` prints and writes verify_strips.csv; reports.verification
has the same rows.

The cylinder's equations are written here once more, in cylindrical components, as ten first-order equations along the
axis. The matrix exponential solves them exactly on short pieces; their dynamic stiffnesses are assembled, and mode m
of n nodal diameters is where the m-th eigenvalue passes through zero (Wittrick & Williams, Quart. J. Mech. Appl. Math.
24, 1971, 263: no piece is long enough to have clamped modes of its own below).
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.linalg import eigvalsh, expm
from scipy.optimize import brentq

from casingfem.io.arrays import FloatArray
from casingfem.modal.fourier import lowest
from casingfem.structure.edge.support import Clamped
from casingfem.structure.geometry.chart import Cylinder
from casingfem.structure.geometry.strip import Strip
from casingfem.structure.material import Material
from casingfem.structure.mesh.shell_mesh import ShellMesh
from casingfem.structure.shell.axisymmetric import harmonic_matrices
from casingfem.structure.shell.shell import Shell
from reports.tables import Row, check, command_line, show, write

STEEL = Material(E=210e9, nu=0.3, rho=7800.0)
ALUMINIUM = Material(E=70e9, nu=0.33, rho=2700.0)
RADIUS, KAPPA = 0.3, 5.0 / 6.0
Segment = tuple[float, float, Material]  # length, thickness, material
SEGMENTS: tuple[Segment, ...] = ((0.08, 4e-3, STEEL), (0.03, 10e-3, ALUMINIUM), (0.09, 6e-3, STEEL))


def stepped(segments: Sequence[Segment] = SEGMENTS, **changes: object) -> Shell:
    """The cylinder of these segments, of linear walls: the first is the wall, the others are strips."""
    ends = np.cumsum([length for length, _, _ in segments]).tolist()
    strips = tuple(
        Strip(start=start, end=end, thickness=t, material=material)
        for start, end, (_, t, material) in zip(ends, ends[1:], segments[1:], strict=False)
    )
    parts = {"supports": {"base": Clamped()}, "strips": strips, "mesh": None, "wall": "linear"} | changes
    return Shell(
        chart=Cylinder(radius=RADIUS, height=ends[-1]), thickness=segments[0][1], material=segments[0][2], **parts
    )


def refined(shell: Shell, order: int) -> Shell:
    """The same strips on a mesh of higher order."""
    return replace(shell, mesh=replace(shell.mesh, order=order))


def state_matrix(n: int, t: float, material: Material, omega: float) -> FloatArray:
    """d/dz of (q, p): q = (u_z, u_theta, u_r, w_z, w_theta), p the edge forces, both per unit angle.

    Strain = A q + B q'; p = R B^T D strain, p' = R (A^T D strain - omega^2 m q).
    """
    R, E, nu, G = RADIUS, material.E, material.nu, material.shear_modulus
    A, B = np.zeros((8, 5)), np.zeros((8, 5))
    A[1, 1], A[1, 2] = n / R, 1.0 / R  # hoop stretch (n v + w)/R
    A[2, 0] = -n / R  # membrane shear v' - n u/R
    A[4, 4], A[4, 1], A[4, 2] = n / R, n / R**2, 1.0 / R**2  # hoop bending
    A[5, 3] = -n / R  # twist w_theta' - n w_z/R + v'/R
    A[6, 3] = 1.0  # axial shear w_z + w'
    A[7, 4], A[7, 1], A[7, 2] = 1.0, -1.0 / R, -n / R  # hoop shear
    B[0, 0] = B[2, 1] = B[3, 3] = B[5, 4] = B[6, 2] = 1.0
    B[5, 1] = 1.0 / R
    C = E / (1.0 - nu**2) * np.array([[1.0, nu, 0.0], [nu, 1.0, 0.0], [0.0, 0.0, (1.0 - nu) / 2.0]])
    D = np.zeros((8, 8))
    D[:3, :3], D[3:6, 3:6] = t * C, t**3 / 12.0 * C
    D[6, 6] = D[7, 7] = KAPPA * G * t
    mass = material.rho * np.array([t, t, t, t**3 / 12.0, t**3 / 12.0])
    slope = np.linalg.inv(R * B.T @ D @ B)
    mixed = R * B.T @ D @ A
    return np.block(
        [
            [-slope @ mixed, slope],
            [R * A.T @ D @ A - mixed.T @ slope @ mixed - omega**2 * R * np.diag(mass), mixed.T @ slope],
        ]
    )


def dynamic_stiffness(n: int, segments: Sequence[Segment], omega: float) -> FloatArray:
    """Exact dynamic stiffness of the cylinder clamped at its base, on the ends of pieces about 2 t long."""
    blocks = []
    for length, t, material in segments:
        pieces = int(np.ceil(length / (2.0 * t)))
        T = expm(state_matrix(n, t, material, omega) * length / pieces)
        inverse = np.linalg.inv(T[:5, 5:])
        piece = np.block([[inverse @ T[:5, :5], -inverse], [-inverse.T, T[5:, 5:] @ inverse]])
        blocks += [0.5 * (piece + piece.T)] * pieces
    K = np.zeros((5 * len(blocks) + 5, 5 * len(blocks) + 5))
    for k, block in enumerate(blocks):
        K[5 * k : 5 * k + 10, 5 * k : 5 * k + 10] += block
    return K[5:, 5:]


def exact(n: int, m: int, near: float, segments: Sequence[Segment] = SEGMENTS) -> float:
    """Angular frequency [rad/s] of mode m = 1, 2, ... of n nodal diameters, sought within 5 % of `near`."""

    def passage(omega: float) -> float:
        K = dynamic_stiffness(n, segments, omega)
        root = 1.0 / np.sqrt(np.abs(np.diag(K)))
        return float(eigvalsh(root[:, None] * K * root, subset_by_index=[m - 1, m - 1])[0])

    return float(brentq(passage, 0.95 * near, 1.05 * near, rtol=1e-12, xtol=1e-9 * near))


def found(shell: Shell, n: int, count: int) -> FloatArray:
    """The lowest angular frequencies of n nodal diameters, by the meridian problem."""
    return np.sqrt(np.maximum(lowest(harmonic_matrices(shell, n), count, 1e4)[0], 0.0))


def torsion(t1: float, t2: float, part: float) -> float:
    """First torsion of a free tube stepped at `part` of its length L: k L of t1 tan(k L1) + t2 tan(k L2) = 0."""

    def ends(k: float) -> float:
        first, second = k * part, k * (1.0 - part)
        return float(t1 * np.sin(first) * np.cos(second) + t2 * np.sin(second) * np.cos(first))

    return float(brentq(ends, 2.0, 4.5, rtol=1e-14))


def rows(quick: bool) -> list[Row]:
    """The stepped cylinder on its default mesh, and the stepped tube."""
    shell = stepped()
    table = []
    for n in (0, 2, 6) if quick else (0, 1, 2, 4, 6, 9):
        omega = found(shell, n, 2)
        for m in (1, 2):
            near = float(omega[m - 1])
            reference = exact(n, m, near) / (2.0 * np.pi)
            case = f"strips: cylinder, steel 4 mm, aluminium 10 mm, steel 6 mm, n = {n}, m = {m}"
            table.append(check(case, "same theory, exact", reference, near / (2.0 * np.pi), 0.038))
    tube = stepped(((0.2, 2e-3, STEEL), (0.4, 5e-3, STEEL)), supports={}, mesh=ShellMesh(order=8, rows=(0, 1 / 3, 1)))
    reference = torsion(2e-3, 5e-3, 1.0 / 3.0) / 0.6 * np.sqrt(STEEL.shear_modulus / STEEL.rho) / (2.0 * np.pi)
    omega = found(tube, 0, 60) / (2.0 * np.pi)
    near = float(omega[np.abs(omega - reference).argmin()])
    return [*table, check("strips: free tube 2 mm and 5 mm, first torsion", "wave equation", reference, near, 0.0045)]


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print and write them."""
    found = rows(quick)
    show("Strips", found)
    write(out / "verify_strips.csv", found)
    return found


if __name__ == "__main__":
    command_line(__doc__, main)
