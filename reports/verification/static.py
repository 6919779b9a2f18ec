"""The static obstacle set of MacNeal & Harder (1985) on named meshes.

`python -m reports.verification.static [--quick] [--out DIR]` prints the rows that reports.verification includes, then
two studies of what a row means: the pinched cylinder's displacement under its point force against the mesh (it has no
limit on a shear shell, and one in the thin-shell limit), and the full hemisphere's against the hole left at its pole.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd

from casingfem.structure.edge.support import Clamped, ElasticEdge, ShearDiaphragm, Symmetry
from casingfem.structure.geometry.blade import TwistedPlate
from casingfem.structure.geometry.chart import Panel
from casingfem.structure.geometry.revolved import Arc, RevolvedPanel
from casingfem.structure.material import Material
from casingfem.structure.mesh.shell_mesh import ShellMesh
from casingfem.structure.shell.loads import EdgeLoad, PointLoad, SurfaceLoad
from casingfem.structure.shell.shell import Shell
from casingfem.structure.shell.static import solve_static
from reports.tables import DATA, Row, check, command_line, show, write

REFERENCE = DATA / "reference" / "macneal_harder_static.csv"
SOURCE = "MacNeal & Harder"
QUARTER = np.pi / 2.0
ROOF = ShellMesh(order=8, rows=2, around=2)
PINCHED = ShellMesh(order=8, rows=4, around=4)
BOWL = ShellMesh(order=8, rows=4, around=4)
BEAM = ShellMesh(order=8, rows=4, around=1)
THIN = 1e4  # shear correction of the thin-shell limit


def mesh_name(mesh: ShellMesh) -> str:
    """How a row names its mesh."""
    return f"{len(mesh.breaks) - 1} x {mesh.columns}, order {mesh.order}"


def roof(mesh: ShellMesh = ROOF) -> float:
    """Scordelis-Lo roof, half its length: vertical displacement at the middle of a free edge, downwards."""
    shell = Shell(
        chart=Panel(radius=25.0, length=25.0, angle=float(np.radians(80.0))),
        thickness=0.25,
        material=Material(E=4.32e8, nu=0.0, rho=1.0),
        supports={"root": ShearDiaphragm(), "tip": Symmetry()},
        mesh=mesh,
    )
    (_, middle), (_, side) = shell.chart.bounds
    return -float(solve_static(shell, [SurfaceLoad(force=(-90.0, 0.0, 0.0))]).at(middle, side)[0])


def pinched(mesh: ShellMesh = PINCHED, shear_correction: float = 5.0 / 6.0) -> float:
    """Pinched cylinder, an eighth of it: displacement under the force, inwards."""
    shell = Shell(
        chart=Panel(radius=300.0, length=300.0, angle=QUARTER),
        thickness=3.0,
        material=Material(E=3e6, nu=0.3, rho=1.0),
        supports={"root": Symmetry(), "tip": ShearDiaphragm(), "left": Symmetry(), "right": Symmetry()},
        shear_correction=shear_correction,
        mesh=mesh,
    )
    place = (0.0, QUARTER / 2.0)
    inwards = -np.array([np.cos(place[1]), np.sin(place[1]), 0.0])
    force = PointLoad(at=place, force=tuple(0.25 * inwards))
    return float(inwards @ solve_static(shell, [force]).at(*place))


def hemisphere(hole_deg: float, mesh: ShellMesh = BOWL, shear_correction: float = 5.0 / 6.0) -> float:
    """Hemisphere with a hole at its pole, a quarter of it: displacement along the outward force.

    The forces balance along the axis, where a soft spring at the hole holds the shell.
    """
    shell = Shell(
        chart=RevolvedPanel(profile=Arc(radius=10.0, start=0.0, end=float(np.radians(90.0 - hole_deg))), angle=QUARTER),
        thickness=0.04,
        material=Material(E=6.825e7, nu=0.3, rho=1.0),
        supports={"left": Symmetry(), "right": Symmetry(), "tip": ElasticEdge(k_z=1e-3)},
        shear_correction=shear_correction,
        mesh=mesh,
    )
    side = QUARTER / 2.0
    right, left = (np.array([np.cos(angle), np.sin(angle), 0.0]) for angle in (side, -side))
    forces = [PointLoad(at=(0.0, side), force=tuple(right)), PointLoad(at=(0.0, -side), force=tuple(-left))]
    return float(right @ solve_static(shell, forces).at(0.0, side))


def beam(thickness: float, force: float, direction: tuple[float, float, float], mesh: ShellMesh = BEAM) -> float:
    """Twisted beam: displacement at the middle of the tip along a force spread over the tip."""
    shell = Shell(
        chart=TwistedPlate(length=12.0, width=1.1, twist=QUARTER),
        thickness=thickness,
        material=Material(E=29e6, nu=0.22, rho=1.0),
        supports={"root": Clamped()},
        mesh=mesh,
    )
    per_length = tuple(force / 1.1 * np.array(direction))
    return float(np.dot(direction, solve_static(shell, [EdgeLoad(edge="tip", force=per_length)]).at(12.0, 0.0)))


def rows(quick: bool) -> list[Row]:
    """A6: every problem of the set; quick leaves out the hemispheres and one of the pinched cylinders."""
    value = pd.read_csv(REFERENCE, comment="#").set_index("case").value
    sinks = "a point force sinks into a shear shell without limit; its thin-shell limit has a row"

    def row(name: str, mesh: ShellMesh, case: str, computed: float, gap: float = 0.0) -> Row:
        return check(f"A6 {name}, {mesh_name(mesh)}", SOURCE, float(value[case]), computed, 0.75, gap=gap, reason=sinks)

    found = [row("Scordelis-Lo roof, half", ROOF, "scordelis-lo", roof())]
    if not quick:
        found.append(row("pinched cylinder, an eighth", PINCHED, "pinched-cylinder", pinched(), gap=1.5))
        found.append(row("hemisphere, 18 deg hole, a quarter", BOWL, "hemisphere-hole", hemisphere(18.0)))
        found.append(row("hemisphere, hole of .1 deg, a quarter", BOWL, "hemisphere-full", hemisphere(0.1)))
    thin = pinched(shear_correction=THIN)
    found.append(row("pinched cylinder, thin-shell limit", PINCHED, "pinched-cylinder", thin))
    directions = {"in-plane": (0.0, 0.0, 1.0), "out-of-plane": (0.0, 1.0, 0.0)}
    for name, thickness, force in (("thick", 0.32, 1.0), ("thin", 0.0032, 1e-6)):
        for way, direction in directions.items():
            computed = beam(thickness, force, direction)
            found.append(row(f"twisted beam, t {thickness:g}, {way}", BEAM, f"twisted-beam-{name}-{way}", computed))
    return found


def point_force(quick: bool) -> list[Row]:
    """The pinched cylinder on finer and finer meshes: a shear shell sinks in, a thin shell does not."""
    meshes = [replace(PINCHED, rows=n, around=n) for n in ((2, 4) if quick else (2, 4, 8))]
    return [
        {"mesh": mesh_name(mesh), "shear shell": pinched(mesh), "thin-shell limit": pinched(mesh, THIN)}
        for mesh in meshes
    ]


def poles(quick: bool) -> list[Row]:
    """The hemisphere's displacement as the hole at its pole closes."""
    holes = (1.0, 0.1) if quick else (18.0, 5.0, 2.0, 1.0, 0.5, 0.1, 0.02)
    return [{"hole deg": hole, "displacement": hemisphere(hole)} for hole in holes]


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print rows and studies, and write the rows."""
    found = rows(quick)
    show("Static obstacle set", found)
    show("Pinched cylinder: displacement under its point force", point_force(quick))
    show("Hemisphere: displacement against the hole at its pole", poles(quick))
    write(out / "verify_static.csv", found)
    return found


if __name__ == "__main__":
    command_line(__doc__, main)
