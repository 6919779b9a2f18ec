"""Rotating parts against independent solutions: beams, waves of a ring, a rigid drum, reduced bodies.

`python -m reports.verification.rotation [--quick] [--out DIR]` prints the rows that reports.verification includes and a
Campbell table of a blade. Beams: the published flap factors (A.D. Wright, C.E. Smith, R.W. Thresher, J.L.C. Wang,
J. Appl. Mech. 49, 1982, 197; D.H. Hodges, M.J. Rutkowski, AIAA J. 19, 1981, 1459), quoted from memory of the
literature and computed anew by `rotating_beam`, which the tests hold against them to one in the last digit.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.polynomial import Polynomial, legendre

from casingfem.io.arrays import FloatArray
from casingfem.modal.campbell import Campbell, campbell
from casingfem.modal.interface.kinds import Rim
from casingfem.modal.reduction import reduce
from casingfem.modal.whirl import WhirlModes, whirl_modes
from casingfem.structure.edge.support import Clamped, ElasticEdge
from casingfem.structure.geometry.chart import Cylinder, Frustum, Plate
from casingfem.structure.geometry.rotation import Rotation
from casingfem.structure.material import Material
from casingfem.structure.mesh.shell_mesh import ShellMesh
from casingfem.structure.shell.shell import Shell
from contact.model.bodies.modal_body import ModalBody
from reports.tables import Row, check, command_line, show, write

STRIP = ShellMesh(order=8, rows=4, around=1)
RING = ShellMesh(order=7, rows=1, around=7)
STEEL = Material(E=210e9, nu=0.3, rho=7800.0)
SLENDER = Material(E=210e9, nu=0.0, rho=7800.0)  # without Poisson's ratio a strip is a beam, a band a ring
FACTORS = {
    0: (3.5160, 22.0345, 61.6972),
    1: (3.6817, 22.1810, 61.8418),
    2: (4.1373, 22.6149, 62.2732),
    3: (4.7973, 23.3203, 62.9850),
    4: (5.5850, 24.2734, 63.9668),
    5: (6.4495, 25.4461, 65.2050),
    6: (7.3604, 26.8091, 66.6839),
    12: (13.1702, 37.6031, 79.6145),
}  # eta = Omega L^2 sqrt(m/EI) -> flap factors omega L^2 sqrt(m/EI), as published


def rotating_beam(eta: float, count: int = 3, *, hub: float = 0.0, terms: int = 12) -> FloatArray:
    """Flap factors of a clamped-free uniform beam at eta, by Rayleigh-Ritz with x^2 times Legendre polynomials.

    int w''^2 + eta^2/2 [(1 + hub)^2 - (x + hub)^2] w'^2 = factor^2 int w^2, hub = hub radius over length.
    """
    x, weight = legendre.leggauss(40)
    x, weight = 0.5 * (x + 1.0), 0.5 * weight
    square = Polynomial([0.0, 0.0, 1.0])
    shapes = [square * legendre.Legendre.basis(k, domain=[0.0, 1.0]).convert(kind=Polynomial) for k in range(terms)]
    w, slope, bend = (np.array([shape.deriv(d)(x) if d else shape(x) for shape in shapes]) for d in range(3))
    tension = 0.5 * eta**2 * ((1.0 + hub) ** 2 - (x + hub) ** 2)
    K = (bend * weight) @ bend.T + (slope * weight * tension) @ slope.T
    root = np.linalg.inv(np.linalg.cholesky((w * weight) @ w.T))
    return np.asarray(np.sqrt(np.linalg.eigvalsh(root @ K @ root.T))[:count])


def strip(stagger: float, *, hub: float = 0.0) -> Shell:
    """A slender strip of length 1 and thickness .001 on a hub: a beam, but for 1e-6 of shear."""
    chart = Plate(length=1.0, width=0.03)
    rotation = Rotation.of_blade(chart, omega=0.0, hub_radius=hub, stagger=stagger)
    return Shell(
        chart=chart, thickness=1e-3, material=SLENDER, supports={"root": Clamped()}, rotation=rotation, mesh=STRIP
    )


def strip_factors(shell: Shell, eta: list[float], count: int) -> FloatArray:
    """Factors of the strip's lowest modes at each eta, (speeds, count)."""
    unit = float(np.sqrt(shell.material.E * shell.thickness**2 / 12.0 / shell.material.rho))
    return np.asarray(campbell(shell, unit * np.array(eta), count).freq * 2.0 * np.pi / unit)


def beam_rows(quick: bool) -> list[Row]:
    """Flap and lead-lag of the strip, the worst of three modes at each speed; one with a hub."""
    speeds = [1, 12] if quick else [1, 2, 3, 4, 5, 6, 12]
    rows = []
    for name, stagger, softened in (("flap", np.pi / 2.0, 0.0), ("lead-lag", 0.0, 1.0)):
        found = strip_factors(strip(stagger), [float(eta) for eta in speeds], 3)
        for eta, row in zip(speeds, found, strict=True):
            exact = np.sqrt(np.square(FACTORS[eta]) - softened * eta**2)
            k = int(np.abs(row / exact - 1.0).argmax())
            case = f"A8 rotating beam, {name}, eta {eta}, worst of 3: mode {k + 1}"
            rows.append(check(case, "Wright et al., Hodges & Rutkowski", exact[k], row[k], 0.0038))
    found, exact = strip_factors(strip(np.pi / 2.0, hub=1.5), [6.0], 3)[0], rotating_beam(6.0, hub=1.5)
    k = int(np.abs(found / exact - 1.0).argmax())
    case = f"A8 rotating beam, flap, eta 6, hub radius 1.5 L, worst of 3: mode {k + 1}"
    return [*rows, check(case, "beam theory, Ritz", exact[k], found[k], 0.0013)]


def ring_waves(n: int, omega: float, *, still: float, springs: float) -> tuple[float, float]:
    """Forward and backward frequencies [rad/s] of a thin ring that turns with its springs, in the rotating frame.

    Inextensional, with the hoop tension of its own rotation (the problem of G.F. Carrier, Quart. Appl. Math. 3, 1945,
    235); with u_r = -dv/dtheta and v = q e^(i n theta) Lagrange's equation is one quadratic in omega:
    omega = -+ 2 n Omega/(n^2 + 1) + sqrt(still^2 + springs + Omega^2 n^2 (n^2 - 1)^2/(n^2 + 1)^2), `still` the
    frequency at rest, `springs` the radial and tangential stiffness per mass.
    """
    shift = 2.0 * n * omega / (n**2 + 1)
    middle = float(np.sqrt(still**2 + springs + omega**2 * n**2 * (n**2 - 1) ** 2 / (n**2 + 1) ** 2))
    return middle - shift, middle + shift


def drum(radius: float, height: float, thickness: float, omega: float, k: float) -> Shell:
    """A cylinder that turns with springs of stiffness k per mass and direction, half of them at each edge."""
    per_length = 0.5 * k * SLENDER.rho * thickness * height
    edge = ElasticEdge(k_r=per_length, k_theta=per_length, k_z=per_length)
    return Shell(
        chart=Cylinder(radius=radius, height=height), thickness=thickness, material=SLENDER,
        supports={"base": edge, "top": edge}, rotation=Rotation(omega=omega), mesh=RING,
    )  # fmt: skip


def in_plane(found: WhirlModes, n: int, sense: int) -> float:
    """Lowest frequency [rad/s] of a wave of n that moves in the plane of rotation."""
    axial = np.abs(found.fields[:, 2]).max(axis=0)
    k = np.flatnonzero((found.nodal_diameters == n) & (found.sense == sense) & (axial < 0.1))[0]
    return float(2.0 * np.pi * found.freq[k])


def ring_rows() -> list[Row]:
    """Waves n = 1 to 4 of a thin ring whose tension is several times its bending stiffness."""
    radius, height, thickness, omega = 0.5, 0.004, 0.002, 100.0
    k = 1.5 * omega**2
    found = whirl_modes(drum(radius, height, thickness, omega, k), 18)
    bending = np.sqrt(SLENDER.E * thickness**2 / 12.0 / SLENDER.rho) / radius**2
    rows = []
    for n in (1, 2, 3, 4):
        still = float(bending * n * (n**2 - 1) / np.sqrt(n**2 + 1))
        waves = ring_waves(n, omega, still=still, springs=k)
        for name, sense, exact in (("forward", 1, waves[0]), ("backward", -1, waves[1])):
            case = f"A8 rotating ring, {name} wave, n = {n}"
            rows.append(check(case, "ring theory, closed form", exact, in_plane(found, n, sense), 0.022))
    return rows


def precession_rows() -> list[Row]:
    """A rigid drum on springs that tilts: nu^2 -+ (2 - r) Omega nu = (r - 1) Omega^2 + k_tilt/I_t, r = I_p/I_t."""
    radius, height, thickness, omega = 0.5, 0.6, 0.05, 20.0
    k = 1.5 * omega**2
    found = whirl_modes(drum(radius, height, thickness, omega, k), 8)
    about_axis = radius**2 + thickness**2 / 4.0
    across = about_axis / 2.0 + height**2 / 12.0
    ratio, tilt = about_axis / across, k * (radius**2 / 2.0 + height**2 / 4.0) / across
    p, q = 0.5 * (2.0 - ratio) * omega, (ratio - 1.0) * omega**2 + tilt
    rows = []
    for name, sense, exact in (("forward", 1, np.sqrt(p**2 + q) - p), ("backward", -1, np.sqrt(p**2 + q) + p)):
        waves = np.flatnonzero((found.nodal_diameters == 1) & (found.sense == sense))
        near = min((2.0 * np.pi * float(found.freq[k]) for k in waves), key=lambda value: abs(value - exact))
        rows.append(check(f"A8 rigid drum that tilts, {name}", "Euler's equations", exact, near, 6e-4))
    return rows


def reduced_rows(quick: bool) -> list[Row]:
    """Whirl of bodies reduced at rest against that of their full models on the same mesh: the worst of the lowest."""
    frustum = Shell(
        chart=Frustum(r_base=0.5, r_top=0.45, height=0.25), thickness=3e-3, material=STEEL,
        supports={"base": Clamped()}, mesh=ShellMesh(order=6, rows=2, around=15) if quick else ShellMesh(),
    )  # fmt: skip
    ring = replace(drum(0.5, 0.004, 0.002, 0.0, 86400.0), rotation=None)
    cases = [("frustum", frustum, 16, (1200.0,) if quick else (300.0, 1200.0, 2700.0)), ("ring", ring, 6, (400.0,))]
    found = []
    for name, casing, count, speeds in cases:
        body = ModalBody.of(reduce(casing, Rim("top", n_max=4), modes=20))
        for rpm in speeds:
            omega = 2.0 * np.pi * rpm / 60.0
            exact = whirl_modes(replace(casing, rotation=Rotation(omega=omega)), count).freq
            poles = body.poles(omega).imag
            computed = poles[poles > 0.0][:count] / (2.0 * np.pi)
            k = int(np.abs(computed / exact - 1.0).argmax())
            case = f"A8 reduced {name}, whirl at {rpm:g} rpm, worst of {count}: mode {k + 1}"
            found.append(check(case, "whirl_modes of the full model", exact[k], computed[k], 3.5e-5))
    return found


def rows(quick: bool) -> list[Row]:
    """A8: beams, ring and drum, and reduced bodies."""
    return beam_rows(quick) + ring_rows() + precession_rows() + reduced_rows(quick)


def blade(hub_radius: float = 0.3) -> Shell:
    """A blade of 110 x 40 x 2 mm on a hub, its chord along the axis."""
    chart = Plate(length=0.11, width=0.04)
    rotation = Rotation.of_blade(chart, omega=0.0, hub_radius=hub_radius)
    return Shell(chart=chart, thickness=2e-3, material=STEEL, supports={"root": Clamped()}, rotation=rotation)


def table(data: Campbell) -> list[Row]:
    """Frequencies against speed, one row a speed."""
    return [
        {"speed Hz": float(speed)} | {f"f{k + 1} Hz": float(value) for k, value in enumerate(freq)}
        for speed, freq in zip(data.speed_hz, data.freq, strict=True)
    ]


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print rows and the Campbell table, and write both."""
    found = rows(quick)
    show("Rotating parts", found)
    shell = blade()
    if quick:
        shell = replace(shell, mesh=ShellMesh(order=6, rows=3, around=1))
    data = campbell(shell, 2.0 * np.pi * np.linspace(0.0, 200.0, 3 if quick else 9), count=4)
    lines = table(data)
    show("Campbell: blade 110 x 40 x 2 mm, steel, hub radius .3 m, rotating frame, without Coriolis forces", lines)
    print("Southwell coefficients at rest:", "  ".join(f"{value:.3f}" for value in data.southwell))
    write(out / "verify_rotation.csv", found)
    write(out / "campbell.csv", lines)
    return found


if __name__ == "__main__":
    command_line(__doc__, main)
