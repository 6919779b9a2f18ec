"""Ring stiffeners on a wall of 3 mm against bricks of wall and rings together, nodal diameters 0 to 10.

`python -m reports.verification.modes.stiffeners [--quick] [--out DIR]` prints one table and writes stiffeners.csv. The
rings are beams tied to the mid-surface (`Stiffener`); the bricks, 27-noded, are a narrow sector of a wheel
(`cyclic_modes`), on two meshes. Casings are clamped at the base. Compared are the two lowest frequencies of each nodal
diameter with the finer bricks; beside them, what the coarser ones differ by, and what the rings are worth: the casing
without rings, and with their centres in the wall. A web touches the wall along its depth, a beam in a line: shells are
softer.
--quick takes one casing and coarser bricks.
"""

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from casingfem.io.arrays import FloatArray
from casingfem.modal.cyclic.modes import cyclic_modes
from casingfem.modal.fourier import lowest
from casingfem.structure.edge.ring import Stiffener
from casingfem.structure.edge.section import Section
from casingfem.structure.edge.support import Clamped
from casingfem.structure.geometry.pieces import Piece, PiecewiseMeridian
from casingfem.structure.geometry.revolved import Revolved
from casingfem.structure.imported.cyclic.sector import CyclicSector
from casingfem.structure.imported.grid import end_group, grid_mesh
from casingfem.structure.imported.mesh.mesh_data import MeshData
from casingfem.structure.imported.solid import Solid
from casingfem.structure.shell.axisymmetric import harmonic_matrices
from casingfem.structure.shell.shell import Shell
from reports.tables import Row, command_line, show, write
from reports.verification.modes.meridians import STEEL, WALL, profile_of

HIGHEST, EACH, SECTORS = 10, 2, 400  # nodal diameters, modes of each, sectors of the bricks' wheel
STRAIGHT = (Piece(to=(0.3, 0.25)),)
CONED = (Piece(to=(0.3, 0.15)), Piece(to=(0.3 - 0.15 * 3**-0.5, 0.30)))
Rings = tuple[tuple[float, float, float], ...]  # at, width, depth [m]; width below 0: inside
CASINGS: dict[str, tuple[tuple[Piece, ...], Rings]] = {
    "cylinder, two rings of 12 x 4 mm outside": (STRAIGHT, ((0.08, 0.012, 0.004), (0.16, 0.012, 0.004))),
    "cylinder, two of them inside": (STRAIGHT, ((0.08, -0.012, 0.004), (0.16, -0.012, 0.004))),
    "cylinder, one ring of 20 x 8 mm outside": (STRAIGHT, ((0.125, 0.020, 0.008),)),
    "cylinder and cone of 30 degrees, one of 12 x 4 mm": (CONED, ((0.075, 0.012, 0.004),)),
}


def stiffened(pieces: tuple[Piece, ...], rings: Rings, eccentric: bool = True) -> Shell:
    """The casing on a chart."""
    profile = PiecewiseMeridian(start=(0.3, 0.0), pieces=pieces, fillet=WALL)
    stiffeners = tuple(
        Stiffener(
            at=at,
            section=Section.rectangle(width=abs(width), depth=depth),
            offset=(0.5 * (width + np.sign(width) * WALL) * eccentric, 0.0),
        )
        for at, width, depth in rings
    )
    return Shell(
        chart=Revolved(profile=profile),
        thickness=WALL,
        material=STEEL,
        supports={"base": Clamped()},
        stiffeners=stiffeners,
    )


def bricks(shell: Shell, rings: Rings, finer: int) -> CyclicSector:
    """Wall and rings as one solid: cells through the wall and the rings' width, around, along the meridian."""
    profile, width = profile_of(shell), rings[0][1]
    ends = sorted({*profile.lines.tolist(), *(at + side * d for at, _, d in rings for side in (-0.5, 0.5))})
    longest = 0.006 / finer
    counts = [max(int(np.ceil((b - a) / longest)), 2 * finer) for a, b in pairwise(ends)]
    parts = [np.linspace(a, b, n + 1)[1:] for (a, b), n in zip(pairwise(ends), counts, strict=True)]
    rows = np.concatenate([[0.0], *parts])
    count, layers = len(rows) - 1, 3 * finer
    levels = np.concatenate([np.linspace(-0.5, 0.5, 3), 0.5 + np.linspace(0.0, abs(width) / WALL, layers + 1)[1:]])
    levels = levels if width > 0.0 else -levels[::-1]

    def place(u: FloatArray) -> FloatArray:
        through = np.interp(u[:, 0] * (layers + 2), np.arange(layers + 3), levels)
        at = profile.at(np.interp(u[:, 2] * count, np.arange(count + 1), rows))
        theta = 2.0 * np.pi / SECTORS * u[:, 1]
        r, z = at.r + through * WALL * at.z1, at.z - through * WALL * at.r1
        return np.stack([r * np.cos(theta), r * np.sin(theta), z], axis=1)

    grid = grid_mesh("hexahedron27", (layers + 2, 1, count), lambda u: u)
    middle = grid.points[grid.cells].mean(axis=1)
    s = np.interp(middle[:, 2] * count, np.arange(count + 1), rows)
    wall = np.abs(np.interp(middle[:, 0] * (layers + 2), np.arange(layers + 3), levels)) < 0.5
    kept = wall | np.any([np.abs(s - at) < 0.5 * depth for at, _, depth in rings], axis=0)
    used, cells = np.unique(grid.cells[kept], return_inverse=True)
    u = grid.points[used]
    mesh = MeshData(kind=grid.kind, points=place(u), cells=cells.reshape(-1, grid.cells.shape[1]), source="bricks")
    mesh = replace(mesh, groups={"base": end_group(mesh, u[:, 2] == 0.0)})
    return CyclicSector(structure=Solid(mesh=mesh, material=STEEL, supports={"base": Clamped()}), sectors=SECTORS)


def frequencies(shell: Shell) -> FloatArray:
    """The lowest of each nodal diameter [Hz], (diameters, EACH)."""
    values = [lowest(harmonic_matrices(shell, n), EACH, 1e4)[0] for n in range(HIGHEST + 1)]
    return np.asarray(np.sqrt(values) / (2.0 * np.pi))


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print and write the table; returns its rows."""
    rows: list[Row] = []
    for name, (pieces, rings) in list(CASINGS.items())[: 1 if quick else None]:
        shell = stiffened(pieces, rings)
        coarse, exact = (
            cyclic_modes(bricks(shell, rings, k), EACH, diameters=range(HIGHEST + 1)).freq.reshape(-1, EACH)
            for k in ((1, 1) if quick else (1, 2))
        )
        own = frequencies(shell)
        bare, centred = frequencies(replace(shell, stiffeners=())), frequencies(stiffened(pieces, rings, False))
        for n in range(HIGHEST + 1):
            row: Row = {"casing": name, "n": n, "bricks [Hz]": float(exact[n, 0]), "shell [Hz]": float(own[n, 0])}
            others = {"shell": own, "coarser bricks": coarse, "no rings": bare, "rings centred": centred}
            row |= {f"{what} %": float(100.0 * (part[n, 0] / exact[n, 0] - 1.0)) for what, part in others.items()}
            row["shell, second mode %"] = float(100.0 * (own[n, 1] / exact[n, 1] - 1.0))
            rows.append(row)
    show("Ring stiffeners: lowest frequency of each n against bricks", rows)
    write(out / "stiffeners.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
