"""Blades against independent solutions: skew and tapered plates, tapered beams, other charts, a solid blade.

`python -m reports.verification.blades [--quick] [--out DIR]` prints and writes verify_blades.csv; reports.verification
has the same rows. FV22's printed frequencies scatter by -.5 to +1.0 % about the converged first-order shear theory. The
report therefore compares with a Ritz solution of that theory in skew coordinates, computed here, and with 3-D
elasticity.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.polynomial import legendre
from scipy.linalg import eigh

from casingfem.io.arrays import FloatArray
from casingfem.linalg.eigen import solve_modes
from casingfem.modal.modes import modes
from casingfem.structure.edge.support import Clamped
from casingfem.structure.geometry.blade import Blade, TwistedPlate
from casingfem.structure.geometry.chart import Chart, Panel
from casingfem.structure.geometry.stations import Law, Taper, coefficients
from casingfem.structure.material import Material
from casingfem.structure.mesh.element import gauss
from casingfem.structure.mesh.kinematics import frame
from casingfem.structure.mesh.shell_mesh import ShellMesh
from casingfem.structure.shell.assembly import assemble
from casingfem.structure.shell.shell import Shell
from reports.tables import DATA, Row, check, command_line, show, write
from reports.verification.spectral_solid import Orders, solid_modes, unit_cube
from reports.verification.tapered_beam import cantilever, wedge

NAFEMS = Material(E=200e9, nu=0.3, rho=8000.0)
TITANIUM = Material(E=114e9, nu=0.33, rho=4430.0)
SIDE, HEIGHT = 10.0, 10.0 / np.sqrt(2.0)
RHOMBUS = Blade(length=HEIGHT, chord=SIDE, sweep=(0.0, HEIGHT))
TRAPEZOID = Blade(length=10.0, chord=(5.0, 1.0))


def reference(case: str) -> pd.DataFrame:
    """The rows of one NAFEMS case."""
    table = pd.read_csv(DATA / "reference" / "nafems_free_vibration.csv", comment="#")
    return table[table.case == case]


def rhombus(**changes: object) -> Shell:
    """FV22: side 10 m, 45 degrees, 1 m thick, clamped all round."""
    supports = dict.fromkeys(RHOMBUS.edges, Clamped())
    return Shell(chart=RHOMBUS, thickness=1.0, material=NAFEMS, supports=supports, **changes)


def bubbles(order: int, x: FloatArray) -> FloatArray:
    """Polynomials P_(i+2) - P_i, i < order, nothing at both ends of [0, 1], and their slopes: (2, order, points)."""
    table = np.zeros((order, order + 2))
    table[np.arange(order), np.arange(order)], table[np.arange(order), np.arange(order) + 2] = -1.0, 1.0
    t = 2.0 * x - 1.0
    slopes = np.array([2.0 * legendre.legval(t, legendre.legder(row)) for row in table])
    return np.stack([legendre.legval(t, table.T), slopes])


def skew_mindlin(shell: Shell, order: int) -> FloatArray:
    """Bending frequencies [Hz] of the clamped rhombus, by Ritz with `order`^2 polynomials for w, psi_x and psi_y.

    V = 1/2 int D (psi_x,x^2 + psi_y,y^2 + 2 nu psi_x,x psi_y,y + (1 - nu)/2 (psi_x,y + psi_y,x)^2)
      + kappa G t |psi + grad w|^2,  x = height u, y = side v + height u.
    """
    x, weight = gauss(order + 3)
    f, df = bubbles(order, x)
    value, by_u, by_v = (np.einsum("iq,jr->ijqr", a, b).reshape(order**2, -1) for a, b in ((f, f), (df, f), (f, df)))
    by_x, by_y = by_u / HEIGHT - by_v / SIDE, by_v / SIDE  # u = x/height, v = (y - x)/side
    area = np.outer(weight, weight).ravel() * SIDE * HEIGHT
    t, steel = shell.thickness, shell.material
    rigidity, nu = steel.E * t**3 / (12.0 * (1.0 - steel.nu**2)), steel.nu
    shear = float(shell.shear_factor(np.asarray(steel.nu))) * steel.shear_modulus * t
    none = np.zeros_like(value)
    strains = [
        (rigidity * (1.0 + nu) / 2.0, [none, by_x, by_y]),
        (rigidity * (1.0 - nu) / 2.0, [none, by_x, -by_y]),
        (rigidity * (1.0 - nu) / 2.0, [none, by_y, by_x]),
        (shear, [by_x, value, none]),
        (shear, [by_y, none, value]),
    ]
    K = sum(factor * (np.vstack(s) * area) @ np.vstack(s).T for factor, s in strains)
    own = (value * area) @ value.T
    M = np.kron(np.diag(steel.rho * np.array([t, t**3 / 12.0, t**3 / 12.0])), own)
    return np.sqrt(eigh(K, M, eigvals_only=True, subset_by_index=[0, 7])) / (2.0 * np.pi)


def rhombic_solid(orders: Orders, count: int) -> FloatArray:
    """Frequencies [Hz] of the solid rhombus, clamped on its four side faces."""
    u, v, z = unit_cube(orders)
    held = (u == 0.0) | (u == 1.0) | (v == 0.0) | (v == 1.0)
    place = np.array([HEIGHT * u, SIDE * v + HEIGHT * u, z - 0.5])
    return solid_modes(place, held, orders, NAFEMS, count) / (2.0 * np.pi)


def fv22(quick: bool) -> list[Row]:
    """The clamped thick rhombus: a linear wall against the same theory and the print, the curved one against the solid.

    On a flat plate they differ in the shear factor alone, 5/6 and 5/(6 - nu).
    """
    linear = rhombus(wall="linear")
    found = modes(linear, 6).freq
    exact = skew_mindlin(linear, 12 if quick else 16)
    rows = [
        check(f"A5 FV22 thick rhombus, mode {k + 1}", "Mindlin, Ritz", exact[k], found[k], 0.0045) for k in range(5)
    ]
    for k, printed in enumerate(reference("FV22").frequency_hz):
        gap = 100.0 * (exact[k] / printed - 1.0)
        reason = f"the print: the same theory by Ritz is {gap:.2f} % off it"
        case = f"A5 FV22 thick rhombus, mode {k + 1}"
        rows.append(check(case, "NAFEMS, printed", printed, found[k], 0.2, gap=abs(gap) + 0.01, reason=reason))
    if not quick:
        solid = rhombic_solid((12, 12, 4), 1)[0]
        reason = "t/side = .1: first-order shear theory, its clamped edge lets the faces warp"
        curved, case = modes(rhombus(), 1).freq[0], "A5 FV22 thick rhombus, mode 1"
        rows.append(check(case, "3-D elasticity", solid, curved, 0.2, gap=0.58, reason=reason))
    return rows


def membrane(shell: Shell, count: int) -> FloatArray:
    """In-plane frequencies [Hz] of a flat shell: its block of u_x and u_y, which nothing couples to the rest."""
    system = assemble(shell)
    own = np.flatnonzero(system.free % 5 < 2)
    other = np.flatnonzero(system.free % 5 >= 2)
    coupling = abs(system.K[own][:, other]).max()
    if coupling > 1e-12 * abs(system.K).max():
        raise ValueError(f"the shell is not flat: in-plane and bending motions share {coupling:.3g} N/m")
    found = solve_modes(system.K[own][:, own].tocsc(), system.mass[own], count, shift=-1e3)
    return np.sqrt(found.eigenvalues) / (2.0 * np.pi)


def fv32() -> list[Row]:
    """The tapered membrane in its plane, on the default mesh."""
    shell = Shell(chart=TRAPEZOID, thickness=0.05, material=NAFEMS, supports={"root": Clamped()})
    found = membrane(shell, 6)
    rows = []
    for k, row in enumerate(reference("FV32").itertuples()):
        case = f"A5 FV32 tapered membrane, mode {k + 1}"
        rows.append(check(case, "2-D, converged", row.check_hz, found[k], 0.0011))
        rows.append(check(case, "NAFEMS, printed", row.frequency_hz, found[k], 0.075))
    return rows


def slender(chord: Law, thick: Law) -> Shell:
    """A long thin strip that is a beam: nu = 0, stiff in shear, length 1 m, chord at most 40 mm, thickness 5 mm."""
    bare = Material(E=200e9, nu=0.0, rho=8000.0)
    scaled = tuple(0.04 * c for c in np.atleast_1d(chord))
    return Shell(
        chart=Blade(length=1.0, chord=scaled), thickness=5e-3, material=bare, supports={"root": Clamped()},
        taper=Taper(along=thick), shear_correction=20.0, mesh=ShellMesh(order=10, rows=3, around=1),
    )  # fmt: skip


def beams(quick: bool) -> list[Row]:
    """Flapping of tapered strips against Euler-Bernoulli beams; chord and thickness relative to the root's."""
    laws: list[tuple[str, Law, Law]] = [
        ("wedge, tip .2", 1.0, (1.0, 0.2)),
        ("trapezoid, tip .2", (1.0, 0.2), 1.0),
        ("chord and thickness, tip .4", (1.0, 0.4), (1.0, 0.4)),
    ]
    scale = 5e-3 * np.sqrt(200e9 / (12.0 * 8000.0))  # sqrt(E I/(rho A))/L^2 of the root
    rows = []
    for name, chord, thick in laws[:1] if quick else laws:
        c, t = (np.polynomial.Polynomial(coefficients(law)) for law in (chord, thick))
        omega = modes(slender(chord, thick), 8).omega / scale
        for k, factor in enumerate(cantilever(c * t**3, c * t, 1 if quick else 3)):
            near = float(omega[np.abs(omega / factor - 1.0).argmin()])
            rows.append(check(f"blade as a beam, {name}, flap {k + 1}", "Euler-Bernoulli", factor, near, 0.015))
    exact, found = wedge(0.2, 1)[0], float(str(rows[0]["computed"]))
    return [*rows, check("blade as a beam, wedge, tip .2, flap 1", "Kirchhoff, Bessel", exact, found, 3.8e-4)]


def limits() -> list[Row]:
    """Blades in the limits of other charts: the largest difference of eight frequencies."""
    pairs: list[tuple[str, Chart, Blade]] = [
        (
            "camber alone is a panel",
            Panel(radius=0.6096, length=0.3048, angle=0.5),
            Blade(length=0.3048, chord=2.0 * 0.6096 * float(np.sin(0.25)), camber=0.5),
        ),
        (
            "twist alone is a twisted plate",
            TwistedPlate(length=0.3, width=0.1, twist=0.8),
            Blade(length=0.3, chord=0.1, twist=(0.0, 0.8)),
        ),
    ]
    rows = []
    for name, own, blade in pairs:
        shell = Shell(chart=own, thickness=3e-3, material=TITANIUM, supports={"root": Clamped()},
                      mesh=ShellMesh(order=8, rows=2, around=1))  # fmt: skip
        one, other = modes(shell, 8).freq, modes(replace(shell, chart=blade), 8).freq
        worst = int(np.abs(other / one - 1.0).argmax())
        rows.append(check(f"blade: {name}, worst of 8", "its own chart", one[worst], other[worst], 1e-7))
    return rows


def fan_blade() -> Shell:
    """A blade with everything: camber and chord fall, the twist grows, it is swept, leant, thinner at tip and edges."""
    chart = Blade(
        length=0.2,
        chord=(0.12, 0.1, 0.09),
        camber=(0.6, 0.2),
        twist=(0.1, 0.6),
        sweep=(0.0, 0.0, 0.02),
        lean=(0.0, 0.01),
    )
    return Shell(
        chart=chart, thickness=4e-3, material=TITANIUM, supports={"root": Clamped()},
        taper=Taper(along=(1.0, 0.6), across=(0.6, 1.0, 0.6)), mesh=ShellMesh(order=10, rows=2, around=1),
    )  # fmt: skip


def as_solid(shell: Shell, orders: Orders, count: int) -> FloatArray:
    """Frequencies [Hz] of the solid between the faces X +- t/2 along the normal, clamped at its root face."""
    u, v, w = unit_cube(orders)
    (a0, a1), (b0, b1) = shell.chart.bounds
    at = shell.geometry(a0 + (a1 - a0) * u, b0 + (b1 - b0) * v)
    place = at.surface.x + frame(at.surface).normal * at.thickness * (w - 0.5)
    return solid_modes(place, u == 0.0, orders, shell.material, count) / (2.0 * np.pi)


def against_solid(quick: bool) -> list[Row]:
    """The blade with everything against 3-D elasticity on the same faces."""
    shell, count = fan_blade(), 8
    found, solid = modes(shell, count).freq, as_solid(shell, (10, 10, 2) if quick else (14, 14, 3), count)
    return [
        check(
            f"blade of every law against a solid, mode {k + 1}",
            "3-D elasticity",
            solid[k],
            found[k],
            0.6 if quick else 0.2,
        )
        for k in range(count)
    ]


def rows(quick: bool) -> list[Row]:
    """All of them."""
    return fv22(quick) + fv32() + beams(quick) + limits() + against_solid(quick)


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print and write them."""
    found = rows(quick)
    show("Blades", found)
    write(out / "verify_blades.csv", found)
    return found


if __name__ == "__main__":
    command_line(__doc__, main)
