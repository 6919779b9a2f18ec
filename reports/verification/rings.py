"""Rows of the verification on rings: the free circular ring VM09, point masses on a ring, bolts.

The free ring is a `Ring` whose wall is a thin cylinder of a material 1e-7 as stiff and as heavy: the wall only provides
the dofs. Fox's ring is a short cylinder with half of each mass on either edge.
"""

from dataclasses import replace

import numpy as np
import pandas as pd
from scipy.linalg import eigh

from casingfem.io.arrays import IntArray
from casingfem.modal.modes import Modes, modes
from casingfem.structure.edge.bolts import Bolts
from casingfem.structure.edge.ring import EdgeMass, Ring
from casingfem.structure.edge.section import Section
from casingfem.structure.geometry.chart import Cylinder
from casingfem.structure.material import Material
from casingfem.structure.mesh.shell_mesh import ShellMesh
from casingfem.structure.shell.shell import Shell
from reports.tables import DATA, Row, check
from reports.verification.modes.frustum import reference_frustum

NAFEMS = Material(E=200e9, nu=0.3, rho=8000.0)
STEEL = Material(E=210e9, nu=0.3, rho=7800.0)
NOTHING = 1e-7  # of the ring's modulus and density: the wall that carries its dofs
DOUBLE = 1e-7  # per cent: a relative split of 1e-9
FOX = ((0.0, 0.012), (40.0, 0.008), (-40.0, 0.008))  # degrees, kg


def free_ring(section: Section) -> Shell:
    """The ring of VM09, radius 1 m, on a wall of negligible stiffness and mass."""
    carrier = Material(E=NOTHING * NAFEMS.E, nu=NAFEMS.nu, rho=NOTHING * NAFEMS.rho)
    return Shell(
        chart=Cylinder(radius=1.0, height=0.02),
        thickness=1e-3,
        material=carrier,
        supports={"base": Ring(section=section, material=NAFEMS, offset=(0.0, 0.0))},
        mesh=ShellMesh(order=8, rows=1, around=7),
    )


def timoshenko_ring(section: Section, material: Material, radius: float, n: int, *, in_plane: bool) -> float:
    """Lowest frequency [Hz] of a free ring of n nodal diameters with shear and rotary inertia, in closed form.

    In its plane, of tangential v, radial w and rotation p as sin, cos, sin of n theta: stretch (n v + w)/R, bending
    n p/R, shear p - (v + n w)/R. Out of it, of axial u, twist t and rotation p as cos, cos, sin: bending (n p + t)/R,
    torsion -(p + n t)/R, shear -(n u/R + p).
    """
    E, rho, R, area = material.E, material.rho, radius, section.area
    stiff = section.shear * material.shear_modulus * area
    if in_plane:
        strains = [
            (E * area, (n / R, 1.0 / R, 0.0)),
            (E * section.I_z, (0.0, 0.0, n / R)),
            (stiff, (-1.0 / R, -n / R, 1.0)),
        ]
        mass = (rho * area, rho * area, rho * section.I_z)
    else:
        torsion = material.shear_modulus * section.J
        strains = [
            (E * section.I_r, (0.0, 1.0 / R, n / R)),
            (torsion, (0.0, -n / R, -1.0 / R)),
            (stiff, (-n / R, 0.0, -1.0)),
        ]
        mass = (rho * area, rho * (section.I_r + section.I_z), rho * section.I_r)
    K = sum(factor * np.outer(strain, strain) for factor, strain in strains)
    return float(np.sqrt(eigh(K, np.diag(mass), eigvals_only=True)[0]) / (2.0 * np.pi))


def circular_ring() -> list[Row]:
    """VM09: six doublets against the ring with shear in closed form, against the thin ring, and the worst split."""
    table = pd.read_csv(DATA / "reference" / "nafems_vm09_circular_ring.csv", comment="#")
    section = Section.circle(diameter=0.1)
    found = modes(free_ring(section), 18, method="shell").freq[6:]
    rows = []
    for k, (n, plane, thin) in enumerate(zip(table.n, table.type, table.reference_hz.to_numpy(float), strict=True)):
        name, low = f"VM09 free ring, n = {n}, {plane}", float(found[2 * k])
        exact = timoshenko_ring(section, NAFEMS, 1.0, int(n), in_plane=plane == "in-plane")
        gap = 100.0 * (exact / thin - 1.0)
        reason = f"the thin ring has neither shear nor rotary inertia: with them, in closed form, {gap:.2f} %"
        rows.append(check(name, "ring with shear, closed form", exact, low, 9e-6))
        rows.append(check(name, "thin ring, Blevins", thin, low, 0.1, gap=abs(gap) + 0.01, reason=reason))
    split = float(np.max(found[1::2] / found[::2] - 1.0))
    return [*rows, check("VM09 free ring, largest split of its six pairs", "symmetry", 0.0, split, DOUBLE)]


def in_plane(found: Modes, n: int) -> IntArray:
    """Modes of a short cylinder that bend it in its plane with n nodal diameters."""
    axial = np.abs(found.fields[:, 2]).max(axis=0) / np.abs(found.fields[:, :2]).max(axis=(0, 1))
    return np.flatnonzero((found.nodal_diameters == n) & (axial < 0.3))


def fox(n: int, bare: float) -> tuple[float, float]:
    """Frequencies of a thin ring with masses from that of the bare one (Fox, J. Sound Vib. 142, 1990, 227).

    w^2 = w0^2/{1 + [sum m +- (n^2-1)/(n^2+1) |sum m e^(2 i n theta)|]/M0}.
    """
    angles, masses = np.radians([a for a, _ in FOX]), np.array([m for _, m in FOX])
    whole = 2.0 * np.pi * 0.3 * 0.006 * 0.02 * STEEL.rho
    swing = (n**2 - 1) / (n**2 + 1) * abs(np.sum(masses * np.exp(2j * n * angles)))
    low, high = (bare / np.sqrt(1.0 + (masses.sum() + way * swing) / whole) for way in (1.0, -1.0))
    return float(low), float(high)


def point_masses(quick: bool) -> list[Row]:
    """A ring of radius 0.3 m, 6 mm x 20 mm, with three masses: Fox's formula for n = 2 to 5."""
    half = [EdgeMass(angle=float(np.radians(angle)), mass=0.5 * mass) for angle, mass in FOX]
    shell = Shell(chart=Cylinder(radius=0.3, height=0.02), thickness=0.006, material=STEEL,
                  mesh=ShellMesh(order=8, rows=1, around=13))  # fmt: skip
    bare = modes(shell, 34, method="shell")
    found = modes(replace(shell, masses={"base": half, "top": half}), 34)
    rows = []
    for n in (4,) if quick else (2, 3, 4, 5):
        pair = found.freq[in_plane(found, n)[:2]]
        exact = fox(n, float(bare.freq[in_plane(bare, n)[0]]))
        for k, side in enumerate(("lower", "upper")):
            rows.append(check(f"ring with three masses, n = {n}, {side}", "Fox, first order", exact[k], pair[k], 0.08))
    return rows


def equal_bolts(quick: bool) -> list[Row]:
    """Equal bolts split n only if their number divides 2n; the same with a ring between."""
    rows = []
    ring = Ring(section=Section.rectangle(width=0.04, depth=0.04))
    for count, under in ((8, None),) if quick else ((8, None), (24, None), (8, ring)):
        bolts = Bolts(count=count, k=1e8)
        support = bolts if under is None else replace(under, support=bolts)
        found = modes(replace(reference_frustum(ShellMesh(order=7, rows=1, around=24)), supports={"base": support}), 24)
        n = np.array([found.nodal_diameters[low] for low, _ in found.doublets])
        barred = 2 * n % count != 0
        others = f", others to {100 * found.splits[~barred].max():.2g} %" if np.any(~barred) else ""
        name = f"forbidden splits, {count} bolts{' under a ring' if under else ''}{others}"
        rows.append(check(name, "rule: N divides 2n", 0.0, float(found.splits[barred].max()), DOUBLE))
    return rows


def rows(quick: bool) -> list[Row]:
    """All rows; --quick takes n = 4 of Fox's ring and one pattern of bolts."""
    return circular_ring() + point_masses(quick) + equal_bolts(quick)
