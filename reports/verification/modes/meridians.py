"""Meridians of several pieces on a chart against imported quadrilaterals and 3-D elasticity of the same bends.

`python -m reports.verification.modes.meridians [--quick] [--out DIR]` prints one table and writes meridians.csv. Each
casing is clamped at its base; the two others are meshed as a narrow sector of a wheel (`cyclic_modes`), quadrilaterals
of nine nodes on the chart's own mid-surface, bricks of 27 nodes half the wall to each side of it. Frequencies of the
two lowest modes of each nodal diameter 0 to 8 are compared, chart over the other less one, and the chart's with a
corner of half the radius. --quick takes two casings and coarser quadrilaterals.

Bricks are stiff in bending, by an error that falls with the square of their length. At the bend of 30 degrees the
largest difference is 0.153, 0.098 and 0.056 % with bricks of 8, 6 and 4 mm, so it tends to 0.02 %. The chart's own
error is 5e-4 %.
"""

from itertools import pairwise
from pathlib import Path

import numpy as np

from casingfem.io.arrays import FloatArray
from casingfem.modal.cyclic.modes import CyclicModes, cyclic_modes
from casingfem.modal.modes import modes
from casingfem.structure.edge.support import Clamped
from casingfem.structure.geometry.pieces import Piece, PiecewiseMeridian
from casingfem.structure.geometry.revolved import Revolved
from casingfem.structure.geometry.strip import Strip
from casingfem.structure.imported.cyclic.sector import CyclicSector
from casingfem.structure.imported.grid import grid_mesh
from casingfem.structure.imported.mesh.mesh_data import Group, MeshData
from casingfem.structure.imported.shell import MeshShell
from casingfem.structure.imported.solid import Solid
from casingfem.structure.material import Material
from casingfem.structure.shell.shell import Shell
from reports.tables import Row, command_line, show, write

STEEL = Material(E=210e9, nu=0.3, rho=7800.0)
WALL, HIGHEST = 3e-3, 8  # thickness [m], nodal diameters
BRICK = 4e-3  # longest brick [m]
Walls = dict[int, float]  # number of a piece, from 0, -> its own thickness [m]
CASINGS: dict[str, tuple[tuple[Piece, ...], Walls]] = {
    "cylinder and cone of 30 degrees": ((Piece(to=(0.3, 0.15)), Piece(to=(0.3 - 0.15 * 3**-0.5, 0.30))), {}),
    "the same, cone of 5 mm": ((Piece(to=(0.3, 0.15)), Piece(to=(0.3 - 0.15 * 3**-0.5, 0.30))), {1: 5e-3}),
    "cylinder and cone of 60 degrees": ((Piece(to=(0.3, 0.15)), Piece(to=(0.2, 0.15 + 0.1 * 3**-0.5))), {}),
    "cylinder and flange": ((Piece(to=(0.3, 0.20)), Piece(to=(0.34, 0.20))), {}),
    "cylinder, arc, cylinder": (
        (Piece(to=(0.3, 0.10)), Piece(to=(0.2, 0.20), radius=0.1), Piece(to=(0.2, 0.25))),
        {},
    ),
}  # the arc leaves the first cylinder smoothly and meets the second at a right angle


def chart_shell(pieces: tuple[Piece, ...], walls: Walls, fillet: float) -> Shell:
    """The casing on a chart."""
    profile = PiecewiseMeridian(start=(0.3, 0.0), pieces=pieces, fillet=fillet)
    strips = tuple(Strip(start=profile.owners[k][0], end=profile.owners[k][1], thickness=t) for k, t in walls.items())
    return Shell(
        chart=Revolved(profile=profile), thickness=WALL, material=STEEL, supports={"base": Clamped()}, strips=strips
    )


def stations(shell: Shell, longest: float, least: int) -> FloatArray:
    """Arc lengths of element lines: those of the meridian and its strips, and at least so many rows between two."""
    profile = profile_of(shell)
    ends = sorted({*profile.lines.tolist(), *(end for strip in shell.strips for end in (strip.start, strip.end))})
    counts = [max(int(np.ceil((b - a) / longest)), least) for a, b in pairwise(ends)]
    parts = [np.linspace(a, b, n + 1)[1:] for (a, b), n in zip(pairwise(ends), counts, strict=True)]
    return np.concatenate([[0.0], *parts])


def profile_of(shell: Shell) -> PiecewiseMeridian:
    """The meridian of a casing."""
    assert isinstance(shell.chart, Revolved)
    assert isinstance(shell.chart.profile, PiecewiseMeridian)
    return shell.chart.profile


def sector(shell: Shell, *, rows: FloatArray, sectors: int, solid: bool) -> CyclicSector:
    """A narrow sector of the casing, meshed."""
    profile, count = profile_of(shell), len(rows) - 1

    def place(u: FloatArray) -> FloatArray:
        through = u[:, 0] - 0.5 if solid else np.zeros(len(u))
        s = np.interp(u[:, -1] * count, np.arange(count + 1), rows)
        at, theta = profile.at(s), 2.0 * np.pi / sectors * u[:, -2]
        t = shell.geometry(s, theta, np.interp(u[:, -1] * count, np.arange(count + 1), rows)).thickness
        r, z = at.r + through * t * at.z1, at.z - through * t * at.r1
        return np.stack([r * np.cos(theta), r * np.sin(theta), z], axis=1)

    if solid:
        mesh = grid_mesh("hexahedron27", (2, 1, count), place, groups={"base": (2, 0.0)})
        part: Solid | MeshShell = Solid(mesh=mesh, material=STEEL, supports={"base": Clamped()})
        return CyclicSector(structure=part, sectors=sectors)
    mesh = grid_mesh("quad9", (2, count), place, groups={"base": (1, 0.0)})
    middle = np.tile(rows[:-1] + 0.5 * np.diff(rows), 2)  # of each cell
    groups, thicknesses = dict(mesh.groups), {}
    for k, strip in enumerate(shell.strips):
        cells = np.flatnonzero(strip.covers(middle))
        groups[f"strip {k}"], thicknesses[f"strip {k}"] = (
            Group(nodes=mesh.cells[cells].ravel(), cells=cells),
            strip.thickness,
        )
    mesh = MeshData(kind=mesh.kind, points=mesh.points, cells=mesh.cells, groups=groups)
    part = MeshShell(mesh=mesh, thickness=WALL, thicknesses=thicknesses, material=STEEL, supports={"base": Clamped()})
    return CyclicSector(structure=part, sectors=sectors)


def lowest(shell: Shell) -> dict[int, FloatArray]:
    """The two lowest frequencies of each nodal diameter [Hz]."""
    count, found = 60, modes(shell, 60)
    while min(np.count_nonzero(found.nodal_diameters == n) for n in range(HIGHEST + 1)) < 2:
        count *= 2
        found = modes(shell, count)
    return {n: found.freq[found.nodal_diameters == n][:: 2 if n else 1][:2] for n in range(HIGHEST + 1)}


def errors(own: dict[int, FloatArray], other: CyclicModes | dict[int, FloatArray]) -> FloatArray:
    """Relative differences over the modes that both have."""
    found = []
    for n, freq in own.items():
        theirs = other[n] if isinstance(other, dict) else other.freq[other.nodal_diameters == n]
        shared = min(len(freq), len(theirs))
        found.append(freq[:shared] / theirs[:shared] - 1.0)
    return np.concatenate(found)


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print and write the table; returns its rows."""
    rows: list[Row] = []
    for name, (pieces, walls) in list(CASINGS.items())[: 2 if quick else None]:
        fillet = max(WALL, *walls.values()) if walls else WALL
        shell = chart_shell(pieces, walls, fillet)
        own = lowest(shell)
        quads = sector(
            shell, rows=stations(shell, 0.012 if quick else 0.006, 4 if quick else 8), sectors=60, solid=False
        )
        row: Row = {"casing": name, "modes": sum(map(len, own.values()))}
        compared = {"quadrilaterals": errors(own, cyclic_modes(quads, 2, diameters=range(HIGHEST + 1)))}
        if not walls:  # a step of the wall is no bend of bricks
            bricks = sector(shell, rows=stations(shell, BRICK, 8), sectors=400, solid=True)
            compared["3-D"] = errors(own, cyclic_modes(bricks, 2, diameters=range(HIGHEST + 1)))
            compared["half the fillet"] = errors(own, lowest(chart_shell(pieces, walls, 0.5 * fillet)))
        for what in ("quadrilaterals", "3-D", "half the fillet"):
            error = compared.get(what)
            row[f"{what}: worst %"] = None if error is None else float(100.0 * np.abs(error).max())
            row[f"{what}: rms %"] = None if error is None else float(100.0 * np.sqrt(np.mean(error**2)))
        rows.append(row)
    show("Meridians of several pieces: chart against", rows)
    write(out / "meridians.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
