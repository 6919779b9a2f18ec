"""Splitting rules: which doublets an imperfection splits, and by how much.

`python -m reports.verification.splitting [--quick] [--out DIR]` prints one row for each rule and writes splitting.csv.

- A field cos p theta splits n only if 2n = k p; N equal springs only if N divides 2n: every other doublet stays
  double to all orders. Turning the field changes no frequency. Measured on the reference frustum.
- Thin free ring in its plane, first order, cos less sin member (theory by Rayleigh's quotient), for relative waves
  e cos 2n theta of: thickness, e (n^2 + 2)/(n^2 + 1); radius, -e (4 n^2 - 1)/(n^2 + 1); modulus, e/2; density,
  -(e/2) (n^2 - 1)/(n^2 + 1). Measured on a free cylinder as short as a ring.
"""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from casingfem.modal.modes import Modes, modes
from casingfem.structure.edge.support import ElasticEdge
from casingfem.structure.field.fourier import FourierField
from casingfem.structure.geometry.chart import Cylinder
from casingfem.structure.material import Material
from casingfem.structure.mesh.shell_mesh import ShellMesh
from casingfem.structure.shell.shell import Shell
from reports.tables import Row, check, command_line, show, write
from reports.verification.modes.frustum import reference_frustum

ODD = ShellMesh(order=8, rows=1, around=37)  # shares no factor with a field's waves
BOLTED = ShellMesh(order=8, rows=1, around=24)  # a multiple of the springs' number
RING = ShellMesh(order=8, rows=1, around=13)
STEEL = Material(E=210e9, nu=0.3, rho=7800.0)
COUNT = 24
DOUBLE = 1e-7  # per cent: a relative split of 1e-9
RULE = "rule: n splits only if 2n = k p"


SLOPES: dict[str, Callable[[int], float]] = {
    "thickness": lambda n: (n**2 + 2) / (n**2 + 1),
    "radius": lambda n: -(4 * n**2 - 1) / (n**2 + 1),
    "modulus": lambda n: 0.5,
    "density": lambda n: -0.5 * (n**2 - 1) / (n**2 + 1),
}


def fields() -> dict[str, dict[str, FourierField]]:
    """Imperfections whose harmonics are multiples of one p: name -> fields."""
    return {
        "cos 8, radius 0.2 %": {"radius_defect": FourierField.of({8: 0.002})},
        "cos 6, thickness 5 %": {"thickness_defect": FourierField.of({6: 0.05})},
        "p = 10, radius 0.1 % and thickness 3.6 %": {
            "radius_defect": FourierField.of({10: 0.001}),
            "thickness_defect": FourierField.of({10: (0.02, 0.03)}),
        },
        "cos 8, modulus 4 %": {"modulus_defect": FourierField.of({8: 0.04})},
        "cos 6, density 5 %": {"density_defect": FourierField.of({6: 0.05})},
    }


def forbidden(found: Modes, p: int) -> tuple[float, float]:
    """Largest split of the doublets that must stay double, and of those that may part."""
    n = np.array([found.nodal_diameters[low] for low, _ in found.doublets])
    barred = 2 * n % p != 0
    return float(found.splits[barred].max()), float(found.splits[~barred].max())


def stays_double(name: str, shell: Shell, p: int, rule: str) -> Row:
    """A row on the doublets that p may not split."""
    barred, split = forbidden(modes(shell, COUNT, method="shell"), p)
    return check(f"forbidden splits, {name} (others to {100 * split:.2g} %)", rule, 0.0, barred, DOUBLE)


def sprung(number: int) -> Shell:
    """The frustum on springs that vary `number` times around."""
    around = FourierField.of({number: (0.9, 0.0)})
    supports = {"base": ElasticEdge(k_face=1e12, around=around)}
    return replace(reference_frustum(BOLTED), supports=supports)


TURNED: dict[str, dict[str, FourierField]] = {
    "radius, 8 and 5 waves": {"radius_defect": FourierField.of({8: 0.002, 5: (0.001, 0.001)})},
    "modulus, 8 and 5 waves": {"modulus_defect": FourierField.of({8: 0.04, 5: (0.02, 0.02)})},
    "density, 8 and 5 waves": {"density_defect": FourierField.of({8: 0.04, 5: (0.02, 0.02)})},
}
MIXED = {"radius_defect": FourierField.of({2: 0.002, 3: (0.001, 0.0005), 4: 0.001, 5: 0.0005, 8: 0.001})}


def turned(name: str, parts: dict[str, FourierField], mesh: ShellMesh | None) -> Row:
    """Largest change of a frequency when the imperfections are turned, on a mesh or on the default one."""
    shells = [
        replace(reference_frustum(), mesh=mesh, **{key: field.rotated(angle) for key, field in parts.items()})
        for angle in (0.0, 0.4567, 2.0)
    ]
    still, *others = (modes(shell, COUNT).freq for shell in shells)
    change = max(float(np.abs(freq / still - 1.0).max()) for freq in others)
    return check(f"{name}, turned by .457 and 2 rad", "invariance of the casing", 0.0, change, DOUBLE)


def ring(n: int, kind: str, relative: float = 1e-3) -> Row:
    """Slope of the in-plane split of a thin ring, R/h = 100, by one of its fields."""
    shell = Shell(
        chart=Cylinder(radius=1.0, height=0.02),
        thickness=0.01,
        material=STEEL,
        mesh=RING,
        **{f"{kind}_defect": FourierField.of({2 * n: relative})},
    )
    cosine, sine = in_plane(modes(shell, 4 * n + 6), n)
    slope = (cosine - sine) / (0.5 * (cosine + sine))
    case = f"ring, n = {n}, cos {2 * n} in the {kind}: slope"
    return check(case, "thin ring, first order", SLOPES[kind](n), slope / relative, 0.3)


def in_plane(found: Modes, n: int) -> tuple[float, float]:
    """Frequencies [Hz] of the cosine and the sine member of a ring's in-plane pair."""
    axial = np.abs(found.fields[:, 2]).max(axis=0) / np.abs(found.fields[:, :2]).max(axis=(0, 1))
    pair = np.flatnonzero((found.nodal_diameters == n) & (axial < 0.3))
    angle = found.angle_deg[pair] % (180.0 / n)
    cosine = np.minimum(angle, 180.0 / n - angle) < 45.0 / n
    return float(found.freq[pair][cosine].mean()), float(found.freq[pair][~cosine].mean())


def checks(quick: bool = False) -> list[Row]:
    """All rows; the quick ones are one of each kind."""
    chosen = list(fields().items())[: 1 if quick else None]
    rows = [
        stays_double(name, replace(reference_frustum(ODD), **parts), p, RULE)
        for (name, parts), p in zip(chosen, (8, 6, 10, 8, 6), strict=False)
    ]
    springs = (8,) if quick else (6, 8)
    rows += [stays_double(f"{n} springs", sprung(n), n, "rule: N divides 2n") for n in springs]
    if not quick:
        rows += [turned(name, parts, ODD) for name, parts in TURNED.items()]
        rows.append(turned("radius, five harmonics, default mesh", MIXED, None))
    numbers = (2,) if quick else (2, 3, 4, 5, 6)
    return rows + [ring(n, kind) for kind in SLOPES for n in numbers]


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the rows and write them."""
    rows = checks(quick)
    show("Splitting rules", rows)
    write(out / "splitting.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
