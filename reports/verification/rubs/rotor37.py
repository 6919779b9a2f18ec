"""NASA rotor 37 before a steel cylinder of 4 mm: a blade of published geometry, its mesh, its basis and its scene.

`python -m reports.verification.rubs.rotor37 [--quick] [--out DIR]` meshes the blade of data/reference/nasa_rotor_37.csv
in 18-Ni-200 maraging steel, clamped at the hub section, and compares its frequencies at rest and at the design speed of
17,188.7 rpm with those of CalculiX 2.20 on as many bricks. `reports.verification.rubs.beside` runs the scene: the tip
20 um from a steel cylinder that is 50 um out of round with four lobes.
"""

import math
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.interpolate import RegularGridInterpolator

import casingfem as cf
import contact as ct
from casingfem.io.arrays import FloatArray
from casingfem.modal.interface.mesh_rows import facets_of, tip_frame
from reports.tables import DATA, Row, check, command_line, show, write

DESIGN = 17188.7 / 60.0  # turns/s
MARAGING = cf.Material(E=180e9, nu=0.3, rho=8000.0)
STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
AXIS = (1.0, 0.0, 0.0)
CELLS, COARSE = (24, 20), (12, 10)  # along chord and span
CALCULIX = {0.0: (865.6, 2468.1, 3141.2, 4751.2), DESIGN: (1102.6, 2516.1, 3402.2, 4818.8)}  # Hz, 24 x 20 x 1 bricks
ALLOWED, OF_COARSE = 0.15, 1.5  # %
WALL, HEIGHT = 4e-3, 0.12  # m


def sections() -> FloatArray:
    """Sections from hub to tip, stations along the chord, then z, r, theta_1, theta_2: (12, 33, 4)."""
    table = pd.read_csv(DATA / "reference" / "nasa_rotor_37.csv", comment="#")
    return table.iloc[:, 1:].to_numpy().reshape(int(table["section"].max()), -1, 4)


def blade(cells: tuple[int, int] = CELLS, speed_hz: float = DESIGN) -> cf.Solid:
    """The blade in bricks of 20 nodes, one through its thickness, turning about x; groups "hub" and "tip"."""
    given = sections()
    axes = [np.linspace(0.0, 1.0, size) for size in given.shape[:2]]
    at = RegularGridInterpolator(axes, given, method="cubic")

    def place(unit: FloatArray) -> FloatArray:
        """Unit coordinates along chord, span and thickness -> positions."""
        z, r, first, second = at(unit[:, [1, 0]]).T
        theta = first + (second - first) * unit[:, 2]
        return np.stack([z, r * np.sin(theta), r * np.cos(theta)], axis=1)

    mesh = cf.imported.grid_mesh("hexahedron20", (*cells, 1), place, groups={"hub": (1, 0.0), "tip": (1, 1.0)})
    rotation = cf.Rotation(omega=2.0 * math.pi * speed_hz, axis=AXIS)
    return cf.Solid(mesh=mesh, material=MARAGING, supports={"hub": cf.Clamped()}, rotation=rotation)


def lean_deg(part: cf.Solid) -> float:
    """Angle of the radius at the tip from the tip's span towards its flap [deg]."""
    system = part.assembled()
    facets = facets_of(system, "tip")
    span, flap, _ = tip_frame(system, facets, "tip")
    middle = np.average(facets.x, axis=0, weights=facets.weight) * [0.0, 1.0, 1.0]
    return math.degrees(math.atan2(flap @ middle, span @ middle))


def scene(cells: tuple[int, int] = CELLS, speed_hz: float = 298.0) -> ct.Scene:
    """The tip before the cylinder, without friction."""
    part = blade(cells)
    cylinder = cf.Shell(
        chart=cf.Cylinder(radius=float(sections()[-1, :, 1].mean()), height=HEIGHT), thickness=WALL, material=STEEL,
        supports={"base": cf.Clamped()}, mesh=cf.ShellMesh(order=6, rows=2, around=24),
    )  # fmt: skip
    tip = cf.reduce(part, cf.Tip("tip"), modes=4, zeta=1e-3)
    rim = cf.reduce(cylinder, cf.Rim("top", n_max=12), modes=26, zeta=2e-3)
    rub = ct.RotatingRim(
        ct.ModalBody.of(rim), ct.ModalBody.of(tip), clearance=2e-5, speed_hz=speed_hz, lean_deg=lean_deg(part),
        out_of_roundness=[{"p": 4, "cos": 5e-5}],
    )  # fmt: skip
    return ct.Scene(what=rub, law=ct.Unilateral(), t_end=0.2, dt=1e-5)


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the frequencies beside those of CalculiX; write rotor37.csv."""
    cells, allowed = (COARSE, OF_COARSE) if quick else (CELLS, ALLOWED)
    rows = [
        check(f"rotor 37 at {60.0 * speed:.0f} rpm, mode {k}", "CalculiX 2.20", reference, float(found), allowed)
        for speed, references in CALCULIX.items()
        for k, (reference, found) in enumerate(
            zip(references, cf.modes(blade(cells, speed), len(references)).freq, strict=True), 1
        )
    ]
    show("NASA rotor 37, clamped at the hub section", rows)
    write(out / "rotor37.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
